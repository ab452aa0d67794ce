// Flat bounds on what a brick holds, so that a disc of shell points can lie beside a wall, however
// the wall is turned, and be known free.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/voxmap.h"
#include "runtime/query/query_kernel.h"

namespace forcelayer::query {

// All non-free voxels of a brick lie where normal . x <= offset, x in voxels from the brick's
// corner.
struct BrickBound {
  std::array<float, 3> normal{};  // unit, but for rounding; zero where nothing is known
  float offset = 0;
};

// The bound of a brick of two-bit values: along the vector area of its non-free voxels' boundary,
// which for a wall is the wall's normal.
BrickBound brick_bound(const std::uint32_t* brick);

// How far the points of a disc may move, voxels: along its axis, and across it.
struct Leeway {
  float along, across;
};

// A disc in voxels from the directory's corner. All rounding is in its margin.
struct PlacedDisc {
  std::array<float, 3> center;  // from `whole`
  std::array<std::int32_t, 3> whole;
  std::array<float, 3> axis;  // unit
  float radius, half_height;
  float margin;  // that its extent along any direction is larger by
};

// The bounds of all bricks of a map.
class BrickBounds {
 public:
  explicit BrickBounds(const Voxmap& voxmap);

  // The fraction of `largest`, at most 1, by which the disc may move before one of its points can
  // lie in a voxel that is not free or not known. At most 0 where this cannot tell.
  float fraction(const KernelMap& map, const PlacedDisc& disc,
                 const Leeway& largest) const noexcept;

 private:
  std::vector<BrickBound> bounds_;
};

}  // namespace forcelayer::query
