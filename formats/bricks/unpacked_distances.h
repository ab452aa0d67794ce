// Bricks of distances as they were last unpacked. A brick is asked for again and again: by its
// neighbors, and in the next frame. No answer depends on earlier questions. For one thread at a
// time.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/voxmap.h"

namespace forcelayer {

class UnpackedDistances {
 public:
  // The map outlives this. Keeps 2^slot_bits bricks, half a kilobyte each.
  explicit UnpackedDistances(const DistanceView& map, unsigned slot_bits = 10)
      : map_(map),
        shift_(32 - slot_bits),
        numbers_(std::size_t{1} << slot_bits, kNone),
        codes_(numbers_.size()) {}

  // The codes of a stored brick; valid until the next call.
  const BrickCodes& brick(std::uint32_t number) noexcept {
    const std::size_t slot = number * kHash >> shift_;
    if (numbers_[slot] != number) {
      unpack_distances(map_.brick_at(number), codes_[slot]);
      numbers_[slot] = number;
    }
    return codes_[slot];
  }

  // The codes of the eight voxels from a relative one on, z fastest; the directory contains all.
  std::array<std::uint32_t, 8> cell(std::int32_t x, std::int32_t y, std::int32_t z) noexcept {
    std::array<std::uint32_t, 8> codes;
    if ((x & 7) == 7 || (y & 7) == 7 || (z & 7) == 7) {
      for (int n = 0; n < 8; ++n) {
        codes[static_cast<std::size_t>(n)] = code(x + (n >> 2), y + (n >> 1 & 1), z + (n & 1));
      }
      return codes;
    }
    const std::uint32_t entry = map_.entry(x, y, z);
    if (is_uniform(entry)) {
      codes.fill(uniform_wide_value(entry));
      return codes;
    }
    const auto* const at =
        &brick(entry)[static_cast<std::size_t>((x & 7) << 6 | (y & 7) << 3 | (z & 7))];
    return {at[0], at[1], at[8], at[9], at[64], at[65], at[72], at[73]};
  }

  // The code of a relative voxel that the directory contains.
  std::uint32_t code(std::int32_t x, std::int32_t y, std::int32_t z) noexcept {
    const std::uint32_t entry = map_.entry(x, y, z);
    if (is_uniform(entry)) return uniform_wide_value(entry);
    return brick(entry)[static_cast<std::size_t>((x & 7) << 6 | (y & 7) << 3 | (z & 7))];
  }

 private:
  static constexpr std::uint32_t kNone = kUniformBit;  // no brick has this number
  static constexpr std::uint32_t kHash = 0x9e3779b1u;  // 2^32 over the golden ratio

  DistanceView map_;
  unsigned shift_;
  std::vector<std::uint32_t> numbers_;
  std::vector<BrickCodes> codes_;
};

}  // namespace forcelayer
