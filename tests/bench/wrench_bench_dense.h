// The peer that stores nothing cleverly: every distance as a float, in a dense array (Barbic and
// James 2008, written for the vectors of today). The contact query, its skipping and the points are
// ours.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/field/force_field.h"

namespace forcelayer::bench {

// Distances at the centers of a box of voxels, m.
struct DenseDistances {
  std::array<std::int64_t, 3> low{};   // voxel of the first, world lattice
  std::array<std::int32_t, 3> dims{};  // at least two each
  std::vector<float> distance_m;       // z fastest

  std::size_t index(const std::array<std::int64_t, 3>& voxel) const {
    return static_cast<std::size_t>(((voxel[0] - low[0]) * dims[1] + voxel[1] - low[1]) * dims[2] +
                                    voxel[2] - low[2]);
  }
};

// Depth below the surface at `offset_m`, along the gradient of the trilinear interpolation. A point
// that is not between the centers of the box has no depth.
class DenseField final : public field::ForceField {
 public:
  // Both must outlive the field.
  DenseField(const Voxmap& voxmap, const DenseDistances& distances, double offset_m);

  void measure(const query::CollectedPoints& points,
               field::FieldSamples& samples) const noexcept override;
  bool has_exact_slopes() const noexcept override { return true; }

 private:
  const DenseDistances& distances_;
  std::array<std::int32_t, 3> first_;  // voxel of the query that is the box's first
  float voxel_size_m_, offset_m_;
};

}  // namespace forcelayer::bench
