#include "runtime/level_bricks.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace forcelayer {
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

// Levels of the four values in a byte, in order.
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

// Of a node's 512 entries the one that holds a brick, by three bits of each coordinate.
std::uint64_t entry_number(const std::array<std::int32_t, 3>& brick, int shift) {
  const auto digit = [shift](std::int32_t i) { return static_cast<std::uint64_t>(i >> shift & 7); };
  return digit(brick[0]) * 64 + digit(brick[1]) * 8 + digit(brick[2]);
}

// The entry for the 64^3 voxels around a brick of the directory: a lower node, or uniform.
std::uint32_t lower_entry(const VoxmapView& map, const std::array<std::int32_t, 3>& brick) {
  const auto& dims = map.directory_dims;
  const std::uint32_t entry =
      map.directory[(std::int64_t{brick[0] >> 6} * dims[1] + (brick[1] >> 6)) * dims[2] +
                    (brick[2] >> 6)];
  if (is_uniform(entry)) return entry;
  return map.upper_nodes[std::uint64_t{entry} * kNodeEntries + entry_number(brick, 3)];
}

// The values of a brick in lower node `node`.
const std::uint8_t* brick_in(const VoxmapView& map, std::uint32_t node,
                             const std::array<std::int32_t, 3>& brick) {
  const std::uint32_t entry =
      map.lower_nodes[std::uint64_t{node} * kNodeEntries + entry_number(brick, 0)];
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

}  // namespace

LevelBricks::LevelBricks(const Voxmap& voxmap)
    : map_(voxmap.view()),
      keys_(kSlots, kNoKey),
      tags_(std::size_t{4} * kSlots, kNone),
      levels_(std::size_t{kBrickBytes} * kSlots) {
  const VoxmapHeader& header = voxmap.header();
  const auto& blocks = header.directory_dims;
  strides_ = {blocks[1] * blocks[2] * 64 * 64, blocks[2] * 64, 1};
  keys_are_unique_ = std::uint64_t{blocks[0]} * blocks[1] * blocks[2] < kNoKey / (64 * 64 * 64);
  known_ = known_box(header, header.directory_origin);
}

const std::uint8_t* LevelBricks::hold(std::int32_t bx, std::int32_t by, std::int32_t bz) noexcept {
  const std::uint32_t key = static_cast<std::uint32_t>(bx) * strides_[0] +
                            static_cast<std::uint32_t>(by) * strides_[1] +
                            static_cast<std::uint32_t>(bz) * strides_[2];
  const std::uint32_t at = slot(key);
  std::int32_t* tag = &tags_[std::size_t{4} * at];
  std::uint8_t* levels = &levels_[std::size_t{kBrickBytes} * at];
  if (tag[0] == bx && tag[1] == by && tag[2] == bz) return levels;
  const BrickIndex brick{bx, by, bz};
  if (near_cropped_side(brick)) {
    decode_voxelwise(brick, levels);
  } else {
    decode(brick, levels);
  }
  keys_[at] = key;
  tag[0] = bx, tag[1] = by, tag[2] = bz;
  return levels;
}

bool LevelBricks::near_cropped_side(const BrickIndex& brick) const noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t low = std::int64_t{8} * brick[axis];
    if (low - 1 < known_.low[axis] || low + 9 > known_.high[axis]) return true;
  }
  return false;
}

// The 128 bytes of a brick, stored or uniform; free outside the directory.
const std::uint8_t* LevelBricks::values_of(const BrickIndex& brick) const noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (brick[axis] < 0 || brick[axis] >> 6 >= map_.directory_dims[axis]) {
      return kUniformBricks[0].data();
    }
  }
  const std::uint32_t lower = lower_entry(map_, brick);
  return is_uniform(lower) ? uniform(lower) : brick_in(map_, lower, brick);
}

// The bricks around one and itself: 9 x + 3 y + z.
std::array<const std::uint8_t*, 27> LevelBricks::values_around(
    const BrickIndex& brick) const noexcept {
  std::array<const std::uint8_t*, 27> values{};
  bool in_one_node = true;
  for (const std::int32_t b : brick) in_one_node = in_one_node && (b & 7) > 0 && (b & 7) < 7;
  const std::uint32_t lower = in_one_node ? lower_entry(map_, brick) : uniform_entry(0);
  for (int n = 0; n < 27; ++n) {
    const BrickIndex neighbour{brick[0] + n / 9 - 1, brick[1] + n / 3 % 3 - 1,
                               brick[2] + n % 3 - 1};
    values[n] = is_uniform(lower) ? values_of(neighbour) : brick_in(map_, lower, neighbour);
  }
  return values;
}

// Plane by plane: ten rows of raised levels (the last of the brick before, the eight of this one,
// the first of the next), then each three neighbours in one.
void LevelBricks::decode(const BrickIndex& brick, std::uint8_t* levels) const noexcept {
  const auto values = values_around(brick);
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
      voxel[axis] = std::min(std::max(voxel[axis], known_.low[axis]), known_.high[axis] - 1);
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

}  // namespace forcelayer
