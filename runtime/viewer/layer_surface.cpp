#include "runtime/viewer/layer_surface.h"

#include <bit>
#include <utility>

namespace forcelayer {
namespace {

// How far out a value lies: a face belongs to the voxel of the lower rank.
constexpr std::array<std::uint8_t, 4> kRank = {3, 0, 1, 2};  // free, interior, surface, proximity

using Voxel = std::array<std::int32_t, 3>;  // relative to directory_origin

class Extraction {
 public:
  Extraction(const Voxmap& voxmap, VoxelValue layer, const glm::dvec3& origin_m, Faces faces)
      : voxmap_(voxmap), rank_(kRank[static_cast<unsigned>(layer)]), faces_(faces) {
    surface_.origin_m = origin_m;
    for (int axis = 0; axis < 3; ++axis) {
      base_m_[axis] =
          static_cast<double>(voxmap.view().directory_origin[axis]) * voxmap.voxel_size_m() -
          origin_m[axis];
    }
  }

  QuadSurface run() {
    const auto& dims = voxmap_.view().directory_dims;
    for (std::int32_t x = 0; x < dims[0]; ++x) {
      for (std::int32_t y = 0; y < dims[1]; ++y) {
        for (std::int32_t z = 0; z < dims[2]; ++z) {
          visit({x * 512, y * 512, z * 512}, kUpperNodeEdge);
        }
      }
    }
    return std::move(surface_);
  }

 private:
  std::uint8_t rank_of(std::uint32_t code) const {
    return kRank[static_cast<unsigned>(voxel_value(voxmap_.header(), code))];
  }

  std::uint8_t rank_at(const Voxel& v) const {
    const VoxmapView& view = voxmap_.view();
    if (!view.contains(v[0], v[1], v[2])) return kRank[0];
    return rank_of(view.lookup(v[0], v[1], v[2]).code);
  }

  // One box of the tree: uniform, a brick, or 8x8x8 smaller ones.
  void visit(const Voxel& low, std::int32_t edge) {
    const VoxelLookup found = voxmap_.view().lookup(low[0], low[1], low[2]);
    if (found.edge_voxels >= static_cast<std::uint32_t>(edge)) {
      if (rank_of(found.code) == rank_) uniform_box(low, edge);
    } else if (edge == static_cast<std::int32_t>(kBrickEdge)) {
      brick(low);
    } else {
      const std::int32_t child = edge / 8;
      for (std::int32_t n = 0; n < 512; ++n) {
        visit(
            {low[0] + (n >> 6) * child, low[1] + ((n >> 3) & 7) * child, low[2] + (n & 7) * child},
            child);
      }
    }
  }

  // Only the sides of a uniform box can have faces.
  void uniform_box(const Voxel& low, std::int32_t edge) {
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (const int side : {-1, 1}) {
        Voxel tile = low;
        if (side > 0) tile[axis] += edge - 1;
        for (tile[u] = low[u]; tile[u] < low[u] + edge; tile[u] += 8) {
          for (tile[v] = low[v]; tile[v] < low[v] + edge; tile[v] += 8) {
            emit(tile, axis, side, outer_neighbours(tile, axis, side));
          }
        }
      }
    }
  }

  // Bit (8 v + u) is set where the neighbour of the tile's voxel beyond `side` lies further out.
  std::uint64_t outer_neighbours(const Voxel& tile, int axis, int side) const {
    std::uint64_t mask = 0;
    for (int bit = 0; bit < 64; ++bit) {
      Voxel voxel = tile;
      voxel[axis] += side;
      voxel[(axis + 1) % 3] += bit & 7;
      voxel[(axis + 2) % 3] += bit >> 3;
      if (rank_at(voxel) > rank_) mask |= std::uint64_t{1} << bit;
    }
    return mask;
  }

