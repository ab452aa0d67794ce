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

AlignedBytes scene_bytes() { return golden_file_bytes("v2.vox"); }

AlignedBytes distance_scene_bytes() { return golden_file_bytes("v2_distances.vox"); }

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
  expect_refused(scene_bytes, AT(dims_voxels) + 8, std::uint64_t{507}, "dims_voxels");
  expect_refused(scene_bytes, AT(dims_voxels) + 16, ~std::uint64_t{0}, "dims_voxels");
}

TEST(VoxmapFields, ValidBox) {
  expect_refused(scene_bytes, AT(valid_min_voxel), std::int64_t{-513}, "valid_min_voxel");
  expect_refused(scene_bytes, AT(valid_min_voxel), std::int64_t{INT64_MIN}, "valid_min_voxel");
  expect_refused(scene_bytes, AT(valid_max_voxel), std::int64_t{-468}, "valid_max_voxel");
  expect_refused(scene_bytes, AT(valid_max_voxel) + 8, std::int64_t{-200}, "valid_max_voxel");
  expect_refused(scene_bytes, AT(valid_max_voxel), std::int64_t{INT64_MAX}, "valid_max_voxel");
  expect_refused(scene_bytes, AT(cropped_sides), std::uint32_t{64}, "cropped_sides");
}

TEST(VoxmapFields, Enumerations) {
  expect_refused(scene_bytes, AT(offset_layers), std::uint32_t{65536}, "offset_layers");
  expect_refused(scene_bytes, AT(metric), std::uint32_t{2}, "metric");
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
  expect_refused(scene_bytes, AT(reserved1), 1u, "reserved");
}

TEST(VoxmapFields, DirectoryThatDoesNotFitItsSection) {
  AlignedBytes bytes = scene_bytes();
  const auto map = open_with<Voxmap>(bytes, AT(directory_dims) + 4, 2u);
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().code, ErrorCode::kSectionInvalid);
  EXPECT_EQ(map.error().where, "directory");
}

TEST(VoxmapFields, Counts) {
  const std::uint64_t volume = 47 * 37 * 37;
  expect_refused(scene_bytes, AT(interior_voxels), volume, "surface_voxels");
  expect_refused(scene_bytes, AT(interior_voxels), volume + 1, "interior_voxels");
  expect_refused(scene_bytes, AT(proximity_voxels), ~std::uint64_t{0}, "proximity_voxels");
}

TEST(VoxmapFields, LengthsOfTheMetric) {
  // v2.vox is Chebyshev and has none of them.
  for (const double wrong : {0.001, -0.001, kNan}) {
    expect_refused(scene_bytes, AT(zero_force_m), wrong, "zero_force_m");
    expect_refused(scene_bytes, AT(force_depth_m), wrong, "force_depth_m");
    expect_refused(scene_bytes, AT(distance_quantum_m), wrong, "distance_quantum_m");
  }
  expect_refused(scene_bytes, AT(metric), 1u, "zero_force_m");
  expect_refused(scene_bytes, AT(distance_zero_code), 1, "distance_zero_code");
  // v2_distances.vox is Euclidean.
  expect_refused(distance_scene_bytes, AT(metric), 0u, "zero_force_m");
  for (const double wrong : {0.0, -0.001, kInfinity, kNan}) {
    expect_refused(distance_scene_bytes, AT(zero_force_m), wrong, "zero_force_m");
    expect_refused(distance_scene_bytes, AT(force_depth_m), wrong, "force_depth_m");
  }
  expect_refused(distance_scene_bytes, AT(force_depth_m), 0.003, "force_depth_m");
  for (const double wrong : {-1e-9, 1.1 * kMaxVoxelSizeM, kInfinity, kNan}) {
    expect_refused(distance_scene_bytes, AT(distance_quantum_m), wrong, "distance_quantum_m");
  }
  for (const std::int32_t wrong : {0, -1, 255, INT32_MAX, INT32_MIN}) {
    expect_refused(distance_scene_bytes, AT(distance_zero_code), wrong, "distance_zero_code");
  }
}

AlignedBytes standoff_bytes() {
  AlignedBytes bytes = distance_scene_bytes();
  write_at(bytes.bytes(), AT(offset_layers), 0u);
  return bytes;
}

