// The outer surface of a layer of voxels as flat rectangles: what a picture of a million voxels
// needs, where a cube per voxel would be six times too much.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "formats/voxmap.h"

namespace forcelayer {

// Rectangles in space, each with four corners of its own, counter-clockwise from outside.
struct QuadSurface {
  glm::dvec3 origin_m{0, 0, 0};               // world; corners are relative to it
  std::vector<std::array<float, 3>> corners;  // [4 * quads] m
  std::uint64_t voxel_faces = 0;              // unit faces that the rectangles cover

  std::uint64_t quad_count() const { return corners.size() / 4; }
};

// Whether neighbouring unit faces become one rectangle (within the 8x8 faces of a brick's side).
enum class Faces { kMerged, kSingle };

// The faces at which `layer` (interior, surface or proximity) borders on a value further out, in
// the order interior, surface, proximity, free. `origin_m`: world point that corners are given
// from.
QuadSurface layer_surface(const Voxmap& voxmap, VoxelValue layer, const glm::dvec3& origin_m,
                          Faces faces = Faces::kMerged);

}  // namespace forcelayer
