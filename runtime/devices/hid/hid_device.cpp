#include "runtime/devices/hid/hid_device.h"

#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "forcelayer/ranges.h"
#include "runtime/devices/hid/hid_report_descriptor.h"
#include "runtime/machine/real_time.h"

namespace forcelayer::devices {
namespace {

constexpr long long kNsPerMs = 1'000'000;
constexpr int kGreetMs = 1000, kHelloMs = 50, kFirstStateMs = 500;
constexpr long long kSilentNs = 100 * kNsPerMs;  // without a new state: the connection is lost
constexpr long long kShownNs = 20 * kNsPerMs;    // of a fault or watchdog, so that the loop sees it
constexpr long long kResendNs = 1 * kNsPerMs;    // of a fading wrench
constexpr long long kHeartbeatNs = 10 * kNsPerMs;  // of zero, below any sensible watchdog
constexpr std::uint32_t kWatchdogUs = 20'000;      // of the device; hid_haptic_report.md
constexpr double kMaxWatchdogS = 0.1, kMaxForceN = 100, kMaxTorqueNm = 10;

std::uint32_t microseconds(long long ns) { return static_cast<std::uint32_t>(ns / 1000); }

bool is_zero(const Wrench& w) { return w.force_n == glm::dvec3(0) && w.torque_nm == glm::dvec3(0); }

Error refused(const HidDeviceInfo& info, std::string_view what, std::string_view mend) {
  return {ErrorCode::kDeviceRefused, to_text(info), "", what, mend};
}

// One application collection of ours, one input and one output report of 64 bytes, no numbers.
Status check_descriptor(HidPort& port, const HidDeviceInfo& info) {
  const char* const mend =
      "check that this is the right device; the firmware must send reports as in "
      "hid_haptic_report.md";
  const auto parsed = parse_hid_report_descriptor(port.report_descriptor());
  if (!parsed) {
    return refused(info, parsed.error().where + ": " + parsed.error().what, mend);
  }
  const auto bits = [&](HidReportKind kind) {
    std::uint32_t sum = 0;
    for (const HidReportSize& report : parsed->reports)
      sum += report.kind == kind ? report.bits : 0;
    return sum;
  };
  if (parsed->applications.size() != 1 || parsed->applications.front() != kHapticUsage ||
      parsed->numbered() || bits(HidReportKind::kInput) != 8 * kHapticReportBytes ||
      bits(HidReportKind::kOutput) != 8 * kHapticReportBytes) {
    return refused(info, "the report descriptor does not describe a haptic device", mend);
  }
  return {};
}

}  // namespace

HidDevice::HidDevice(std::unique_ptr<HidBus> bus, HidSelector selector, double stale_s)
    : bus_(std::move(bus)),
      stale_s_(stale_s),
      link_(*bus_, {"haptic HID device", {}, kHapticUsage}, std::move(selector), *this) {
  sem_init(&written_, 0, 0);
}

HidDevice::~HidDevice() {
  stop();
  sem_destroy(&written_);
}

Status HidDevice::start() { return link_.start(); }

void HidDevice::stop() noexcept { link_.stop(); }

// ---- the loop's thread

DeviceSample HidDevice::read(double) noexcept {
  DeviceSample sample;
  sample.fresh = states_.take(state_);
  sample.device_from_handle = state_.device_from_handle;
  sample.velocity = state_.velocity;
  sample.buttons = state_.buttons;
  sample.sequence = state_.sequence;
  sample.calibrated = (state_.status & kHapticCalibrated) != 0;
  const long long now_ns = machine::monotonic_ns();
  sample.output_held = held_.load(std::memory_order_relaxed) ||
                       now_ns < held_until_ns_.load(std::memory_order_relaxed);
  sample.output_falls = falls_.load(std::memory_order_relaxed);
  sample.present = link_.connected() && now_ns >= absent_until_ns_.load(std::memory_order_relaxed);
  return sample;
}

void HidDevice::write(const Wrench& device_wrench) noexcept {
  outgoing_.put({device_wrench, machine::monotonic_ns(), ++frame_});
  sem_post(&written_);
}

// ---- the link's thread

Status HidDevice::attach(HidPort& port, const HidDeviceInfo& info) {
  if (Status sound = check_descriptor(port, info); !sound) return sound;
  if (Status greeted = greet(port, info); !greeted) return greeted;
  if (Status first = await_state(port, info); !first) return first;
  writer_stop_.store(false);
  write_failed_.store(false);
  held_.store(true);  // until the loop has been at zero
  writer_ = std::thread([this, &port] { run_writer(port); });
  return {};
}

bool HidDevice::send(HidPort& port, const HapticReport& report) noexcept {
  std::array<std::uint8_t, 1 + kHapticReportBytes> numbered{};  // reports have no number: 0
  std::copy(report.begin(), report.end(), numbered.begin() + 1);
  const long long begin_ns = machine::monotonic_ns();
  const bool sent = port.write(numbered);
  const auto took_ns = static_cast<std::uint64_t>(machine::monotonic_ns() - begin_ns);
  if (took_ns > longest_write_ns_.load(std::memory_order_relaxed)) {
    longest_write_ns_.store(took_ns, std::memory_order_relaxed);
  }
  return sent;
}

// Asks for the capabilities until they come.
Status HidDevice::greet(HidPort& port, const HidDeviceInfo& info) {
  const long long begin_ns = machine::monotonic_ns();
  const std::uint32_t first = sequence_ + 1;
  long long hello_ns = begin_ns - kHelloMs * kNsPerMs;
  HapticDefect defect = HapticDefect::kNone;
  std::array<std::uint8_t, 2 * kHapticReportBytes> report;
  while (machine::monotonic_ns() - begin_ns < kGreetMs * kNsPerMs) {
    if (machine::monotonic_ns() - hello_ns >= kHelloMs * kNsPerMs) {
      hello_ns = machine::monotonic_ns();
      if (!send(port, encode_hello(++sequence_, microseconds(hello_ns)))) break;
    }
    const int bytes = port.read(report, kHelloMs / 5);
    if (bytes < 0) break;
    if (bytes == 0) continue;
    HapticRatings ratings;
    const HapticDefect now = decode_ratings(std::span(report).first(std::size_t(bytes)), ratings);
    if (now != HapticDefect::kNone) {
      if (now != HapticDefect::kKind) defect = now;
      continue;
    }
    if (ratings.echo - first > sequence_ - first) continue;  // of an earlier hello
    ratings.capabilities.name = "hid";
    ratings.capabilities.hardware = true;
    if (Status fit = check_ratings(ratings.capabilities, info); !fit) return fit;
    if (!known_) capabilities_ = ratings.capabilities;  // else the loop reads them by now
    known_ = true;
    return {};
  }
  return Error{ErrorCode::kDeviceFailed, to_text(info), "",
               defect == HapticDefect::kNone
                   ? "does not send its capabilities"
                   : std::string("the reports are damaged: ") + to_text(defect),
               "plug the device in again; the firmware must use version 1 of hid_haptic_report.md"};
}

Status HidDevice::check_ratings(const DeviceCapabilities& device, const HidDeviceInfo& info) const {
  const char* const mend = "correct the ratings in the firmware";
  if (!(device.watchdog_s > 0 && device.watchdog_s <= kMaxWatchdogS)) {
    return refused(info, "the device has no watchdog, or the watchdog waits longer than 100 ms",
                   mend);
  }
  if (device.sensed_axes != kAllAxes)
    return refused(info, "the device does not sense all six axes", mend);
  if (!(device.max_force_n > 0 && device.max_force_n <= kMaxForceN &&
        device.max_torque_nm <= kMaxTorqueNm && forcelayer::check_ratings(device) &&
        (device.rate_hz == 0 || device.rate_hz >= kMinMotorsHz))) {
    return refused(info, "the ratings are impossible for a hand-held device", mend);
  }
  const bool same = device.max_force_n == capabilities_.max_force_n &&
                    device.max_torque_nm == capabilities_.max_torque_nm &&
                    device.max_stiffness_n_per_m == capabilities_.max_stiffness_n_per_m &&
                    device.max_stiffness_nm_per_rad == capabilities_.max_stiffness_nm_per_rad &&
                    device.damping_ns_per_m == capabilities_.damping_ns_per_m &&
                    device.damping_nms_per_rad == capabilities_.damping_nms_per_rad &&
                    device.actuated_axes == capabilities_.actuated_axes &&
                    device.senses_velocity == capabilities_.senses_velocity;
  if (known_ && !same) {
    return refused(info, "the ratings have changed since the device was unplugged",
                   "start voxrun again");
  }
  return {};
}

// A zero wrench opens the device's watchdog; then the first state must come.
Status HidDevice::await_state(HidPort& port, const HidDeviceInfo& info) {
  const long long begin_ns = machine::monotonic_ns();
  std::array<std::uint8_t, 2 * kHapticReportBytes> report;
  HapticDefect defect = HapticDefect::kNone;
  std::uint16_t status = 0;
  while (machine::monotonic_ns() - begin_ns < kFirstStateMs * kNsPerMs) {
    if (!send_command(port, {}, {}, false)) break;
    const int bytes = port.read(report, kHelloMs / 5);
    if (bytes < 0) break;
    if (bytes == 0) continue;
    HapticState state;
    const HapticDefect now = decode_state(std::span(report).first(std::size_t(bytes)), state);
    if (now == HapticDefect::kNone) {
      status = state.status;
      if ((status & (kHapticWatchdog | kHapticFault)) != 0) continue;
      watch_ = {};
      watch_.taken = true;
      watch_.newest = state;
      watch_.newest_ns = machine::monotonic_ns();
      known_state_.store(state.sequence, std::memory_order_relaxed);
      states_.put(state);
      return {};
    }
    if (now != HapticDefect::kKind) defect = now;
  }
  std::string what = "does not send poses";
  if (defect != HapticDefect::kNone) {
    what = std::string("the reports are damaged: ") + to_text(defect);
  } else if ((status & kHapticFault) != 0) {
    what = "reports a fault";
  } else if ((status & kHapticWatchdog) != 0) {
    what = "its watchdog is still tripped, although a zero wrench was sent to reset it";
  }
  return Error{ErrorCode::kDeviceFailed, to_text(info), "", what, "plug it in again"};
}

void HidDevice::take_report(std::span<const std::uint8_t> report, long long now_ns) noexcept {
  HapticState state;
  const HapticDefect defect = decode_state(report, state);
  if (defect == HapticDefect::kNone) return take_state(state, now_ns);
  if (defect == HapticDefect::kKind) {
    // Capabilities that answer a repeated hello count in the sequence and say nothing new.
    HapticRatings ratings;
    if (decode_ratings(report, ratings) == HapticDefect::kNone) {
      if (report[4] == ((watch_.newest.sequence + 1) & 0xff)) ++watch_.newest.sequence;
      return;
    }
  }
  ++watch_.malformed;
  watch_.defect = defect;
  count_malformed_.fetch_add(1, std::memory_order_relaxed);
}

void HidDevice::take_state(const HapticState& state, long long now_ns) noexcept {
  const std::uint32_t ahead = state.sequence - watch_.newest.sequence;
  const bool newer = ahead != 0 && ahead < 0x80000000u && state.time_us != watch_.newest.time_us;
  if (!newer) {
    ++watch_.repeated;
    count_repeated_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  count_states_.fetch_add(1, std::memory_order_relaxed);
  count_gaps_.fetch_add(ahead - 1, std::memory_order_relaxed);
  note_status(state.status, now_ns);
  watch_ = {state, now_ns, 0, 0, HapticDefect::kNone, false};
}

// Looks at every state, also at those that a newer one overtakes.
void HidDevice::note_status(std::uint16_t status, long long now_ns) noexcept {
  const std::uint16_t bad = status & (kHapticWatchdog | kHapticFault);
  if (bad == 0) return;
  bad_status_.store(bad, std::memory_order_relaxed);
  bad_losses_.store(link_.losses(), std::memory_order_relaxed);
  std::atomic<long long>& until_ns = (bad & kHapticFault) != 0 ? absent_until_ns_ : held_until_ns_;
  until_ns.store(now_ns + kShownNs, std::memory_order_relaxed);
}

HidLoss HidDevice::look(long long now_ns) noexcept {
  if (!watch_.taken) {
    watch_.taken = true;
    known_state_.store(watch_.newest.sequence, std::memory_order_relaxed);
    states_.put(watch_.newest);
  }
  if (write_failed_.load(std::memory_order_relaxed)) {
    return {"the device does not accept commands", "check plug and power"};
  }
  if (now_ns - watch_.newest_ns <= kSilentNs) return {};
  if (watch_.malformed > 0) {
    return {"the device's reports are damaged", "check the cable and the firmware"};
  }
  const char* const mend = "switch the device off and on, and check the firmware";
  if (watch_.repeated > 0) return {"the device is frozen: it repeats its reports", mend};
  return {"the device is frozen: it sends no reports", mend};
}

void HidDevice::detach() noexcept {
  writer_stop_.store(true);
  sem_post(&written_);
  if (writer_.joinable()) writer_.join();
}

// ---- the writer's thread

bool HidDevice::send_command(HidPort& port, const Outgoing& newest, const Wrench& wrench,
                             bool motors_on) noexcept {
  HapticCommand command;
  command.motors_on = motors_on;
  command.faded =
      wrench.force_n != newest.wrench.force_n || wrench.torque_nm != newest.wrench.torque_nm;
  command.sequence = ++sequence_;
  command.time_us = microseconds(machine::monotonic_ns());
  command.wrench = wrench;
  command.watchdog_us = kWatchdogUs;
  command.answers = known_state_.load(std::memory_order_relaxed);
  command.frame = newest.frame;
  count_commands_.fetch_add(1, std::memory_order_relaxed);
  count_faded_.fetch_add(command.faded, std::memory_order_relaxed);
  return send(port, encode_command(command));
}

void HidDevice::run_writer(HidPort& port) noexcept {
  (void)machine::take_real_time_priority();
  OutputWatch watch(stale_s_);
  bool lost = false;
  for (long long next_ns = machine::monotonic_ns(); !lost && !writer_stop_.load();) {
    const timespec until{next_ns / 1'000'000'000, static_cast<long>(next_ns % 1'000'000'000)};
    (void)sem_clockwait(&written_, CLOCK_MONOTONIC, &until);
    const bool fresh = outgoing_.take(newest_);
    const long long now_ns = machine::monotonic_ns();
    if (!fresh && now_ns < next_ns) continue;
    const Wrench wrench = watch.pass(newest_.wrench, newest_.written_ns, now_ns);
    held_.store(watch.latched(), std::memory_order_relaxed);
    falls_.store(watch.falls(), std::memory_order_relaxed);
    lost = !send_command(port, newest_, wrench, true);
    next_ns = machine::monotonic_ns() + (is_zero(wrench) ? kHeartbeatNs : kResendNs);
  }
  if (lost || !send_command(port, newest_, {}, false)) write_failed_.store(true);
}

// ---- any thread

HidStatistics HidDevice::statistics() const {
  HidStatistics s;
  s.states = count_states_.load();
  s.gaps = count_gaps_.load();
  s.repeated = count_repeated_.load();
  s.malformed = count_malformed_.load();
  s.commands = count_commands_.load();
  s.faded = count_faded_.load();
  s.losses = link_.losses();
  s.longest_write_ns = longest_write_ns_.load();
  return s;
}

std::vector<DeviceCounter> HidDevice::counters() const {
  const HidStatistics s = statistics();
  return {{"states", s.states},
          {"sequence_gaps", s.gaps},
          {"repeated", s.repeated},
          {"malformed", s.malformed},
          {"commands", s.commands},
          {"faded_commands", s.faded},
          {"connection_losses", s.losses},
          {"longest_write_ns", s.longest_write_ns}};
}

DeviceTrouble HidDevice::trouble() const {
  // The device's own report counts unless the connection was lost since.
  const std::uint16_t bad = bad_losses_.load() == link_.losses() ? bad_status_.load() : 0;
  if ((bad & kHapticFault) != 0) {
    return {"the device reports a fault",
            "look up the fault in the manual of the device, and switch the device off and on"};
  }
  if ((bad & kHapticWatchdog) != 0) {
    return {
        "the device's watchdog tripped",
        "no command reached the device in time: run voxrun doctor, and connect nothing else to the "
        "same USB bus"};
  }
  return link_.trouble();
}

}  // namespace forcelayer::devices
