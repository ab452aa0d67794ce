// The inner loop of a search: the least way from a place to the mesh over the voxels of a front.
#pragma once

#include <cstddef>

namespace forcelayer::clearance {

// Columns of a front (front.h), a multiple of 16 long.
struct FrontColumns {
  const float *x, *y, *z;  // centers, voxels
  const float* smallest;   // their distances from the mesh, voxels
  std::size_t count;
};

// The least of `best` and of all |p - center| + least, p = (x, y, z). Every instruction set gives
// the same bits.
float min_sum(const FrontColumns& front, float x, float y, float z, float best) noexcept;

}  // namespace forcelayer::clearance
