#include "voxelize/tree/brick_cutter.h"

#include <algorithm>
#include <bit>
#include <cstring>

// Compiled once for every instruction set that Highway supports, picked at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/tree/brick_cutter.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include "formats/lattice/brick_bits.h"

HWY_BEFORE_NAMESPACE();
namespace forcelayer::tree::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr hn::CappedTag<std::uint64_t, 8> kTag{};
using V = hn::Vec<decltype(kTag)>;

using Eight = std::array<std::uint64_t, 8>;
using Plane = std::array<Eight, 8>;  // [x][y] rows of a column, or [x][z] words of its bricks

// Byte i of word j becomes byte j of word i.
HWY_INLINE void transpose_bytes(Eight& words) {
  const auto swap_blocks = [&](std::size_t distance, std::uint64_t mask) {
    const int shift = static_cast<int>(distance) * 8;
    for (std::size_t i = 0; i < 8; ++i) {
      if (i & distance) continue;
      const std::uint64_t moved = (words[i] >> shift ^ words[i + distance]) & mask;
      words[i + distance] ^= moved;
      words[i] ^= moved << shift;
    }
  };
  swap_blocks(4, 0x00000000ffffffffu);
  swap_blocks(2, 0x0000ffff0000ffffu);
  swap_blocks(1, 0x00ff00ff00ff00ffu);
}

// Every bit of the low 32 moved to twice its place.
HWY_INLINE V spread_bits(V bits) {
  const auto step = [](V value, int distance, std::uint64_t mask) HWY_ATTR {
    return hn::And(hn::Or(value, hn::ShiftLeftSame(value, distance)), hn::Set(kTag, mask));
  };
  bits = hn::And(bits, hn::Set(kTag, 0xffffffffu));
  bits = step(bits, 16, 0x0000ffff0000ffffu);
  bits = step(bits, 8, 0x00ff00ff00ff00ffu);
  bits = step(bits, 4, 0x0f0f0f0f0f0f0f0fu);
  bits = step(bits, 2, 0x3333333333333333u);
  return step(bits, 1, 0x5555555555555555u);
}

// Two-bit values from their low and high bits: value = low + 2 high.
HWY_INLINE void interleave(const Eight& low, const Eight& high, Brick& brick) {
  alignas(64) std::array<std::uint64_t, 16> values;
  for (std::size_t x = 0; x < 8; x += hn::Lanes(kTag)) {
    const V l = hn::LoadU(kTag, low.data() + x), h = hn::LoadU(kTag, high.data() + x);
    const V first = hn::Or(spread_bits(l), hn::ShiftLeft<1>(spread_bits(h)));
    const V second = hn::Or(spread_bits(hn::ShiftRight<32>(l)),
                            hn::ShiftLeft<1>(spread_bits(hn::ShiftRight<32>(h))));
    hn::StoreInterleaved2(first, second, kTag, values.data() + 2 * x);
  }
  std::memcpy(brick.data(), values.data(), sizeof brick);
}

constexpr bool is_full_or_empty(unsigned byte) { return byte == 0 || byte == 0xff; }

// The value that a whole brick has, or -1, for the eight bricks of a column.
HWY_INLINE std::array<int, 8> uniform_values(const Plane& low, const Plane& high) {
  std::uint64_t any_low = 0, all_low = ~std::uint64_t{0}, any_high = 0, all_high = all_low;
  for (std::size_t x = 0; x < 8; ++x) {
    for (std::size_t y = 0; y < 8; ++y) {
      any_low |= low[x][y];
      all_low &= low[x][y];
      any_high |= high[x][y];
      all_high &= high[x][y];
    }
  }
  std::array<int, 8> values;
  for (std::size_t z = 0; z < 8; ++z) {
    const auto byte = [z](std::uint64_t word) {
      return static_cast<unsigned>(word >> 8 * z & 0xff);
    };
    const unsigned l = byte(any_low), h = byte(any_high);
    const bool uniform =
        l == byte(all_low) && h == byte(all_high) && is_full_or_empty(l) && is_full_or_empty(h);
    values[z] = uniform ? static_cast<int>((l & 1) | (h & 1) << 1) : -1;
  }
  return values;
}

