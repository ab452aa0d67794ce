// The bricks of one 64^3-voxel node while its triangles are drawn.
#pragma once

#include <array>
#include <cstdint>

#include "formats/lattice/voxel_overlap.h"

namespace forcelayer::scan {

struct NodeCanvas {
  lattice::BrickMask touched;                  // bricks that have been drawn to
  std::array<lattice::BrickMask, 512> bricks;  // undefined where not touched

  void clear() { touched = {}; }

  // Brick (x, y, z) of the node, each 0..7.
  lattice::BrickMask& brick(unsigned x, unsigned y, unsigned z) {
    const unsigned n = x << 6 | y << 3 | z;
    const std::uint64_t bit = std::uint64_t{1} << (n & 63);
    if ((touched.words[x] & bit) == 0) {
      touched.words[x] |= bit;
      bricks[n] = {};
    }
    return bricks[n];
  }
};

}  // namespace forcelayer::scan
