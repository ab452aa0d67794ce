#include "voxelize/brick_bits.h"

namespace forcelayer {
namespace {

// Applies `f` to every word.
template <class F>
BrickMask each_word(const BrickMask& mask, F&& f) {
  BrickMask result;
  for (std::size_t x = 0; x < 8; ++x) result.words[x] = f(mask.words[x]);
  return result;
}

BrickMask one_word(std::size_t x, std::uint64_t word) {
  BrickMask mask;
  mask.words[x] = word;
  return mask;
}

}  // namespace

BrickMask side_cells(const BrickMask& mask, int side) {
  switch (side) {
    case 0:
      return one_word(0, mask.words[0]);
    case 1:
      return one_word(7, mask.words[7]);
    case 2:
      return each_word(mask, [](std::uint64_t word) { return word & 0xff; });
    case 3:
      return each_word(mask, [](std::uint64_t word) { return word & kAllBits << 56; });
    case 4:
      return each_word(mask, [](std::uint64_t word) { return word & kFirstColumn; });
    default:
      return each_word(mask, [](std::uint64_t word) { return word & kFirstColumn << 7; });
  }
}

BrickMask across(const BrickMask& neighbor, int side) {
  switch (side) {
    case 0:
      return one_word(0, neighbor.words[7]);
    case 1:
      return one_word(7, neighbor.words[0]);
    case 2:
      return each_word(neighbor, [](std::uint64_t word) { return word >> 56; });
    case 3:
      return each_word(neighbor, [](std::uint64_t word) { return word << 56; });
    case 4:
      return each_word(neighbor, [](std::uint64_t word) { return word >> 7 & kFirstColumn; });
    default:
      return each_word(neighbor, [](std::uint64_t word) { return (word & kFirstColumn) << 7; });
  }
}

BrickMask shifted(const BrickMask& mask, int side) {
  BrickMask result;
  switch (side) {
    case 0:
      for (std::size_t x = 0; x < 7; ++x) result.words[x] = mask.words[x + 1];
      return result;
    case 1:
      for (std::size_t x = 1; x < 8; ++x) result.words[x] = mask.words[x - 1];
      return result;
    case 2:
      return each_word(mask, [](std::uint64_t word) { return word >> 8; });
    case 3:
      return each_word(mask, [](std::uint64_t word) { return word << 8; });
    case 4:
      return each_word(mask, [](std::uint64_t word) { return (word & ~kFirstColumn) >> 1; });
    default:
      return each_word(mask, [](std::uint64_t word) { return (word & ~(kFirstColumn << 7)) << 1; });
  }
}

BrickMask flooded(const BrickMask& seeds, const BrickMask& open) {
  BrickMask reached = seeds & open;
  for (;;) {
    BrickMask next;
    for (std::size_t x = 0; x < 8; ++x) {
      const std::uint64_t word = reached.words[x];
      std::uint64_t spread = word | word << 8 | word >> 8 | (word & ~(kFirstColumn << 7)) << 1 |
                             (word & ~kFirstColumn) >> 1;
      if (x > 0) spread |= reached.words[x - 1];
      if (x < 7) spread |= reached.words[x + 1];
      next.words[x] = spread & open.words[x];
    }
    if (next == reached) return reached;
    reached = next;
  }
}

}  // namespace forcelayer
