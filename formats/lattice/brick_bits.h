// Bit-parallel steps on 8x8x8 masks (word x, bit y*8 + z): voxels of a brick, bricks of a node,
// nodes of a directory cell. Cells are also numbered n = x*64 + y*8 + z.
#pragma once

#include <bit>
#include <cstdint>

#include "formats/lattice/voxel_overlap.h"

namespace forcelayer::lattice {

inline constexpr std::uint64_t kFirstColumn = 0x0101010101010101u;  // bit z = 0 of all eight rows
inline constexpr std::uint64_t kAllBits = ~std::uint64_t{0};

// The six sides of a cube: axis side / 2, the far end where side is odd.
inline constexpr int kSides = 6;
constexpr int opposite(int side) { return side ^ 1; }

// Masks go by reference: gcc warns that it passes 64-byte aligned arguments by value otherwise
// than 4.5.
inline BrickMask operator|(const BrickMask& a, const BrickMask& b) {
  BrickMask mask;
  for (std::size_t x = 0; x < 8; ++x) mask.words[x] = a.words[x] | b.words[x];
  return mask;
}
inline BrickMask operator&(const BrickMask& a, const BrickMask& b) {
  BrickMask mask;
  for (std::size_t x = 0; x < 8; ++x) mask.words[x] = a.words[x] & b.words[x];
  return mask;
}
inline BrickMask operator~(const BrickMask& a) {
  BrickMask mask;
  for (std::size_t x = 0; x < 8; ++x) mask.words[x] = ~a.words[x];
  return mask;
}

inline BrickMask full_mask() {
  BrickMask mask;
  mask.words.fill(kAllBits);
  return mask;
}

inline int count(const BrickMask& mask) {
  int sum = 0;
  for (const std::uint64_t word : mask.words) sum += std::popcount(word);
  return sum;
}

inline bool test(const BrickMask& mask, unsigned n) {
  return (mask.words[n >> 6] >> (n & 63) & 1) != 0;
}
inline void set(BrickMask& mask, unsigned n) { mask.words[n >> 6] |= std::uint64_t{1} << (n & 63); }

// Calls f(n) for every set cell.
template <class F>
void for_each_set(const BrickMask& mask, F&& f) {
  for_each_cell(mask, [&](unsigned x, unsigned y, unsigned z) { f(x << 6 | y << 3 | z); });
}

// The cell next to cell n across `side`, wrapped around to the far end where n lies on that side.
constexpr unsigned stepped(unsigned n, int side) {
  const int shift = 6 - 3 * (side / 2);
  const unsigned digit = (n >> shift) + (side % 2 == 1 ? 1u : 7u);
  return (n & ~(7u << shift)) | (digit & 7u) << shift;
}
constexpr bool lies_on(unsigned n, int side) {
  return (n >> (6 - 3 * (side / 2)) & 7u) == (side % 2 == 1 ? 7u : 0u);
}

// The cells of `mask` on `side`, where they are.
inline BrickMask side_cells(const BrickMask& mask, int side) {
  BrickMask cells;
  if (side < 2) {
    const std::size_t x = side == 0 ? 0 : 7;
    cells.words[x] = mask.words[x];
    return cells;
  }
  constexpr std::uint64_t kCells[] = {0xff, kAllBits << 56, kFirstColumn, kFirstColumn << 7};
  const std::uint64_t on_side = kCells[side - 2];
  for (std::size_t x = 0; x < 8; ++x) cells.words[x] = mask.words[x] & on_side;
  return cells;
}

// Whether `mask` has a cell on `side`.
inline bool any_on_side(const BrickMask& mask, int side) {
  if (side < 2) return mask.words[side == 0 ? 0 : 7] != 0;
  std::uint64_t all = 0;
  for (const std::uint64_t word : mask.words) all |= word;
  constexpr std::uint64_t kCells[] = {0xff, kAllBits << 56, kFirstColumn, kFirstColumn << 7};
  return (all & kCells[side - 2]) != 0;
}

// Adds the cells on `side` that touch the set cells of a `neighbor` across that side.
inline void add_across(const BrickMask& neighbor, int side, BrickMask& cells) {
  switch (side) {
    case 0:
      cells.words[0] |= neighbor.words[7];
      return;
    case 1:
      cells.words[7] |= neighbor.words[0];
      return;
    case 2:
      for (std::size_t x = 0; x < 8; ++x) cells.words[x] |= neighbor.words[x] >> 56;
      return;
    case 3:
      for (std::size_t x = 0; x < 8; ++x) cells.words[x] |= neighbor.words[x] << 56;
      return;
    case 4:
      for (std::size_t x = 0; x < 8; ++x) {
        cells.words[x] |= neighbor.words[x] >> 7 & kFirstColumn;
      }
      return;
    default:
      for (std::size_t x = 0; x < 8; ++x) {
        cells.words[x] |= (neighbor.words[x] & kFirstColumn) << 7;
      }
  }
}
inline BrickMask across(const BrickMask& neighbor, int side) {
  BrickMask cells;
  add_across(neighbor, side, cells);
  return cells;
}

// The cells next to set cells across `side`; those that leave the mask are lost.
inline BrickMask shifted(const BrickMask& mask, int side) {
  BrickMask result;
  switch (side) {
    case 0:
      for (std::size_t x = 0; x < 7; ++x) result.words[x] = mask.words[x + 1];
      return result;
    case 1:
      for (std::size_t x = 1; x < 8; ++x) result.words[x] = mask.words[x - 1];
      return result;
    case 2:
      for (std::size_t x = 0; x < 8; ++x) result.words[x] = mask.words[x] >> 8;
      return result;
    case 3:
      for (std::size_t x = 0; x < 8; ++x) result.words[x] = mask.words[x] << 8;
      return result;
    case 4:
      for (std::size_t x = 0; x < 8; ++x) {
        result.words[x] = (mask.words[x] & ~kFirstColumn) >> 1;
      }
      return result;
    default:
      for (std::size_t x = 0; x < 8; ++x) {
        result.words[x] = (mask.words[x] & ~(kFirstColumn << 7)) << 1;
      }
      return result;
  }
}

// The cells of `open` that a 6-connected walk inside `open` reaches from `seeds`.
BrickMask flooded(const BrickMask& seeds, const BrickMask& open);

}  // namespace forcelayer::lattice
