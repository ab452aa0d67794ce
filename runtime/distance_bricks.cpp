#include "runtime/distance_bricks.h"

#include <algorithm>
#include <cstring>

namespace forcelayer {
namespace {

// Eight codes along z of a stored brick.
std::array<std::uint8_t, 8> row_of(const VoxmapView& map, std::uint32_t brick, int x, int y) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(map.bricks + std::uint64_t{brick} * 16 *
                                                                             map.bits_per_voxel);
  std::array<std::uint8_t, 8> row{};
  const int first = x * 64 + y * 8;
  if (map.bits_per_voxel == 8) {
    std::memcpy(row.data(), bytes + first, 8);
  } else {
    for (int z = 0; z < 8; ++z) {
      row[static_cast<std::size_t>(z)] =
          static_cast<std::uint8_t>(bytes[(first + z) / 2] >> (4 * (z % 2)) & 15);
    }
  }
  return row;
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
  for (std::size_t x = 0; x < 10; ++x) {
    for (std::size_t y = 0; y < 9; ++y) {
      std::uint8_t* out = codes + x * kPlaneBytes + y * kRowBytes;
      for (std::size_t z = 0; z < 10; ++z) {
        out[2 * z] = halo[x][y][z];
        out[2 * z + 1] = halo[x][y + 1][z];
      }
    }
  }
  return codes;
}

// From the 27 bricks around, row by row. Outside the directory all is free.
void DistanceBricks::gather(const BrickIndex& brick, Halo& halo) const noexcept {
  const std::array<std::uint32_t, 27> entries =
      entries_around(map_, brick, uniform_entry(free_code_));
  for (int x = 0; x < 10; ++x) {
    for (int y = 0; y < 10; ++y) {
      const std::uint32_t* along_z =
          &entries[static_cast<std::size_t>(9 * ((x + 7) >> 3) + 3 * ((y + 7) >> 3))];
      std::array<std::array<std::uint8_t, 8>, 3> rows;
      for (std::size_t i = 0; i < 3; ++i) {
        if (is_uniform(along_z[i])) {
          rows[i].fill(static_cast<std::uint8_t>(uniform_value(along_z[i])));
        } else {
          rows[i] = row_of(map_, along_z[i], (x + 7) & 7, (y + 7) & 7);
        }
      }
      auto& out = halo[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)];
      out[0] = rows[0][7];
      std::memcpy(&out[1], rows[1].data(), 8);
      out[9] = rows[2][0];
    }
  }
}

// Voxel by voxel, with the nearest known voxel in the place of every unknown one.
void DistanceBricks::gather_known(const BrickIndex& brick, Halo& halo) const noexcept {
  for (int n = 0; n < 1000; ++n) {
    const std::array<int, 3> in_halo{n / 100, n / 10 % 10, n % 10};
    std::array<std::int32_t, 3> voxel{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t at = std::int64_t{8} * brick[axis] + in_halo[axis] - 1;
      voxel[axis] = static_cast<std::int32_t>(
          std::min(std::max(at, known().low[axis]), known().high[axis] - 1));
    }
    const bool inside = map_.contains(voxel[0], voxel[1], voxel[2]);
    const std::uint32_t code = inside ? map_.lookup(voxel[0], voxel[1], voxel[2]).code : free_code_;
    halo[static_cast<std::size_t>(in_halo[0])][static_cast<std::size_t>(in_halo[1])]
        [static_cast<std::size_t>(in_halo[2])] = static_cast<std::uint8_t>(code);
  }
}

}  // namespace forcelayer
