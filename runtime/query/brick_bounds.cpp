#include "runtime/query/brick_bounds.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "formats/voxmap_format.h"

namespace forcelayer::query {
namespace {

constexpr std::uint32_t kBrickWords = kNodeEntries * kValueBits / 32;
constexpr int kEdge = kBrickEdge;
constexpr float kMostExtent = 64;         // voxels: a larger disc is not looked at
constexpr float kAcrossRounding = 2e-6f;  // of the square of a component of a float unit vector
constexpr float kOffsetRounding = 1e-5f;  // voxels: of normal . x inside a brick, in floats

float greater(float a, float b) { return a > b ? a : b; }  // one instruction, as std::max is not

// Bit 2z of column 8x + y: voxel (x, y, z) is not free.
using Columns = std::array<std::uint32_t, kEdge * kEdge>;

Columns columns_of(const std::uint32_t* brick) {
  Columns columns{};
  for (std::uint32_t word = 0; word < kBrickWords; ++word) {
    const std::uint32_t set = (brick[word] | brick[word] >> 1) & 0x5555'5555u;
    columns[2 * word] = set & 0xffffu;
    columns[2 * word + 1] = set >> 16;
  }
  return columns;
}

// The vector area of the boundary: per axis, voxels of the first face less those of the last.
std::array<int, 3> vector_area(const Columns& columns) {
  std::array<int, 3> area{};
  for (int i = 0; i < kEdge; ++i) {
    const auto count = [&](int x, int y) { return std::popcount(columns[x * kEdge + y]); };
    area[0] += count(0, i) - count(kEdge - 1, i);
    area[1] += count(i, 0) - count(i, kEdge - 1);
  }
  for (const std::uint32_t column : columns) {
    area[2] += static_cast<int>(column & 1) - static_cast<int>(column >> 2 * (kEdge - 1) & 1);
  }
  return area;
}

// Half of the disc's extent along a direction on which its axis has the component `along`, and by
// how much `most` lengthens it.
struct Extent {
  float half, growth;
};

inline Extent extent_of(const PlacedDisc& disc, const Leeway& most, float along) {
  const float across = std::sqrt(greater(0, 1 + kAcrossRounding - along * along));
  along = std::abs(along);
  return {disc.radius * across + disc.half_height * along + disc.margin,
          most.across * across + most.along * along};
}

// The share of `most` that the disc lies on the free side of a brick's bound; `corner` is the
// brick's, as the disc's center is told.
float beyond(const BrickBound& bound, const PlacedDisc& disc, const Leeway& most,
             const std::array<float, 3>& corner) {
  float along = 0, center = -bound.offset, length2 = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float n = bound.normal[axis];
    along += n * disc.axis[axis];
    center += n * (disc.center[axis] - corner[axis]);
    length2 += n * n;
  }
  if (!(length2 > 0)) return -1;
  const Extent extent = extent_of(disc, most, along);
  return (center - extent.half) / extent.growth;
}

bool is_free(std::uint32_t entry) { return is_uniform(entry) && uniform_value(entry) == 0; }

// The entries of the column of cells (8^3 voxels) from (x, y, z) to the end of its node, or the one
// entry that stands for all of them.
struct CellColumn {
  const std::uint32_t* entries;
  bool one_for_all;
};

CellColumn cell_column(const KernelMap& map, int x, int y, int z) {
  const auto slot = [&](int shift) {
    return static_cast<std::uint32_t>((x >> shift & 7) << 6 | (y >> shift & 7) << 3 |
                                      (z >> shift & 7));
  };
  const std::uint32_t* entry =
      map.directory + (std::int64_t{x >> 6} * map.dims[1] + (y >> 6)) * map.dims[2] + (z >> 6);
  if (is_uniform(*entry)) return {entry, true};
  entry = map.upper_nodes + std::uint64_t{*entry} * kNodeEntries + slot(3);
  if (is_uniform(*entry)) return {entry, true};
  return {map.lower_nodes + std::uint64_t{*entry} * kNodeEntries + slot(0), false};
}

}  // namespace

