// Bit-parallel steps on 8x8x8 masks (word x, bit y*8 + z): voxels of a brick, bricks of a node,
// nodes of a block. Cells are also numbered n = x*64 + y*8 + z.
#pragma once

#include <bit>
#include <cstdint>

#include "formats/mesh/voxel_overlap.h"

namespace forcelayer {

inline constexpr std::uint64_t kFirstColumn = 0x0101010101010101u;  // bit z = 0 of all eight rows
inline constexpr std::uint64_t kAllBits = ~std::uint64_t{0};

// The six sides of a cube: axis side / 2, the far end where side is odd.
inline constexpr int kSides = 6;
constexpr int opposite(int side) { return side ^ 1; }

inline BrickMask operator|(BrickMask a, const BrickMask& b) {
  for (std::size_t x = 0; x < 8; ++x) a.words[x] |= b.words[x];
  return a;
}
inline BrickMask operator&(BrickMask a, const BrickMask& b) {
  for (std::size_t x = 0; x < 8; ++x) a.words[x] &= b.words[x];
  return a;
}
inline BrickMask operator~(BrickMask a) {
  for (std::uint64_t& word : a.words) word = ~word;
  return a;
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
BrickMask side_cells(const BrickMask& mask, int side);

// The cells on `side` of a mask that touch the set cells of its `neighbor` across that side.
BrickMask across(const BrickMask& neighbor, int side);

// The cells next to set cells across `side`; those that leave the mask are lost.
BrickMask shifted(const BrickMask& mask, int side);

// The cells of `open` that a 6-connected walk inside `open` reaches from `seeds`.
BrickMask flooded(const BrickMask& seeds, const BrickMask& open);

}  // namespace forcelayer
