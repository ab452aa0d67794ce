#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "formats/bricks/packed_bricks.h"

namespace forcelayer {
namespace {

// A brick's rows of eight codes along z, as words whose lowest byte is that of z = 0.
using Rows = std::array<std::uint64_t, 64>;
constexpr std::uint64_t kTopBits = 0x8080808080808080u, kEachByte = 0x0101010101010101u;

// a - b of each byte, modulo 256.
std::uint64_t bytes_minus(std::uint64_t a, std::uint64_t b) {
  return ((a | kTopBits) - (b & ~kTopBits)) ^ ((a ^ ~b) & kTopBits);
}

// The difference of a code from the sum of those before it: along z, then y, then x, modulo 256.
Rows differences_of(const std::uint8_t* codes) {
  Rows rows;
  std::memcpy(rows.data(), codes, sizeof rows);
  for (std::uint64_t& row : rows) row = bytes_minus(row, row << 8);
  for (std::size_t n = rows.size(); n-- > 0;) {
    if (n % 8 != 0) rows[n] = bytes_minus(rows[n], rows[n - 1]);
  }
  for (std::size_t n = rows.size(); n-- > 8;) rows[n] = bytes_minus(rows[n], rows[n - 8]);
  return rows;
}

// Takes the middle one of seven differences along an edge off them.
std::uint8_t take_slope(std::int8_t* differences, std::size_t step) {
  std::array<std::int8_t, 7> along;
  for (std::size_t n = 0; n < 7; ++n) along[n] = differences[(n + 1) * step];
  std::nth_element(along.begin(), along.begin() + 3, along.end());
  const std::int8_t slope = along[3];
  for (std::size_t n = 1; n < 8; ++n) {
    differences[n * step] = static_cast<std::int8_t>(differences[n * step] - slope);
  }
  return static_cast<std::uint8_t>(slope);
}

// The least number of bits that holds all eight bytes of a row as signed numbers; 0 where all are
// 0.
unsigned width_of(std::uint64_t row) {
  if (row == 0) return 0;
  const std::uint64_t negative = (row >> 7 & kEachByte) * 255;
  std::uint64_t magnitude = row ^ negative;
  magnitude |= magnitude >> 32;
  magnitude |= magnitude >> 16;
  magnitude |= magnitude >> 8;
  return 1 + static_cast<unsigned>(std::bit_width(magnitude & 255));
}

// The low `width` bits of each byte, with the least signed number as 0, side by side.
std::uint64_t fields_of(std::uint64_t row, unsigned width) {
  const std::uint64_t mask = (std::uint64_t{1} << width) - 1,
                      bias = std::uint64_t{1} << (width - 1);
  constexpr std::uint64_t kTwos = 0x00ff00ff00ff00ffu, kFours = 0x0000ffff0000ffffu;
  std::uint64_t fields = (row & mask * kEachByte) ^ bias * kEachByte;
  fields = (fields & kTwos) | (fields >> 8 & kTwos) << width;
  fields = (fields & kFours) | (fields >> 16 & kFours) << 2 * width;
  return (fields & 0xffffffffu) | fields >> 32 << 4 * width;
}

void pad(std::vector<std::uint8_t>& bytes) {
  bytes.resize((bytes.size() + kPackedUnitBytes - 1) / kPackedUnitBytes * kPackedUnitBytes);
}

void pack_brick(const std::uint8_t* codes, std::vector<std::uint8_t>& bytes) {
  Rows rows = differences_of(codes);
  auto* const differences = reinterpret_cast<std::int8_t*>(rows.data());
  const auto base = static_cast<std::uint8_t>(differences[0]);
  differences[0] = 0;
  std::array<std::uint8_t, kMaxPackedDistancesBytes> packed{};
  packed[0] = base;
  packed[1] = take_slope(differences, 64);
  packed[2] = take_slope(differences, 8);
  packed[3] = take_slope(differences, 1);
  std::size_t at = 36;
  for (unsigned row = 0; row < 64; ++row) {
    const unsigned width = width_of(rows[row]);
    packed[4 + row / 2] = static_cast<std::uint8_t>(packed[4 + row / 2] | width << row % 2 * 4);
    if (width == 0) continue;
    const std::uint64_t fields = fields_of(rows[row], width);
    std::memcpy(packed.data() + at, &fields, 8);  // of which the last may be overwritten
    at += width;
  }
  bytes.insert(bytes.end(), packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(at));
}

void pack_brick(const std::uint16_t* numbers, std::vector<std::uint8_t>& bytes) {
  std::array<std::uint16_t, 16> palette{};
  std::size_t count = 0;
  for (std::size_t n = 0; n < 512 && count <= palette.size(); ++n) {
    const auto end = palette.begin() + static_cast<std::ptrdiff_t>(count);
    if (std::find(palette.begin(), end, numbers[n]) != end) continue;
    if (count < palette.size()) palette[count] = numbers[n];
    ++count;
  }
  const unsigned bits = count <= 2 ? 1 : count <= 4 ? 2 : count <= 16 ? 4 : 16;
  const auto add = [&](const void* data, std::size_t size) {
    const std::size_t at = bytes.size();
    bytes.resize(at + size);
    std::memcpy(bytes.data() + at, data, size);
  };
  const std::array<std::uint8_t, 2> head{static_cast<std::uint8_t>(bits), 0};
  add(head.data(), head.size());
  if (bits == 16) return add(numbers, 1024);
  const auto end = palette.begin() + static_cast<std::ptrdiff_t>(count);
  std::sort(palette.begin(), end);
  add(palette.data(), std::size_t{2} << bits);
  std::array<std::uint8_t, 256> indices{};
  for (std::size_t n = 0; n < 512; ++n) {
    const auto index =
        static_cast<unsigned>(std::find(palette.begin(), end, numbers[n]) - palette.begin());
    const std::size_t bit = n * bits;
    indices[bit / 8] = static_cast<std::uint8_t>(indices[bit / 8] | index << bit % 8);
  }
  add(indices.data(), std::size_t{64} * bits);
}

template <typename Element>
PackedBricks packed(std::span<const Element> elements, std::uint32_t max_bytes) {
  PackedBricks result;
  const std::size_t bricks = elements.size() / 512;
  result.units.reserve(bricks);
  for (std::size_t n = 0; n < bricks; ++n) {
    result.units.push_back(static_cast<std::uint32_t>(result.bytes.size() / kPackedUnitBytes));
    pack_brick(elements.data() + 512 * n, result.bytes);
    pad(result.bytes);
  }
  if (bricks > 0) {
    const std::size_t smallest = std::size_t{result.units.back()} * kPackedUnitBytes + max_bytes;
    result.bytes.resize(std::max(result.bytes.size(), smallest));
  }
  return result;
}

}  // namespace

PackedBricks pack_distances(std::span<const std::uint8_t> codes) {
  return packed(codes, kMaxPackedDistancesBytes);
}

PackedBricks pack_objects(std::span<const std::uint16_t> numbers) {
  return packed(numbers, kMaxPackedObjectsBytes);
}

}  // namespace forcelayer
