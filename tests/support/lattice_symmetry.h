// Turns and mirrors of the voxel lattice, and the reference bake under them.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "tests/support/reference_bake.h"

namespace forcelayer::reference {

// One of the 24 rotations of the cube, or 24 reflections: world axis d is `sign[d]` times axis
// `from[d]` of before.
struct Symmetry {
  std::array<std::size_t, 3> from;
  std::array<int, 3> sign;

  // Voxels whose low side was half-open towards minus have it towards plus on a mirrored axis: a
  // voxel i of before is voxel -1 - i there, and holds its high side, not its low one.
  lattice::VoxelIndex voxel(const lattice::VoxelIndex& v) const {
    lattice::VoxelIndex result;
    for (std::size_t d = 0; d < 3; ++d) result[d] = sign[d] > 0 ? v[from[d]] : -1 - v[from[d]];
    return result;
  }
  lattice::LatticeTriangle triangle(const lattice::LatticeTriangle& t) const {
    lattice::LatticeTriangle result;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t d = 0; d < 3; ++d) result[k][d] = sign[d] * t[k][from[d]];
    }
    return result;
  }
  std::vector<LatticeMesh> meshes(std::vector<LatticeMesh> list) const {
    for (LatticeMesh& mesh : list) {
      for (lattice::LatticeTriangle& t : mesh) t = triangle(t);
    }
    return list;
  }
};

inline std::vector<Symmetry> symmetries() {
  std::vector<Symmetry> all;
  std::array<std::size_t, 3> from = {0, 1, 2};
  do {
    for (int n = 0; n < 8; ++n)
      all.push_back({from, {n & 1 ? -1 : 1, n & 2 ? -1 : 1, n & 4 ? -1 : 1}});
  } while (std::next_permutation(from.begin(), from.end()));
  return all;
}

// G of the moved mesh by the reference, with the half-open rule moved along: on a mirrored axis a
// voxel holds its high side and not its low one.
inline bool overlaps_moved_voxel(const lattice::LatticeTriangle& triangle,
                                 const lattice::VoxelIndex& voxel, const Symmetry& symmetry) {
  lattice::LatticePoint low, high;
  std::array<bool, 3> high_closed;
  for (std::size_t d = 0; d < 3; ++d) {
    low[d] = voxel[d] * lattice::kSnapUnits;
    high[d] = low[d] + lattice::kSnapUnits;
    high_closed[d] = symmetry.sign[d] < 0;
  }
  return overlaps<Int128>(triangle, low, high, high_closed);
}

// The whole reference bake in the moved frame.
inline DenseGrid moved_reference(const std::vector<LatticeMesh>& meshes, const Symmetry& symmetry,
                                 int layers) {
  const std::vector<LatticeMesh> moved = symmetry.meshes(meshes);
  const std::int64_t margin = layers + 3;
  ReferenceScene scene{grid_around(moved, margin), grid_around(moved, margin)};
  for (const LatticeMesh& mesh : moved) {
    if (mesh.empty()) continue;
    DenseGrid object = grid_around({mesh}, 2);  // all beyond is free
    for (const lattice::LatticeTriangle& triangle : mesh) {
      lattice::VoxelIndex low, high;
      for (std::size_t d = 0; d < 3; ++d) {
        // On a mirrored axis a corner on a face belongs to the voxel below.
        const std::int64_t down = symmetry.sign[d] < 0 ? 1 : 0;
        low[d] = (std::min({triangle[0][d], triangle[1][d], triangle[2][d]}) - down) >>
                 lattice::kSnapBits;
        high[d] = (std::max({triangle[0][d], triangle[1][d], triangle[2][d]}) - down) >>
                  lattice::kSnapBits;
      }
      DenseGrid(low, high).for_each([&](const lattice::VoxelIndex& v) {
        if (object.at(v) == 0 && overlaps_moved_voxel(triangle, v, symmetry)) object.at(v) = 1;
      });
    }
    mark_free({}, object);
    object.for_each([&](const lattice::VoxelIndex& v) {
      if (object.at(v) == 1) scene.geometry.at(v) = 1;
      if (object.at(v) == 0) scene.interior.at(v) = 1;
    });
  }
  return offset_scene(scene, layers);
}

}  // namespace forcelayer::reference