  void brick(const Voxel& low) {
    std::array<std::uint8_t, 512> own{};
    bool any = false;
    for (int n = 0; n < 512; ++n) {
      own[n] = rank_at({low[0] + (n >> 6), low[1] + ((n >> 3) & 7), low[2] + (n & 7)});
      any = any || own[n] == rank_;
    }
    if (!any) return;
    constexpr std::array<int, 3> kStride = {64, 8, 1};
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (int slab = 0; slab < 8; ++slab) {
        Voxel tile = low;
        tile[axis] += slab;
        std::uint64_t layer = 0;
        for (int bit = 0; bit < 64; ++bit) {
          const int n = slab * kStride[axis] + (bit & 7) * kStride[u] + (bit >> 3) * kStride[v];
          if (own[n] == rank_) layer |= std::uint64_t{1} << bit;
        }
        if (layer == 0) continue;
        for (const int side : {-1, 1}) {
          emit(tile, axis, side, layer & slab_beyond(own, tile, axis, slab + side));
        }
      }
    }
  }

  // The same mask as outer_neighbours for the slab at `slab` of a brick, read from `own` inside it.
  std::uint64_t slab_beyond(const std::array<std::uint8_t, 512>& own, const Voxel& tile, int axis,
                            int slab) const {
    const int side = slab - (tile[axis] & 7);
    if (slab < 0 || slab > 7) return outer_neighbours(tile, axis, side);
    constexpr std::array<int, 3> kStride = {64, 8, 1};
    std::uint64_t mask = 0;
    for (int bit = 0; bit < 64; ++bit) {
      const int n = slab * kStride[axis] + (bit & 7) * kStride[(axis + 1) % 3] +
                    (bit >> 3) * kStride[(axis + 2) % 3];
      if (own[n] > rank_) mask |= std::uint64_t{1} << bit;
    }
    return mask;
  }

  // Covers the faces of `mask` with rectangles: a run along u, then as many equal rows as follow.
  void emit(const Voxel& tile, int axis, int side, std::uint64_t mask) {
    surface_.voxel_faces += std::popcount(mask);
    while (mask != 0) {
      const int first = std::countr_zero(mask);
      const int u = first & 7, v = first >> 3;
      int width = 1, height = 1;
      if (faces_ == Faces::kMerged) {
        while (u + width < 8 && (mask >> (first + width)) & 1u) ++width;
        const std::uint64_t row = (std::uint64_t{1} << width) - 1;
        while (v + height < 8 && ((mask >> (first + 8 * height)) & row) == row) ++height;
      }
      for (int line = 0; line < height; ++line) {
        mask &= ~(((std::uint64_t{1} << width) - 1) << (first + 8 * line));
      }
      rectangle(tile, axis, side, {u, v}, {width, height});
    }
  }

  void rectangle(const Voxel& tile, int axis, int side, std::array<int, 2> at,
                 std::array<int, 2> size) {
    const std::array<std::array<int, 2>, 4> order = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    for (int n = 0; n < 4; ++n) {
      const auto& corner = order[side > 0 ? n : 3 - n];
      Voxel voxel = tile;
      voxel[axis] += side > 0 ? 1 : 0;
      voxel[(axis + 1) % 3] += at[0] + corner[0] * size[0];
      voxel[(axis + 2) % 3] += at[1] + corner[1] * size[1];
      std::array<float, 3> point{};
      for (int k = 0; k < 3; ++k) {
        point[k] = static_cast<float>(base_m_[k] + voxel[k] * voxmap_.voxel_size_m());
      }
      surface_.corners.push_back(point);
    }
  }

  const Voxmap& voxmap_;
  const std::uint8_t rank_;
  const Faces faces_;
  glm::dvec3 base_m_{};
  QuadSurface surface_;
};

}  // namespace

QuadSurface layer_surface(const Voxmap& voxmap, VoxelValue layer, const glm::dvec3& origin_m,
                          Faces faces) {
  return Extraction(voxmap, layer, origin_m, faces).run();
}

}  // namespace forcelayer
