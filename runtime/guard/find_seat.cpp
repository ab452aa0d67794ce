// The set-up of a seat: SeatRule::find().
#include <algorithm>
#include <cstdio>
#include <glm/geometric.hpp>
#include <string>

#include "runtime/guard/seat_rule.h"

namespace forcelayer::guard {
namespace {

// The floor of a seat, in voxels: at least kSeatGiveVoxels deep, which leaves room for the contact
// spring and for the error of interpolation between flat and curved faces, and at least
// kMinGiveVoxels below the deepest point of the seat.
constexpr float kSeatGiveVoxels = 0.25f, kMinGiveVoxels = 0.05f;

// The force of a seat begins so far before the surface where the part lies as far from it: one
// contact point that pushes with the coupling's force limit is that deep, or less
// (kHoldDepthVoxels of default_model.cpp), so it ends at the surface.
constexpr float kEarlyVoxels = 0.15f;

// An object that lies deeper than this between two points in the seat stands in a gap of the part
// that is narrower than its points are apart: nothing is felt between points of it.
constexpr float kMaxBetweenVoxels = 0.3f;

// The floor must lie this far above the distance of the lowest code, in voxels: where some of the
// eight centers have that code, the interpolated distance can be this much too large.
constexpr double kUntoldVoxels = 0.35;

// Without distances all points in the interior are alike: a seat looks like a penetration.
Error no_distances(bool stored) {
  if (stored) {
    return {ErrorCode::kUsage, "", "start",
            "the part starts inside the scene, and this force field cannot distinguish a seat from "
            "a penetration",
            "leave out --force, or start elsewhere (--start)"};
  }
  return {ErrorCode::kUsage, "", "start",
          "the part starts inside the scene, and a scene without stored distances cannot "
          "distinguish a seat from a penetration",
          "bake the scene without --kind lean or paper, or start elsewhere (--start)"};
}

}  // namespace

// An error where an object's floor lies too near the lowest code. Below that code the stored
// distances tell no depth, and close above it interpolation is too coarse.
Status SeatRule::check_depth(const SeatObject& object) const {
  const VoxmapHeader& header = probe_.voxmap().header();
  const double told_m = header.distance_quantum_m * (header.distance_zero_code - 1) -
                        kUntoldVoxels * header.voxel_size_m;
  if (-double{object.corner_floor_m} < told_m) return {};
  const double max_m = told_m - kMinGiveVoxels * header.voxel_size_m - header.distance_quantum_m;
  if (told_m <= kSeatGiveVoxels * header.voxel_size_m + header.distance_quantum_m) {
    return Error{ErrorCode::kUsage, "", "start",
                 "the part touches " + name_of(object.object) +
                     ", but no distances are stored deep enough for a seat",
                 "bake the scene with a larger --range"};
  }
  char depth[80], largest[80];
  std::snprintf(depth, sizeof depth, "the part starts %s%.3g mm inside ",
                object.overlap_m < told_m ? "" : "more than ",
                1000 * std::min(object.overlap_m, told_m));
  std::snprintf(largest, sizeof largest, "; the stored distances allow a seat up to %.3g mm deep",
                1000 * max_m);
  return Error{
      ErrorCode::kUsage, "", "start", depth + name_of(object.object) + largest,
      "check --start and both files' units; if voxelize reports a cavity at the start pose, bake "
      "the scene with --free-seed, --narrow-passages or smaller voxels; if it reports none there, "
      "bake the scene with a larger --range"};
}

std::string SeatRule::name_of(std::uint32_t object) const {
  const std::string_view name = probe_.voxmap().object_name(object);
  return name.empty() ? "the scene" : std::string(name);
}

// An error where collected point i does not tell on which side of the scene's surface it lies.
Status SeatRule::check_side(std::uint32_t i) const {
  if (!probe_.is_two_sided(i) || glm::length(probe_.slope(i)) >= field::kSideSlope ||
      probe_.lies_beside_solid(i, half_sheet_m())) {
    return {};
  }
  return Error{ErrorCode::kUsage, "", "start",
               "at the start, open sheets of the part and of " + name_of(probe_.object_of(i)) +
                   " meet, so it is not known on which side the part is",
               "give one of the two sheets a thickness, or start elsewhere (--start)"};
}

Status SeatRule::find(const Pose& world_from_center, SeatDepth depth) {
  seat_ = {};
  tables_ = SeatTables(seat_);
  const std::size_t points = probe_.query().shell().view().point_count;
  in_seat_m_.assign(points, 0);
  in_seat_steepness_.assign(points, 1);
  corner_points_ = 0;
  walls_.reserve(points);
  nearest_.reserve(points);
  turned_.resize(points);
  probe_.query_pose(world_from_center);
  const field::FieldSamples& samples = probe_.samples();
  const auto voxel_size_m = static_cast<float>(probe_.voxmap().voxel_size_m());
  const auto step_m = static_cast<float>(probe_.voxmap().header().distance_quantum_m);
  const float farthest_m = kEarlyVoxels * voxel_size_m + 0.5f * step_m;
  Seat seat;
  for (std::uint32_t i = 0; i < probe_.count(); ++i) {
    const bool interior = rule_.goes_by_value() && field::is_interior(probe_.points().value[i]);
    const bool near = probe_.proves_distances() &&
                      (rule_.is_too_near(samples.distance_m[i]) || samples.depth_m[i] > 0);
    if (!interior && !near) continue;
    if (!probe_.proves_distances()) return no_distances(probe_.voxmap().distances() != nullptr);
    if (Status side = check_side(i); !side) return side;
    SeatObject& object = seat.at(probe_.object_of(i));
    if (object.points == 0) object.contact_m = object.between_m = farthest_m;
    const float distance_m = probe_.stored_distance_m(i);
    in_seat_m_[probe_.point(i)] = distance_m;
    object.corner_floor_m = std::min(object.corner_floor_m, distance_m);
    ++object.points;
    // In a corner, interpolation mixes two faces: the depth there does not hold for other points.
    const float steepness = glm::length(probe_.slope(i));
    if (steepness > kFaceSlope) object.contact_m = std::min(object.contact_m, distance_m);
    if (!touches_in_corner(i)) continue;
    in_seat_steepness_[probe_.point(i)] = steepness;
    ++corner_points_;
  }
  between_.find(world_from_center, seat);
  // A distance is read with an error of up to half a step, so a surface that only touches may be
  // read a step deep. Elsewhere a point may read deeper than in the seat: without this, a pin
  // stayed in the mouth of its bore. A part that lies deeper than a step overlaps the object: there
  // the deepest reading holds.
  const auto onset_m = [&](float min_m) {
    return std::min(min_m, std::max(min_m - 0.5f * step_m, -step_m));
  };
  for (SeatObject& object : seat.entries()) {
    if (object.runs_through) {
      return Error{ErrorCode::kUsage, "", "start",
                   name_of(object.object) + " pierces the part at the start pose",
                   "check --start and the units of both files; if the object may pierce the part, "
                   "leave it out of the scene"};
    }
    object.overlap_m = -double{object.corner_floor_m};
    const auto floor_m = [&](float min_m) {
      return std::min(min_m - kMinGiveVoxels * voxel_size_m, -kSeatGiveVoxels * voxel_size_m) -
             step_m;
    };
    object.floor_m = floor_m(object.contact_m);
    object.corner_floor_m = floor_m(object.corner_floor_m);
    object.feels_between = object.between_m > -kMaxBetweenVoxels * voxel_size_m;
    object.between_floor_m = floor_m(object.between_m);
    object.installed_m = std::min(object.contact_m, 0.0f);
    object.contact_m = onset_m(object.contact_m);
    // The faces beside an edge may lie as near as others of the object.
    object.between_m = std::min(object.between_m, object.contact_m);
    if (depth == SeatDepth::kOfMeshes) continue;
    if (Status told = check_depth(object); !told) return told;
  }
  seat_ = std::move(seat);
  tables_ = SeatTables(seat_);
  return {};
}

}  // namespace forcelayer::guard
