// The voxels of one 64^3 node as rows along z, for steps that read many of them at once.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <memory>

#include "voxelize/masks/mask_tree.h"

namespace forcelayer::masks {

using NodeRows = std::array<std::uint64_t, 4096>;  // [x*64 + y], bit z

// The voxels of the tree in the node at `origin`, whether it has a node there or a tile.
void node_rows(const MaskTree& tree, const Coord& origin, NodeRows& rows);

// Writes eight rows of a brick's plane, rows first_y to end_y - 1, as byte `byte` of rows along z.
inline void write_rows(std::uint64_t word, std::uint64_t* rows, unsigned byte, int first_y = 0,
                       int end_y = 8) {
  static_assert(std::endian::native == std::endian::little, "rows are filled byte by byte");
  auto* bytes = reinterpret_cast<unsigned char*>(rows) + byte;
  for (int y = first_y; y < end_y; ++y) {
    bytes[y * 8] = static_cast<unsigned char>(word >> (8 * y));
  }
}

// A node with these voxels.
std::unique_ptr<LowerMaskNode> node_of_rows(const NodeRows& rows, const Coord& origin);

// The 4^3 voxels from `low` on as bits x*16 + y*4 + z.
inline std::uint64_t cell_bits(const NodeRows& rows, const std::array<int, 3>& low) {
  std::uint64_t bits = 0;
  for (int n = 0; n < 16; ++n) {
    const auto row = static_cast<std::size_t>((low[0] + n / 4) * 64 + low[1] + n % 4);
    bits |= (rows[row] >> low[2] & 15) << (4 * n);
  }
  return bits;
}

inline void add_cell_bits(std::uint64_t bits, const std::array<int, 3>& low, NodeRows& rows) {
  for (int n = 0; n < 16; ++n) {
    const auto row = static_cast<std::size_t>((low[0] + n / 4) * 64 + low[1] + n % 4);
    rows[row] |= (bits >> (4 * n) & 15) << low[2];
  }
}

// Whether all voxels of the cube of `edge` (at most 32) from `low` on are set.
inline bool all_set(const NodeRows& rows, const std::array<int, 3>& low, int edge) {
  const std::uint64_t mask = ((std::uint64_t{1} << edge) - 1) << low[2];
  for (int x = low[0]; x < low[0] + edge; ++x) {
    for (int y = low[1]; y < low[1] + edge; ++y) {
      if ((rows[static_cast<std::size_t>(x * 64 + y)] & mask) != mask) return false;
    }
  }
  return true;
}

}  // namespace forcelayer::masks
