#include "forcelayer/pose_datagram.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace forcelayer {
namespace {

constexpr double kUnitTolerance = 1e-3;  // of a quaternion's length squared

template <std::size_t kCount>
bool all_finite(const std::array<double, kCount>& numbers) {
  for (const double number : numbers) {
    if (!std::isfinite(number)) return false;
  }
  return true;
}

bool is_pose(const std::array<double, 7>& n) {
  const double length2 = n[3] * n[3] + n[4] * n[4] + n[5] * n[5] + n[6] * n[6];
  return all_finite(n) && std::abs(length2 - 1) < kUnitTolerance;
}

}  // namespace

std::array<double, 7> pose_numbers(const Pose& pose) {
  const auto& [p, q] = pose;
  return {p.x, p.y, p.z, q.w, q.x, q.y, q.z};
}

Pose pose_from_numbers(const std::array<double, 7>& n) {
  return {{n[0], n[1], n[2]}, glm::dquat(n[3], n[4], n[5], n[6])};
}

std::string_view object_name_of(const PoseDatagram& d) {
  const std::string_view all(d.object_name.data(), d.object_name.size());
  return all.substr(0, all.find('\0'));
}

void set_object_name(PoseDatagram& d, std::string_view name) {
  std::size_t size = std::min(name.size(), d.object_name.size());
  const auto continues = [&](std::size_t n) {
    return n < name.size() && (static_cast<unsigned char>(name[n]) & 0xc0) == 0x80;
  };
  while (size > 0 && continues(size)) --size;
  d.object_name.fill('\0');
  std::copy_n(name.begin(), size, d.object_name.begin());
}

std::optional<PoseDatagram> parse_pose_datagram(std::span<const std::byte> bytes) {
  PoseDatagram d{};
  if (bytes.size() < sizeof d) return std::nullopt;
  std::memcpy(&d, bytes.data(), sizeof d);
  const bool ours = d.magic == kPoseMagic && d.version == kPoseVersion && d.bytes == bytes.size();
  const bool sound =
      is_pose(d.world_from_part) && is_pose(d.world_from_handle) && is_pose(d.world_from_target) &&
      all_finite(d.force_n) && all_finite(d.torque_nm) && std::isfinite(d.time_s) &&
      all_finite(d.nearest_point_m) && std::isfinite(d.clearance_m) && d.clearance_m >= 0;
  if (!ours || !sound || d.output > 2 || d.clearance_kind > 2) return std::nullopt;
  return d;
}

}  // namespace forcelayer
