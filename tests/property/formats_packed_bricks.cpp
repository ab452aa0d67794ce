// Packed bricks of distances and objects: what was packed comes back, by the reader, element by
// element, and by the words of voxmap_format.md, section 5.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "formats/bricks/packed_bricks.h"

namespace forcelayer {
namespace {

std::uint64_t bits_at(const std::uint8_t* bytes, std::size_t first, std::size_t count) {
  std::uint64_t bits = 0;
  for (std::size_t n = 0; n < count; ++n) {
    bits |= std::uint64_t{bytes[(first + n) / 8] >> (first + n) % 8 & 1u} << n;
  }
  return bits;
}

// The code of a voxel as the specification says: the sum of the differences of all voxels that do
// not lie behind it along any axis.
int slow_code(const std::uint8_t* packed, int x, int y, int z) {
  int sum = packed[0] + packed[1] * x + packed[2] * y + packed[3] * z;
  std::size_t at = 36;
  for (int row = 0; row < 64; ++row) {
    const auto width = static_cast<int>(bits_at(packed + 4, static_cast<std::size_t>(4 * row), 4));
    const int in_x = row / 8, in_y = row % 8;
    for (int in_z = 0; in_z <= z && in_x <= x && in_y <= y && width > 0; ++in_z) {
      sum += static_cast<int>(bits_at(packed + at, static_cast<std::size_t>(in_z * width),
                                      static_cast<std::size_t>(width))) -
             (1 << (width - 1));
    }
    at += static_cast<std::size_t>(width);
  }
  return sum & 255;
}

int slow_number(const std::uint8_t* packed, std::size_t n) {
  const auto u16 = [&](std::size_t at) { return static_cast<int>(bits_at(packed + at, 0, 16)); };
  const std::size_t bits = packed[0];
  if (bits == 16) return u16(2 + 2 * n);
  const std::size_t palette_bytes = std::size_t{2} << bits;
  return u16(2 + 2 * bits_at(packed + 2 + palette_bytes, n * bits, bits));
}

// Codes as files hold them, and worse: a plane, a ball, two walls, noise of some width, steps; held
// to 0 and 255.
BrickCodes random_codes(std::mt19937& random) {
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  const unsigned kind = random() % 6, noise = 1u << random() % 9;
  const double at = real(-100, 400), slope[3] = {real(-32, 32), real(-32, 32), real(-32, 32)};
  const double center[3] = {real(-9, 17), real(-9, 17), real(-9, 17)};
  BrickCodes codes;
  for (int n = 0; n < 512; ++n) {
    const int v[3] = {n / 64, n / 8 % 8, n % 8};
    double code = at, squared = 0;
    for (int d = 0; d < 3; ++d) {
      code += slope[d] * v[d];
      squared += (v[d] - center[d]) * (v[d] - center[d]);
    }
    if (kind == 1) code = 32 * std::sqrt(squared);
    if (kind == 2) code = std::abs(code - 128);
    if (kind == 3) code += random() % noise;
    if (kind == 4) code = random() % noise * 255.0 / noise;
    if (kind == 5) code = at;
    codes[static_cast<std::size_t>(n)] = static_cast<std::uint8_t>(std::clamp(code, 0.0, 255.0));
  }
  return codes;
}

TEST(PackedBricks, DistancesComeBackByEveryReader) {
  std::mt19937 random(23);
  for (int round = 0; round < 300; ++round) {
    SCOPED_TRACE(round);
    std::vector<std::uint8_t> all;
    const std::size_t bricks = 1 + random() % 4;
    std::vector<BrickCodes> expected;
    for (std::size_t n = 0; n < bricks; ++n) {
      expected.push_back(random_codes(random));
      all.insert(all.end(), expected.back().begin(), expected.back().end());
    }
    const PackedBricks packed = pack_distances(all);
    ASSERT_EQ(packed.units.size(), bricks);
    ASSERT_EQ(packed.bytes.size() % kPackedUnitBytes, 0u);
    for (std::size_t b = 0; b < bricks; ++b) {
      const std::size_t begin = std::size_t{packed.units[b]} * kPackedUnitBytes;
      ASSERT_LE(begin + kMaxPackedDistancesBytes, packed.bytes.size());
      const std::uint8_t* const brick = packed.bytes.data() + begin;
      ASSERT_EQ(packed_distances_fault(brick), nullptr);
      BrickCodes codes;
      unpack_distances(brick, codes);
      ASSERT_EQ(codes, expected[b]);
      for (int n = 0; n < 512; ++n) {
        ASSERT_EQ(packed_distance(brick, static_cast<std::uint32_t>(n)),
                  codes[static_cast<std::size_t>(n)]);
        if (round < 100) {
          ASSERT_EQ(slow_code(brick, n / 64, n / 8 % 8, n % 8), codes[static_cast<std::size_t>(n)]);
        }
      }
    }
  }
}

TEST(PackedBricks, ObjectsComeBackByEveryReader) {
  std::mt19937 random(29);
  for (const std::uint32_t names : {1u, 2u, 3u, 4u, 5u, 15u, 16u, 17u, 300u, 512u}) {
    SCOPED_TRACE(names);
    std::vector<std::uint16_t> numbers(3 * 512);
    for (std::size_t n = 0; n < numbers.size(); ++n) {
      const std::uint32_t which =
          n % 512 < names ? static_cast<std::uint32_t>(n % 512) : random() % names;
      numbers[n] = static_cast<std::uint16_t>(which * 128 + n / 512);  // up to 65535
    }
    const PackedBricks packed = pack_objects(numbers);
    for (std::size_t b = 0; b < 3; ++b) {
      const std::size_t begin = std::size_t{packed.units[b]} * kPackedUnitBytes;
      ASSERT_LE(begin + kMaxPackedObjectsBytes, packed.bytes.size());
      const std::uint8_t* const brick = packed.bytes.data() + begin;
      BrickNumbers unpacked;
      unpack_objects(brick, unpacked);
      std::uint16_t largest = 0;
      for (std::size_t n = 0; n < 512; ++n) {
        ASSERT_EQ(unpacked[n], numbers[512 * b + n]);
        ASSERT_EQ(slow_number(brick, n), unpacked[n]);
        ASSERT_EQ(packed_object(brick, static_cast<std::uint32_t>(n)), unpacked[n]);
        largest = std::max(largest, unpacked[n]);
      }
      EXPECT_EQ(packed_objects_fault(brick, largest), nullptr);
      if (largest > 0) {
        EXPECT_NE(packed_objects_fault(brick, largest - 1u), nullptr);
      }
    }
  }
}

// A brick that is near to one plane takes a tenth of its codes, one with two names a twelfth of its
// numbers.
TEST(PackedBricks, PlainBricksAreSmall) {
  std::vector<std::uint8_t> codes(512);
  for (std::size_t n = 0; n < 512; ++n)
    codes[n] = static_cast<std::uint8_t>(100 + 20 * (n / 64) - 5 * (n % 8));
  EXPECT_LE(pack_distances(codes).bytes.size(), kMaxPackedDistancesBytes);
  codes.resize(1024);
  std::copy_n(codes.begin(), 512, codes.begin() + 512);
  EXPECT_EQ(pack_distances(codes).units[1] * kPackedUnitBytes, 48u);
  std::vector<std::uint16_t> numbers(1024, 3);
  for (std::size_t n = 0; n < 1024; n += 7) numbers[n] = 60000;
  EXPECT_EQ(pack_objects(numbers).units[1] * kPackedUnitBytes, 80u);
}

// Any bytes can be read: none beyond the most that a brick takes (the sanitizers' test).
TEST(PackedBricks, AnyBytesAreReadWithinBounds) {
  std::mt19937 random(31);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::uint8_t> distances(kMaxPackedDistancesBytes), objects(kMaxPackedObjectsBytes);
    for (std::uint8_t& byte : distances)
      byte = static_cast<std::uint8_t>(round % 2 != 0 ? 255 : random());
    for (std::uint8_t& byte : objects) byte = static_cast<std::uint8_t>(random());
    objects[0] = static_cast<std::uint8_t>(round % 20);
    BrickCodes codes;
    BrickNumbers numbers;
    unpack_distances(distances.data(), codes);
    unpack_objects(objects.data(), numbers);
    for (std::uint32_t n = 0; n < 512; ++n)
      ASSERT_EQ(packed_distance(distances.data(), n), codes[n]);
  }
}

}  // namespace
}  // namespace forcelayer
