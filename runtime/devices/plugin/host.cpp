// voxrun-plugin: the process in which a device plugin runs (runtime/devices/plugin/plugin_device.h
// starts it). It drives the plugin, keeps watch over the loop, and dies alone.
//   voxrun-plugin LIBRARY ARGUMENTS PARENT trusted|confined, with the shared memory at descriptor 3
#include <dlfcn.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <glm/geometric.hpp>
#include <string>
#include <thread>

#include "formats/file/confinement.h"
#include "runtime/devices/output_watch.h"
#include "runtime/devices/plugin/plugin_link.h"
#include "runtime/machine/real_time.h"

namespace forcelayer::devices {
namespace {

constexpr int kLinkDescriptor = 3;
constexpr long long kLookNs = 50'000'000;      // for the loop's process
constexpr long long kCloseNs = 2'000'000'000;  // that closing may take without it

std::atomic<bool> ended{false};
extern "C" void end_on_signal(int) { ended.store(true, std::memory_order_relaxed); }

void fail(PluginLink& link, const std::string& what) {
  std::snprintf(link.error.data(), link.error.size(), "%s", what.c_str());
  link.state.store(PluginState::kFailed, std::memory_order_release);
}

// Carries readings from the plugin to the loop, and watched wrenches back.
class Exchange {
 public:
  Exchange(PluginLink& link, pid_t parent, const forcelayer_plugin_info& info)
      : link_(link),
        parent_(parent),
        max_force_n_(info.max_force_n),
        max_torque_nm_(info.max_torque_nm),
        watch_(link.stale_s, 1 / info.rate_hz) {}

  // The loop says so, or is no more.
  bool ending() const {
    return ended.load(std::memory_order_relaxed) ||
           link_.stop.load(std::memory_order_acquire) != 0 || getppid() != parent_;
  }

  void give(const forcelayer_plugin_reading& reading) {
    readings_.put(link_.readings,
                  {reading, ++sequence_, watch_.latched() ? 1u : 0u, watch_.falls()});
  }

  void lose() { link_.state.store(PluginState::kLost, std::memory_order_release); }

  forcelayer_plugin_wrench wrench() {
    commands_.take(link_.commands, command_);
    forcelayer_plugin_wrench out{};
    if (ending() || command_.written_ns == 0 || !link_.whole() || commands_.broken()) return out;
    const double* f = command_.wrench.force_n;
    const double* t = command_.wrench.torque_nm;
    const Wrench newest{{f[0], f[1], f[2]}, {t[0], t[1], t[2]}};
    // The loop keeps within the ratings: what does not, the plugin itself wrote over.
    if (!(glm::length(newest.force_n) <= max_force_n_ * kRounding &&
          glm::length(newest.torque_nm) <= max_torque_nm_ * kRounding)) {
      watch_.latch();
      return out;
    }
    const Wrench watched = watch_.pass(newest, command_.written_ns, machine::monotonic_ns());
    for (int axis = 0; axis < 3; ++axis) {
      out.force_n[axis] = watched.force_n[axis];
      out.torque_nm[axis] = watched.torque_nm[axis];
    }
    return out;
  }

 private:
  static constexpr double kRounding = 1 + 1e-9;

