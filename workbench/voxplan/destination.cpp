#include "workbench/voxplan/destination.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>

#include "runtime/clearance/front.h"
#include "runtime/clearance/required_distance.h"

namespace forcelayer::voxplan {
namespace {

constexpr double kBeside = 1e-6;  // of the part's radius; exceeds the rounding of a box

// How far beside the box of the scene's voxels a part must be so that its clearance is proven, m.
// Outside of this box all stored distances are at least the reach of the map. If more is required,
// the gap between the boxes alone is enough: a voxel more, because distances are measured from
// centers of voxels.
double clear_beside_m(const Problem& problem) {
  const double required =
      clearance::RequiredDistance(problem.scene, problem.part, problem.clearance_m).voxels();
  if (required <= clearance::reach_voxels(problem.scene.header())) return 0;
  return (required + 1) * problem.scene.voxel_size_m();
}

}  // namespace

Destination::Destination(const Problem& problem)
    : problem_(problem),
      clear_m_(clear_beside_m(problem)),
      cropped_sides_(problem.scene.header().cropped_sides) {
  const VoxmapHeader& h = problem.scene.header();
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    scene_.low[axis] = static_cast<double>(h.origin_voxel[i]) * h.voxel_size_m;
    scene_.high[axis] = scene_.low[axis] + static_cast<double>(h.dims_voxels[i]) * h.voxel_size_m;
  }
  // Includes room to pass the scene and to turn beside it.
  const double around_m =
      3 * problem.part.header().bounding_radius_m + problem.clearance_m + clear_m_;
  const glm::dvec3& start = problem.world_from_start.position_m;
  bounds_ = {glm::min(scene_.low, start) - around_m, glm::max(scene_.high, start) + around_m};
}

Destination Destination::at(const Problem& problem, const Pose& world_from_center) {
  Destination goal(problem);
  goal.pose_ = world_from_center;
  const double around_m = 3 * problem.part.header().bounding_radius_m;
  goal.bounds_.low = glm::min(goal.bounds_.low, world_from_center.position_m - around_m);
  goal.bounds_.high = glm::max(goal.bounds_.high, world_from_center.position_m + around_m);
  return goal;
}

Destination Destination::out_of_scene(const Problem& problem) { return Destination(problem); }

double Destination::beside() const {
  return clear_m_ + kBeside * problem_.part.header().bounding_radius_m;
}

Box Destination::part_box(const Pose& pose) const {
  const PshellView& v = problem_.part.view();
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Box box{glm::dvec3(kFar), glm::dvec3(-kFar)};
  for (std::uint64_t i = 0; i < v.block_count; ++i) {
    const BoundingSphere& s = v.blocks[i];
    const glm::dvec3 center = pose.orientation * glm::dvec3(s.x, s.y, s.z) + pose.position_m;
    box.low = glm::min(box.low, center - double{s.radius});
    box.high = glm::max(box.high, center + double{s.radius});
  }
  return box;
}

double Destination::distance_m(const Pose& pose) const {
  if (pose_) return travel_between_m(problem_, pose, *pose_);
  const Box box = part_box(pose);
  double min_m = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (ends_at(axis, true)) min_m = std::min(min_m, scene_.high[axis] - box.low[axis]);
    if (ends_at(axis, false)) min_m = std::min(min_m, box.high[axis] - scene_.low[axis]);
  }
  return std::max(0.0, min_m);
}

std::optional<Pose> Destination::straight_from(const Pose& from,
                                               const glm::dvec3& direction) const {
  if (pose_) return *pose_;
  const Box box = part_box(from);
  double distance_m = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double up = direction[axis];
    if (up == 0 || !ends_at(axis, up > 0)) continue;
    const double beside_m = up > 0 ? scene_.high[axis] - box.low[axis] + beside()
                                   : box.high[axis] - scene_.low[axis] + beside();
    distance_m = std::min(distance_m, std::max(0.0, beside_m) / std::abs(up));
  }
  if (!std::isfinite(distance_m)) return std::nullopt;
  return Pose{from.position_m + distance_m * direction, from.orientation};
}

Pose Destination::sample(Random& random) const {
  if (pose_) return *pose_;
  Pose pose = problem_.world_from_start;
  if (random.fraction() < 0.5) pose.orientation = random.orientation();
  if (random.fraction() < 0.5) {
    for (int axis = 0; axis < 3; ++axis) {
      pose.position_m[axis] = random.between(scene_.low[axis], scene_.high[axis]);
    }
  }
  int axis;
  bool high;
  do {
    axis = static_cast<int>(random.below(3));
    high = random.fraction() < 0.5;
  } while (!ends_at(axis, high));
  const Box box = part_box(pose);
  pose.position_m[axis] += high ? scene_.high[axis] - box.low[axis] + beside()
                                : scene_.low[axis] - box.high[axis] - beside();
  return pose;
}

}  // namespace forcelayer::voxplan
