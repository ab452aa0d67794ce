#include "voxelize/brick_cutter.h"

#include <algorithm>
#include <cstring>

#include "voxelize/brick_bits.h"

namespace forcelayer {
namespace {

// The low 32 bits, each moved to every second bit.
std::uint64_t spread_bits(std::uint64_t bits) {
  bits &= 0xffffffffu;
  bits = (bits | bits << 16) & 0x0000ffff0000ffffu;
  bits = (bits | bits << 8) & 0x00ff00ff00ff00ffu;
  bits = (bits | bits << 4) & 0x0f0f0f0f0f0f0f0fu;
  bits = (bits | bits << 2) & 0x3333333333333333u;
  return (bits | bits << 1) & 0x5555555555555555u;
}

// Byte i of word j becomes byte j of word i.
void transpose_bytes(std::array<std::uint64_t, 8>& words) {
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

constexpr bool is_full_or_empty(unsigned byte) { return byte == 0 || byte == 0xff; }

// A column of eight bricks along z, out of a node's rows.
class BrickColumn {
 public:
  BrickColumn(const NodeCodes& codes, unsigned bx, unsigned by) {
    std::uint64_t any_low = 0, all_low = kAllBits, any_high = 0, all_high = kAllBits;
    for (unsigned x = 0; x < 8; ++x) {
      for (unsigned y = 0; y < 8; ++y) {
        const std::size_t row = (bx * 8 + x) * 64 + by * 8 + y;
        low_[x][y] = codes.low[row];
        high_[x][y] = codes.high[row];
        any_low |= low_[x][y];
        all_low &= low_[x][y];
        any_high |= high_[x][y];
        all_high &= high_[x][y];
      }
    }
    for (unsigned z = 0; z < 8; ++z) {
      const auto byte = [z](std::uint64_t word) {
        return static_cast<unsigned>(word >> 8 * z & 0xff);
      };
      const bool same = byte(any_low) == byte(all_low) && byte(any_high) == byte(all_high) &&
                        is_full_or_empty(byte(any_low)) && is_full_or_empty(byte(any_high));
      uniform_[z] = same ? static_cast<int>((byte(any_low) & 1) | (byte(any_high) & 1) << 1) : -1;
    }
  }

  // The one value of brick z, or -1.
  int uniform(unsigned z) const { return uniform_[z]; }

  bool all_uniform() const {
    return std::none_of(uniform_.begin(), uniform_.end(), [](int value) { return value < 0; });
  }

  // Before brick(): rows to bricks.
  void transpose() {
    for (auto& words : low_) transpose_bytes(words);
    for (auto& words : high_) transpose_bytes(words);
  }

  BrickMask non_free(unsigned z) const {
    BrickMask mask;
    for (std::size_t x = 0; x < 8; ++x) mask.words[x] = low_[x][z] | high_[x][z];
    return mask;
  }

  Brick brick(unsigned z) const {
    Brick brick;
    for (std::size_t x = 0; x < 8; ++x) {
      const std::uint64_t low = low_[x][z], high = high_[x][z];
      const std::uint64_t halves[2] = {spread_bits(low) | spread_bits(high) << 1,
                                       spread_bits(low >> 32) | spread_bits(high >> 32) << 1};
      std::memcpy(&brick[x * 4], halves, sizeof halves);
    }
    return brick;
  }

 private:
  std::array<std::array<std::uint64_t, 8>, 8> low_, high_;  // [x][y] rows, then [x][z] brick words
  std::array<int, 8> uniform_;
};

}  // namespace

BuiltNode cut_into_bricks(const NodeCodes& codes) {
  BuiltNode node;
  for (unsigned bx = 0; bx < 8; ++bx) {
    for (unsigned by = 0; by < 8; ++by) {
      BrickColumn column(codes, bx, by);
      if (!column.all_uniform()) column.transpose();
      for (unsigned bz = 0; bz < 8; ++bz) {
        const unsigned n = bx * 64 + by * 8 + bz;
        std::uint32_t& entry = node.entries[n];
        if (column.uniform(bz) != 0) set(node.held, n);
        if (column.uniform(bz) >= 0) {
          entry = uniform_entry(static_cast<std::uint32_t>(column.uniform(bz)));
        } else {
          entry = static_cast<std::uint32_t>(node.bricks.size());
          node.bricks.push_back(column.brick(bz));
          node.nearness.emplace_back(column.non_free(bz));
        }
      }
    }
  }
  return node;
}

}  // namespace forcelayer
