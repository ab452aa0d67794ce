#include "formats/bricks/packed_bricks.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace forcelayer {
namespace {

static_assert(std::endian::native == std::endian::little, "the machine must be little-endian");

// A packed brick of distances: base, slopes along x, y and z; the widths of 64 rows, four bits
// each; the rows, as many bytes each as its width.
constexpr std::size_t kWidthsAt = 4, kRowsAt = 36;
constexpr std::uint64_t kEvenBytes = 0x00ff00ff00ff00ffu, kEachLane = 0x0001000100010001u;

unsigned width_of(const std::uint8_t* packed, unsigned row) {
  const unsigned width = packed[kWidthsAt + row / 2] >> row % 2 * 4 & 15u;
  return std::min(width, 8u);
}

// Eight numbers along z in lanes of 16 bits, those of even and those of odd z, modulo 256 each.
struct Lanes {
  std::uint64_t even = 0, odd = 0;

  void add(const Lanes& more) { even += more.even, odd += more.odd; }
};

// The eight differences of a row that begins at `bytes`, of which eight are read. At most 510 each.
Lanes row_of(const std::uint8_t* bytes, unsigned width) {
  std::uint64_t fields;
  std::memcpy(&fields, bytes, sizeof fields);
  // Fields of `width` bits, moved apart: fours, twos, ones.
  const std::uint64_t one = (std::uint64_t{1} << width) - 1,
                      two = (std::uint64_t{1} << 2 * width) - 1,
                      four = (std::uint64_t{1} << 4 * width) - 1;
  fields = (fields & four) | (fields >> 4 * width & four) << 32;
  const std::uint64_t twos = two | two << 32;
  fields = (fields & twos) | (fields >> 2 * width & twos) << 16;
  const std::uint64_t ones = one * kEachLane;
  const std::uint64_t bias = (256 - (std::uint64_t{1} << (width - 1))) * kEachLane;
  return {(fields & ones) + bias, (fields >> width & ones) + bias};
}

// The part of a row's differences that base and slopes make.
Lanes start_of(const std::uint8_t* packed, unsigned row) {
  if (row == 0) {
    const std::uint64_t slope = packed[3];
    return {packed[0] + slope * (kEachLane - 1), slope * kEachLane};
  }
  if (row % 8 == 0) return {packed[1], 0};
  if (row < 8) return {packed[2], 0};
  return {0, 0};
}

// The sums of the numbers up to each, as bytes.
std::uint64_t sums_along_z(const Lanes& row) {
  const std::uint64_t even = row.even * kEachLane, odd = row.odd * kEachLane;
  return ((even + (odd << 16)) & kEvenBytes) | ((even + odd) & kEvenBytes) << 8;
}

// Byte by byte.
std::uint64_t sum_of_bytes(std::uint64_t a, std::uint64_t b) {
  constexpr std::uint64_t kHighest = 0x8080808080808080u;
  return ((a & ~kHighest) + (b & ~kHighest)) ^ ((a ^ b) & kHighest);
}

// A packed brick of objects: bits of an index, zero, the palette, the indices; or 16, zero, and the
// numbers themselves.
constexpr std::size_t kPaletteAt = 2;
bool has_palette(unsigned bits) { return bits == 1 || bits == 2 || bits == 4; }
std::size_t indices_at(unsigned bits) { return kPaletteAt + (std::size_t{2} << bits); }

std::uint16_t number_at(const std::uint8_t* bytes) {
  std::uint16_t number;
  std::memcpy(&number, bytes, sizeof number);
  return number;
}

}  // namespace

void unpack_distances(const std::uint8_t* packed, BrickCodes& codes) noexcept {
  const std::uint8_t* next = packed + kRowsAt;
  for (unsigned x = 0; x < 8; ++x) {
    std::uint64_t sum = 0;
    for (unsigned y = 0; y < 8; ++y) {
      const unsigned row = 8 * x + y, width = width_of(packed, row);
      if (width > 0 || x == 0 || y == 0) {
        Lanes lanes = start_of(packed, row);
        if (width > 0) lanes.add(row_of(next, width));
        next += width;
        sum = sum_of_bytes(sum, sums_along_z(lanes));
      }
      std::memcpy(codes.data() + 8 * row, &sum, sizeof sum);
    }
  }
  for (std::size_t n = 64; n < codes.size(); ++n) {
    codes[n] = static_cast<std::uint8_t>(codes[n] + codes[n - 64]);
  }
}

std::uint8_t packed_distance(const std::uint8_t* packed, std::uint32_t n) noexcept {
  const unsigned x = n >> 6, y = n >> 3 & 7, z = n & 7;
  const std::uint8_t* next = packed + kRowsAt;
  Lanes sums;  // of at most 64 rows: below 2^16
  for (unsigned row = 0; row <= 8 * x + y; ++row) {
    const unsigned width = width_of(packed, row);
    if (row % 8 <= y) {
      sums.add(start_of(packed, row));
      if (width > 0) sums.add(row_of(next, width));
    }
    next += width;
  }
  sums.even &= kEvenBytes, sums.odd &= kEvenBytes;
  return static_cast<std::uint8_t>(sums_along_z(sums) >> 8 * z);
}

const char* packed_distances_fault(const std::uint8_t* packed) noexcept {
  for (std::size_t n = 0; n < 32; ++n) {
    const unsigned widths = packed[kWidthsAt + n];
    if ((widths & 15) > 8 || widths >> 4 > 8)
      return "has a row whose numbers have more than eight bits";
  }
  return nullptr;
}

std::uint16_t packed_object(const std::uint8_t* packed, std::uint32_t n) noexcept {
  const unsigned bits = packed[0];
  if (!has_palette(bits)) return number_at(packed + kPaletteAt + std::size_t{2} * n);
  const unsigned bit = n * bits;
  const unsigned index = packed[indices_at(bits) + bit / 8] >> bit % 8 & ((1u << bits) - 1);
  return number_at(packed + kPaletteAt + std::size_t{2} * index);
}

void unpack_objects(const std::uint8_t* packed, BrickNumbers& numbers) noexcept {
  for (std::uint32_t n = 0; n < numbers.size(); ++n) numbers[n] = packed_object(packed, n);
}

const char* packed_objects_fault(const std::uint8_t* packed, std::uint32_t object_count) noexcept {
  const unsigned bits = packed[0];
  if ((!has_palette(bits) && bits != 16) || packed[1] != 0)
    return "is not packed in 1, 2, 4 or 16 bits";
  const std::size_t count = bits == 16 ? 512 : std::size_t{1} << bits;
  for (std::size_t n = 0; n < count; ++n) {
    if (number_at(packed + kPaletteAt + 2 * n) > object_count)
      return "names an object that does not exist";
  }
  return nullptr;
}

}  // namespace forcelayer
