// Fields and points of a .pshell that lie, under right checksums.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/support/damaged_fields.h"
#include "tests/support/golden_content.h"

namespace forcelayer::testing {
namespace {

constexpr float kFloatNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kFloatInfinity = std::numeric_limits<float>::infinity();

AlignedBytes shell_bytes() { return golden_file_bytes("v2.pshell"); }

template <typename T>
void expect_refused(std::size_t offset, T value, const char* field) {
  expect_refused<Pshell>(shell_bytes(), offset, value, field);
}

#define AT(field) offsetof(PshellHeader, field)

TEST(PshellFields, Counts) {
  for (const std::uint64_t wrong : {std::uint64_t{0}, kMaxShellPoints + 1, ~std::uint64_t{0}}) {
    expect_refused(AT(point_count), wrong, "point_count");
  }
  expect_refused(AT(point_count), std::uint64_t{64}, "block_count");
  expect_refused(AT(point_count), std::uint64_t{129}, "block_count");
  for (const std::uint32_t wrong : {0u, 8u, 63u, 4112u, ~0u}) {
    expect_refused(AT(block_points), wrong, "block_points");
  }
  expect_refused(AT(block_points), 128u, "block_count");
  expect_refused(AT(super_block_blocks), 0u, "super_block_blocks");
  expect_refused(AT(super_block_blocks), 4097u, "super_block_blocks");
  expect_refused(AT(super_block_blocks), 2u, "super_block_count");
  expect_refused(AT(block_count), ~std::uint64_t{0}, "block_count");
  expect_refused(AT(super_block_count), std::uint64_t{0}, "super_block_count");
}

TEST(PshellFields, Numbers) {
  for (const double wrong : {-1e-9, kInfinity, kNan}) {
    expect_refused(AT(covering_radius_m), wrong, "covering_radius_m");
    expect_refused(AT(convex_radius_m), wrong, "convex_radius_m");
    expect_refused(AT(convex_gap_m), wrong, "convex_gap_m");
    expect_refused(AT(bounding_radius_m), wrong, "bounding_radius_m");
    expect_refused(AT(part_deviation_m), wrong, "part_deviation_m");
    expect_refused(AT(area_m2), wrong, "area_m2");
    expect_refused(AT(inertia_m2) + 16, wrong, "inertia_m2");
    expect_refused(AT(voxel_size_m), wrong, "voxel_size_m");
  }
  expect_refused(AT(voxel_size_m), 0.0, "voxel_size_m");
  expect_refused(AT(bounding_radius_m), 0.0025 * ((1 << 20) + 1), "bounding_radius_m");
  for (const double wrong : {kInfinity, kNan}) {
    expect_refused(AT(center_m) + 8, wrong, "center_m");
    expect_refused(AT(inertia_m2) + 40, wrong, "inertia_m2");
  }
  for (const double wrong : {1.0, -1.0, kNan}) expect_refused(AT(volume_m3), wrong, "volume_m3");
  expect_refused(AT(mass_source), 0u, "volume_m3");
  expect_refused(AT(mass_source), 2u, "mass_source");
  expect_refused(AT(method), 2u, "method");
  expect_refused(AT(reserved) + 7, std::uint8_t{1}, "reserved");
}

#undef AT

std::size_t element(const AlignedBytes& bytes, PshellSection section, std::size_t index,
                    std::size_t element_bytes = 4) {
  return section_offset(bytes.bytes(), static_cast<std::uint32_t>(section)) + element_bytes * index;
}

void expect_bad_element(PshellSection section, std::size_t index, float value,
                        const std::string& where) {
  SCOPED_TRACE(where + " = " + std::to_string(value));
  AlignedBytes bytes = shell_bytes();
  const auto shell = open_with<Pshell>(bytes, element(bytes, section, index), value);
  ASSERT_FALSE(shell);
  EXPECT_EQ(shell.error().code, ErrorCode::kEntryInvalid);
  EXPECT_EQ(shell.error().where, where) << to_line(shell.error());
}

TEST(PshellElements, Points) {
  for (const float wrong : {kFloatNan, kFloatInfinity, 3e38f, 1.0f}) {
    expect_bad_element(PshellSection::kPositionX, 0, wrong, "x, y, z entry 0");
    expect_bad_element(PshellSection::kPositionY, 63, wrong, "x, y, z entry 63");
    expect_bad_element(PshellSection::kPositionZ, 99, wrong, "x, y, z entry 99");
  }
}

TEST(PshellElements, Normals) {
  for (const float wrong : {kFloatNan, kFloatInfinity, 0.5f, 2.0f}) {
    expect_bad_element(PshellSection::kNormalX, 1, wrong, "normals entry 1");
    expect_bad_element(PshellSection::kNormalZ, 98, wrong, "normals entry 98");
  }
}

// Their squared length is within 2e-6 of 1 (section 3 of the format); a float is as near as 1e-7.
TEST(PshellElements, LengthsOfNormals) {
  for (const double squared : {1 - 3e-6, 1 - 1e-6, 1 + 1e-6, 1 + 3e-6}) {
    SCOPED_TRACE(squared);
    AlignedBytes bytes = shell_bytes();
    write_at(bytes.bytes(), element(bytes, PshellSection::kNormalY, 7), 0.0f);
    write_at(bytes.bytes(), element(bytes, PshellSection::kNormalZ, 7), 0.0f);
    const auto shell = open_with<Pshell>(bytes, element(bytes, PshellSection::kNormalX, 7),
                                         static_cast<float>(std::sqrt(squared)));
    EXPECT_EQ(shell.ok(), std::abs(squared - 1) < 2e-6);
  }
}

TEST(PshellElements, WeightsAndCones) {
  for (const float wrong : {kFloatNan, kFloatInfinity, -1e-9f}) {
    expect_bad_element(PshellSection::kWeight, 5, wrong, "weight entry 5");
  }
  for (const float wrong : {kFloatNan, -1.5f, 1.01f}) {
    expect_bad_element(PshellSection::kNormalCones, 5, wrong, "normal cones entry 5");
  }
}

// A shell without any area would have no mean to share force by.
TEST(PshellElements, WeightsThatAreAllZero) {
  AlignedBytes bytes = shell_bytes();
  for (std::size_t i = 0; i < 100; ++i) {
    write_at(bytes.bytes(), element(bytes, PshellSection::kWeight, i), 0.0f);
  }
  resign(bytes.bytes());
  const auto shell = Pshell::from_bytes(bytes.bytes(), "part.pshell");
  ASSERT_FALSE(shell);
  EXPECT_EQ(shell.error().code, ErrorCode::kEntryInvalid);
  EXPECT_EQ(shell.error().where, "weight entry 0");
}

TEST(PshellElements, Padding) {
  expect_bad_element(PshellSection::kPositionX, 100, 0.25f, "point sections entry 100");
  expect_bad_element(PshellSection::kNormalY, 127, 0.25f, "point sections entry 127");
  expect_bad_element(PshellSection::kWeight, 110, 1e-9f, "point sections entry 110");
  expect_bad_element(PshellSection::kWeight, 110, -0.0f, "point sections entry 110");
}

TEST(PshellElements, Spheres) {
  for (std::size_t index = 0; index < 2; ++index) {
    for (std::size_t part = 0; part < 4; ++part) {
      for (const float wrong : {kFloatNan, kFloatInfinity, -0.5f}) {
        const std::string number = std::to_string(index);
        expect_bad_element(PshellSection::kBlocks, 4 * index + part, wrong,
                           "blocks entry " + number);
        expect_bad_element(PshellSection::kSuperBlocks, 4 * index + part, wrong,
                           "super-blocks entry " + number);
      }
    }
  }
}

// The golden table is (2, 1.5), (4, 0.75), (8, 0.5) mm.
TEST(PshellElements, Losses) {
  const auto expect_bad_loss = [](std::size_t number, double value, const std::string& where) {
    SCOPED_TRACE(std::to_string(number) + " = " + std::to_string(value));
    AlignedBytes bytes = shell_bytes();
    const auto shell =
        open_with<Pshell>(bytes, element(bytes, PshellSection::kLosses, number, 8), value);
    ASSERT_FALSE(shell);
    EXPECT_EQ(shell.error().code, ErrorCode::kEntryInvalid);
    EXPECT_EQ(shell.error().where, where) << to_line(shell.error());
  };
  for (const double wrong : {kNan, kInfinity, -1.0, 0.001}) {
    expect_bad_loss(0, wrong, "losses entry 0");  // a distance below the loss
  }
  for (const double wrong : {kNan, kInfinity, -1e-9, 0.0021}) {
    expect_bad_loss(1, wrong, "losses entry 0");
  }
  expect_bad_loss(2, 0.002, "losses entry 1");   // as near as the entry before
  expect_bad_loss(3, 0.0016, "losses entry 1");  // a larger loss, farther away
  expect_bad_loss(5, 0.0008, "losses entry 2");
}

TEST(PshellElements, TooManyLosses) {
  const auto [points, normals] = golden_points();
  for (const std::size_t count : {kMaxLosses, kMaxLosses + 1}) {
    TestShellOptions options = golden_shell_options();
    options.losses.clear();
    for (std::size_t n = 0; n < count; ++n) {
      options.losses.push_back({0.002 + 0.001 * static_cast<double>(n), 0.001});
    }
    const AlignedBytes bytes(pshell_bytes(TestShell(points, normals, options).content()));
    const auto shell = Pshell::from_bytes(bytes.bytes(), "part.pshell");
    EXPECT_EQ(shell.ok(), count == kMaxLosses);
    if (!shell) {
      EXPECT_EQ(shell.error().where, "losses");
    }
  }
}

// The next smaller radius that a float can hold no longer holds the farthest point.
TEST(PshellElements, SpheresThatJustMissAPoint) {
  const AlignedBytes whole = shell_bytes();
  const auto shell = Pshell::from_bytes(whole.bytes(), "part.pshell");
  ASSERT_TRUE(shell);
  const PshellView& v = shell->view();
  const BoundingSphere sphere = v.blocks[0];
  double farthest = 0;
  for (std::size_t i = 0; i < v.block_points; ++i) {
    const double dx = double{v.x[i]} - sphere.x, dy = double{v.y[i]} - sphere.y,
                 dz = double{v.z[i]} - sphere.z;
    farthest = std::max(farthest, dx * dx + dy * dy + dz * dz);
  }
  auto radius = static_cast<float>(std::sqrt(farthest));
  while (double{radius} * radius >= farthest) radius = std::nextafter(radius, 0.0f);
  expect_bad_element(PshellSection::kBlocks, 3, radius, "blocks entry 0");
  AlignedBytes bytes = shell_bytes();
  EXPECT_TRUE(open_with<Pshell>(bytes, element(bytes, PshellSection::kBlocks, 3),
                                std::nextafter(radius, 1.0f)));
}

TEST(PshellCorruption, IsRefusedOrHarmless) {
  const AlignedBytes whole = shell_bytes();
  int accepted = 0, refused = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    AlignedBytes bytes(whole.bytes());
    const std::size_t limit = seed % 2 ? bytes.bytes().size() : 700;
    for (std::uint64_t place = 0; place <= random() % 3; ++place) {
      const std::size_t at = 64 + random() % (limit - 64);
      bytes.bytes()[at] ^= static_cast<std::byte>(1u << (random() % 8));
    }
    resign(bytes.bytes());
    const auto shell =
        Pshell::from_bytes(bytes.bytes(), "part.pshell", Verify::kStructureAndChecksums);
    if (!shell) {
      EXPECT_EQ(exit_status(shell.error().code), 4);
      EXPECT_FALSE(shell.error().where.empty());
      ++refused;
      continue;
    }
    const PshellView& v = shell->view();
    double sum = 0;
    for (std::size_t i = 0; i < v.block_count * v.block_points; ++i) {
      sum += v.x[i] + v.y[i] + v.z[i] + v.nx[i] + v.ny[i] + v.nz[i] + v.weight_m2[i];
      if (v.cone_cos) sum += v.cone_cos[i];
    }
    for (std::size_t i = 0; i < v.block_count; ++i) sum += v.blocks[i].radius;
    EXPECT_TRUE(std::isfinite(sum));
    ++accepted;
  }
  EXPECT_GT(accepted, 50);
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace forcelayer::testing
