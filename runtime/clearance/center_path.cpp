#include "runtime/clearance/center_path.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "runtime/coupling/coupling.h"

namespace forcelayer::clearance {
namespace {

// Exceeds the rounding of a length here.
constexpr double kRoundUp = 1 + 1e-9;

glm::dvec3 turn_between(const Pose& from, const Pose& to) {
  return coupling::rotation_vector(to.orientation * glm::conjugate(from.orientation));
}

}  // namespace

Pose pose_of(const PathRow& row) {
  const auto& p = row.position_m;
  const auto& q = row.orientation_wxyz;
  return {{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}};
}

CenterPath::CenterPath(std::span<const PathRow> rows, const Pshell& shell)
    : radius_m_(shell.header().bounding_radius_m * kRoundUp) {
  const auto& c = shell.header().center_m;
  for (const PathRow& row : rows) {
    const Pose center = pose_of(row) * Pose{glm::dvec3(c[0], c[1], c[2]), {1, 0, 0, 0}};
    double travel_m = 0;
    if (!world_from_center_.empty()) {
      const Pose& before = world_from_center_.back();
      const double turn_rad = glm::length(turn_between(before, center));
      turn_rad_.push_back(turn_rad);
      travel_m = travel_m_.back() + kRoundUp * (glm::length(center.position_m - before.position_m) +
                                                radius_m_ * turn_rad);
    }
    time_s_.push_back(row.time_s);
    travel_m_.push_back(travel_m);
    world_from_center_.push_back(center);
  }
  turn_rad_.push_back(0);
}

double CenterPath::time_s(const Moment& m) const {
  if (m.share == 0) return time_s_[m.pose];
  return time_s_[m.pose] + m.share * (time_s_[m.pose + 1] - time_s_[m.pose]);
}

double CenterPath::travel_m(const Moment& m) const {
  if (m.share == 0) return travel_m_[m.pose];
  return travel_m_[m.pose] + m.share * (travel_m_[m.pose + 1] - travel_m_[m.pose]);
}

Pose CenterPath::world_from_center(const Moment& m) const {
  const Pose& from = world_from_center_[m.pose];
  if (m.share == 0) return from;
  const Pose& to = world_from_center_[m.pose + 1];
  return {
      from.position_m + (to.position_m - from.position_m) * m.share,
      glm::normalize(coupling::rotation_by(turn_between(from, to) * m.share) * from.orientation)};
}

std::size_t CenterPath::pose_beyond(double travel_m, std::size_t first, std::size_t last) const {
  const auto begin = travel_m_.begin();
  const auto at = std::lower_bound(begin + static_cast<std::ptrdiff_t>(first),
                                   begin + static_cast<std::ptrdiff_t>(last), travel_m);
  return static_cast<std::size_t>(at - begin);
}

double CenterPath::arc_deviation_m(std::size_t pose, double shares) const {
  const double turn_rad = turn_rad_[pose] * shares;
  return kRoundUp * radius_m_ * turn_rad * turn_rad / 8;
}

}  // namespace forcelayer::clearance
