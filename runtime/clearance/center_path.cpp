#include "runtime/clearance/center_path.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

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
    : CenterPath(
          rows,
          {shell.header().center_m[0], shell.header().center_m[1], shell.header().center_m[2]},
          shell.header().bounding_radius_m) {}

CenterPath::CenterPath(std::span<const PathRow> rows, const glm::dvec3& center_m, double radius_m)
    : radius_m_(radius_m * kRoundUp) {
  const double arm_m = glm::length(center_m);
  for (const PathRow& row : rows) {
    const Pose center = pose_of(row) * Pose{center_m, {1, 0, 0, 0}};
    double travel_m = 0;
    if (!world_from_center_.empty()) {
      const Pose& before = world_from_center_.back();
      turn_rad_.push_back(glm::length(turn_between(before, center)));
      const double step_m = travel_between_m(before, center);
      // Rounded up, so that the travel between two poses is never less than that of its steps.
      travel_m = travel_m_.back() + step_m;
      if (step_m > 0) travel_m = std::nextafter(travel_m, std::numeric_limits<double>::infinity());
    }
    farthest_m_ = std::max(farthest_m_, glm::length(pose_of(row).position_m) + arm_m);
    time_s_.push_back(row.time_s);
    travel_m_.push_back(travel_m);
    world_from_center_.push_back(center);
  }
  turn_rad_.push_back(0);
}

double CenterPath::travel_between_m(const Pose& from, const Pose& to) const {
  return kRoundUp * (glm::length(to.position_m - from.position_m) +
                     radius_m_ * glm::length(turn_between(from, to)));
}

double CenterPath::time_s(const Moment& m) const {
  if (m.fraction == 0) return time_s_[m.pose];
  return time_s_[m.pose] + m.fraction * (time_s_[m.pose + 1] - time_s_[m.pose]);
}

// In units of 2^-53: of the centroid at a pose, 9 of its arm and 1 of its place; of the way between
// two poses, which is up to twice as long as they are far, 4, and of the place on it 1; of the
// travel at either moment 3. Along each axis; in all directions sqrt(3) times as much.
double CenterPath::rounding_m() const { return std::ldexp(farthest_m_ + travel_m_.back(), -48); }

Moment CenterPath::at(double time_s) const {
  const auto after = std::upper_bound(time_s_.begin(), time_s_.end(), time_s);
  if (after == time_s_.begin()) return {0, 0};
  const auto pose = static_cast<std::size_t>(after - time_s_.begin() - 1);
  if (after == time_s_.end()) return {pose, 0};
  const double fraction = (time_s - time_s_[pose]) / (*after - time_s_[pose]);
  return fraction < 1 ? Moment{pose, fraction} : Moment{pose + 1, 0};
}

double CenterPath::travel_m(const Moment& m) const {
  if (m.fraction == 0) return travel_m_[m.pose];
  return travel_m_[m.pose] + m.fraction * (travel_m_[m.pose + 1] - travel_m_[m.pose]);
}

Pose CenterPath::world_from_center(const Moment& m) const {
  const Pose& from = world_from_center_[m.pose];
  if (m.fraction == 0) return from;
  const Pose& to = world_from_center_[m.pose + 1];
  return {from.position_m + (to.position_m - from.position_m) * m.fraction,
          glm::normalize(coupling::rotation_by(turn_between(from, to) * m.fraction) *
                         from.orientation)};
}

std::size_t CenterPath::pose_beyond(double travel_m, std::size_t first, std::size_t last) const {
  const auto begin = travel_m_.begin();
  const auto at = std::lower_bound(begin + static_cast<std::ptrdiff_t>(first),
                                   begin + static_cast<std::ptrdiff_t>(last), travel_m);
  return static_cast<std::size_t>(at - begin);
}

Moment CenterPath::middle(const Moment& from, const Moment& to) const {
  const Between poses = between(from, to);
  const double half_m = (travel_m(from) + travel_m(to)) / 2;
  if (poses.count() > 0) return {pose_beyond(half_m, poses.first, poses.beyond - 1), 0};
  const double end = to.pose == from.pose ? to.fraction : 1;
  return {from.pose, (from.fraction + end) / 2};
}

// A point at the radius r that turns evenly by a deviates from its chord, at equal fractions of
// both ways, by r a^2 / 8 at most.
double CenterPath::arc_deviation_m(double turn_rad) const {
  return kRoundUp * radius_m_ * turn_rad * turn_rad / 8;
}

// Compared with a part that goes evenly from a to b, whose points deviate from their chords by that
// of an arc. Between two poses a point deviates no more than at them, and by the arc of that
// motion.
double CenterPath::deviation_m(const Moment& a, const Moment& b) const {
  const Pose from = world_from_center(a), to = world_from_center(b);
  const glm::dvec3 shift_m = to.position_m - from.position_m, turn_rad = turn_between(from, to);
  const double begin_m = travel_m(a), all_m = travel_m(b) - begin_m;
  const Between poses = between(a, b);
  if (poses.count() == 0) return arc_deviation_m(glm::length(turn_rad));
  double deviation_m = 0, max_turn_rad = turn_rad_[a.pose];
  for (std::size_t pose = poses.first; pose < poses.beyond; ++pose) {
    const double fraction = all_m > 0 ? (travel_m_[pose] - begin_m) / all_m : 0;
    const Pose& there = world_from_center_[pose];
    const Pose even{from.position_m + shift_m * fraction,
                    coupling::rotation_by(turn_rad * fraction) * from.orientation};
    deviation_m = std::max(deviation_m, glm::length(there.position_m - even.position_m) +
                                            radius_m_ * glm::length(turn_between(even, there)));
    max_turn_rad = std::max(max_turn_rad, turn_rad_[pose]);
  }
  return kRoundUp * deviation_m + arc_deviation_m(glm::length(turn_rad)) +
         arc_deviation_m(max_turn_rad);
}

}  // namespace forcelayer::clearance
