#include "runtime/doctor/doctor.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "formats/command/command.h"
#include "formats/file/confinement.h"
#include "runtime/loop/histogram.h"
#include "runtime/machine/real_time.h"
#include "runtime/query/query_kernel.h"

namespace forcelayer::doctor {
namespace {

namespace fs = std::filesystem;

constexpr long long kPeriodNs = 1'000'000;
constexpr double kQuietUs = 100;  // p99.9 of waking late on a machine that is set up for it
constexpr rlim_t kEnoughMemory = rlim_t{1} << 30;

std::string read_text(const fs::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  std::string all = text.str();
  while (!all.empty() && (all.back() == '\n' || all.back() == ' ' || all.back() == 0)) {
    all.pop_back();
  }
  return all;
}

std::vector<fs::path> entries(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code failure;
  for (fs::directory_iterator at(folder, failure), end; !failure && at != end;
       at.increment(failure)) {
    found.push_back(at->path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

Finding good(std::string what, std::string seen) {
  return {std::move(what), Verdict::kGood, std::move(seen), ""};
}
Finding note(std::string what, std::string seen) {
  return {std::move(what), Verdict::kNote, std::move(seen), ""};
}
Finding change(std::string what, std::string seen, std::string mend) {
  return {std::move(what), Verdict::kChange, std::move(seen), std::move(mend)};
}

// ---- what the loop asks of the system: tried, not guessed

Finding real_time_priority() {
  std::vector<std::string> refused;
  std::thread([&] { refused = machine::take_real_time_priority(); }).join();
  if (refused.empty()) return good("real-time priority", "SCHED_FIFO is granted");
  rlimit limit{};
  getrlimit(RLIMIT_RTPRIO, &limit);
  return change("real-time priority",
                "refused (rtprio limit " + std::to_string(limit.rlim_max) + ")",
                "add '@realtime - rtprio 90' to /etc/security/limits.d/realtime.conf, then "
                "'sudo groupadd -f realtime; sudo usermod -aG realtime $USER', and log in again");
}

Finding memory_locking() {
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  const bool refused = mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) != 0;
  if (!refused) munlockall();
  if (!refused && (geteuid() == 0 || limit.rlim_cur == RLIM_INFINITY)) {
    return good("memory locking", "granted, without limit");
  }
  const std::string seen = limit.rlim_cur == RLIM_INFINITY
                               ? std::string("refused")
                               : "limited to " + std::to_string(limit.rlim_cur >> 20) + " MiB";
  if (!refused && limit.rlim_cur >= kEnoughMemory) return good("memory locking", seen);
  return change("memory locking", seen,
                "add '@realtime - memlock unlimited' to /etc/security/limits.d/realtime.conf, join "
                "the group realtime, and log in again");
}

Finding real_time_throttling(const fs::path& root) {
  const std::string runtime = read_text(root / "proc/sys/kernel/sched_rt_runtime_us");
  const std::string period = read_text(root / "proc/sys/kernel/sched_rt_period_us");
  if (runtime.empty()) return note("real-time throttling", "not known");
  if (runtime == "-1") return good("real-time throttling", "off");
  return note("real-time throttling",
              "real-time threads get " + runtime + " of every " + period +
                  " us: this is enough, and the machine still responds if a loop never sleeps");
}

// ---- kernel and processor

Finding kernel_preemption(const fs::path& root) {
  utsname name{};
  uname(&name);
  const std::string version = name.version, release = name.release;
  if (read_text(root / "sys/kernel/realtime") == "1" ||
      version.find("PREEMPT_RT") != std::string::npos) {
    return good("kernel preemption", release + ": PREEMPT_RT");
  }
  const bool dynamic = version.find("PREEMPT_DYNAMIC") != std::string::npos;
  const bool full = version.find("PREEMPT") != std::string::npos && !dynamic;
  return change("kernel preemption",
                release + ": " +
                    (full      ? "PREEMPT"
                     : dynamic ? "PREEMPT_DYNAMIC"
                               : "no preemption") +
                    ", not PREEMPT_RT: delays of a millisecond or more are possible",
                std::string("install linux-image-rt-amd64") +
                    (dynamic ? ", or at least boot with preempt=full" : ""));
}

Finding frequency_governor(const fs::path& root) {
  std::vector<std::string> others;
  std::size_t seen = 0;
  for (const fs::path& cpu : entries(root / "sys/devices/system/cpu")) {
    const std::string governor = read_text(cpu / "cpufreq/scaling_governor");
    if (governor.empty()) continue;
    ++seen;
    if (governor != "performance") others.push_back(governor);
  }
  if (seen == 0) {
    return note("frequency governor",
                "the system offers no choice (it is a virtual machine, or the firmware decides)");
  }
  if (others.empty()) return good("frequency governor", "performance on all cores");
  return change("frequency governor",
                others.front() + " on " + std::to_string(others.size()) + " of " +
                    std::to_string(seen) + " cores: these cores are slow after a sleep",
                "sudo cpupower frequency-set -g performance");
}

Finding idle_states(const fs::path& root) {
  const fs::path latency = root / "dev/cpu_dma_latency";
  std::error_code failure;
  if (entries(root / "sys/devices/system/cpu/cpu0/cpuidle").empty()) {
    return note("idle states", "the system reports no idle states");
  }
  if (!fs::exists(latency, failure))
    return note("idle states", "this system cannot limit idle states");
  if (access(latency.c_str(), W_OK) == 0) {
    return note(
        "idle states",
        "deep idle states are allowed, but programs can prevent them with /dev/cpu_dma_latency");
  }
  return change(
      "idle states", "deep idle states are allowed, and /dev/cpu_dma_latency is not writable",
      "boot with processor.max_cstate=1 intel_idle.max_cstate=1 on a haptics workstation");
}

Finding cores() {
  const unsigned count = std::thread::hardware_concurrency();
  const std::string seen = std::to_string(count) + ", instruction set " + query::kernel_target();
  if (count >= 4) return good("cores", seen);
  return change(
      "cores", seen + ": the loop shares the cores with graphics and driver",
      "use a machine with four cores or more, or run nothing else while a hand holds the device");
}

Finding virtual_machine(const fs::path& root) {
  const bool guest = read_text(root / "proc/cpuinfo").find(" hypervisor") != std::string::npos;
  if (!guest) return good("virtual machine", "no");
  return change("virtual machine",
                "yes: the host can stop a core at any time; cores were stopped for " +
                    std::to_string(static_cast<long long>(machine::steal_seconds())) +
                    " s since boot",
                "run the loop on a real machine, and never drive motors from a virtual machine");
}

Finding clock_source(const fs::path& root) {
  const std::string source =
      read_text(root / "sys/devices/system/clocksource/clocksource0/current_clocksource");
  if (source.empty()) return note("clock source", "not known");
  if (source == "tsc" || source == "kvm-clock" || source == "arch_sys_counter") {
    return good("clock source", source);
  }
  return change("clock source", source + ": each reading of the clock takes microseconds",
                "boot with tsc=reliable if the processor's TSC is invariant");
}

Finding swap(const fs::path& root) {
  const std::string table = read_text(root / "proc/swaps");
  const bool in_use = std::count(table.begin(), table.end(), '\n') > 0;
  if (!in_use) return good("swap", "none");
  return note("swap", "swap space exists; this is harmless where memory locking is granted");
}

// The kernel's means to confine a device plugin and the readers of --sandbox.
Finding confinement() {
  const int version = landlock_version();
  const std::string files = version > 0 ? "Landlock " + std::to_string(version) : "";
  const std::string calls = filters_system_calls() ? "seccomp" : "";
  if (version > 0 && !calls.empty()) return good("confinement of plugins", files + ", " + calls);
  return change("confinement of plugins",
                files + calls + (files.empty() && calls.empty() ? "none" : " only") +
                    ": a device plugin can do more than it should",
                "boot a kernel with Landlock and seccomp (lsm=landlock,...)");
}

// ---- devices

// "HID_ID=0003:0000256F:0000C635" gives "256f:c635".
std::string hid_name(const fs::path& node, const fs::path& root) {
  const std::string text = read_text(root / "sys/class/hidraw" / node.filename() / "device/uevent");
  std::string vendor, name;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("HID_ID=", 0) == 0 && line.size() >= 29) {
      vendor = line.substr(16, 4) + ":" + line.substr(25, 4);
    }
    if (line.rfind("HID_NAME=", 0) == 0) name = line.substr(9);
  }
  std::transform(vendor.begin(), vendor.end(), vendor.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name.empty() ? vendor : name + " (" + vendor + ")";
}

constexpr const char* kUdevRule =
    "KERNEL==\"hidraw*\", ATTRS{idVendor}==\"xxxx\", ATTRS{idProduct}==\"yyyy\", TAG+=\"uaccess\"";

std::vector<Finding> hid_devices(const fs::path& root) {
  std::vector<Finding> found;
  for (const fs::path& node : entries(root / "dev")) {
    if (node.filename().string().rfind("hidraw", 0) != 0) continue;
    const std::string seen = hid_name(node, root);
    if (access(node.c_str(), R_OK | W_OK) == 0) {
      found.push_back(good(node.filename().string(), seen + ": you may use it"));
    } else {
      found.push_back(note(
          node.filename().string(),
          seen + ": you have no permission; if this is the haptic device, see \"udev rules\""));
    }
  }
  if (found.empty()) found.push_back(note("HID devices", "no HID device is plugged in"));
  return found;
}

// Whether a rule file gives the user at the screen a hidraw device by its vendor.
bool gives_hidraw(const fs::path& rule) {
  std::istringstream lines(read_text(rule));
  for (std::string line; std::getline(lines, line);) {
    const auto has = [&](const char* word) { return line.find(word) != std::string::npos; };
    if (line[0] != '#' && has("hidraw") && has("uaccess") && has("idVendor")) return true;
  }
  return false;
}

Finding udev_rules(const fs::path& root) {
  for (const char* folder : {"etc/udev/rules.d", "usr/lib/udev/rules.d", "lib/udev/rules.d"}) {
    for (const fs::path& rule : entries(root / folder)) {
      if (!gives_hidraw(rule)) continue;
      // 73-seat-late.rules grants what carries the tag by then.
      if (rule.filename().string() < "73") return good("udev rules", rule.filename().string());
      return change("udev rules", rule.filename().string() + " is read too late to take effect",
                    "rename it to 70-haptics.rules");
    }
  }
  return change(
      "udev rules", "no rule lets users access a hidraw device",
      std::string("write '") + kUdevRule +
          "' with the ids of the device into /etc/udev/rules.d/70-haptics.rules, then run 'sudo "
          "udevadm control --reload; sudo udevadm trigger'");
}

// ---- the clock, measured

void sleep_through(double seconds, loop::DurationHistogram& late) {
  static_cast<void>(machine::take_real_time_priority());
  const auto ticks = static_cast<long long>(seconds * 1e9) / kPeriodNs;
  long long tick_ns = machine::monotonic_ns();
  for (long long i = 0; i < ticks; ++i) {
    tick_ns = std::max(tick_ns + kPeriodNs, machine::monotonic_ns());
    machine::sleep_until_ns(tick_ns);
    late.record(machine::monotonic_ns() - tick_ns);
  }
}

Finding clock_quality(double seconds) {
  const auto late = std::make_unique<loop::DurationHistogram>();
  std::thread([&] { sleep_through(seconds, *late); }).join();
  const auto us = [&](double fraction) {
    return static_cast<double>(late->quantile_ns(fraction)) / 1000;
  };
  std::ostringstream seen;
  seen.precision(3);
  seen << "wake-up delay p50 " << us(0.5) << " us, p99 " << us(0.99) << " us, p99.9 " << us(0.999)
       << " us, max " << us(1) << " us at 1 kHz in " << seconds << " s";
  if (us(0.999) < kQuietUs) return good("clock", seen.str());
  return change(
      "clock", seen.str(),
      "make the changes listed above, and run nothing else on the machine while the loop runs");
}

const char* to_text(Verdict verdict) {
  switch (verdict) {
    case Verdict::kGood:
      return "good";
    case Verdict::kChange:
      return "change";
    case Verdict::kNote:
      break;
  }
  return "note";
}

nlohmann::ordered_json findings_json(const std::vector<Finding>& findings) {
  nlohmann::ordered_json json;
  json["version"] = command::kVersion;
  json["findings"] = nlohmann::ordered_json::array();
  for (const Finding& f : findings) {
    json["findings"].push_back(
        {{"what", f.what}, {"verdict", to_text(f.verdict)}, {"seen", f.seen}, {"mend", f.mend}});
  }
  return json;
}

}  // namespace

std::vector<Finding> examine_machine(const fs::path& root, double clock_s) {
  std::vector<Finding> findings = {real_time_priority(),
                                   memory_locking(),
                                   real_time_throttling(root),
                                   kernel_preemption(root),
                                   frequency_governor(root),
                                   idle_states(root),
                                   cores(),
                                   virtual_machine(root),
                                   clock_source(root),
                                   swap(root),
                                   confinement()};
  for (Finding& device : hid_devices(root)) findings.push_back(std::move(device));
  findings.push_back(udev_rules(root));
  if (clock_s > 0) findings.push_back(clock_quality(clock_s));
  return findings;
}

std::string findings_text(const std::vector<Finding>& findings) {
  std::string text;
  std::size_t changes = 0;
  for (const Finding& f : findings) {
    std::string verdict = to_text(f.verdict);
    verdict.resize(7, ' ');
    text += verdict + f.what + ": " + f.seen + "\n";
    if (f.verdict != Verdict::kChange) continue;
    text += "       -> " + f.mend + "\n";
    ++changes;
  }
  return text + (changes == 0 ? "nothing to change\n"
                              : "changes to make before a hand holds a device with motors: " +
                                    std::to_string(changes) + "\n");
}

Status run_doctor(const DoctorOptions& options) {
  const auto findings = examine_machine("/", options.clock_s);
  if (!options.quiet) std::cout << findings_text(findings) << std::flush;
  return options.json.empty() ? Status{}
                              : command::write_report(options.json, findings_json(findings));
}

}  // namespace forcelayer::doctor
