#include <algorithm>
#include <array>
#include <cstring>

#include "formats/bricks/packed_bricks.h"

namespace forcelayer {
namespace {

using Differences = std::array<std::int8_t, 512>;

// The difference of a code from the sum of those before it: along z, then y, then x, modulo 256.
Differences differences_of(const std::uint8_t* codes) {
  std::array<std::uint8_t, 512> sums;
  std::memcpy(sums.data(), codes, sums.size());
  for (std::size_t n = sums.size(); n-- > 64;) {
    sums[n] = static_cast<std::uint8_t>(sums[n] - sums[n - 64]);
  }
  for (std::size_t x = 0; x < 8; ++x) {
    std::uint8_t* slab = sums.data() + 64 * x;
    for (std::size_t n = 64; n-- > 8;) slab[n] = static_cast<std::uint8_t>(slab[n] - slab[n - 8]);
  }
  Differences differences;
  for (std::size_t n = 0; n < sums.size(); ++n) {
    differences[n] = static_cast<std::int8_t>(n % 8 == 0 ? sums[n] : sums[n] - sums[n - 1]);
  }
  return differences;
}

// Takes the middle one of seven differences along an edge off them.
std::uint8_t take_slope(Differences& differences, std::size_t step) {
  std::array<std::int8_t, 7> along;
  for (std::size_t n = 0; n < 7; ++n) along[n] = differences[(n + 1) * step];
  std::nth_element(along.begin(), along.begin() + 3, along.end());
  const std::int8_t slope = along[3];
  for (std::size_t n = 1; n < 8; ++n) {
    differences[n * step] = static_cast<std::int8_t>(differences[n * step] - slope);
  }
  return static_cast<std::uint8_t>(slope);
}

// The least number of bits that holds all eight as signed numbers; 0 where all are 0.
unsigned width_of(const std::int8_t* row) {
  unsigned magnitude = 0;
  bool any = false;
  for (std::size_t z = 0; z < 8; ++z) {
    magnitude |= static_cast<unsigned>(row[z] < 0 ? ~row[z] : row[z]);
    any |= row[z] != 0;
  }
  unsigned width = any ? 1 : 0;
  for (; magnitude != 0; magnitude >>= 1) ++width;
  return width;
}

void pad(std::vector<std::uint8_t>& bytes) {
  bytes.resize((bytes.size() + kPackedUnitBytes - 1) / kPackedUnitBytes * kPackedUnitBytes);
}

void pack_brick(const std::uint8_t* codes, std::vector<std::uint8_t>& bytes) {
  Differences differences = differences_of(codes);
  const auto base = static_cast<std::uint8_t>(differences[0]);
  differences[0] = 0;
  std::array<std::uint8_t, kMostPackedDistancesBytes> packed{};
  packed[0] = base;
  packed[1] = take_slope(differences, 64);
  packed[2] = take_slope(differences, 8);
  packed[3] = take_slope(differences, 1);
  std::size_t at = 36;
  for (unsigned row = 0; row < 64; ++row) {
    const std::int8_t* of_row = differences.data() + 8 * row;
    const unsigned width = width_of(of_row);
    packed[4 + row / 2] = static_cast<std::uint8_t>(packed[4 + row / 2] | width << row % 2 * 4);
    if (width == 0) continue;
    const unsigned bias = 1u << (width - 1);
    std::uint64_t fields = 0;
    for (unsigned z = 0; z < 8; ++z) {
      const unsigned field = (static_cast<unsigned>(of_row[z]) + bias) & 255u;
      fields |= std::uint64_t{field} << z * width;
    }
    std::memcpy(packed.data() + at, &fields, width);
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
PackedBricks packed(std::span<const Element> elements, std::uint32_t most_bytes) {
  PackedBricks result;
  const std::size_t bricks = elements.size() / 512;
  result.units.reserve(bricks);
  for (std::size_t n = 0; n < bricks; ++n) {
    result.units.push_back(static_cast<std::uint32_t>(result.bytes.size() / kPackedUnitBytes));
    pack_brick(elements.data() + 512 * n, result.bytes);
    pad(result.bytes);
  }
  if (bricks > 0) {
    const std::size_t least = std::size_t{result.units.back()} * kPackedUnitBytes + most_bytes;
    result.bytes.resize(std::max(result.bytes.size(), least));
  }
  return result;
}

}  // namespace

PackedBricks pack_distances(std::span<const std::uint8_t> codes) {
  return packed(codes, kMostPackedDistancesBytes);
}

PackedBricks pack_objects(std::span<const std::uint16_t> numbers) {
  return packed(numbers, kMostPackedObjectsBytes);
}

}  // namespace forcelayer
