// How near the non-free voxels of a cube come to its sides, edges and corners: what a free cell
// next to the cube must know to tell its Chebyshev distance from them exactly.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "formats/mesh/voxel_overlap.h"

namespace forcelayer {

// Directions from a cell to its 26 neighbours: (dx+1)*9 + (dy+1)*3 + (dz+1), dx, dy, dz in -1..1;
// 13 is the cell itself.
inline constexpr unsigned kDirections = 27;
inline constexpr unsigned kSelf = 13;

// For a cube that lies in direction d of a free cell: the least number of voxels m so that a
// non-free voxel of the cube lies at most m voxels behind the side, edge or corner that faces the
// cell, along every axis on which d is not 0. The cell's distance from the cube's non-free voxels
// is then m + 1.
struct NodeNearness {
  std::array<std::uint16_t, kDirections> steps{};
  unsigned towards(unsigned direction) const { return steps[direction]; }
};

// The same for a brick, with four bits a direction (0..7).
class BrickNearness {
 public:
  BrickNearness() = default;
  explicit BrickNearness(const BrickMask& non_free);  // at least one voxel set
  unsigned towards(unsigned direction) const {
    return static_cast<unsigned>(nibbles_[direction >> 4] >> 4 * (direction & 15)) & 15;
  }

 private:
  std::array<std::uint64_t, 2> nibbles_{};
};

// Of a node, from its cells of `edge` voxels: `set_cells` (at least one) hold something, and
// steps_of(n, direction) tells how near it comes.
template <class StepsOf>
NodeNearness combined(const BrickMask& set_cells, unsigned edge, StepsOf&& steps_of);

namespace detail {

// Cells by how far behind a direction's facing side they lie: shells[direction][steps].
using Shells = std::array<std::array<BrickMask, 8>, kDirections>;
extern const Shells kShells;

// Steps of place i (0..7) behind the side that faces a cell from which the cube lies towards d.
constexpr unsigned behind(unsigned i, int d) { return d > 0 ? i : d < 0 ? 7 - i : 0; }

}  // namespace detail

template <class StepsOf>
NodeNearness combined(const BrickMask& set_cells, unsigned edge, StepsOf&& steps_of) {
  NodeNearness nearness;
  for (unsigned direction = 0; direction < kDirections; ++direction) {
    if (direction == kSelf) continue;
    const int d[3] = {static_cast<int>(direction / 9) - 1, static_cast<int>(direction / 3 % 3) - 1,
                      static_cast<int>(direction % 3) - 1};
    unsigned shell = 0;
    BrickMask nearest;
    for (; shell < 8 && !nearest.any(); ++shell) {
      for (std::size_t x = 0; x < 8; ++x) {
        nearest.words[x] = set_cells.words[x] & detail::kShells[direction][shell].words[x];
      }
    }
    --shell;
    unsigned least = edge;
    for_each_cell(nearest, [&](unsigned x, unsigned y, unsigned z) {
      // Only the axes on which the cell is `shell` cells behind matter inside it.
      const unsigned at[3] = {x, y, z};
      unsigned inner = 0;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const bool matters = d[axis] != 0 && detail::behind(at[axis], d[axis]) == shell;
        inner = inner * 3 + static_cast<unsigned>(matters ? d[axis] + 1 : 1);
      }
      least = std::min(least, steps_of(x << 6 | y << 3 | z, inner));
    });
    nearness.steps[direction] = static_cast<std::uint16_t>(shell * edge + least);
  }
  return nearness;
}

}  // namespace forcelayer
