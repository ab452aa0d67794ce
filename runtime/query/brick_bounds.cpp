#include "runtime/query/brick_bounds.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "formats/voxmap_format.h"

namespace forcelayer::query {
namespace {

constexpr std::uint32_t kBrickWords = kNodeEntries * kValueBits / 32;
constexpr int kEdge = kBrickEdge;
constexpr float kMaxExtent = 64;          // voxels: a larger disc is not looked at
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
// how much `largest` lengthens it.
struct Extent {
  float half, growth;
};

inline Extent extent_of(const PlacedDisc& disc, const Leeway& largest, float along) {
  const float across = std::sqrt(greater(0, 1 + kAcrossRounding - along * along));
  along = std::abs(along);
  return {disc.radius * across + disc.half_height * along + disc.margin,
          largest.across * across + largest.along * along};
}

// The fraction of `largest` that the disc lies on the free side of a brick's bound; `corner` is the
// brick's, as the disc's center is given.
float beyond(const BrickBound& bound, const PlacedDisc& disc, const Leeway& largest,
             const std::array<float, 3>& corner) {
  float along = 0, center = -bound.offset, length2 = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float n = bound.normal[axis];
    along += n * disc.axis[axis];
    center += n * (disc.center[axis] - corner[axis]);
    length2 += n * n;
  }
  if (!(length2 > 0)) return -1;
  const Extent extent = extent_of(disc, largest, along);
  return (center - extent.half) / extent.growth;
}

bool is_free(std::uint32_t entry) { return is_uniform(entry) && uniform_value(entry) == 0; }

int slot(int x, int y, int z) { return (x & 7) << 6 | (y & 7) << 3 | (z & 7); }

// The entries of the 8^3 cells (8^3 voxels each) of a node, or the one that stands for all of them.
struct CellNode {
  const std::uint32_t* entries = nullptr;
  bool one_for_all = false;
  std::array<int, 3> at = {-1, -1, -1};
};

CellNode node_at(const KernelMap& map, int x, int y, int z) {
  const std::array<int, 3> at = {x, y, z};
  const std::uint32_t* entry =
      map.directory + (std::int64_t{x >> 3} * map.dims[1] + (y >> 3)) * map.dims[2] + (z >> 3);
  if (is_uniform(*entry)) return {entry, true, at};
  entry = map.upper_nodes + std::uint64_t{*entry} * kNodeEntries + slot(x, y, z);
  if (is_uniform(*entry)) return {entry, true, at};
  return {map.lower_nodes + std::uint64_t{*entry} * kNodeEntries, false, at};
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

BrickBounds::BrickBounds(const Voxmap& voxmap) {
  bounds_.reserve(voxmap.brick_count());
  for (std::uint64_t i = 0; i < voxmap.brick_count(); ++i) {
    bounds_.push_back(brick_bound(voxmap.view().bricks + i * kBrickWords));
  }
}

float BrickBounds::fraction(const KernelMap& map, const PlacedDisc& disc,
                            const Leeway& largest) const noexcept {
  std::array<float, 3> low{}, high{}, per_voxel{};
  std::array<int, 3> first{}, last{};  // cells
  float fraction = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const Extent extent = extent_of(disc, largest, disc.axis[axis]);
    if (!(extent.half < kMaxExtent)) return -1;
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
      fraction = std::min(fraction, inside * per_voxel[axis]);
    }
  }
  const auto corner = [&](int axis, int cell) { return float(cell * kEdge - disc.whole[axis]); };
  // The fraction by which the disc lies off the cells whose corner is at `at`.
  const auto gap = [&](int axis, float at) {
    return greater(low[axis] - (at + kEdge), at - high[axis]) * per_voxel[axis];
  };
  CellNode node;
  for (int x = first[0]; x <= last[0]; ++x) {
    const float at_x = corner(0, x), off_x = gap(0, at_x);
    for (int y = first[1]; y <= last[1] && off_x < fraction; ++y) {
      const float at_y = corner(1, y), off_xy = greater(off_x, gap(1, at_y));
      for (int z = first[2]; z <= last[2] && off_xy < fraction;) {
        const int end = std::min(last[2], z | 7) + 1;  // of the node
        if (node.at != std::array<int, 3>{x >> 3, y >> 3, z >> 3}) {
          node = node_at(map, x >> 3, y >> 3, z >> 3);
        }
        if (node.one_for_all && is_free(*node.entries)) z = end;
        for (; z < end; ++z) {
          const std::uint32_t entry = node.entries[node.one_for_all ? 0 : slot(x, y, z)];
          if (is_free(entry)) continue;
          const float at_z = corner(2, z);
          float off = greater(off_xy, gap(2, at_z));
          if (off < fraction && !is_uniform(entry)) {
            off = greater(off, beyond(bounds_[entry], disc, largest, {at_x, at_y, at_z}));
          }
          if (off < fraction) fraction = off;
          if (fraction <= 0) return fraction;
        }
      }
    }
  }
  return fraction;
}

}  // namespace forcelayer::query
