#include "runtime/field/distance_field.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace forcelayer::field {
namespace {

static_assert(std::endian::native == std::endian::little, "a word's first byte is its lowest");

// Eight codes along z of a stored brick, a byte each.
std::uint64_t row_of(const DistanceView& map, std::uint32_t brick, int x, int y) {
  const auto* bytes =
      reinterpret_cast<const std::uint8_t*>(map.bricks) + std::uint64_t{brick} * 512;
  std::uint64_t row = 0;
  std::memcpy(&row, bytes + x * 64 + y * 8, 8);
  return row;
}

std::uint64_t row_of_entry(const DistanceView& map, std::uint32_t entry, int x, int y) {
  if (is_uniform(entry)) return uniform_value(entry) * 0x0101010101010101u;
  return row_of(map, entry, x, y);
}

// Words along z, two in one number.
using Words = std::array<std::uint64_t, 5>;

// The codes of a row in the lowest bytes of words.
Words spread(const DistanceBricks::Row& row) {
  const auto two = [](std::uint64_t codes) { return (codes | codes << 24) & 0x000000ff000000ffu; };
  const auto at = [&](int n) { return two(row.first >> 8 * n & 0xffff); };
  return {at(0), at(2), at(4), at(6), two(row.last)};
}

// Two words in each, the second `shift` bits higher.
Words joined(const Words& low, const Words& high, int shift) {
  return {low[0] | high[0] << shift, low[1] | high[1] << shift, low[2] | high[2] << shift,
          low[3] | high[3] << shift, low[4] | high[4] << shift};
}

}  // namespace

DistanceBricks::DistanceBricks(const Voxmap& voxmap)
    : BrickCache(voxmap),
      map_(*voxmap.distances()),
      codes_(std::size_t{kBrickBytes} * kSlots + 2 * kMargin) {}

const std::uint8_t* DistanceBricks::hold_brick(std::int32_t bx, std::int32_t by,
                                               std::int32_t bz) noexcept {
  const BrickIndex brick{bx, by, bz};
  const auto [slot, held] = take_slot(brick);
  std::uint8_t* codes = &codes_[kMargin + std::size_t{kBrickBytes} * slot];
  if (held) return codes;
  Halo halo;
  if (near_cropped_side(brick)) {
    gather_voxelwise(brick, halo);
  } else {
    gather(brick, halo);
  }
  // Two rows of a plane in one, then two such pairs.
  std::array<Words, 9> before;
  for (std::size_t x = 0; x < 10; ++x) {
    Words row = spread(halo[x][0]);
    for (std::size_t y = 0; y < 9; ++y) {
      const Words next = spread(halo[x][y + 1]), pair = joined(row, next, 8);
      if (x > 0) {
        const Words words = joined(before[y], pair, 16);
        std::memcpy(codes + (x - 1) * kPlaneBytes + y * kRowBytes, words.data(), kRowBytes);
      }
      before[y] = pair;
      row = next;
    }
  }
  return codes;
}

// From the brick and the 26 around it, row by row. Outside the directory all is free.
void DistanceBricks::gather(const BrickIndex& brick, Halo& halo) const noexcept {
  const std::array<std::uint32_t, 27> entries = brick_entries<3>(
      map_, {brick[0] - 1, brick[1] - 1, brick[2] - 1}, uniform_entry(kMostDistanceCode));
  for (int x = 0; x < 10; ++x) {
    for (int y = 0; y < 10; ++y) {
      const int in_x = x + 7, in_y = y + 7;  // from the bricks before on
      const std::uint32_t* along_z =
          &entries[static_cast<std::size_t>(9 * (in_x >> 3) + 3 * (in_y >> 3))];
      const std::uint64_t before = row_of_entry(map_, along_z[0], in_x & 7, in_y & 7) >> 56;
      const std::uint64_t own = row_of_entry(map_, along_z[1], in_x & 7, in_y & 7);
      const std::uint64_t behind = row_of_entry(map_, along_z[2], in_x & 7, in_y & 7) & 255;
      halo[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)] = {
          before | own << 8, static_cast<std::uint32_t>(own >> 56 | behind << 8)};
    }
  }
}

// Voxel by voxel, with the nearest known voxel in the place of every unknown one.
void DistanceBricks::gather_voxelwise(const BrickIndex& brick, Halo& halo) const noexcept {
  for (int n = 0; n < 10 * 10 * 10; ++n) {
    const std::array<int, 3> in_halo{n / 100, n / 10 % 10, n % 10};
    std::array<std::int32_t, 3> voxel{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t at = std::int64_t{8} * brick[axis] + in_halo[axis] - 1;
      voxel[axis] = static_cast<std::int32_t>(
          std::min(std::max(at, known().low[axis]), known().high[axis] - 1));
    }
    const bool inside = map_.contains(voxel[0], voxel[1], voxel[2]);
    const std::uint32_t code =
        inside ? map_.lookup(voxel[0], voxel[1], voxel[2]).code : kMostDistanceCode;
    Row& row = halo[static_cast<std::size_t>(in_halo[0])][static_cast<std::size_t>(in_halo[1])];
    if (in_halo[2] == 0) row = {0, 0};
    if (in_halo[2] < 8) {
      row.first |= std::uint64_t{code} << 8 * in_halo[2];
    } else {
      row.last |= code << 8 * (in_halo[2] - 8);
    }
  }
}

std::optional<Error> DistanceField::unreadable(const Voxmap& voxmap) {
  if (voxmap.distances() != nullptr) return std::nullopt;
  return Error{ErrorCode::kUsage, "", "distance field", "the scene stores no distances",
               "bake the scene without --lean and --metric chebyshev, or use --force level"};
}

// A code stands for the middle of its step.
DistanceField::DistanceField(const Voxmap& voxmap)
    : cropped_(voxmap.header().cropped_sides != 0), bricks_(voxmap) {
  const VoxmapHeader& h = voxmap.header();
  const double codes_per_voxel = h.voxel_size_m / h.distance_quantum_m;
  scale_.voxel_size_m = static_cast<float>(h.voxel_size_m);
  scale_.zero_code =
      static_cast<float>(h.distance_zero_code - 0.5 + h.zero_force_m / h.distance_quantum_m);
  scale_.voxels_per_code = static_cast<float>(1 / codes_per_voxel);
  scale_.mesh_code = static_cast<float>(h.distance_zero_code);
  scale_.squared_codes_per_voxel = static_cast<float>(codes_per_voxel * codes_per_voxel);
}

// The codes of unknown voxels are those of known ones, which is no bound.
void DistanceField::disprove_beside_cropped_sides(const query::CollectedPoints& points,
                                                  FieldSamples& samples) const noexcept {
  const KnownBox& known = bricks_.known();
  for (std::uint32_t i = 0; i < points.count; ++i) {
    const std::array<std::int64_t, 3> voxel{points.vx[i], points.vy[i], points.vz[i]};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (voxel[axis] - 1 >= known.low[axis] && voxel[axis] + 1 < known.high[axis]) continue;
      samples.distance_m[i] = 0;
    }
  }
}

}  // namespace forcelayer::field
