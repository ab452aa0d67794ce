// A report between a host and a haptic HID device: read by either side.
#include "runtime/devices/hid/hid_haptic_report.h"

#include <cmath>

#include "runtime/devices/hid/firmware/haptic_firmware.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forcelayer;
  const std::span<const std::uint8_t> bytes(data, size);
  devices::HapticKind kind;
  (void)devices::haptic_report_kind(bytes, kind);
  devices::HapticState state;
  if (devices::decode_state(bytes, state) == devices::HapticDefect::kNone) {
    const Pose& pose = state.device_from_handle;
    fuzz::require(std::isfinite(glm::length(pose.position_m)), "a position");
    fuzz::require(std::abs(glm::length(pose.orientation) - 1) < 1e-9, "a rotation");
    fuzz::require(std::isfinite(glm::length(state.velocity.linear_mps)), "a velocity");
  }
  devices::HapticRatings ratings;
  if (devices::decode_ratings(bytes, ratings) == devices::HapticDefect::kNone) {
    fuzz::require(ratings.capabilities.max_force_n >= 0, "a rating is no negative force");
  }

  HapticFirmware device;
  HapticDeviceRatings ratings_of_device{};
  ratings_of_device.max_force_un = 1000000;
  ratings_of_device.watchdog_us = 20000;
  haptic_init(&device, &ratings_of_device);
  if (haptic_receive(&device, data, static_cast<std::uint32_t>(size), 1) == 1) {
    const HapticWrench wrench = haptic_motors(&device, 0, 2);
    fuzz::require(std::abs(std::int64_t{wrench.force_un[0]}) <= 1000000, "within the ratings");
  }
  return 0;
}