// Without layers the lengths tell where the interior ends; it holds all that the mesh passes
// through, and distances tell the rest.
TEST(VoxmapFields, Standoff) {
  AlignedBytes bytes = standoff_bytes();
  EXPECT_TRUE(open_with<Voxmap>(bytes, AT(zero_force_m), 0.001 * (1 + 888.0 / 1024)));
  expect_refused(standoff_bytes, AT(zero_force_m), 0.001 * (1 + 887.0 / 1024), "zero_force_m");
  expect_refused(standoff_bytes, AT(force_depth_m), 0.0021, "zero_force_m");
  const auto lean = [] {
    AlignedBytes made = golden_file_bytes("baked_lean.vox");
    return made;
  };
  expect_refused(+lean, AT(offset_layers), 0u, "offset_layers");
}

TEST(VoxmapFields, Objects) {
  for (const std::uint32_t wrong : {kMaxObjects + 1, ~0u}) {
    expect_refused(distance_scene_bytes, AT(object_count), wrong, "object_count");
  }
  // A header that counts other objects than the names, and trees that it does not announce.
  const struct {
    std::size_t offset;
    std::uint64_t value;  // of four bytes, or eight
    const char* where;
    const char* what;
  } cases[] = {{AT(object_count), 1, "object names", "has 2 names, but the header requires 1"},
               {AT(object_count), 3, "object names", "has 2 names, but the header requires 3"},
               {AT(object_count), 0, "object directory",
                "object_count is zero, so the file must not have this tree"},
               {AT(distance_quantum_m), 0, "distance directory",
                "distance_quantum_m is zero, so the file must not have this tree"}};
  for (const auto& c : cases) {
    AlignedBytes bytes = distance_scene_bytes();
    if (c.offset == AT(object_count)) {
      write_at(bytes.bytes(), c.offset, static_cast<std::uint32_t>(c.value));
    } else {
      write_at(bytes.bytes(), c.offset, c.value);
      write_at(bytes.bytes(), AT(distance_zero_code), 0);
    }
    const auto map = open_with<Voxmap>(bytes, 0, bytes.bytes()[0]);
    ASSERT_FALSE(map) << c.what;
    EXPECT_EQ(map.error().code, ErrorCode::kSectionInvalid);
    EXPECT_EQ(map.error().where, c.where);
    EXPECT_NE(map.error().what.find(c.what), std::string::npos) << to_line(map.error());
  }
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
  const Level levels[] = {{VoxmapSection::kDirectory, "directory", 2, map->upper_node_count()},
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
  // Codes up to 255, objects up to two, and nothing in bits 16 to 30.
  for (const std::uint32_t entry :
       {uniform_entry(256), uniform_entry(0xffff), uniform_entry(0) | 0x10000u,
        uniform_entry(255) | 0x40000000u}) {
    expect_bad_entry(distance_scene_bytes, VoxmapSection::kDistanceDirectory, 0, entry,
                     "distance directory");
    expect_bad_entry(distance_scene_bytes, VoxmapSection::kDistanceUpperNodes, 5, entry,
                     "distance upper nodes");
    expect_bad_entry(distance_scene_bytes, VoxmapSection::kDistanceLowerNodes, 511, entry,
                     "distance lower nodes");
  }
  for (const std::uint32_t entry : {uniform_entry(3), uniform_entry(0xffff),
                                    uniform_entry(0) | 0x10000u, uniform_entry(2) | 0x40000000u}) {
    expect_bad_entry(distance_scene_bytes, VoxmapSection::kObjectDirectory, 0, entry,
                     "object directory");
    expect_bad_entry(distance_scene_bytes, VoxmapSection::kObjectUpperNodes, 5, entry,
                     "object upper nodes");
    expect_bad_entry(distance_scene_bytes, VoxmapSection::kObjectLowerNodes, 511, entry,
                     "object lower nodes");
  }
}

TEST(VoxmapEntries, ChildrenOfTheOtherTrees) {
  const struct {
    VoxmapSection section;
    const char* name;
  } sections[] = {{VoxmapSection::kDistanceDirectory, "distance directory"},
                  {VoxmapSection::kDistanceUpperNodes, "distance upper nodes"},
                  {VoxmapSection::kDistanceLowerNodes, "distance lower nodes"},
                  {VoxmapSection::kObjectDirectory, "object directory"},
                  {VoxmapSection::kObjectUpperNodes, "object upper nodes"},
                  {VoxmapSection::kObjectLowerNodes, "object lower nodes"}};
  for (const auto& [section, name] : sections) {
    for (const std::uint32_t child : {1u, 0x7fffffffu}) {  // each has one child
      expect_bad_entry(distance_scene_bytes, section, 0, child, name);
    }
  }
}

// Opens v2_distances.vox with changed content.
template <typename Change>
Result<Voxmap> with_content(Change change) {
  const GoldenDistances golden;
  VoxmapContent content = golden.content();
  change(content);
  static AlignedBytes bytes;  // a map that opens points into it
  bytes = AlignedBytes(voxmap_bytes(content));
  return Voxmap::from_bytes(bytes.bytes(), "scene.vox", Verify::kStructureAndChecksums);
}

TEST(VoxmapSections, TreesOfAnotherShape) {
  const std::vector<std::uint32_t> two(2, uniform_entry(0));
  for (const auto part :
       {&VoxmapContent::values, &VoxmapContent::distances, &VoxmapContent::objects}) {
    const auto longer = with_content([&](VoxmapContent& c) { (c.*part).directory = two; });
    ASSERT_FALSE(longer);
    EXPECT_EQ(longer.error().code, ErrorCode::kSectionInvalid);
    EXPECT_EQ(longer.error().what, "has 2 entries, but the header requires 1");
    const auto missing = with_content([&](VoxmapContent& c) { (c.*part).directory = {}; });
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().what, "has 0 entries, but the header requires 1");
  }
}

