// The guard's threshold, its comparison, and its decision to accept a pose. The proof is in
// docs/proofs.md, section 4.
#pragma once

#include <cstdint>

#include "formats/voxmap_format.h"
#include "runtime/field/contact_set.h"

namespace forcelayer::guard {

// Which shell points may not be where they are: those that are not proven to keep the guard's
// distance from the static mesh, and those in the interior. In a map with a standoff the distance
// decides alone, and the values of voxels do not.
class PointRule {
 public:
  // `proves_distances`: whether the force field does. Where it does not, the interior alone counts.
  PointRule(const VoxmapHeader& header, bool proves_distances);

  // Marks the barred points of a set, and finds its least proven distance. `proven_m`: each point
  // of the set is proven to be so far from the static mesh; not read where nothing is proven.
  void mark_points(const float* proven_m, field::ContactSet& set) const noexcept;

  // `proven_m`: the point is proven to be so far from the static mesh.
  bool is_too_near(float proven_m) const noexcept;
  // Whether a point in the interior is barred for that alone.
  bool goes_by_value() const noexcept { return by_value_; }

 private:
  float threshold_m_ = 0;  // the guard's distance; 0 where nothing is proven: no point is too near
  float free_m_ = 0;       // no point in a free voxel is nearer to the static mesh
  bool proves_ = false, by_value_ = true;
};

// The decision: whether the part may go from the pose of `here` to that of `there`. It may where
// every point that is barred there is barred here too. So a part that keeps the distance never
// loses it, and one that started too near can leave.
bool accepts_pose(const field::ContactSet& here, const field::ContactSet& there) noexcept;

// The premise of the proof between two poses: no point of the part goes farther than half a voxel.
inline constexpr double kMaxTravelVoxels = 0.5;

// Whether that holds for a motion that shifts the centroid by `shift_m` and turns the part by
// `turn_rad`. No point is farther from the centroid than `radius_m`, so none has a longer arc.
bool is_within_travel(double shift_m, double turn_rad, double radius_m,
                      double voxel_size_m) noexcept;

}  // namespace forcelayer::guard
