// A haptic device without hardware: the reference firmware core, a hand that moves it, a log of
// what the motors had, and the ways in which such devices fail. Its USB side is the caller's.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <vector>

#include "forcelayer/pose.h"
#include "runtime/devices/hid/firmware/haptic_firmware.h"
#include "runtime/machine/real_time.h"

namespace forcelayer::test {

inline HapticDeviceRatings virtual_ratings() {
  HapticDeviceRatings ratings{};
  ratings.sensed_axes = ratings.actuated_axes = 0x3f;
  ratings.max_force_un = 12'000'000;
  ratings.max_torque_unm = 200'000;
  ratings.damping_uns_per_m = 2'000'000;
  ratings.damping_nnms_per_rad = 5'000'000;
  ratings.rate_mhz = 1'000'000;
  ratings.watchdog_us = 20'000;
  ratings.delay_us = 1000;
  return ratings;
}

inline HapticReading reading_of(const Pose& pose) {
  HapticReading reading{};
  for (int i = 0; i < 3; ++i) {
    reading.position_10nm[i] = static_cast<std::int32_t>(std::lround(pose.position_m[i] * 1e8));
  }
  const double quaternion[4] = {pose.orientation.w, pose.orientation.x, pose.orientation.y,
                                pose.orientation.z};
  for (int i = 0; i < 4; ++i) {
    reading.orientation_q30[i] = static_cast<std::int32_t>(std::lround(quaternion[i] * (1 << 30)));
  }
  reading.calibrated = 1;
  return reading;
}

class VirtualHapticDevice {
 public:
  enum class Fault {
    kNone,
    kSilent,      // sends nothing, takes nothing
    kRepeating,   // sends its last report again and again
    kClockStill,  // counts on, but its clock stands still
    kDamaged,     // one bit of every report is wrong
    kReported,    // says itself that its motors are off
    kDeaf,        // sends, but takes nothing
  };
  // A command as it came, and what the motors had right after it.
  struct Taken {
    std::uint32_t frame = 0, answers = 0;
    std::uint16_t flags = 0;
    HapticWrench wrench{}, motors{};
    std::uint32_t time_us = 0;  // the device's clock
  };

  explicit VirtualHapticDevice(const HapticDeviceRatings& ratings = virtual_ratings()) {
    haptic_init(&firmware_, &ratings);
  }

  // The hand's pose, so many seconds after the loop's first wrench came; 0 until then.
  void set_hand(std::function<Pose(double)> hand) {
    const std::lock_guard lock(mutex_);
    hand_ = std::move(hand);
  }

  void set_fault(Fault fault) {
    const std::lock_guard lock(mutex_);
    fault_ = fault;
    still_us_ = now_us();
  }

  // A report from the host. What it did goes to the log, from the loop's first wrench on.
  void receive(std::span<const std::uint8_t> report) {
    const std::lock_guard lock(mutex_);
    if (fault_ == Fault::kSilent || fault_ == Fault::kDeaf) return;
    const auto bytes = static_cast<std::uint32_t>(report.size());
    if (haptic_receive(&firmware_, report.data(), bytes, now_us()) == 0 || report[0] != 0x81)
      return;
    Taken taken;
    taken.flags = static_cast<std::uint16_t>(report[2] | report[3] << 8);
    taken.frame = number(report, 44);
    taken.answers = number(report, 40);
    taken.wrench = firmware_.wrench;
    taken.motors = haptic_motors(&firmware_, fault_ == Fault::kReported, now_us());
    taken.time_us = now_us();
    if (taken.frame > 0) log_.push_back(taken);
  }

  // The next report for the host; false where the device is silent.
  bool next_report(std::array<std::uint8_t, HAPTIC_REPORT_BYTES>& report) {
    const std::lock_guard lock(mutex_);
    if (fault_ == Fault::kSilent) return false;
    if (fault_ != Fault::kRepeating || !sent_) {
      const std::uint32_t felt_us = log_.empty() ? 0 : now_us() - log_.front().time_us;
      HapticReading reading = reading_of(hand_(felt_us * 1e-6));
      reading.fault = fault_ == Fault::kReported;
      haptic_next_report(&firmware_, &reading, fault_ == Fault::kClockStill ? still_us_ : now_us(),
                         last_.data());
      sent_ = true;
    }
    report = last_;
    if (fault_ == Fault::kDamaged) report[20] ^= 4;
    return true;
  }

  // The wrench on the motors now.
  HapticWrench motors() {
    const std::lock_guard lock(mutex_);
    return haptic_motors(&firmware_, fault_ == Fault::kReported, now_us());
  }
  bool watchdog_holds() {
    const std::lock_guard lock(mutex_);
    (void)haptic_motors(&firmware_, fault_ == Fault::kReported, now_us());  // its motor loop's tick
    return firmware_.latched != 0;
  }
  std::vector<Taken> log() {
    const std::lock_guard lock(mutex_);
    return log_;
  }
  std::uint32_t refused() {
    const std::lock_guard lock(mutex_);
    return firmware_.refused;
  }

  std::uint32_t now_us() const {
    return static_cast<std::uint32_t>((machine::monotonic_ns() - begin_ns_) / 1000);
  }

 private:
  static std::uint32_t number(std::span<const std::uint8_t> report, std::size_t at) {
    return static_cast<std::uint32_t>(report[at] | report[at + 1] << 8 | report[at + 2] << 16) |
           static_cast<std::uint32_t>(report[at + 3]) << 24;
  }

  std::mutex mutex_;
  std::function<Pose(double)> hand_ = [](double) { return Pose{}; };
  HapticFirmware firmware_{};
  Fault fault_ = Fault::kNone;
  std::uint32_t still_us_ = 0;
  bool sent_ = false;
  std::array<std::uint8_t, HAPTIC_REPORT_BYTES> last_{};
  std::vector<Taken> log_;
  long long begin_ns_ = machine::monotonic_ns();
};

inline bool is_zero(const HapticWrench& w) {
  for (int i = 0; i < 3; ++i) {
    if (w.force_un[i] != 0 || w.torque_unm[i] != 0) return false;
  }
  return true;
}

}  // namespace forcelayer::test
