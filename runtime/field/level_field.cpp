#include "runtime/field/level_field.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace forcelayer::field {
namespace {

// A brick of one value, as the map stores it.
using UniformBrick = std::array<std::uint8_t, 128>;
constexpr UniformBrick uniform_brick(std::uint8_t value) {
  UniformBrick brick{};
  for (auto& byte : brick) byte = static_cast<std::uint8_t>(value * 0x55u);
  return brick;
}
alignas(64) constexpr std::array<UniformBrick, 4> kUniformBricks{
    uniform_brick(0), uniform_brick(1), uniform_brick(2), uniform_brick(3)};

// Raised levels of values 0 free, 1 interior, 2 surface, 3 proximity.
constexpr std::array<std::uint8_t, 4> kRaisedLevel{3, 0, 1, 2};

// Raised levels of the four values in a byte, in order.
constexpr auto kLevelsOfByte = [] {
  std::array<std::array<std::uint8_t, 4>, 256> table{};
  for (std::size_t byte = 0; byte < 256; ++byte) {
    for (std::size_t i = 0; i < 4; ++i) table[byte][i] = kRaisedLevel[byte >> (2 * i) & 3];
  }
  return table;
}();

const std::uint8_t* uniform(std::uint32_t entry) {
  return kUniformBricks[uniform_value(entry) & 3].data();
}

// The 128 bytes of an entry for a brick.
const std::uint8_t* values_of_entry(const VoxmapView& map, std::uint32_t entry) {
  if (is_uniform(entry)) return uniform(entry);
  return reinterpret_cast<const std::uint8_t*>(map.bricks + std::uint64_t{entry} * 32);
}

// Row (x, y) of a stored brick: two bytes, eight values.
const std::uint8_t* row(const std::uint8_t* values, int x, int y) {
  return values + 16 * x + 2 * y;
}

// Three rows of levels, of two bits each, in the bytes of one.
void pack_rows(const std::uint8_t* low, const std::uint8_t* middle, const std::uint8_t* high,
               std::uint8_t* out) {
  const auto pack = [&](auto word, std::uint32_t at) {
    auto a = word, b = word, c = word;
    std::memcpy(&a, low + at, sizeof a);
    std::memcpy(&b, middle + at, sizeof b);
    std::memcpy(&c, high + at, sizeof c);
    word = a | b << 2 | c << 4;
    std::memcpy(out + at, &word, sizeof word);
  };
  static_assert(LevelBricks::kRowBytes == 12);
  pack(std::uint64_t{}, 0);
  pack(std::uint32_t{}, 8);
}

LevelScale scale_of(const Voxmap& voxmap) {
  LevelScale scale;
  scale.voxel_size_m = static_cast<float>(voxmap.voxel_size_m());
  if (voxmap.header().metric == static_cast<std::uint32_t>(Metric::kEuclidean)) {
    scale.a = 0.8660254f;
    scale.b = 0.5f;
  }
  return scale;
}

}  // namespace

LevelBricks::LevelBricks(const Voxmap& voxmap)
    : BrickCache(voxmap), map_(voxmap.view()), levels_(std::size_t{kBrickBytes} * kSlots) {}

const std::uint8_t* LevelBricks::hold_brick(std::int32_t bx, std::int32_t by,
                                            std::int32_t bz) noexcept {
  const BrickIndex brick{bx, by, bz};
  const auto [slot, held] = take_slot(brick);
  std::uint8_t* levels = &levels_[std::size_t{kBrickBytes} * slot];
  if (held) return levels;
  if (near_cropped_side(brick)) {
    decode_voxelwise(brick, levels);
  } else {
    decode(brick, levels);
  }
  return levels;
}

// The 128 bytes of a brick, stored or uniform; free outside the directory.
const std::uint8_t* LevelBricks::values_of(const BrickIndex& brick) const noexcept {
  return values_of_entry(map_, brick_entry(map_, brick, uniform_entry(0)));
}