  PluginLink& link_;
  pid_t parent_;
  double max_force_n_, max_torque_nm_;
  OutputWatch watch_;
  machine::ValueProducer<PluginReading> readings_;
  machine::ValueConsumer<PluginCommand> commands_;
  PluginCommand command_{};
  std::uint64_t sequence_ = 0;
};

extern "C" int exchange_once(void* context, const forcelayer_plugin_reading* reading,
                             forcelayer_plugin_wrench* wrench) {
  auto& exchange = *static_cast<Exchange*>(context);
  if (reading != nullptr) {
    exchange.give(*reading);
  } else {
    exchange.lose();
  }
  *wrench = exchange.wrench();
  return exchange.ending() ? 1 : 0;
}

// Pull mode: this process keeps the clock.
void pull(const forcelayer_plugin& plugin, void* device, double rate_hz, Exchange& exchange) {
  const auto period_ns = static_cast<long long>(1e9 / rate_hz);
  long long tick_ns = machine::monotonic_ns();
  while (!exchange.ending()) {
    forcelayer_plugin_reading reading{};
    const int read = plugin.read(device, &reading);
    if (read > 0) exchange.give(reading);
    const forcelayer_plugin_wrench wrench = exchange.wrench();
    const int written = plugin.write(device, &wrench);
    if (read < 0 || written < 0) return exchange.lose();
    tick_ns = std::max(tick_ns + period_ns, machine::monotonic_ns() - period_ns);
    machine::sleep_until_ns(tick_ns);
  }
  const forcelayer_plugin_wrench zero{};
  plugin.write(device, &zero);
}

const forcelayer_plugin* load(const char* library, PluginLink& link) {
  void* const handle = dlopen(library, RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    fail(link, std::string("cannot be loaded: ") + dlerror());
    return nullptr;
  }
  const auto entry =
      reinterpret_cast<forcelayer_plugin_entry_function>(dlsym(handle, "forcelayer_plugin_entry"));
  const forcelayer_plugin* plugin = entry != nullptr ? entry(FORCELAYER_PLUGIN_ABI) : nullptr;
  if (entry == nullptr) {
    fail(link, "is not a plugin: it has no function forcelayer_plugin_entry");
  } else if (plugin == nullptr) {
    fail(link, "does not support version 1 of the interface");
  } else if (plugin->open == nullptr || plugin->close == nullptr ||
             (plugin->run == nullptr && (plugin->read == nullptr || plugin->write == nullptr))) {
    fail(link, "must have open() and close(), and either run(), or read() and write()");
    return nullptr;
  }
  return plugin;
}

// A driver that hangs does not notice the end of the loop. This ends its process then.
void end_after(pid_t parent) {
  std::thread([parent] {
    while (getppid() == parent) machine::sleep_until_ns(machine::monotonic_ns() + kLookNs);
    machine::sleep_until_ns(machine::monotonic_ns() + kCloseNs);
    _exit(1);
  }).detach();
}

int serve(const char* library, const char* arguments, pid_t parent, PluginLink& link) {
  const forcelayer_plugin* plugin = load(library, link);
  if (plugin == nullptr) return 1;
  end_after(parent);
  void* device = nullptr;
  std::array<char, 200> error{};
  forcelayer_plugin_info info{};
  if (plugin->open(arguments, &info, &device, error.data(), error.size()) != 0) {
    error.back() = 0;
    fail(link, std::string("does not open its device: ") +
                   (error[0] != 0 ? error.data() : "the plugin gives no reason"));
    return 1;
  }
  link.info = info;
  link.state.store(PluginState::kOpen, std::memory_order_release);
  machine::lock_memory();
  machine::take_real_time_priority(1);  // a plugin that never sleeps must not keep the loop's core
  Exchange exchange(link, parent, info);
  if (plugin->run != nullptr) {
    const forcelayer_plugin_host host{&exchange, exchange_once};
    plugin->run(device, &host);
    if (!exchange.ending()) exchange.lose();
  } else if (info.rate_hz >= 1) {  // else the host refuses the handshake
    pull(*plugin, device, info.rate_hz, exchange);
  }
  plugin->close(device);
  PluginState open = PluginState::kOpen;
  link.state.compare_exchange_strong(open, PluginState::kClosed);
  return 0;
}

// A terminal's signals are the loop's affair; ours end in order.
void end_in_order_on_signals() {
  for (const int number : {SIGTERM, SIGINT, SIGHUP}) signal(number, end_on_signal);
  signal(SIGPIPE, SIG_IGN);
}

// The plugin's code gets what it needs: no descriptor but the terminal's and the link, and no way
// to rights that this process has not. Unless it is trusted, it writes to devices and temporary
// files alone, starts no other program, and reaches into no other process (confinement.h).
void give_up_rights(bool trusted) {
  syscall(SYS_close_range, kLinkDescriptor + 1, ~0u, 0);
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  if (trusted) return;
  const char* const temporary = std::getenv("TMPDIR");
  const std::string writable[] = {
      "/dev",       "/proc/self",   "/run",
      "/sys/bus",  // and not /sys/fs, whose groups of processes can be stopped
      "/sys/class", "/sys/devices", "/tmp", "/var/tmp", temporary == nullptr ? "/tmp" : temporary};
  confine_files(writable);
  machine::limit_real_time_priority(1);
  confine_system_calls(CallsOf::kDriver);
}

}  // namespace
}  // namespace forcelayer::devices

int main(int argc, char** argv) {
  using forcelayer::devices::PluginLink;
  void* const mapped = argc == 5 ? mmap(nullptr, sizeof(PluginLink), PROT_READ | PROT_WRITE,
                                        MAP_SHARED, forcelayer::devices::kLinkDescriptor, 0)
                                 : MAP_FAILED;
  if (mapped == MAP_FAILED) {
    std::fprintf(stderr,
                 "voxrun-plugin: this program can only be started by voxrun --device plugin\n");
    return 2;
  }
  auto& link = *static_cast<PluginLink*>(mapped);
  if (!link.whole()) {
    forcelayer::devices::fail(link, "voxrun and voxrun-plugin have different versions");
    return 1;
  }
  forcelayer::devices::give_up_rights(std::strcmp(argv[4], "trusted") == 0);
  forcelayer::devices::end_in_order_on_signals();
  return forcelayer::devices::serve(argv[1], argv[2], static_cast<pid_t>(std::atoi(argv[3])), link);
}