BrickBound brick_bound(const std::uint32_t* brick) {
  const Columns columns = columns_of(brick);
  const std::array<int, 3> area = vector_area(columns);
  const int length2 = area[0] * area[0] + area[1] * area[1] + area[2] * area[2];
  BrickBound bound;
  if (length2 == 0) return bound;
  std::array<float, 3>& n = bound.normal;
  for (int axis = 0; axis < 3; ++axis) {
    n[axis] = static_cast<float>(area[axis]) / std::sqrt(static_cast<float>(length2));
  }
  bound.offset = -3 * kEdge;
  for (int x = 0; x < kEdge; ++x) {
    for (int y = 0; y < kEdge; ++y) {
      const std::uint32_t column = columns[x * kEdge + y];
      if (column == 0) continue;
      // The corner of the column's voxels that lies farthest along the normal.
      const int z =
          n[2] > 0 ? (31 - std::countl_zero(column)) / 2 + 1 : std::countr_zero(column) / 2;
      const int right = n[0] > 0 ? x + 1 : x, back = n[1] > 0 ? y + 1 : y;
      bound.offset =
          std::max(bound.offset, n[0] * float(right) + n[1] * float(back) + n[2] * float(z));
    }
  }
  bound.offset += kOffsetRounding;
  return bound;
}

[[gnu::cold]] BrickBounds::BrickBounds(const Voxmap& voxmap) {
  bounds_.reserve(voxmap.brick_count());
  for (std::uint64_t i = 0; i < voxmap.brick_count(); ++i) {
    bounds_.push_back(brick_bound(voxmap.view().bricks + i * kBrickWords));
  }
}

float BrickBounds::share(const KernelMap& map, const PlacedDisc& disc,
                         const Leeway& most) const noexcept {
  std::array<float, 3> low{}, high{}, per_voxel{};
  std::array<int, 3> first{}, last{};  // cells
  float share = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const Extent extent = extent_of(disc, most, disc.axis[axis]);
    if (!(extent.half < kMostExtent)) return -1;
    low[axis] = disc.center[axis] - extent.half;
    high[axis] = disc.center[axis] + extent.half;
    per_voxel[axis] = 1 / extent.growth;
    const int whole = disc.whole[axis];
    const int end = map.dims[axis] << 6;
    const auto cell = [whole](float at) { return (whole + static_cast<int>(std::floor(at))) >> 3; };
    first[axis] = std::max(cell(low[axis] - extent.growth), 0);
    last[axis] = std::min(cell(high[axis] + extent.growth), end - 1);
    if (map.cropped) {
      const float inside =
          std::min(low[axis] - static_cast<float>(double(map.known_min[axis]) - whole),
                   static_cast<float>(double(map.known_max[axis]) - whole) - high[axis]);
      share = std::min(share, inside * per_voxel[axis]);
    }
  }
  // The share by which the disc lies off what the cell at (x, y, z) holds, `share` if it is more.
  const auto off = [&](std::uint32_t entry, int x, int y, int z) {
    const std::array<float, 3> corner = {float(x * kEdge - disc.whole[0]),
                                         float(y * kEdge - disc.whole[1]),
                                         float(z * kEdge - disc.whole[2])};
    float off_cell = -1;
    for (int axis = 0; axis < 3; ++axis) {
      const float gap = greater(low[axis] - (corner[axis] + kEdge), corner[axis] - high[axis]);
      off_cell = greater(off_cell, gap * per_voxel[axis]);
    }
    if (off_cell >= share || is_uniform(entry)) return std::min(off_cell, share);
    return std::min(greater(off_cell, beyond(bounds_[entry], disc, most, corner)), share);
  };
  for (int x = first[0]; x <= last[0]; ++x) {
    for (int y = first[1]; y <= last[1]; ++y) {
      for (int z = first[2]; z <= last[2];) {
        const int end = std::min(last[2], z | 7) + 1;  // of the node
        CellColumn column = cell_column(map, x, y, z);
        if (column.one_for_all && is_free(*column.entries)) z = end;
        for (; z < end; ++z) {
          if (!is_free(*column.entries)) share = off(*column.entries, x, y, z);
          if (share <= 0) return share;
          if (!column.one_for_all) ++column.entries;
        }
      }
    }
  }
  return share;
}

}  // namespace forcelayer::query