// Plane by plane: ten rows of raised levels (the last of the brick before, the eight of this one,
// the first of the next), then each three neighbors in one.
void LevelBricks::decode(const BrickIndex& brick, std::uint8_t* levels) const noexcept {
  const auto entries =
      brick_entries<3>(map_, {brick[0] - 1, brick[1] - 1, brick[2] - 1}, uniform_entry(0));
  std::array<const std::uint8_t*, 27> values{};
  for (std::size_t n = 0; n < 27; ++n) values[n] = values_of_entry(map_, entries[n]);
  for (int x = -1; x <= 8; ++x) {
    std::uint8_t rows[10][kRowBytes] = {};
    for (int y = -1; y <= 8; ++y) {
      const std::uint8_t* const* along_z = &values[9 * ((x + 8) >> 3) + 3 * ((y + 8) >> 3)];
      const std::uint8_t* before = row(along_z[0], x & 7, y & 7);
      const std::uint8_t* own = row(along_z[1], x & 7, y & 7);
      const std::uint8_t* after = row(along_z[2], x & 7, y & 7);
      std::uint8_t* out = rows[y + 1];
      out[0] = kLevelsOfByte[before[1]][3];
      std::memcpy(out + 1, kLevelsOfByte[own[0]].data(), 4);
      std::memcpy(out + 5, kLevelsOfByte[own[1]].data(), 4);
      out[9] = kLevelsOfByte[after[0]][0];
    }
    for (int y = 0; y < 8; ++y) {
      pack_rows(rows[y], rows[y + 1], rows[y + 2],
                levels + (x + 1) * int{kPlaneBytes} + y * int{kRowBytes});
    }
  }
}

// The same voxel by voxel, with the nearest known voxel in the place of every unknown one.
void LevelBricks::decode_voxelwise(const BrickIndex& brick, std::uint8_t* levels) const noexcept {
  std::memset(levels, 0, kBrickBytes);
  for (int n = 0; n < 1000; ++n) {
    const std::array<int, 3> in_halo{n / 100, n / 10 % 10, n % 10};
    std::array<std::int64_t, 3> voxel{};
    BrickIndex holder{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      voxel[axis] = std::int64_t{8} * brick[axis] + in_halo[axis] - 1;
      voxel[axis] = std::min(std::max(voxel[axis], known().low[axis]), known().high[axis] - 1);
      holder[axis] = static_cast<std::int32_t>(voxel[axis] >> 3);
    }
    const std::uint8_t* values =
        row(values_of(holder), static_cast<int>(voxel[0] & 7), static_cast<int>(voxel[1] & 7));
    const int z = static_cast<int>(voxel[2] & 7);
    const int level = kLevelsOfByte[values[z >> 2]][static_cast<std::size_t>(z & 3)];
    for (int third = 0; third < 3; ++third) {
      const int y = in_halo[1] - third;
      if (y < 0 || y > 7) continue;
      std::uint8_t& byte = levels[in_halo[0] * int{kPlaneBytes} + y * int{kRowBytes} + in_halo[2]];
      byte = static_cast<std::uint8_t>(byte | level << (2 * third));
    }
  }
}

std::optional<Error> LevelField::unreadable(const Voxmap& voxmap) {
  const VoxmapHeader& header = voxmap.header();
  if (header.offset_layers == 0) {
    return Error{ErrorCode::kUsage, "", "level field",
                 has_standoff(header)
                     ? "needs offset layers, but this scene has a standoff"
                     : "the scene has no offset layers, so its values jump from interior to "
                       "proximity",
                 has_standoff(header)
                     ? "leave out --force, or bake the scene with --layers instead of --standoff"
                     : "bake the scene with --layers 1 or more, or use --force tangent-plane"};
  }
  return std::nullopt;
}

LevelField::LevelField(const Voxmap& voxmap) : scale_(scale_of(voxmap)), bricks_(voxmap) {}

}  // namespace forcelayer::field
