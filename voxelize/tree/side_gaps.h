// The gap between each side, edge and corner of a cube and the cube's nearest non-free voxel. A
// free cell next to the cube finds its exact Chebyshev distance from those voxels by them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "formats/lattice/voxel_overlap.h"

namespace forcelayer::tree {

// Directions from a cell to its 26 neighbors: (dx+1)*9 + (dy+1)*3 + (dz+1), dx, dy, dz in -1..1;
// 13 is the cell itself.
inline constexpr unsigned kDirections = 27;
inline constexpr unsigned kSelf = 13;

// The gaps of a node. Take a free cell from which the node lies in direction d. The gap is the
// least number of voxels m such that a non-free voxel lies at most m voxels behind the side, edge
// or corner that faces the cell, along every axis on which d is not 0. The cell's distance is then
// m + 1.
struct NodeGaps {
  std::array<std::uint16_t, kDirections> steps{};  // [direction]
  unsigned towards(unsigned direction) const { return steps[direction]; }
};

// The gaps of a brick, 0..7, in four bits a direction.
class BrickGaps {
 public:
  BrickGaps() = default;
  explicit BrickGaps(const lattice::BrickMask& non_free);  // at least one voxel set
  unsigned towards(unsigned direction) const {
    return static_cast<unsigned>(nibbles_[direction >> 4] >> 4 * (direction & 15)) & 15;
  }

 private:
  std::array<std::uint64_t, 2> nibbles_{};
};

// A node's gaps from those of its cells of `edge` voxels: `set_cells` (at least one) are not free,
// and gap_of(n, direction) is the gap inside cell n.
template <class GapOf>
NodeGaps combine_gaps(const lattice::BrickMask& set_cells, unsigned edge, GapOf&& gap_of);

namespace detail {

// Cells by how far behind a direction's facing side they lie: shells[direction][steps].
using Shells = std::array<std::array<lattice::BrickMask, 8>, kDirections>;
extern const Shells kShells;

// How many steps place i (0..7) lies behind the facing side, for a cube that lies towards d.
constexpr unsigned behind(unsigned i, int d) { return d > 0 ? i : d < 0 ? 7 - i : 0; }

}  // namespace detail

template <class GapOf>
NodeGaps combine_gaps(const lattice::BrickMask& set_cells, unsigned edge, GapOf&& gap_of) {
  NodeGaps gaps;
  for (unsigned direction = 0; direction < kDirections; ++direction) {
    if (direction == kSelf) continue;
    const int d[3] = {static_cast<int>(direction / 9) - 1, static_cast<int>(direction / 3 % 3) - 1,
                      static_cast<int>(direction % 3) - 1};
    unsigned shell = 0;
    lattice::BrickMask nearest;
    for (; shell < 8 && !nearest.any(); ++shell) {
      for (std::size_t x = 0; x < 8; ++x) {
        nearest.words[x] = set_cells.words[x] & detail::kShells[direction][shell].words[x];
      }
    }
    --shell;
    unsigned smallest = edge;
    lattice::for_each_cell(nearest, [&](unsigned x, unsigned y, unsigned z) {
      // Inside the cell, only the axes on which it lies `shell` cells behind count.
      const unsigned at[3] = {x, y, z};
      unsigned inner = 0;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const bool matters = d[axis] != 0 && detail::behind(at[axis], d[axis]) == shell;
        inner = inner * 3 + static_cast<unsigned>(matters ? d[axis] + 1 : 1);
      }
      smallest = std::min(smallest, gap_of(x << 6 | y << 3 | z, inner));
    });
    gaps.steps[direction] = static_cast<std::uint16_t>(shell * edge + smallest);
  }
  return gaps;
}

}  // namespace forcelayer::tree
