#include "voxelize/distance/nearest_objects.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "voxelize/distance/triangle_search.h"

namespace forcelayer::distance {
namespace {

// The number of a voxel in its brick, x*64 + y*8 + z.
constexpr unsigned voxel_of(unsigned x, unsigned y, unsigned z) { return x * 64 + y * 8 + z; }

// The eighth of its cube that point n lies in.
constexpr std::size_t eighth_of(std::size_t n) {
  return (n >> 5) * 4 + (n >> 3 & 1) * 2 + (n >> 1 & 1);
}

}  // namespace

void ObjectChoice::begin(std::span<const std::uint16_t> numbers,
                         const std::vector<PreparedTriangle>& near) {
  numbers_ = numbers;
  of_cell_.fill(0);
  // The triangles stand in the order of their objects.
  one_object_ = near.empty() || near.front().object == near.back().object;
}

void ObjectChoice::add(const std::array<int, 3>& low, TriangleList list,
                       const std::array<float, kEighths>& reach, const NearestTriangles& nearest) {
  const auto brick = static_cast<unsigned>((low[0] >> 3) << 6 | (low[1] >> 3) << 3 | low[2] >> 3);
  const auto cell = static_cast<unsigned>((low[0] & 4) + (low[1] >> 1 & 2) + (low[2] >> 2 & 1));
  std::uint32_t& of_cell = of_cell_[brick * kCells + cell];
  const std::uint32_t object = list[0]->object;
  if (one_object_ || std::all_of(list.begin(), list.end(), [&](const PreparedTriangle* triangle) {
        return triangle->object == object;
      })) {
    of_cell = numbers_[object];
    return;
  }
  // The object of each eighth, and the eighths that several objects are near to.
  std::array<std::uint32_t, kEighths> objects;
  unsigned any = 0, several = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    for (unsigned bits = nearest.measured_in(i) & ~several; bits != 0; bits &= bits - 1) {
      const unsigned bit = bits & -bits;
      std::uint32_t& first = objects[static_cast<std::size_t>(std::countr_zero(bits))];
      if ((any & bit) == 0) first = list[i]->object;
      if (first != list[i]->object) several |= bit;
      any |= bit;
    }
  }
  const auto first = static_cast<std::size_t>(std::countr_zero(any));
  bool one = several == 0;
  for (unsigned n = 0; n < objects.size(); ++n) {
    one = one && ((any >> n & 1) == 0 || objects[n] == objects[first]);
  }
  if (one) {
    of_cell = numbers_[objects[first]];
    return;
  }
  of_cell = kSeveral;
  std::array<std::uint16_t, kCubePoints> chosen{};
  for (std::size_t n = 0; n < kCubePoints; ++n) {
    const std::size_t at = eighth_of(n);
    if (((any & ~several) >> at & 1) != 0) chosen[n] = numbers_[objects[at]];
  }
  if (several != 0) choose(low, list, several, reach, nearest, chosen);
  if (node_.numbers.empty()) node_.numbers.resize(512 * kBrickVoxels);
  std::uint16_t* out = node_.numbers.data() + brick * kBrickVoxels;
  const auto x0 = static_cast<unsigned>(low[0] & 7), y0 = static_cast<unsigned>(low[1] & 7),
             z0 = static_cast<unsigned>(low[2] & 7);
  for (unsigned n = 0; n < kCubePoints; ++n) {
    out[voxel_of(x0 + (n >> 4), y0 + (n >> 2 & 3), z0 + (n & 3))] = chosen[n];
  }
}

