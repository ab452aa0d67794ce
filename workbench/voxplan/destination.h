// Where a path may end: at a pose, or anywhere outside of the scene.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "workbench/voxplan/check/problem.h"
#include "workbench/voxplan/random.h"

namespace forcelayer::voxplan {

// A box along the world's axes, m.
struct Box {
  glm::dvec3 low{0}, high{0};
};

class Destination {
 public:
  // A pose of the centroid frame.
  static Destination at(const Problem& problem, const Pose& world_from_center);
  // The part's box is beside the scene's, the box of its voxels that are not free: at a side that
  // is not cropped, beyond which the scene does not go on.
  static Destination out_of_scene(const Problem& problem);
  // Whether there is such a side. Else nothing below may be asked.
  bool is_known() const { return pose_ || cropped_sides_ != kAllSides; }

  bool is_reached(const Pose& pose) const { return distance_m(pose) <= 0; }
  double distance_m(const Pose& pose) const;  // that is left to go at least
  Pose sample(Random& random) const;
  // The one pose, or the nearest pose outside that a part gets to from `from` in that direction.
  std::optional<Pose> straight_from(const Pose& from, const glm::dvec3& direction) const;
  bool is_one_pose() const { return pose_.has_value(); }

  // Wherever it is of use to look for the part's centroid.
  const Box& bounds() const { return bounds_; }

 private:
  static constexpr std::uint32_t kAllSides = 63;  // CroppedSide bits

  explicit Destination(const Problem& problem);
  Box part_box(const Pose& pose) const;
  double beside() const;  // by so much more, m
  bool ends_at(int axis, bool high) const { return !(cropped_sides_ >> (2 * axis + high) & 1u); }

  const Problem& problem_;
  std::optional<Pose> pose_;
  Box scene_, bounds_;
  std::uint32_t cropped_sides_;
};

}  // namespace forcelayer::voxplan
