// The host's side of the haptic HID reports: bytes to values and back. The normative text is
// hid_haptic_report.md.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "forcelayer/device.h"

namespace forcelayer::devices {

inline constexpr std::size_t kHapticReportBytes = 64;
using HapticReport = std::array<std::uint8_t, kHapticReportBytes>;

inline constexpr std::uint32_t kHapticUsage = 0xff46'0001;  // page and usage of the collection

// Bits of HapticState::status.
enum HapticStatus : std::uint16_t {
  kHapticCalibrated = 1,  // the pose can be trusted
  kHapticWatchdog = 2,    // the device's watchdog holds zero until it gets a zero wrench
  kHapticFault = 4,       // motors off for a reason of the device's own
  kHapticMotorsOn = 8,    // the last wrench is on the motors
  kHapticLimited = 16,    // cut to the device's ratings
};

// A state report, device to host.
struct HapticState {
  std::uint16_t status = 0;
  std::uint32_t sequence = 0;
  std::uint32_t time_us = 0;  // the device's clock
  Pose device_from_handle;    // orientation normalized
  Twist velocity;             // of the handle's origin, device axes; zero where it is not sensed
  std::uint16_t buttons = 0;
  std::uint32_t echo = 0;  // sequence of the newest command that the device took
};

// A capabilities report, device to host: `name` stays empty.
struct HapticRatings {
  DeviceCapabilities capabilities;
  std::uint32_t echo = 0;  // sequence of the hello that it answers
};

// A command, host to device.
struct HapticCommand {
  bool motors_on = false;
  bool faded = false;  // not the loop's own wrench: it was late
  std::uint32_t sequence = 0;
  std::uint32_t time_us = 0;  // the host's clock
  Wrench wrench;              // on the hand, about the handle's origin, device axes
  std::uint32_t watchdog_us = 0;
  std::uint32_t answers = 0;  // sequence of the newest state that the host knew
  std::uint32_t frame = 0;    // counts the loop's wrenches
};

enum class HapticKind : std::uint8_t {
  kState = 1,
  kCapabilities = 2,
  kCommand = 0x81,
  kHello = 0x82
};

// Why a report was not taken.
enum class HapticDefect : std::uint8_t {
  kNone,
  kLength,
  kChecksum,
  kVersion,
  kKind,
  kReserved,
  kOrientation,  // no unit quaternion
};
const char* to_text(HapticDefect defect);

// The kind of a device's report. Checks length, checksum and version first.
HapticDefect haptic_report_kind(std::span<const std::uint8_t> bytes, HapticKind& kind) noexcept;

// Both check the whole report and leave the result alone where there is a defect.
HapticDefect decode_state(std::span<const std::uint8_t> bytes, HapticState& state) noexcept;
HapticDefect decode_ratings(std::span<const std::uint8_t> bytes, HapticRatings& ratings) noexcept;

// Values beyond the layout's range end there; a wrench that is not finite is sent as zero with the
// motors off.
HapticReport encode_command(const HapticCommand& command) noexcept;
HapticReport encode_hello(std::uint32_t sequence, std::uint32_t time_us) noexcept;

}  // namespace forcelayer::devices
