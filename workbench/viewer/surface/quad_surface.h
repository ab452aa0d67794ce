// The faces of voxel sets as flat rectangles. A picture of a million voxels needs them: a cube per
// voxel would be six times as much.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "formats/voxmap.h"
#include "formats/voxmap_walk.h"

namespace forcelayer::viewer {

// Rectangles in space, each with four corners of its own, counter-clockwise from outside.
struct QuadSurface {
  glm::dvec3 origin_m{0, 0, 0};               // world; corners are relative to it
  std::vector<std::array<float, 3>> corners;  // [4 * quads] m
  std::vector<std::uint8_t> directions;       // [quads] 2 axis + (1 where the side is upper)
  std::uint64_t voxel_faces = 0;              // unit faces that the rectangles cover

  std::uint64_t quad_count() const { return corners.size() / 4; }
};

// Whether neighboring unit faces become one rectangle (within the 8x8 faces of a brick's side).
enum class Faces { kMerged, kSingle };

using RelativeVoxel = std::array<std::int32_t, 3>;  // relative to a map's directory_origin

// Adds faces to a surface, 8x8 at a time.
class QuadWriter {
 public:
  // The voxels given to add() are relative to `directory_origin`.
  QuadWriter(const std::array<std::int64_t, 3>& directory_origin, double voxel_size_m,
             const glm::dvec3& origin_m, Faces faces)
      : voxel_size_m_(voxel_size_m), faces_(faces) {
    surface_.origin_m = origin_m;
    for (int axis = 0; axis < 3; ++axis) {
      base_m_[axis] =
          static_cast<double>(directory_origin[static_cast<std::size_t>(axis)]) * voxel_size_m -
          origin_m[axis];
    }
  }

  // The faces across `axis`, on the lower (-1) or upper (1) `side`, of those of the 8x8 voxels at
  // `tile` whose bit is set: bit 8 v + u is the voxel u along axis + 1 and v along axis + 2.
  void add(const RelativeVoxel& tile, int axis, int side, std::uint64_t mask);

  QuadSurface take() { return std::move(surface_); }

 private:
  void rectangle(const RelativeVoxel& tile, int axis, int side, std::array<int, 2> at,
                 std::array<int, 2> size);

  double voxel_size_m_;
  Faces faces_;
  glm::dvec3 base_m_{};
  QuadSurface surface_;
};

// The faces at which a set of voxels ends. `Set` gives
//   bool contains(const RelativeVoxel&)  whether a voxel belongs to the set,
//   bool borders(const RelativeVoxel&)   whether a face towards this voxel outside it is wanted.
template <typename Set>
class FaceFinder {
 public:
  FaceFinder(const Set& set, QuadWriter& writer) : set_(set), writer_(writer) {}

  // A box of voxels that all belong to the set: only its sides can have faces.
  void uniform_box(const RelativeVoxel& low, std::int32_t edge) {
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (const int side : {-1, 1}) {
        RelativeVoxel tile = low;
        if (side > 0) tile[axis] += edge - 1;
        for (tile[u] = low[u]; tile[u] < low[u] + edge; tile[u] += 8) {
          for (tile[v] = low[v]; tile[v] < low[v] + edge; tile[v] += 8) {
            writer_.add(tile, axis, side, bordering(tile, axis, side, ~std::uint64_t{0}));
          }
        }
      }
    }
  }

  // 8x8x8 voxels at `low`, mixed.
  void brick(const RelativeVoxel& low) {
    std::array<std::uint64_t, 8> members{};  // bit 8 y + z of word x
    std::uint64_t any = 0;
    for (int n = 0; n < 512; ++n) {
      if (set_.contains({low[0] + (n >> 6), low[1] + ((n >> 3) & 7), low[2] + (n & 7)})) {
        members[n >> 6] |= std::uint64_t{1} << (n & 63);
      }
    }
    for (const std::uint64_t word : members) any |= word;
    if (any == 0) return;
    for (int axis = 0; axis < 3; ++axis) {
      for (int slab = 0; slab < 8; ++slab) {
        RelativeVoxel tile = low;
        tile[axis] += slab;
        const std::uint64_t mask = slab_of(members, axis, slab);
        if (mask == 0) continue;
        for (const int side : {-1, 1}) {
          const int next = slab + side;
          const bool within = next >= 0 && next < 8;
          const std::uint64_t open = within ? mask & ~slab_of(members, axis, next) : mask;
          writer_.add(tile, axis, side, bordering(tile, axis, side, open));
        }
      }
    }
  }

 private:
  // The members in one slab across `axis`, as QuadWriter::add orders them.
  static std::uint64_t slab_of(const std::array<std::uint64_t, 8>& members, int axis, int slab) {
    std::uint64_t mask = 0;
    for (int bit = 0; bit < 64; ++bit) {
      std::array<int, 3> at{};
      at[axis] = slab;
      at[(axis + 1) % 3] = bit & 7;
      at[(axis + 2) % 3] = bit >> 3;
      if ((members[at[0]] >> (8 * at[1] + at[2])) & 1u) mask |= std::uint64_t{1} << bit;
    }
    return mask;
  }

  // The bits of `mask` whose voxel has a neighbor beyond `side` towards which the set wants a face.
  std::uint64_t bordering(const RelativeVoxel& tile, int axis, int side, std::uint64_t mask) const {
    std::uint64_t kept = 0;
    for (std::uint64_t rest = mask; rest != 0; rest &= rest - 1) {
      const int bit = std::countr_zero(rest);
      RelativeVoxel voxel = tile;
      voxel[axis] += side;
      voxel[(axis + 1) % 3] += bit & 7;
      voxel[(axis + 2) % 3] += bit >> 3;
      if (set_.borders(voxel)) kept |= std::uint64_t{1} << bit;
    }
    return kept;
  }

  const Set& set_;
  QuadWriter& writer_;
};

// Calls box(low, edge_voxels, code) for every uniform box of the tree and brick(low) for every
// brick, in voxels relative to the directory.
template <typename Box, typename Brick>
void walk_tree(const VoxmapView& view, Box box, Brick brick) {
  for_each_region(view, [&](const VoxmapRegion& region) {
    RelativeVoxel low{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = static_cast<std::int32_t>(region.low[axis] - view.directory_origin[axis]);
    }
    if (region.is_brick) {
      brick(low);
    } else {
      box(low, static_cast<std::int32_t>(region.edge_voxels), uniform_value(region.entry));
    }
  });
}

// The value of any voxel relative to the map's directory: free beyond it.
inline VoxelValue relative_value(const Voxmap& voxmap, const RelativeVoxel& v) {
  const VoxmapView& view = voxmap.view();
  if (!view.contains(v[0], v[1], v[2])) return VoxelValue::kFree;
  return static_cast<VoxelValue>(view.lookup(v[0], v[1], v[2]).code);
}

}  // namespace forcelayer::viewer
