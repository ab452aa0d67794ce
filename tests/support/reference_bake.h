// The bake of a scene on a dense grid, voxel by voxel: slow and obviously right.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "formats/lattice/voxel_overlap.h"
#include "formats/voxmap_format.h"
#include "tests/support/exact_overlap.h"
#include "voxelize/bake.h"

namespace forcelayer::reference {

__extension__ typedef __int128 Int128;

// A byte per voxel of a box, world voxel indices, both ends inclusive.
class DenseGrid {
 public:
  DenseGrid(const lattice::VoxelIndex& low, const lattice::VoxelIndex& high)
      : low_(low), high_(high) {
    for (std::size_t d = 0; d < 3; ++d) dims_[d] = high[d] - low[d] + 1;
    values_.assign(static_cast<std::size_t>(dims_[0] * dims_[1] * dims_[2]), 0);
  }

  bool contains(const lattice::VoxelIndex& v) const {
    for (std::size_t d = 0; d < 3; ++d) {
      if (v[d] < low_[d] || v[d] > high_[d]) return false;
    }
    return true;
  }
  std::uint8_t& at(const lattice::VoxelIndex& v) { return values_[index(v)]; }
  std::uint8_t at(const lattice::VoxelIndex& v) const { return values_[index(v)]; }
  const lattice::VoxelIndex& low() const { return low_; }
  const lattice::VoxelIndex& high() const { return high_; }

  template <class F>
  void for_each(F&& f) const {
    for (std::int64_t x = low_[0]; x <= high_[0]; ++x) {
      for (std::int64_t y = low_[1]; y <= high_[1]; ++y) {
        for (std::int64_t z = low_[2]; z <= high_[2]; ++z) f(lattice::VoxelIndex{x, y, z});
      }
    }
  }

 private:
  std::size_t index(const lattice::VoxelIndex& v) const {
    return static_cast<std::size_t>(((v[0] - low_[0]) * dims_[1] + (v[1] - low_[1])) * dims_[2] +
                                    (v[2] - low_[2]));
  }

  lattice::VoxelIndex low_, high_;
  std::array<std::int64_t, 3> dims_;
  std::vector<std::uint8_t> values_;
};

using LatticeMesh = std::vector<lattice::LatticeTriangle>;

inline LatticeMesh snapped(const mesh::Mesh& mesh, const mesh::Affine& world_from_mesh,
                           double voxel_size_m) {
  LatticeMesh triangles;
  for (const mesh::Triangle& corners : mesh.triangles) {
    lattice::LatticeTriangle& triangle = triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      triangle[k] =
          lattice::snap(mesh::apply(world_from_mesh, mesh.vertices[corners[k]]), voxel_size_m);
    }
  }
  return triangles;
}

// The grid that holds all meshes and `margin` voxels around them.
inline DenseGrid grid_around(const std::vector<LatticeMesh>& meshes, std::int64_t margin) {
  lattice::VoxelIndex low{INT64_MAX, INT64_MAX, INT64_MAX}, high{INT64_MIN, INT64_MIN, INT64_MIN};
  for (const LatticeMesh& mesh : meshes) {
    for (const lattice::LatticeTriangle& triangle : mesh) {
      for (const lattice::LatticePoint& point : triangle) {
        for (std::size_t d = 0; d < 3; ++d) {
          low[d] = std::min(low[d], (point[d] >> lattice::kSnapBits) - margin);
          high[d] = std::max(high[d], (point[d] >> lattice::kSnapBits) + margin);
        }
      }
    }
  }
  return DenseGrid(low, high);
}

// G: marks with 1 the voxels of the mesh, each of a triangle's box tested by itself.
inline void mark_geometry(const LatticeMesh& mesh, DenseGrid& grid) {
  for (const lattice::LatticeTriangle& triangle : mesh) {
    lattice::VoxelIndex low, high;
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = std::min({triangle[0][d], triangle[1][d], triangle[2][d]}) >> lattice::kSnapBits;
      high[d] = std::max({triangle[0][d], triangle[1][d], triangle[2][d]}) >> lattice::kSnapBits;
    }
    DenseGrid(low, high).for_each([&](const lattice::VoxelIndex& v) {
      if (grid.at(v) == 0 && overlaps_cell<Int128>(triangle, v)) grid.at(v) = 1;
    });
  }
}

// F: marks with 2 what a 6-connected walk reaches from the grid's border and from the seeds. The
// grid must leave a margin around the mesh.
inline void mark_free(const std::vector<lattice::VoxelIndex>& seeds, DenseGrid& grid) {
  std::vector<lattice::VoxelIndex> stack = {grid.low()};
  stack.insert(stack.end(), seeds.begin(), seeds.end());
  while (!stack.empty()) {
    const lattice::VoxelIndex v = stack.back();
    stack.pop_back();
    if (!grid.contains(v) || grid.at(v) != 0) continue;
    grid.at(v) = 2;
    for (std::size_t d = 0; d < 3; ++d) {
      for (const std::int64_t step : {-1, 1}) {
        lattice::VoxelIndex next = v;
        next[d] += step;
        stack.push_back(next);
      }
    }
  }
}

// Geometry and interior of all objects, each flooded by itself, then united.
struct ReferenceScene {
  DenseGrid geometry, interior;  // 1 where set
};

inline ReferenceScene united_scene(const std::vector<LatticeMesh>& meshes,
                                   const std::vector<lattice::VoxelIndex>& seeds,
                                   std::int64_t margin) {
  ReferenceScene scene{grid_around(meshes, margin), grid_around(meshes, margin)};
  for (const LatticeMesh& mesh : meshes) {
    if (mesh.empty()) continue;
    DenseGrid object = grid_around({mesh}, 1);  // all beyond is free
    mark_geometry(mesh, object);
    mark_free(seeds, object);
    object.for_each([&](const lattice::VoxelIndex& v) {
      if (object.at(v) == 1) scene.geometry.at(v) = 1;
      if (object.at(v) == 0) scene.interior.at(v) = 1;
    });
  }
  return scene;
}

// The value of every voxel after the offset by `layers`. The margin must be above layers + 1.
inline DenseGrid offset_scene(const ReferenceScene& scene, int layers) {
  const int reach = layers + 1;
  DenseGrid distance(scene.geometry.low(), scene.geometry.high());  // 1 + c(v); 0 = above reach
  scene.geometry.for_each([&](const lattice::VoxelIndex& g) {
    if (scene.geometry.at(g) == 0) return;
    for (int x = -reach; x <= reach; ++x) {
      for (int y = -reach; y <= reach; ++y) {
        for (int z = -reach; z <= reach; ++z) {
          const int c = std::max({std::abs(x), std::abs(y), std::abs(z)});
          std::uint8_t& stored = distance.at({g[0] + x, g[1] + y, g[2] + z});
          if (stored == 0 || stored > c + 1) stored = static_cast<std::uint8_t>(c + 1);
        }
      }
    }
  });
  DenseGrid values(scene.geometry.low(), scene.geometry.high());
  values.for_each([&](const lattice::VoxelIndex& v) {
    const int c = distance.at(v) == 0 ? reach + 1 : distance.at(v) - 1;
    VoxelValue value = VoxelValue::kFree;
    if (c == layers + 1) value = VoxelValue::kProximity;
    if (c == layers) value = VoxelValue::kSurface;
    if (c < layers || scene.interior.at(v) == 1) value = VoxelValue::kInterior;
    values.at(v) = static_cast<std::uint8_t>(value);
  });
  return values;
}

}  // namespace forcelayer::reference
