// Fields and tree entries of a .vox that lie, under right checksums.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "formats/voxmap_walk.h"
#include "tests/support/damaged_fields.h"
#include "tests/support/golden_content.h"

namespace forcelayer::testing {
namespace {

AlignedBytes scene_bytes() { return golden_file_bytes("v1.vox"); }

AlignedBytes wide_scene_bytes() { return golden_file_bytes("v1_wide.vox"); }

template <typename T>
void expect_refused(AlignedBytes (*make)(), std::size_t offset, T value, const char* field) {
  expect_refused<Voxmap>(make(), offset, value, field);
}

#define AT(field) offsetof(VoxmapHeader, field)

TEST(VoxmapFields, Lengths) {
  for (const double wrong : {0.0, -0.005, 1e-10, 1e7, kInfinity, -kInfinity, kNan}) {
    expect_refused(scene_bytes, AT(voxel_size_m), wrong, "voxel_size_m");
  }
  for (const double wrong : {-1e-9, kInfinity, kNan}) {
    expect_refused(scene_bytes, AT(static_deviation_m), wrong, "static_deviation_m");
  }
}

TEST(VoxmapFields, TightBox) {
  expect_refused(scene_bytes, AT(origin_voxel), std::int64_t{-1025}, "origin_voxel");
  expect_refused(scene_bytes, AT(origin_voxel), std::int64_t{INT64_MIN}, "origin_voxel");
  expect_refused(scene_bytes, AT(origin_voxel), std::int64_t{INT64_MAX}, "origin_voxel");
  expect_refused(scene_bytes, AT(dims_voxels), std::uint64_t{0}, "dims_voxels");
  expect_refused(scene_bytes, AT(dims_voxels) + 8, std::uint64_t{513}, "dims_voxels");
  expect_refused(scene_bytes, AT(dims_voxels) + 16, ~std::uint64_t{0}, "dims_voxels");
}

TEST(VoxmapFields, ValidBox) {
  expect_refused(scene_bytes, AT(valid_min_voxel), std::int64_t{-513}, "valid_min_voxel");
  expect_refused(scene_bytes, AT(valid_min_voxel), std::int64_t{INT64_MIN}, "valid_min_voxel");
  expect_refused(scene_bytes, AT(valid_max_voxel), std::int64_t{-431}, "valid_max_voxel");
  expect_refused(scene_bytes, AT(valid_max_voxel) + 8, std::int64_t{-200}, "valid_max_voxel");
  expect_refused(scene_bytes, AT(valid_max_voxel), std::int64_t{INT64_MAX}, "valid_max_voxel");
  expect_refused(scene_bytes, AT(cropped_sides), std::uint32_t{64}, "cropped_sides");
}

TEST(VoxmapFields, Enumerations) {
  expect_refused(scene_bytes, AT(offset_layers), std::uint32_t{65536}, "offset_layers");
  expect_refused(scene_bytes, AT(metric), std::uint32_t{2}, "metric");
  for (const std::uint32_t wrong : {0u, 1u, 3u, 16u, 32u, ~0u}) {
    expect_refused(scene_bytes, AT(bits_per_voxel), wrong, "bits_per_voxel");
  }
}

TEST(VoxmapFields, Directory) {
  expect_refused(scene_bytes, AT(directory_origin), std::int64_t{-1023}, "directory_origin");
  expect_refused(scene_bytes, AT(directory_origin), std::int64_t{INT64_MIN}, "directory_origin");
  expect_refused(scene_bytes, AT(directory_origin), kMaxVoxelIndex + 512, "directory_origin");
  expect_refused(scene_bytes, AT(directory_dims), std::uint32_t{0}, "directory_dims");
  expect_refused(scene_bytes, AT(directory_dims), kMaxDirectoryDim + 1, "directory_dims");
  // 2^21 * 2^21 entries: each axis is in range, the product is not.
  expect_refused(scene_bytes, AT(directory_dims),
                 std::uint64_t{kMaxDirectoryDim} << 32 | kMaxDirectoryDim, "directory_dims");
  expect_refused(scene_bytes, AT(directory_dims), ~0u, "directory_dims");
  expect_refused(scene_bytes, AT(reserved0), 1u, "reserved");
}

TEST(VoxmapFields, DirectoryThatDoesNotFitItsSection) {
  AlignedBytes bytes = scene_bytes();
  const auto map = open_with<Voxmap>(bytes, AT(directory_dims) + 4, 2u);
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().code, ErrorCode::kSectionInvalid);
  EXPECT_EQ(map.error().where, "directory");
}

TEST(VoxmapFields, Counts) {
  const std::uint64_t volume = 84 * 70 * 72;
  expect_refused(scene_bytes, AT(interior_voxels), volume, "surface_voxels");
  expect_refused(scene_bytes, AT(interior_voxels), volume + 1, "interior_voxels");
  expect_refused(scene_bytes, AT(proximity_voxels), ~std::uint64_t{0}, "proximity_voxels");
}

TEST(VoxmapFields, CodesAtTwoBits) {
  expect_refused(scene_bytes, AT(range_m), 0.1, "range_m");
  expect_refused(scene_bytes, AT(quantum_m), 0.1, "quantum_m");
  for (const std::size_t at :
       {AT(zero_code), AT(surface_code), AT(proximity_code), AT(free_code)}) {
    expect_refused(scene_bytes, at, 1u, "thresholds");
  }
}

TEST(VoxmapFields, CodesAtFourBits) {
  for (const double wrong : {0.0, -1.0, kInfinity, kNan}) {
    expect_refused(wide_scene_bytes, AT(range_m), wrong, "range_m");
    expect_refused(wide_scene_bytes, AT(quantum_m), wrong, "quantum_m");
  }
  expect_refused(wide_scene_bytes, AT(quantum_m), 0.005, "quantum_m");
  expect_refused(wide_scene_bytes, AT(zero_code), 16u, "zero_code");
  expect_refused(wide_scene_bytes, AT(surface_code), 0u, "surface_code");
  expect_refused(wide_scene_bytes, AT(surface_code), 8u, "proximity_code");
  expect_refused(wide_scene_bytes, AT(proximity_code), 11u, "free_code");
  expect_refused(wide_scene_bytes, AT(free_code), 16u, "free_code");
}

#undef AT

// An entry that must be refused, with section and number in the message.
void expect_bad_entry(AlignedBytes (*make)(), VoxmapSection section, std::size_t index,
                      std::uint32_t entry, const std::string& where) {
  SCOPED_TRACE(where + " = " + std::to_string(entry));
  AlignedBytes bytes = make();
  const std::size_t at = section_offset(bytes.bytes(), static_cast<std::uint32_t>(section));
  const auto map = open_with<Voxmap>(bytes, at + 4 * index, entry);
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().code, ErrorCode::kEntryInvalid);
  EXPECT_EQ(map.error().where, where + " entry " + std::to_string(index));
}

