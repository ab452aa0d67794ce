// The end of a path: one pose, or any pose outside of the scene.
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
  // Any pose at which the part's box is beside the box of the scene's voxels that are not free.
  // Only sides that are not cropped count, because the scene does not go on there.
  static Destination out_of_scene(const Problem& problem);
  // Whether there is such a side. If not, the functions below must not be called.
  bool is_known() const { return pose_ || cropped_sides_ != kAllSides; }

  bool is_reached(const Pose& pose) const { return distance_m(pose) <= 0; }
  double distance_m(const Pose& pose) const;  // lower bound of the distance left to go
  Pose sample(Random& random) const;
  // The one pose, or the nearest pose outside that the part reaches from `from` in that direction.
  std::optional<Pose> straight_from(const Pose& from, const glm::dvec3& direction) const;
  bool is_one_pose() const { return pose_.has_value(); }

  // The positions of the part's centroid among which a search is useful.
  const Box& bounds() const { return bounds_; }

 private:
  static constexpr std::uint32_t kAllSides = 63;  // CroppedSide bits

  explicit Destination(const Problem& problem);
  Box part_box(const Pose& pose) const;
  double beside() const;  // extra distance between the boxes at a goal, m
  bool ends_at(int axis, bool high) const { return !(cropped_sides_ >> (2 * axis + high) & 1u); }

  const Problem& problem_;
  std::optional<Pose> pose_;
  double clear_m_ = 0;  // by so much the boxes must be apart for the clearance to be proven
  Box scene_, bounds_;
  std::uint32_t cropped_sides_;
};

}  // namespace forcelayer::voxplan