// Measures in the eighths of `several` from one object after the other. A voxel has the first that
// is as near as the nearest.
void ObjectChoice::choose(const std::array<int, 3>& low, TriangleList list, unsigned several,
                          const std::array<float, kEighths>& reach, const NearestTriangles& nearest,
                          std::array<std::uint16_t, kCubePoints>& chosen) {
  constexpr float kMore = kEquallyNearVoxels * static_cast<float>(lattice::kSnapUnits);
  CubeValues limit;
  std::array<float, kEighths> near_enough{};  // a triangle farther than this changes nothing
  for (std::size_t n = 0; n < kCubePoints; ++n) {
    const std::size_t at = eighth_of(n);
    const float largest = std::sqrt(nearest.smallest()[n]) + kMore;
    limit[n] = (several >> at & 1) != 0 ? largest * largest : -1.0f;
    near_enough[at] = std::max(near_enough[at], largest);
  }
  for (std::size_t n = 0; n < reach.size(); ++n) {
    near_enough[n] = (several >> n & 1) != 0 ? std::min(near_enough[n], reach[n]) : kNoReach;
  }
  sorted_.clear();
  for (std::size_t i = 0; i < list.size(); ++i) {
    if ((nearest.measured_in(i) & several) != 0) sorted_.push_back(list[i]);
  }
  std::sort(
      sorted_.begin(), sorted_.end(),
      [](const PreparedTriangle* a, const PreparedTriangle* b) { return a->object < b->object; });
  for (auto first = sorted_.begin(); first != sorted_.end();) {
    const std::uint32_t object = (*first)->object;
    const auto end = std::find_if(first, sorted_.end(), [&](const PreparedTriangle* triangle) {
      return triangle->object != object;
    });
    of_one_.find(TriangleList(first, end), low, near_enough);
    const CubeValues& smallest = of_one_.smallest();
    for (std::size_t n = 0; n < kCubePoints; ++n) {
      if (chosen[n] == 0 && smallest[n] <= limit[n]) chosen[n] = numbers_[object];
    }
    first = end;
  }
}

// Gives every voxel of a brick its number.
void ObjectChoice::spread(unsigned n, const std::uint8_t* codes, const masks::KeptBox& kept,
                          const masks::Coord& brick) {
  if (node_.numbers.empty()) node_.numbers.resize(512 * kBrickVoxels);
  std::uint16_t* numbers = node_.numbers.data() + n * kBrickVoxels;
  std::uint32_t lowest = kSeveral;
  for (unsigned v = 0; v < kBrickVoxels; ++v) {
    if (!is_measured(codes[v])) continue;
    const std::uint32_t of_cell = of_cell_[n * kCells + (v >> 8) * 4 + (v >> 4 & 2) + (v >> 2 & 1)];
    if (of_cell != kSeveral) numbers[v] = static_cast<std::uint16_t>(of_cell);
    lowest = std::min<std::uint32_t>(lowest, numbers[v]);
  }
  if (lowest == kSeveral) lowest = 0;
  bool one = true;
  for (unsigned v = 0; v < kBrickVoxels; ++v) {
    if (!is_measured(codes[v])) {
      const bool outside = kept.cropped() && !kept.box.isInside(masks::entry_origin(brick, v, 1));
      numbers[v] = outside ? std::uint16_t{0} : static_cast<std::uint16_t>(lowest);
    }
    one = one && numbers[v] == numbers[0];
  }
  if (one) {
    node_.of_brick[n] = numbers[0];
  } else {
    set(node_.several, n);
  }
}

const NodeObjects& ObjectChoice::finish(const lattice::BrickMask& coded, const std::uint8_t* codes,
                                        const masks::KeptBox& kept, const masks::Coord& origin) {
  node_.of_brick.fill(0);
  node_.several = {};
  lattice::for_each_set(coded, [&](unsigned n) {
    const std::uint32_t* cells = of_cell_.data() + n * kCells;
    const std::uint32_t number = *std::max_element(cells, cells + kCells);
    const bool one = std::all_of(cells, cells + kCells, [&](std::uint32_t of_cell) {
      return of_cell == number || of_cell == 0;
    });
    const masks::Coord brick = masks::entry_origin(origin, n, 8);
    const bool whole =
        !kept.cropped() || kept.box.isInside(openvdb::CoordBBox::createCube(brick, 8));
    if (one && number != kSeveral && whole) {
      node_.of_brick[n] = static_cast<std::uint16_t>(number);
    } else {
      spread(n, codes + n * kBrickVoxels, kept, brick);
    }
  });
  return node_;
}

}  // namespace forcelayer::distance
