#include "runtime/field/distance_field.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace forcelayer::field {
namespace {

static_assert(std::endian::native == std::endian::little, "the machine must be little-endian");

// The voxels of a halo along an axis that lie in the brick before, in its own and in the one
// behind, counted in the halo, and the first of them in its brick.
struct HaloPart {
  std::size_t begin, end, in_brick;
};
constexpr std::array<HaloPart, 3> kHaloParts{{{0, 1, 7}, {1, 9, 0}, {9, 10, 0}}};

// Adds the codes along z of the brick before, of a row's own and of the one behind.
template <int kPart>
void add_codes(std::uint64_t codes, DistanceBricks::Row& row) {
  if constexpr (kPart == 0) row.first |= codes >> 56;
  if constexpr (kPart == 1)
    row.first |= codes << 8, row.last |= static_cast<std::uint32_t>(codes >> 56);
  if constexpr (kPart == 2) row.last |= static_cast<std::uint32_t>(codes & 255) << 8;
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
      unpacked_(map_, kSlotBits),
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

// From the brick and the 26 around it. Outside the directory all is free.
void DistanceBricks::gather(const BrickIndex& brick, Halo& halo) noexcept {
  const std::array<std::uint32_t, 27> entries = brick_entries<3>(
      map_, {brick[0] - 1, brick[1] - 1, brick[2] - 1}, uniform_entry(kMaxDistanceCode));
  halo = {};
  for (std::size_t n = 0; n < entries.size(); n += 3) {
    const HaloPart &in_x = kHaloParts[n / 9], &in_y = kHaloParts[n / 3 % 3];
    add_brick<0>(entries[n], in_x, in_y, halo);
    add_brick<1>(entries[n + 1], in_x, in_y, halo);
    add_brick<2>(entries[n + 2], in_x, in_y, halo);
  }
}

template <int kPart, typename Part>
void DistanceBricks::add_brick(std::uint32_t entry, const Part& in_x, const Part& in_y,
                               Halo& halo) noexcept {
  const BrickCodes* const codes = is_uniform(entry) ? nullptr : &unpacked_.brick(entry);
  std::uint64_t row = uniform_value(entry) * 0x0101010101010101u;
  for (std::size_t x = in_x.begin; x < in_x.end; ++x) {
    for (std::size_t y = in_y.begin; y < in_y.end; ++y) {
      if (codes != nullptr) {
        const std::size_t at =
            (in_x.in_brick + x - in_x.begin) * 64 + (in_y.in_brick + y - in_y.begin) * 8;
        std::memcpy(&row, codes->data() + at, sizeof row);
      }
      add_codes<kPart>(row, halo[x][y]);
    }
  }
}

// Voxel by voxel, with the nearest known voxel in the place of every unknown one.
void DistanceBricks::gather_voxelwise(const BrickIndex& brick, Halo& halo) noexcept {
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
        inside ? unpacked_.code(voxel[0], voxel[1], voxel[2]) : kMaxDistanceCode;
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
               "bake the scene without --kind lean or paper, or use --force level"};
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

}  // namespace forcelayer::field