void cut(const distance::NodeCodes& codes, BuiltNode& node) {
  Plane low, high;
  for (unsigned column = 0; column < 64; ++column) {
    const unsigned bx = column >> 3, by = column & 7;
    for (unsigned x = 0; x < 8; ++x) {
      const std::size_t row = (bx * 8 + x) * 64 + by * 8;
      std::memcpy(low[x].data(), codes.low.data() + row, sizeof(Eight));
      std::memcpy(high[x].data(), codes.high.data() + row, sizeof(Eight));
    }
    const std::array<int, 8> uniform = uniform_values(low, high);
    bool transposed = false;
    for (unsigned bz = 0; bz < 8; ++bz) {
      const unsigned n = column << 3 | bz;
      if (uniform[bz] != 0) set(node.held, n);
      if (uniform[bz] >= 0) {
        node.entries[n] = uniform_entry(static_cast<std::uint32_t>(uniform[bz]));
        continue;
      }
      if (!transposed) {
        for (Eight& rows : low) transpose_bytes(rows);
        for (Eight& rows : high) transpose_bytes(rows);
        transposed = true;
      }
      Eight brick_low, brick_high;
      lattice::BrickMask non_free;
      for (std::size_t x = 0; x < 8; ++x) {
        brick_low[x] = low[x][bz];
        brick_high[x] = high[x][bz];
        non_free.words[x] = brick_low[x] | brick_high[x];
      }
      node.entries[n] = static_cast<std::uint32_t>(node.bricks.size());
      interleave(brick_low, brick_high, node.bricks.emplace_back());
      node.gaps.emplace_back(non_free);
    }
  }
}

}  // namespace
}  // namespace forcelayer::tree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::tree {
namespace {
HWY_EXPORT(cut);

struct CodeRange {
  std::uint8_t smallest, largest;
};
CodeRange range_of(const distance::NodeDistances& node, unsigned n) {
  if (!test(node.measured, n)) {
    const std::uint8_t code = node.solid_row(n, 0) != 0 ? 0 : kMaxDistanceCode;
    return {code, code};
  }
  const std::uint8_t* codes = node.brick(n);
  // As bytes, so that vectors hold sixteen.
  std::uint8_t smallest = 255, largest = 0;
  for (unsigned v = 0; v < distance::kBrickVoxels; ++v) {
    smallest = std::min(smallest, codes[v]);
    largest = std::max(largest, codes[v]);
  }
  return {smallest, largest};
}

}  // namespace

BuiltNode cut_into_bricks(const distance::NodeCodes& codes) {
  // Built in memory that is used again, so that the node's own arrays have their exact size.
  thread_local BuiltNode scratch;
  scratch.held = {};
  scratch.bricks.clear();
  scratch.gaps.clear();
  HWY_DYNAMIC_DISPATCH(cut)(codes, scratch);
  return scratch;
}

BuiltNode cut_into_bricks(const distance::NodeDistances& distances) {
  BuiltNode node;
  std::array<CodeRange, kNodeEntries> ranges;
  std::size_t bricks = 0;
  for (unsigned n = 0; n < kNodeEntries; ++n) {
    ranges[n] = range_of(distances, n);
    bricks += ranges[n].smallest != ranges[n].largest;
  }
  node.bricks.resize(bricks * kDistanceBrickParts);
  std::uint32_t next = 0;
  for (unsigned n = 0; n < kNodeEntries; ++n) {
    if (ranges[n].smallest == ranges[n].largest) {
      node.entries[n] = uniform_entry(ranges[n].smallest);
      continue;
    }
    node.entries[n] = next++;
    std::memcpy(node.bricks[std::size_t{node.entries[n]} * kDistanceBrickParts].data(),
                distances.brick(n), sizeof(Brick) * kDistanceBrickParts);
  }
  return node;
}

BuiltNode cut_into_bricks(const distance::NodeObjects& objects) {
  BuiltNode node;
  node.bricks.resize(static_cast<std::size_t>(lattice::count(objects.several)) * kObjectBrickParts);
  std::uint32_t next = 0;
  for (unsigned n = 0; n < kNodeEntries; ++n) {
    if (!test(objects.several, n)) {
      node.entries[n] = uniform_entry(objects.of_brick[n]);
      continue;
    }
    node.entries[n] = next++;
    std::memcpy(node.bricks[std::size_t{node.entries[n]} * kObjectBrickParts].data(),
                objects.brick(n), sizeof(Brick) * kObjectBrickParts);
  }
  return node;
}

}  // namespace forcelayer::tree
#endif
