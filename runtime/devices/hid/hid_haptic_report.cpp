#include "runtime/devices/hid/hid_haptic_report.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace forcelayer::devices {
namespace {

constexpr std::uint8_t kVersion = 1;
constexpr std::size_t kChecksumAt = 62;
constexpr double kPositionUnitM = 1e-8, kQuaternionUnit = 1.0 / (1 << 30);
constexpr double kLinearUnitMps = 1.0 / 4096, kAngularUnitRadps = 1.0 / 512;
constexpr double kMicrosPerUnit = 1e6, kMillisPerUnit = 1e3, kNanosPerUnit = 1e9;
constexpr double kUnitTolerance = 0.01;  // of a quaternion's length: rounding is 2^-29
constexpr std::uint16_t kStatusBits = 31, kVelocitySensed = 1;
constexpr std::uint16_t kMotorsOn = 1, kFaded = 2;

// CRC-16/CCITT-FALSE: polynomial 0x1021, first value 0xffff, nothing reflected.
std::uint16_t checksum(std::span<const std::uint8_t> bytes) noexcept {
  std::uint16_t crc = 0xffff;
  for (const std::uint8_t byte : bytes) {
    std::uint16_t x = static_cast<std::uint16_t>((crc >> 8) ^ byte);
    x = static_cast<std::uint16_t>(x ^ (x >> 4));
    crc = static_cast<std::uint16_t>((crc << 8) ^ (x << 12) ^ (x << 5) ^ x);
  }
  return crc;
}

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  std::uint8_t u8(std::size_t at) const { return bytes_[at]; }
  std::uint16_t u16(std::size_t at) const {
    return static_cast<std::uint16_t>(bytes_[at] | bytes_[at + 1] << 8);
  }
  std::uint32_t u32(std::size_t at) const {
    return u16(at) | static_cast<std::uint32_t>(u16(at + 2)) << 16;
  }
  double i16(std::size_t at) const { return static_cast<std::int16_t>(u16(at)); }
  double i32(std::size_t at) const { return static_cast<std::int32_t>(u32(at)); }
  glm::dvec3 vector16(std::size_t at) const { return {i16(at), i16(at + 2), i16(at + 4)}; }
  glm::dvec3 vector32(std::size_t at) const { return {i32(at), i32(at + 4), i32(at + 8)}; }
  bool zero(std::size_t from, std::size_t to) const {
    return std::all_of(bytes_.begin() + static_cast<std::ptrdiff_t>(from),
                       bytes_.begin() + static_cast<std::ptrdiff_t>(to),
                       [](std::uint8_t byte) { return byte == 0; });
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

class Writer {
 public:
  Writer(HapticKind kind, std::uint16_t flags, std::uint32_t sequence, std::uint32_t time_us) {
    report_[0] = static_cast<std::uint8_t>(kind);
    report_[1] = kVersion;
    report_[2] = static_cast<std::uint8_t>(flags);
    report_[3] = static_cast<std::uint8_t>(flags >> 8);
    u32(4, sequence);
    u32(8, time_us);
  }

  void u32(std::size_t at, std::uint32_t value) {
    for (int i = 0; i < 4; ++i) report_[at++] = static_cast<std::uint8_t>(value >> (8 * i));
  }

  // `v` in millionths, rounded to the nearest, ending at the type's range.
  void micros32(std::size_t at, const glm::dvec3& v) {
    for (int axis = 0; axis < 3; ++axis) {
      const double steps =
          std::clamp(std::nearbyint(v[axis] * kMicrosPerUnit), -2147483647.0, 2147483647.0);
      u32(at + 4 * static_cast<std::size_t>(axis),
          static_cast<std::uint32_t>(static_cast<std::int32_t>(steps)));
    }
  }

  HapticReport finish() {
    const std::uint16_t crc = checksum(std::span(report_).first(kChecksumAt));
    report_[kChecksumAt] = static_cast<std::uint8_t>(crc);
    report_[kChecksumAt + 1] = static_cast<std::uint8_t>(crc >> 8);
    return report_;
  }

 private:
  HapticReport report_{};
};

HapticDefect check(std::span<const std::uint8_t> bytes, HapticKind wanted) noexcept {
  HapticKind kind{};
  if (const HapticDefect defect = haptic_report_kind(bytes, kind); defect != HapticDefect::kNone) {
    return defect;
  }
  return kind == wanted ? HapticDefect::kNone : HapticDefect::kKind;
}

}  // namespace

const char* to_text(HapticDefect defect) {
  switch (defect) {
    case HapticDefect::kNone:
      return "sound";
    case HapticDefect::kLength:
      return "wrong length";
    case HapticDefect::kChecksum:
      return "wrong checksum";
    case HapticDefect::kVersion:
      return "the layout has a version that is not supported";
    case HapticDefect::kKind:
      return "unknown kind";
    case HapticDefect::kReserved:
      return "reserved bits are set";
    case HapticDefect::kOrientation:
      return "the quaternion is not of length 1";
  }
  return "unknown";
}

HapticDefect haptic_report_kind(std::span<const std::uint8_t> bytes, HapticKind& kind) noexcept {
  if (bytes.size() != kHapticReportBytes) return HapticDefect::kLength;
  const Reader reader(bytes);
  if (reader.u16(kChecksumAt) != checksum(bytes.first(kChecksumAt))) return HapticDefect::kChecksum;
  if (reader.u8(1) != kVersion) return HapticDefect::kVersion;
  kind = static_cast<HapticKind>(reader.u8(0));
  const bool known = kind == HapticKind::kState || kind == HapticKind::kCapabilities;
  return known ? HapticDefect::kNone : HapticDefect::kKind;
}

HapticDefect decode_state(std::span<const std::uint8_t> bytes, HapticState& state) noexcept {
  if (const HapticDefect defect = check(bytes, HapticKind::kState); defect != HapticDefect::kNone) {
    return defect;
  }
  const Reader reader(bytes);
  if ((reader.u16(2) & ~kStatusBits) != 0 || !reader.zero(54, 56) || !reader.zero(60, 62)) {
    return HapticDefect::kReserved;
  }
  const glm::dquat turn(reader.i32(24) * kQuaternionUnit, reader.i32(28) * kQuaternionUnit,
                        reader.i32(32) * kQuaternionUnit, reader.i32(36) * kQuaternionUnit);
  if (!(std::abs(glm::length(turn) - 1) <= kUnitTolerance)) return HapticDefect::kOrientation;
  state.status = reader.u16(2);
  state.sequence = reader.u32(4);
  state.time_us = reader.u32(8);
  state.device_from_handle = {reader.vector32(12) * kPositionUnitM, glm::normalize(turn)};
  state.velocity = {reader.vector16(40) * kLinearUnitMps, reader.vector16(46) * kAngularUnitRadps};
  state.buttons = reader.u16(52);
  state.echo = reader.u32(56);
  return HapticDefect::kNone;
}

HapticDefect decode_ratings(std::span<const std::uint8_t> bytes, HapticRatings& ratings) noexcept {
  if (const HapticDefect defect = check(bytes, HapticKind::kCapabilities);
      defect != HapticDefect::kNone) {
    return defect;
  }
  const Reader reader(bytes);
  if ((reader.u16(2) & ~kVelocitySensed) != 0 || (reader.u16(16) & ~0x3f3f) != 0 ||
      !reader.zero(18, 20) || !reader.zero(60, 62)) {
    return HapticDefect::kReserved;
  }
  DeviceCapabilities& device = ratings.capabilities;
  ratings.echo = reader.u32(12);
  device.sensed_axes = reader.u8(16);
  device.actuated_axes = reader.u8(17);
  device.max_force_n = reader.u32(20) / kMicrosPerUnit;
  device.max_torque_nm = reader.u32(24) / kMicrosPerUnit;
  device.max_stiffness_n_per_m = reader.u32(28) / kMillisPerUnit;
  device.max_stiffness_nm_per_rad = reader.u32(32) / kMicrosPerUnit;
  device.damping_ns_per_m = reader.u32(36) / kMicrosPerUnit;
  device.damping_nms_per_rad = reader.u32(40) / kNanosPerUnit;
  device.workspace_radius_m = reader.u32(44) / kMicrosPerUnit;
  device.rate_hz = reader.u32(48) / kMillisPerUnit;
  device.watchdog_s = reader.u32(52) / kMicrosPerUnit;
  device.delay_s = reader.u32(56) / kMicrosPerUnit;
  device.senses_velocity = (reader.u16(2) & kVelocitySensed) != 0;
  return HapticDefect::kNone;
}

HapticReport encode_command(const HapticCommand& command) noexcept {
  const double sum = glm::dot(command.wrench.force_n, glm::dvec3(1)) +
                     glm::dot(command.wrench.torque_nm, glm::dvec3(1));
  const bool finite = std::isfinite(sum);
  const unsigned flags =
      (command.motors_on && finite ? kMotorsOn : 0u) | (command.faded || !finite ? kFaded : 0u);
  Writer writer(HapticKind::kCommand, static_cast<std::uint16_t>(flags), command.sequence,
                command.time_us);
  if (finite) {
    writer.micros32(12, command.wrench.force_n);
    writer.micros32(24, command.wrench.torque_nm);
  }
  writer.u32(36, command.watchdog_us);
  writer.u32(40, command.answers);
  writer.u32(44, command.frame);
  return writer.finish();
}

HapticReport encode_hello(std::uint32_t sequence, std::uint32_t time_us) noexcept {
  return Writer(HapticKind::kHello, 0, sequence, time_us).finish();
}

}  // namespace forcelayer::devices