// Sections of a tree without nodes or bricks may be absent.
TEST(VoxmapSections, UniformTreesNeedADirectoryAlone) {
  const std::vector<std::uint32_t> far{uniform_entry(255)}, none{uniform_entry(0)};
  const auto map = with_content([&](VoxmapContent& c) {
    c.distances = {far, {}, {}, {}};
    c.objects = {none, {}, {}, {}};
  });
  ASSERT_TRUE(map) << to_line(map.error());
  EXPECT_EQ(map->distance_counts().upper_nodes, 0u);
  EXPECT_EQ(map->min_distance_m(3, 3, 3), 128 * (0.001 / 32));
  EXPECT_EQ(map->nearest_object(3, 3, 3), 0u);
}

TEST(VoxmapSections, LeanFilesHaveTheSameBytesInSharedSections) {
  const GoldenDistances golden;
  VoxmapContent content = golden.content();
  const std::vector<std::byte> whole = voxmap_bytes(content);
  content.header.distance_quantum_m = 0;
  content.header.distance_zero_code = 0;
  content.header.object_count = 0;
  content.distances = content.objects = {};
  content.object_names = {};
  content.compliance = {};
  const std::vector<std::byte> lean = voxmap_bytes(content);
  for (const std::uint32_t id : {1u, 2u, 3u, 4u, 6u}) {
    const auto a = read_at<SectionEntry>(whole, table_entry_of(whole, id));
    const auto b = read_at<SectionEntry>(lean, table_entry_of(lean, id));
    EXPECT_EQ(a.bytes, b.bytes);
    EXPECT_EQ(a.checksum, b.checksum);
  }
}

TEST(VoxmapSections, Names) {
  const auto open = [](std::string_view names) {
    return with_content([&](VoxmapContent& c) { c.object_names = names; });
  };
  using namespace std::string_view_literals;
  const auto empty_names = open("\0\0"sv);
  ASSERT_TRUE(empty_names);
  EXPECT_EQ(empty_names->object_name(2), "");
  const struct {
    std::string_view names;
    const char* what;
  } cases[] = {{"left\0right"sv, "the last name has no end mark"},
               {""sv, "has 0 names, but the header requires 2"},
               {"left\0"sv, "has 1 names, but the header requires 2"},
               {"left\0right\0\0"sv, "has 3 names, but the header requires 2"}};
  for (const auto& c : cases) {
    const auto map = open(c.names);
    ASSERT_FALSE(map) << c.what;
    EXPECT_EQ(map.error().where, "object names");
    EXPECT_EQ(map.error().what, c.what);
    EXPECT_EQ(exit_status(map.error().code), 4);
  }
  const auto unannounced = with_content([](VoxmapContent& c) {
    c.header.object_count = 0;
    c.objects = {};
  });
  ASSERT_FALSE(unannounced);
  EXPECT_EQ(unannounced.error().what, "has 2 names, but the header requires 0");
}

