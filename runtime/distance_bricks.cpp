#include "runtime/distance_bricks.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace forcelayer {
namespace {

static_assert(std::endian::native == std::endian::little, "a word's first byte is its lowest");

// Eight codes along z of a stored brick, a byte each.
std::uint64_t row_of(const VoxmapView& map, std::uint32_t brick, int x, int y) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(map.bricks + std::uint64_t{brick} * 16 *
                                                                             map.bits_per_voxel);
  const int first = x * 64 + y * 8;
  std::uint64_t row = 0;
  if (map.bits_per_voxel == 8) {
    std::memcpy(&row, bytes + first, 8);
    return row;
  }
  std::memcpy(&row, bytes + first / 2, 4);
  row = (row | row << 16) & 0x0000ffff0000ffffu;
  row = (row | row << 8) & 0x00ff00ff00ff00ffu;
  return (row | row << 4) & 0x0f0f0f0f0f0f0f0fu;
}

std::uint64_t row_of_entry(const VoxmapView& map, std::uint32_t entry, int x, int y) {
  if (is_uniform(entry)) return uniform_value(entry) * 0x0101010101010101u;
  return row_of(map, entry, x, y);
}

// Words along z, two in one number and the ninth in the last.
using Words = std::array<std::uint64_t, 5>;

// The codes of a row in the lowest bytes of words.
Words spread(const DistanceBricks::Row& row) {
  const auto two = [&](int z) {
    const std::uint64_t codes = row.own >> 8 * z & 0xffff;
    return (codes | codes << 24) & 0x000000ff000000ffu;
  };
  return {two(0), two(2), two(4), two(6), row.next};
}

// Two words in each, the second `shift` bits higher.
Words joined(const Words& low, const Words& high, int shift) {
  return {low[0] | high[0] << shift, low[1] | high[1] << shift, low[2] | high[2] << shift,
          low[3] | high[3] << shift, low[4] | high[4] << shift};
}

}  // namespace

DistanceBricks::DistanceBricks(const Voxmap& voxmap)
    : BrickMemo(voxmap),
      map_(voxmap.view()),
      free_code_((1u << voxmap.header().bits_per_voxel) - 1),
      codes_(std::size_t{kBrickBytes} * kSlots) {}

const std::uint8_t* DistanceBricks::hold(std::int32_t bx, std::int32_t by,
                                         std::int32_t bz) noexcept {
  const BrickIndex brick{bx, by, bz};
  const auto [slot, held] = take(brick);
  std::uint8_t* codes = &codes_[std::size_t{kBrickBytes} * slot];
  if (held) return codes;
  Halo halo;
  if (near_cropped_side(brick)) {
    gather_known(brick, halo);
  } else {
    gather(brick, halo);
  }
  // Two rows of a plane in one, then two such pairs.
  std::array<Words, 8> before;
  for (std::size_t x = 0; x < 9; ++x) {
    Words row = spread(halo[x][0]);
    for (std::size_t y = 0; y < 8; ++y) {
      const Words next = spread(halo[x][y + 1]), pair = joined(row, next, 8);
      if (x > 0) {
        const Words words = joined(before[y], pair, 16);
        std::uint8_t* out = codes + (x - 1) * kPlaneBytes + y * kRowBytes;
        for (std::size_t i = 0; i < 4; ++i) std::memcpy(out + 8 * i, &words[i], 8);
        std::memcpy(out + 32, &words[4], 4);
      }
      before[y] = pair;
      row = next;
    }
  }
  return codes;
}

// From the brick and the seven behind it, row by row. Outside the directory all is free.
void DistanceBricks::gather(const BrickIndex& brick, Halo& halo) const noexcept {
  const std::array<std::uint32_t, 8> entries =
      brick_entries<2>(map_, brick, uniform_entry(free_code_));
  for (int x = 0; x < 9; ++x) {
    for (int y = 0; y < 9; ++y) {
      const std::uint32_t* along_z =
          &entries[static_cast<std::size_t>(4 * (x >> 3) + 2 * (y >> 3))];
      const std::uint64_t own = row_of_entry(map_, along_z[0], x & 7, y & 7);
      const std::uint64_t next = row_of_entry(map_, along_z[1], x & 7, y & 7) & 255;
      halo[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)] = {
          own, static_cast<std::uint32_t>(next)};
    }
  }
}

// Voxel by voxel, with the nearest known voxel in the place of every unknown one.
void DistanceBricks::gather_known(const BrickIndex& brick, Halo& halo) const noexcept {
  for (int n = 0; n < 9 * 9 * 9; ++n) {
    const std::array<int, 3> in_halo{n / 81, n / 9 % 9, n % 9};
    std::array<std::int32_t, 3> voxel{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t at = std::int64_t{8} * brick[axis] + in_halo[axis];
      voxel[axis] = static_cast<std::int32_t>(
          std::min(std::max(at, known().low[axis]), known().high[axis] - 1));
    }
    const bool inside = map_.contains(voxel[0], voxel[1], voxel[2]);
    const std::uint32_t code = inside ? map_.lookup(voxel[0], voxel[1], voxel[2]).code : free_code_;
    Row& row = halo[static_cast<std::size_t>(in_halo[0])][static_cast<std::size_t>(in_halo[1])];
    if (in_halo[2] == 0) row.own = 0;
    if (in_halo[2] < 8) {
      row.own |= std::uint64_t{code} << 8 * in_halo[2];
    } else {
      row.next = code;
    }
  }
}

}  // namespace forcelayer