TEST(VoxmapEntries, ChildrenOutOfRangeAtEveryLevel) {
  const AlignedBytes bytes = scene_bytes();
  const auto map = Voxmap::from_bytes(bytes.bytes(), "scene.vox");
  ASSERT_TRUE(map);
  struct Level {
    VoxmapSection section;
    const char* name;
    std::uint64_t entries, children;
  };
  const Level levels[] = {{VoxmapSection::kDirectory, "directory", 4, map->upper_node_count()},
                          {VoxmapSection::kUpperNodes, "upper nodes", 512 * map->upper_node_count(),
                           map->lower_node_count()},
                          {VoxmapSection::kLowerNodes, "lower nodes", 512 * map->lower_node_count(),
                           map->brick_count()}};
  for (const Level& level : levels) {
    for (const std::uint64_t index : {std::uint64_t{0}, level.entries / 2, level.entries - 1}) {
      for (const std::uint64_t child :
           {level.children, level.children + 1, std::uint64_t{0x7fffffff}}) {
        expect_bad_entry(scene_bytes, level.section, index, static_cast<std::uint32_t>(child),
                         level.name);
      }
    }
  }
}

TEST(VoxmapEntries, ValuesAndReservedBits) {
  for (const std::uint32_t entry : {uniform_entry(4), uniform_entry(255), uniform_entry(1, 1),
                                    uniform_entry(2, 5), uniform_entry(3, kMaxClearance)}) {
    expect_bad_entry(scene_bytes, VoxmapSection::kDirectory, 0, entry, "directory");
    expect_bad_entry(scene_bytes, VoxmapSection::kUpperNodes, 511, entry, "upper nodes");
    expect_bad_entry(scene_bytes, VoxmapSection::kLowerNodes, 7, entry, "lower nodes");
  }
  for (const std::uint32_t entry : {uniform_entry(16), uniform_entry(10, 1), uniform_entry(0, 1)}) {
    expect_bad_entry(wide_scene_bytes, VoxmapSection::kLowerNodes, 7, entry, "lower nodes");
  }
  AlignedBytes bytes = wide_scene_bytes();
  const std::size_t lower =
      section_offset(bytes.bytes(), static_cast<std::uint32_t>(VoxmapSection::kLowerNodes));
  EXPECT_TRUE(open_with<Voxmap>(bytes, lower + 28, uniform_entry(11, 9)));
}

TEST(VoxmapEntries, Compliance) {
  AlignedBytes (*const make)() = wide_scene_bytes;
  for (const float wrong : {-1.0f, 0.1f, std::numeric_limits<float>::infinity(),
                            std::numeric_limits<float>::quiet_NaN()}) {
    AlignedBytes bytes = make();
    const std::size_t at =
        section_offset(bytes.bytes(), static_cast<std::uint32_t>(VoxmapSection::kCompliance));
    const auto map = open_with<Voxmap>(bytes, at + 8, wrong);
    ASSERT_FALSE(map);
    EXPECT_EQ(map.error().where, "compliance entry 2");
  }
}