TEST(VoxmapEntries, Compliance) {
  AlignedBytes (*const make)() = distance_scene_bytes;
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

Result<Voxmap> with_compliance(const std::vector<float>& pressures, double quantum_m = 0.001 / 32) {
  return with_content([&](VoxmapContent& c) {
    c.header.distance_quantum_m = quantum_m;
    c.compliance = pressures;
  });
}

TEST(VoxmapEntries, ComplianceIsBounded) {
  ASSERT_TRUE(with_compliance({0, 0, 1e3f, 1e9f, 1e9f}));
  ASSERT_TRUE(with_compliance({0, 1000}, 1e-12));
  std::vector<float> deepest(220, 1);  // 2.867 voxels and 128 steps
  deepest[0] = 0;
  ASSERT_TRUE(with_compliance(deepest));
  const struct {
    std::vector<float> pressures;
    const char* where;
    double quantum_m = 0.001 / 32;
  } cases[] = {{{0.5f, 1}, "compliance entry 0"},
               {{0, 1, 1.1e9f}, "compliance entry 2"},
               {{0, 1000}, "compliance entry 1", 0.9e-12},  // above 1e15 Pa/m
               {{0}, "compliance"},
               {{0, 0, 0}, "compliance"},
               {std::vector<float>(221, 0), "compliance"}};  // deeper than code 0
  for (const auto& c : cases) {
    const auto map = with_compliance(c.pressures, c.quantum_m);
    ASSERT_FALSE(map) << c.where << " of " << c.pressures.size();
    EXPECT_EQ(map.error().where, c.where);
    EXPECT_EQ(exit_status(map.error().code), 4);
  }
}

// Earlier programs wrote newtons into section 5, where a program of today could take them for
// pascals. Here the provenance, the section that follows, becomes that section.
TEST(VoxmapEntries, ComplianceInNewtonsIsToBeBakedAgain) {
  for (const std::size_t entries : {0u, 1u, 4u}) {
    const GoldenDistances golden;
    VoxmapContent content = golden.content();
    content.compliance = {};
    const std::string newtons(4 * entries, '\0');
    content.provenance = newtons.empty() ? content.provenance : std::string_view(newtons);
    AlignedBytes bytes(voxmap_bytes(content));
    const std::size_t at =
        table_entry_of(bytes.bytes(), static_cast<std::uint32_t>(VoxmapSection::kProvenance));
    if (entries > 0) {
      write_at(bytes.bytes(), at, static_cast<std::uint32_t>(VoxmapSection::kPointForces));
      write_at(bytes.bytes(), at + 4, std::uint32_t{sizeof(float)});
    }
    resign(bytes.bytes());
    const auto map = Voxmap::from_bytes(bytes.bytes(), "scene.vox", Verify::kStructureAndChecksums);
    ASSERT_EQ(static_cast<bool>(map), entries == 0) << entries;
    if (entries == 0) continue;
    EXPECT_EQ(map.error().where, "compliance");
    EXPECT_NE(map.error().what.find("newtons"), std::string::npos);
    EXPECT_NE(map.error().mend.find("bake the scene again"), std::string::npos);
    EXPECT_EQ(exit_status(map.error().code), 4);
  }
}

TEST(VoxmapEntries, ComplianceNeedsDistances) {
  DenseVoxels voxels({0, 0, 0}, {8, 8, 8}, 0.001);
  voxels.set(3, 3, 3, VoxelValue::kSurface);
  const DenseTree tree(voxels, {});
  VoxmapContent content = tree.content();
  const std::vector<float> pressures{0, 1};
  content.compliance = pressures;
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
    sum += map.object_name(map.nearest_object(world[0], world[1], world[2])).size();
    sum += map.min_distance_m(world[0], world[1], world[2]) > 0;
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
    AlignedBytes bytes = seed % 3 == 0 ? distance_scene_bytes() : scene_bytes();
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
