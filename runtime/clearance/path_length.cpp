#include "runtime/clearance/path_length.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "runtime/coupling/coupling.h"

namespace forcelayer::clearance {
namespace {

constexpr int kDirections = 200;
// Within a step that turns, speeds are taken in the middle of pieces that turn by this or less.
constexpr double kPieceRad = 0.05;

// Evenly over the sphere: a spiral of equal areas.
glm::dvec3 spiral_direction(int i) {
  const double z = 1 - (2 * i + 1) / double{kDirections}, r = std::sqrt(1 - z * z);
  const double turn_rad = std::numbers::pi * (3 - std::sqrt(5.0)) * i;
  return {r * std::cos(turn_rad), r * std::sin(turn_rad), z};
}

// The points of the shell that lie farthest out in each direction, relative to the centroid, m.
std::vector<glm::dvec3> outermost_points_m(const PshellView& shell) {
  std::vector<glm::dvec3> points_m;
  for (int i = 0; i < kDirections; ++i) {
    const glm::vec3 direction(spiral_direction(i));
    std::uint64_t farthest = 0;
    float farthest_m = -INFINITY;
    for (std::uint64_t n = 0; n < shell.point_count; ++n) {
      const float m =
          direction.x * shell.x[n] + direction.y * shell.y[n] + direction.z * shell.z[n];
      if (m > farthest_m) farthest_m = m, farthest = n;
    }
    points_m.emplace_back(shell.x[farthest], shell.y[farthest], shell.z[farthest]);
  }
  return points_m;
}

// The travel of the fastest point while the part turns evenly by `turn_rad` (world) and its
// centroid is shifted by `shift_m`.
double step_length_m(std::span<const glm::dvec3> points_m, const glm::dquat& orientation,
                     const glm::dvec3& shift_m, const glm::dvec3& turn_rad) {
  const double pieces = std::ceil(glm::length(turn_rad) / kPieceRad);
  if (pieces == 0) return glm::length(shift_m);
  double length_m = 0;
  for (double n = 0; n < pieces; ++n) {
    const glm::dquat there = coupling::rotation_by((n + 0.5) / pieces * turn_rad) * orientation;
    double fastest2 = 0;
    for (const glm::dvec3& point_m : points_m) {
      const glm::dvec3 moves_m = shift_m + glm::cross(turn_rad, there * point_m);
      fastest2 = std::max(fastest2, glm::dot(moves_m, moves_m));
    }
    length_m += std::sqrt(fastest2) / pieces;
  }
  return length_m;
}

}  // namespace

PathLength::PathLength(const CenterPath& path, const Pshell& part) : at_pose_m_{0} {
  std::vector<glm::dvec3> points_m;
  for (std::size_t i = 0; i + 1 < path.poses(); ++i) {
    const Pose from = path.world_from_center({i, 0}), to = path.world_from_center({i + 1, 0});
    const glm::dvec3 turn_rad =
        coupling::rotation_vector(to.orientation * glm::conjugate(from.orientation));
    if (turn_rad != glm::dvec3(0) && points_m.empty()) points_m = outermost_points_m(part.view());
    at_pose_m_.push_back(at_pose_m_.back() + step_length_m(points_m, from.orientation,
                                                           to.position_m - from.position_m,
                                                           turn_rad));
  }
}

double PathLength::at_m(const Moment& moment) const {
  const double from_m = at_pose_m_[moment.pose];
  return moment.fraction == 0 ? from_m
                              : std::lerp(from_m, at_pose_m_[moment.pose + 1], moment.fraction);
}

}  // namespace forcelayer::clearance