Result<Voxmap> with_compliance(const std::vector<float>& forces, double quantum_m = 0.0005) {
  const GoldenWideVoxmap golden;
  VoxmapContent content = golden.content();
  content.header.quantum_m = quantum_m;
  content.compliance = forces;
  const AlignedBytes bytes(voxmap_bytes(content));
  return Voxmap::from_bytes(bytes.bytes(), "scene.vox", Verify::kStructureAndChecksums);
}

TEST(VoxmapEntries, ComplianceIsBounded) {
  ASSERT_TRUE(with_compliance({0, 0, 1e6f, 1e6f, 1e6f}));
  ASSERT_TRUE(with_compliance({0, 1}, 1e-12));
  const struct {
    std::vector<float> forces;
    const char* where;
    double quantum_m = 0.0005;
  } cases[] = {{{0.5f, 1}, "compliance entry 0"},
               {{0, 1, 1.1e6f}, "compliance entry 2"},
               {{0, 1}, "compliance entry 1", 0.9e-12},  // above 1e12 N/m
               {{0}, "compliance"},
               {{0, 0, 0}, "compliance"},
               {{0, 1, 2, 3, 4, 5}, "compliance"}};  // deeper than code 0
  for (const auto& c : cases) {
    const auto map = with_compliance(c.forces, c.quantum_m);
    ASSERT_FALSE(map) << c.where << " of " << c.forces.size();
    EXPECT_EQ(map.error().where, c.where);
    EXPECT_EQ(exit_status(map.error().code), 4);
  }
}

TEST(VoxmapEntries, ComplianceNeedsDepth) {
  DenseVoxels voxels({0, 0, 0}, {8, 8, 8}, 0.001);
  voxels.set(3, 3, 3, VoxelValue::kSurface);
  const DenseTree tree(voxels, {});
  VoxmapContent content = tree.content();
  const std::vector<float> forces{0, 1};
  content.compliance = forces;
  const AlignedBytes bytes(voxmap_bytes(content));
  const auto map = Voxmap::from_bytes(bytes.bytes(), "scene.vox");
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().where, "compliance");
}

// A map that the reader accepted must be safe to look into, whatever it says.
void look_around(const Voxmap& map, std::mt19937_64& random) {
  const VoxmapView& view = map.view();
  const VoxmapHeader& h = map.header();
  std::uint64_t sum = 0;
  for (int probe = 0; probe < 64; ++probe) {
    std::array<std::int64_t, 3> world{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::uint64_t extent = std::uint64_t{h.directory_dims[axis]} * kUpperNodeEdge + 16;
      world[axis] = h.directory_origin[axis] - 8 + static_cast<std::int64_t>(random() % extent);
    }
    sum += static_cast<std::uint64_t>(map.value(world[0], world[1], world[2]));
    const std::int32_t x = static_cast<std::int32_t>(world[0] - view.directory_origin[0]),
                       y = static_cast<std::int32_t>(world[1] - view.directory_origin[1]),
                       z = static_cast<std::int32_t>(world[2] - view.directory_origin[2]);
    if (view.contains(x, y, z)) sum += view.lookup(x, y, z).clearance;
  }
  for (const float force : map.compliance()) sum += force > 0;
  for (const char c : map.provenance()) sum += static_cast<unsigned char>(c);
  EXPECT_LT(sum, std::uint64_t{1} << 40);
}

// Overwrites a few random places with random bytes, words or extreme numbers.
void corrupt(std::span<std::byte> bytes, std::size_t limit, std::mt19937_64& random) {
  constexpr std::uint32_t kWords[] = {0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 0x7ff00000};
  const int places = 1 + static_cast<int>(random() % 4);
  for (int place = 0; place < places; ++place) {
    const std::size_t at = random() % (limit - 4);
    switch (random() % 3) {
      case 0:
        bytes[at] ^= static_cast<std::byte>(1u << (random() % 8));
        break;
      case 1:
        write_at(bytes, at / 4 * 4, kWords[random() % std::size(kWords)]);
        break;
      default:
        write_at(bytes, at / 4 * 4, static_cast<std::uint32_t>(random() % 2048));
    }
  }
}

TEST(VoxmapCorruption, IsRefusedOrHarmless) {
  int accepted = 0, refused = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    AlignedBytes bytes = seed % 3 == 0 ? wide_scene_bytes() : scene_bytes();
    // Half of the damage goes to header and table, where it is most telling.
    const std::size_t limit = seed % 2 ? bytes.bytes().size() : 600;
    corrupt(bytes.bytes().subspan(64), limit - 64, random);
    resign(bytes.bytes());
    const auto map = Voxmap::from_bytes(bytes.bytes(), "scene.vox", Verify::kStructureAndChecksums);
    if (!map) {
      EXPECT_EQ(exit_status(map.error().code), 4);
      EXPECT_FALSE(map.error().where.empty());
      ++refused;
      continue;
    }
    look_around(*map, random);
    ++accepted;
  }
  EXPECT_GT(accepted, 100);
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace forcelayer::testing
