// The audit accepts the truth and notices every single untruth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "formats/audit/layer_distance.h"
#include "formats/audit/voxmap_audit.h"
#include "tests/support/distance_scene.h"
#include "tests/support/file_surgery.h"
#include "tests/support/golden_content.h"
#include "tests/support/sanitized.h"

namespace forcelayer::testing {
namespace {

constexpr std::uint64_t kFraction =
    test::kSanitized ? 6 : 1;       // of the seeds: such an audit takes 20 times as long
constexpr std::int64_t kEdge = 48;  // of the scenes, voxels

// Interior boxes at random with their layers, anywhere beside the faces of nodes.
DenseVoxels random_scene(std::mt19937_64& random) {
  const VoxelIndex lowest{static_cast<std::int64_t>(random() % 1100) - 600, -20, 490};
  DenseVoxels voxels(lowest, {kEdge, kEdge, kEdge}, 0.001);
  std::vector<VoxelBox> solids;
  for (int box = 0; box < 4; ++box) {
    VoxelBox solid;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      solid.low[axis] = lowest[axis] + 2 + static_cast<std::int64_t>(random() % (kEdge - 4));
      solid.high[axis] = std::min(lowest[axis] + kEdge - 2,
                                  solid.low[axis] + 1 + static_cast<std::int64_t>(random() % 20));
    }
    solids.push_back(solid);
  }
  for (const int layer : {2, 1, 0}) {
    constexpr VoxelValue kValues[] = {VoxelValue::kInterior, VoxelValue::kSurface,
                                      VoxelValue::kProximity};
    for (const VoxelBox& solid : solids) {
      VoxelBox grown = solid;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        grown.low[axis] -= layer;
        grown.high[axis] += layer;
      }
      voxels.fill(grown.low, grown.high, kValues[layer]);
    }
  }
  return voxels;
}

VoxelIndex random_voxel(const VoxelBox& box, std::mt19937_64& random) {
  VoxelIndex at{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    at[axis] =
        box.low[axis] + static_cast<std::int64_t>(
                            random() % static_cast<std::uint64_t>(box.high[axis] - box.low[axis]));
  }
  return at;
}

DenseVoxmapOptions random_options(std::mt19937_64& random, const DenseVoxels& voxels) {
  DenseVoxmapOptions options;
  options.offset_layers = 1;  // the boxes are as narrow as they come
  options.clearances = true;
  options.share_equal_nodes = random() % 2;
  options.collapse_uniform = random() % 2;
  options.cropped_sides = static_cast<std::uint32_t>(random() % 64);
  options.valid_box = voxels.box();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    options.valid_box.low[axis] -= static_cast<std::int64_t>(random() % 30);
    options.valid_box.high[axis] += static_cast<std::int64_t>(random() % 30);
  }
  return options;
}

Status audit(AlignedBytes& bytes) {
  resign(bytes.bytes());
  const auto map = Voxmap::from_bytes(bytes.bytes(), "scene.vox", Verify::kStructureAndChecksums);
  return map ? audit_voxmap(*map, "scene.vox") : Status(map.error());
}

TEST(VoxmapAudit, AcceptsTheTruth) {
  for (std::uint64_t seed = 1; seed <= 12 / kFraction; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const DenseVoxels voxels = random_scene(random);
    AlignedBytes bytes = dense_voxmap_bytes(voxels, random_options(random, voxels));
    const Status status = audit(bytes);
    EXPECT_TRUE(status) << to_line(status.error());
  }
}

TEST(VoxmapAudit, AcceptsGoldenFilesAndAnEmptyScene) {
  AlignedBytes golden = golden_file_bytes("v2.vox");
  EXPECT_TRUE(audit(golden));
  AlignedBytes distances = golden_file_bytes("v2_distances.vox");
  EXPECT_TRUE(audit(distances));
  AlignedBytes empty = dense_voxmap_bytes(DenseVoxels({0, 0, 0}, {1, 1, 1}, 0.001));
  EXPECT_TRUE(audit(empty));
}

// Clearances of the test helper are the true distances: one more is a lie. Random entries of every
// level are raised, one at a time.
TEST(VoxmapAudit, NoticesEveryClearanceThatIsTooLarge) {
  for (std::uint64_t seed = 31; seed < 31 + 6 / kFraction; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const DenseVoxels voxels = random_scene(random);
    DenseVoxmapOptions options = random_options(random, voxels);
    options.max_clearance = 4000;  // none ends at the cap
    options.share_equal_nodes = false;
    const AlignedBytes whole = dense_voxmap_bytes(voxels, options);
    for (const VoxmapSection section :
         {VoxmapSection::kDirectory, VoxmapSection::kUpperNodes, VoxmapSection::kLowerNodes}) {
      const auto id = static_cast<std::uint32_t>(section);
      const auto entry = read_at<SectionEntry>(whole.bytes(), table_entry_of(whole.bytes(), id));
      int raised = 0;
      for (int tries = 0; tries < 200 && raised < 8; ++tries) {
        AlignedBytes bytes(whole.bytes());
        const std::size_t at = entry.offset + 4 * (random() % (entry.bytes / 4));
        const auto word = read_at<std::uint32_t>(bytes.bytes(), at);
        if (!is_uniform(word) || uniform_value(word) != 0) continue;
        write_at(bytes.bytes(), at, uniform_entry(0, uniform_clearance(word) + 1));
        const Status status = audit(bytes);
        ASSERT_FALSE(status) << "clearance " << uniform_clearance(word) << " at byte " << at;
        EXPECT_NE(status.error().what.find("clearance"), std::string::npos);
        ++raised;
        // Less than the truth, or unknown, is no lie.
        write_at(bytes.bytes(), at, uniform_entry(0, uniform_clearance(word) / 2));
        ASSERT_TRUE(audit(bytes));
      }
      if (section != VoxmapSection::kDirectory) {
        EXPECT_GT(raised, 5);
      }
    }
  }
}

TEST(VoxmapAudit, NoticesWrongCountsAndBoxes) {
  for (const std::size_t at :
       {offsetof(VoxmapHeader, interior_voxels), offsetof(VoxmapHeader, surface_voxels),
        offsetof(VoxmapHeader, proximity_voxels), offsetof(VoxmapHeader, dims_voxels),
        offsetof(VoxmapHeader, dims_voxels) + 16, offsetof(VoxmapHeader, origin_voxel) + 8}) {
    AlignedBytes bytes = golden_file_bytes("v2.vox");
    write_at(bytes.bytes(), at, read_at<std::uint64_t>(bytes.bytes(), at) + 1);
    const Status status = audit(bytes);
    ASSERT_FALSE(status) << at;
    EXPECT_EQ(status.error().code, ErrorCode::kEntryInvalid);
    EXPECT_EQ(status.error().where.rfind("header (", 0), 0u);
  }
}

// One voxel of another value, with counts and box that agree: the layers do not.
TEST(VoxmapAudit, NoticesEveryHoleInALayer) {
  using enum VoxelValue;
  const std::pair<VoxelValue, VoxelValue> changes[] = {
      {kSurface, kFree},      {kSurface, kProximity}, {kSurface, kInterior}, {kInterior, kFree},
      {kProximity, kSurface}, {kProximity, kFree},    {kFree, kProximity},   {kFree, kSurface}};
  std::set<std::string> reasons;
  for (std::uint64_t seed = 51; seed <= 50 + (3 + kFraction - 1) / kFraction; ++seed) {
    std::mt19937_64 random(seed);
    const DenseVoxels whole = random_scene(random);
    for (const auto& [from, to] : changes) {
      SCOPED_TRACE("seed " + std::to_string(seed) + " from " +
                   std::to_string(static_cast<int>(from)) + " to " +
                   std::to_string(static_cast<int>(to)));
      int noticed = 0;
      for (int tries = 0; tries < 20000 && noticed < 3; ++tries) {
        const VoxelIndex at = random_voxel(whole.box(), random);
        if (whole.value(at[0], at[1], at[2]) != from) continue;
        DenseVoxels voxels = whole;
        voxels.set(at[0], at[1], at[2], to);
        AlignedBytes bytes = dense_voxmap_bytes(voxels, {.offset_layers = 1});
        const Status status = audit(bytes);
        ASSERT_FALSE(status);
        EXPECT_EQ(status.error().where.rfind("voxel ", 0), 0u) << to_line(status.error());
        reasons.insert(status.error().what);
        ++noticed;
      }
      EXPECT_EQ(noticed, 3);
    }
  }
  EXPECT_EQ(reasons.size(), 4u);  // each of the checks has found something
}

// The layers around points of a mesh, in an edge of 72 voxels, without distances.
AlignedBytes layers_around(const std::vector<glm::dvec3>& points, std::uint32_t k, Metric metric,
                           std::uint32_t said, std::uint32_t cropped_sides = 0,
                           VoxelBox valid = {{0, 0, 0}, {72, 72, 72}}) {
  DenseVoxels voxels({0, 0, 0}, {72, 72, 72}, 0.001);
  const double radius = interior_radius_voxels(k);
  const auto is_interior = [&](const VoxelIndex& v) {
    return std::any_of(points.begin(), points.end(), [&](const glm::dvec3& point) {
      const glm::dvec3 at(v[0], v[1], v[2]);
      if (metric == Metric::kEuclidean) return glm::length(at + 0.5 - point) < radius;
      const glm::dvec3 off = glm::abs(at - glm::floor(point));
      return std::max({off[0], off[1], off[2]}) <= k - 1;
    });
  };
  std::vector<VoxelIndex> interior;
  for_each_voxel(valid, [&](const VoxelIndex& v) {
    if (is_interior(v)) interior.push_back(v);
  });
  for (const int layer : {2, 1, 0}) {
    constexpr VoxelValue kValues[] = {VoxelValue::kInterior, VoxelValue::kSurface,
                                      VoxelValue::kProximity};
    for (const VoxelIndex& v : interior) {
      VoxelBox box;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] = std::max(valid.low[axis], v[axis] - layer);
        box.high[axis] = std::min(valid.high[axis], v[axis] + layer + 1);
      }
      voxels.fill(box.low, box.high, kValues[layer]);
    }
  }
  AlignedBytes bytes = dense_voxmap_bytes(
      voxels, {.offset_layers = said, .cropped_sides = cropped_sides, .valid_box = valid});
  if (metric == Metric::kEuclidean) {
    const double depth = 0.001;
    write_at(bytes.bytes(), offsetof(VoxmapHeader, metric), std::uint32_t{1});
    write_at(bytes.bytes(), offsetof(VoxmapHeader, zero_force_m),
             interior_radius_voxels(said) * 0.001 + depth);
    write_at(bytes.bytes(), offsetof(VoxmapHeader, force_depth_m), depth);
  }
  return bytes;
}

// Where no distances say how far the interior reaches from the mesh, it must be wide enough for the
// layers that the header says.
TEST(VoxmapAudit, NoticesMoreLayersThanTheInteriorHas) {
  std::mt19937_64 random(71);
  std::uniform_real_distribution<double> inside(20, 50);
  for (const Metric metric : {Metric::kChebyshev, Metric::kEuclidean}) {
    for (const std::uint32_t k : {1u, 2u, 3u, 7u}) {
      std::vector<glm::dvec3> points;
      for (int i = 0; i < 3; ++i)
        points.push_back({inside(random), inside(random), inside(random)});
      for (const std::uint32_t said : {k, k + 1}) {
        AlignedBytes bytes = layers_around(points, k, metric, said);
        const Status status = audit(bytes);
        EXPECT_EQ(status.ok(), said == k)
            << "k " << k << " said " << said << " metric " << static_cast<int>(metric)
            << (status ? "" : to_line(status.error()));
        if (said > k && !status) {
          EXPECT_NE(status.error().what.find("require a wider interior"), std::string::npos);
        }
      }
      // A cut through a ball of the layers: what lies beyond may be interior.
      const auto middle = static_cast<std::int64_t>(points[0][0]);
      AlignedBytes cut =
          layers_around({points[0]}, k, metric, k, kCroppedMinX, {{middle, 0, 0}, {72, 72, 72}});
      const Status status = audit(cut);
      EXPECT_TRUE(status) << to_line(status.error());
    }
  }
}

// So many layers, and no more, are looked at.
TEST(VoxmapAudit, ProvesUpTo32LayersWithoutDistances) {
  for (const std::uint32_t k : {32u, 33u}) {
    AlignedBytes bytes = layers_around({{36, 36, 36}}, k, Metric::kChebyshev, k);
    const Status status = audit(bytes);
    EXPECT_EQ(status.ok(), k == 32) << k;
    if (k == 33) {
      EXPECT_EQ(status.error().where, "header (offset_layers)");
    }
  }
}

// With no layers, where the surface is the mesh's own voxels, the proximity alone is checked.
TEST(VoxmapAudit, PlainClassificationHasProximityOnly) {
  DenseVoxels sheet({0, 0, 0}, {12, 12, 12}, 0.001);  // open: no interior
  sheet.fill({1, 1, 1}, {11, 11, 4}, VoxelValue::kProximity);
  sheet.fill({2, 2, 2}, {10, 10, 3}, VoxelValue::kSurface);
  AlignedBytes plain = dense_voxmap_bytes(sheet, {.offset_layers = 0});
  EXPECT_TRUE(audit(plain));
  AlignedBytes layered = dense_voxmap_bytes(sheet, {.offset_layers = 1});
  EXPECT_FALSE(audit(layered));
  sheet.set(1, 5, 2, VoxelValue::kFree);
  AlignedBytes hole = dense_voxmap_bytes(sheet, {.offset_layers = 0});
  EXPECT_FALSE(audit(hole));
}

// A region cut out of a scene is whole up to its cropped sides; with sides that are said to be
// uncut it is not.
TEST(VoxmapAudit, LooksNotAcrossCroppedSides) {
  int refused = 0;
  for (std::uint64_t seed = 61; seed < 61 + 12 / kFraction; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const DenseVoxels whole = random_scene(random);
    VoxelBox region = whole.box();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      region.low[axis] += 5 + static_cast<std::int64_t>(random() % 10);
      region.high[axis] -= 5 + static_cast<std::int64_t>(random() % 10);
    }
    DenseVoxels cut(region.low,
                    {region.high[0] - region.low[0], region.high[1] - region.low[1],
                     region.high[2] - region.low[2]},
                    0.001);
    bool any = false, cut_through = false;
    for_each_voxel(whole.box(), [&](const VoxelIndex& v) {
      const VoxelValue value = whole.value(v[0], v[1], v[2]);
      if (value == VoxelValue::kFree) return;
      any |= cut.holds(v[0], v[1], v[2]);
      if (cut.holds(v[0], v[1], v[2])) {
        cut.set(v[0], v[1], v[2], value);
      } else {
        cut_through |= value == VoxelValue::kInterior && voxel_distance(region, v) == 1;
      }
    });
    if (!any) continue;
    AlignedBytes cropped = dense_voxmap_bytes(
        cut, {.clearances = true, .offset_layers = 1, .cropped_sides = 63, .valid_box = region});
    const Status status = audit(cropped);
    EXPECT_TRUE(status) << to_line(status.error());
    if (!cut_through) continue;
    AlignedBytes uncut = dense_voxmap_bytes(cut, {.offset_layers = 1, .valid_box = region});
    refused += !audit(uncut);
  }
  EXPECT_GT(refused, kFraction == 1 ? 3 : 0);
}

// Scenes with distances: boxes and points at random, their distance the least of all.
struct DistanceCase {
  explicit DistanceCase(std::uint64_t seed)
      : random(seed),
        layers(1 + static_cast<std::uint32_t>(seed % 3)),
        definition(layers, seed % 2 ? 4 : 6, seed % 2 ? 1 : 2.3) {
    const test::Voxel low{-24 + static_cast<std::int64_t>(random() % 16), 490, -530};
    std::vector<std::array<glm::dvec3, 2>> boxes;  // in voxels: a middle, half an extent
    std::uniform_real_distribution<double> along(16, 24), half(0, 3);
    for (int box = 0; box < 3; ++box) {
      boxes.push_back({glm::dvec3(along(random) + static_cast<double>(low[0]),
                                  along(random) + static_cast<double>(low[1]),
                                  along(random) + static_cast<double>(low[2])),
                       box == 0 ? glm::dvec3(0) : glm::dvec3(half(random), half(random), 0.3)});
    }
    scene = test::distance_scene(
        0.001, low, {40, 40, 40},
        [&](const glm::dvec3& point_m) {
          double nearest = 1e9;
          for (const auto& [middle, extent] : boxes) {
            double outside = 0, inside = -1e9;
            for (int axis = 0; axis < 3; ++axis) {
              const double beyond = std::abs(point_m[axis] / 0.001 - middle[axis]) - extent[axis];
              outside += std::max(beyond, 0.0) * std::max(beyond, 0.0);
              inside = std::max(inside, beyond);
            }
            nearest = std::min(nearest, std::sqrt(outside) + std::min(inside, 0.0));
          }
          return nearest * 0.001;
        },
        layers, definition);
  }

  AlignedBytes bytes(std::uint32_t cropped_sides = 0) const {
    return AlignedBytes(voxmap_bytes(test::SceneFile(scene).content(cropped_sides)));
  }

  std::size_t index(std::size_t x, std::size_t y, std::size_t z) const {
    return (x * 40 + y) * 40 + z;
  }

  // The largest code of the six neighbors of an inner voxel.
  std::uint32_t max_beside(std::size_t i) const {
    std::uint8_t largest = 0;
    for (const std::size_t step : {1u, 40u, 1600u}) {
      largest = std::max({largest, scene.codes[i - step], scene.codes[i + step]});
    }
    return largest;
  }

  std::mt19937_64 random;
  std::uint32_t layers;
  test::DistanceDefinition definition;
  test::VoxelScene scene;
};

TEST(VoxmapAudit, AcceptsTrueDistances) {
  for (std::uint64_t seed = 1; seed <= 12 / kFraction; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    AlignedBytes bytes = DistanceCase(seed).bytes();
    const Status status = audit(bytes);
    EXPECT_TRUE(status) << to_line(status.error());
  }
}

// A code that the voxel's value cannot have, or that its neighbors cannot have beside them.
TEST(VoxmapAudit, NoticesEveryCodeThatCannotBe) {
  for (std::uint64_t seed = 1; seed <= 6 / kFraction; ++seed) {
    DistanceCase truth(seed);
    const auto& d = truth.definition;
    const auto n = static_cast<double>(d.force_layers);
    const double q = d.quantum,
                 from_layers[] = {
                     layer_distance_voxels(interior_radius_voxels(truth.layers), n + 1), 0,
                     layer_distance_voxels(interior_radius_voxels(truth.layers), 0),
                     layer_distance_voxels(interior_radius_voxels(truth.layers), n)};
    int planted[6] = {};
    for (int tries = 0; tries < 60000; ++tries) {
      const std::size_t i =
          truth.index(1 + truth.random() % 38, 1 + truth.random() % 38, 1 + truth.random() % 38);
      const int value = truth.scene.values[i];
      int kind = static_cast<int>(truth.random() % 6);
      std::uint32_t code = 0;
      if (kind == 0 && value == 1) {
        code = d.code(d.interior + 1.5 * q);  // an interior voxel too far out
      } else if (kind >= 1 && kind <= 3 && value == (kind == 3 ? 0 : kind + 1)) {
        code = d.code(from_layers[value] - 2 * q);  // others too near
      } else if (kind == 4 && value >= 2) {
        code =
            d.code(max_layer_distance_voxels(interior_radius_voxels(truth.layers), n + value - 2) +
                   2 * q);  // or too far
      } else if (kind == 5 && value == 0) {
        code = truth.max_beside(i) + static_cast<std::uint32_t>(1 / q) + 2;  // a leap
      } else {
        continue;
      }
      if (planted[kind] == 2 || code > 255 || (kind == 5 && code == 255)) continue;
      const std::uint8_t before = truth.scene.codes[i];
      truth.scene.codes[i] = static_cast<std::uint8_t>(code);
      AlignedBytes bytes = truth.bytes();
      truth.scene.codes[i] = before;
      const Status status = audit(bytes);
      ASSERT_FALSE(status) << "seed " << seed << " kind " << kind << " code " << code;
      EXPECT_NE(status.error().what.find("the code "), std::string::npos);
      ++planted[kind];
    }
    for (const int kind : {0, 1, 2, 3}) EXPECT_EQ(planted[kind], 2) << "kind " << kind;
    EXPECT_GT(planted[4] + planted[5], 0);
  }
}

TEST(VoxmapAudit, NoticesStepsOfCodesThatProveTooLittle) {
  DistanceCase coarse(1);
  AlignedBytes bytes = coarse.bytes();
  write_at(bytes.bytes(), offsetof(VoxmapHeader, distance_quantum_m), 0.000251);
  const Status status = audit(bytes);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().where, "header (distance_quantum_m)");
  // 255 stands for less than where the interior ends: then a voxel in it could have any distance.
  bytes = coarse.bytes();
  write_at(bytes.bytes(), offsetof(VoxmapHeader, distance_zero_code), std::int32_t{250});
  const Status near = audit(bytes);
  ASSERT_FALSE(near);
  EXPECT_EQ(near.error().where, "header (distance_quantum_m, distance_zero_code)");
}

// Entries of free space: "or more" that is not true, because a neighbor is near.
TEST(VoxmapAudit, NoticesFarCodesBesideNearOnes) {
  const GoldenDistances golden;
  VoxmapContent content = golden.content();
  content.header.distance_zero_code = 80;  // 255 now stands for 5.5 voxels and more
  AlignedBytes bytes(voxmap_bytes(content));
  EXPECT_FALSE(audit(bytes));
}

TEST(VoxmapAudit, NoticesAForceThatBeginsElsewhere) {
  AlignedBytes bytes = golden_file_bytes("v2_distances.vox");
  write_at(bytes.bytes(), offsetof(VoxmapHeader, zero_force_m), 0.0029);
  const Status status = audit(bytes);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().where.find("zero_force_m"), std::string::npos);
}

// A tree that a test grows by hand.
struct Tree {
  std::vector<std::uint32_t> directory, uppers, lowers, bricks;

  Tree() = default;
  explicit Tree(const TreeContent& content)
      : directory(content.directory.begin(), content.directory.end()),
        uppers(content.upper_nodes.begin(), content.upper_nodes.end()),
        lowers(content.lower_nodes.begin(), content.lower_nodes.end()),
        bricks(content.bricks.begin(), content.bricks.end()) {}
  TreeContent content() const { return {directory, uppers, lowers, bricks}; }
};

Status audit_content(const VoxmapContent& content) {
  AlignedBytes bytes(voxmap_bytes(content));
  return audit(bytes);
}

void expect_strewn(const Status& status) {
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("cannot all be checked"), std::string::npos)
      << to_line(status.error());
}

// Sets a voxel of brick 0.
void set(Tree& tree, const VoxelIndex& at, VoxelValue value) {
  const auto n = static_cast<std::uint32_t>(at[0] * 64 + at[1] * 8 + at[2]);
  tree.bricks[n / 16] |= static_cast<std::uint32_t>(value) << (2 * (n % 16));
}

// One voxel of surface in the brick of child (`child`, 3, 3) of a node, and the proximity around it
// as far as x < `end`; the node beside it along x; no layers.
VoxmapContent two_nodes(Tree& tree, std::int64_t x, std::int64_t end, std::uint32_t beside,
                        std::uint32_t child = 7) {
  constexpr std::uint32_t kFree = uniform_entry(0);
  VoxmapContent content;
  VoxmapHeader& h = content.header;
  tree.bricks.assign(16 * kValueBits, 0);
  for (std::int64_t i = x - 1; i < std::min(x + 2, end); ++i) {
    for (std::int64_t j = 2; j <= 4; ++j) {
      for (std::int64_t k = 2; k <= 4; ++k) {
        const bool middle = i == x && j == 3 && k == 3;
        set(tree, {i, j, k}, middle ? VoxelValue::kSurface : VoxelValue::kProximity);
        ++(middle ? h.surface_voxels : h.proximity_voxels);
      }
    }
  }
  if (tree.lowers.empty()) tree.lowers.assign(kNodeEntries, kFree);
  tree.lowers[child * 64 + 3 * 8 + 3] = 0;
  tree.uppers.assign(kNodeEntries, kFree);
  tree.uppers[0] = 0;
  tree.uppers[64] = beside;
  tree.directory = {0};
  h.voxel_size_m = 0.001;
  h.directory_dims = {1, 1, 1};
  h.origin_voxel = {8 * child + x - 1, 26, 26};
  h.dims_voxels = {static_cast<std::uint64_t>(std::min(x + 2, end) - x + 1), 3, 3};
  h.valid_max_voxel = {512, 512, 512};
  content.values = tree.content();
  return content;
}

// A node that is free where the proximity of the wall beside it should be.
TEST(VoxmapAudit, NoticesAHoleThatIsAWholeNode) {
  Tree sound, broken;
  EXPECT_TRUE(audit_content(two_nodes(sound, 6, 8, uniform_entry(0))));
  const Status status = audit_content(two_nodes(broken, 7, 8, uniform_entry(0)));
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("is free, but lies beside"), std::string::npos)
      << to_line(status.error());
}

// A free cell of a stored node that holds nothing. Between it and the wall lie 56 voxels, which the
// cells around show, or 64, which they do not: 57 or 65 is true, and one more is not.
TEST(VoxmapAudit, NoticesAClearanceBeyondTheCellsAround) {
  for (const std::uint32_t child : {7u, 6u}) {
    const std::uint32_t smallest = 57 + 8 * (7 - child);
    for (const std::uint32_t clearance : {smallest, smallest + 1}) {
      Tree tree;
      tree.lowers.assign(2 * kNodeEntries, uniform_entry(0));
      tree.lowers[kNodeEntries + 7 * 64 + 3 * 8 + 3] = uniform_entry(0, clearance);
      const Status status = audit_content(two_nodes(tree, 6, 8, 1, child));
      EXPECT_EQ(status.ok(), clearance == smallest) << clearance << " " << child;
    }
  }
}

// Sixteen nodes, each with one voxel of surface and the proximity around it, in the corners of
// sixteen others, and these in all cells of a directory at random. Every fact is true, and nearly
// every corner of a cell has surroundings of its own. Proving each would take minutes a megabyte.
TEST(VoxmapAudit, RefusesValuesThatAreStrewn) {
  std::mt19937_64 random(1);
  constexpr std::uint32_t kFree = uniform_entry(0), kKinds = 16;
  constexpr std::int64_t kCells = 34;
  Tree tree;
  tree.bricks.resize(16 * kValueBits);
  for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
    std::uint32_t far = 0;
    for (const std::uint32_t at : {n >> 6, n >> 3 & 7, n & 7}) {
      far = std::max(far, at > 3 ? at - 3 : 3 - at);
    }
    const auto value = far == 0 ? VoxelValue::kSurface : VoxelValue::kProximity;
    if (far < 2) tree.bricks[n / 16] |= static_cast<std::uint32_t>(value) << (2 * (n % 16));
  }
  tree.lowers.assign(kKinds * kNodeEntries, kFree);
  tree.uppers.assign(kKinds * kNodeEntries, kFree);
  for (std::uint32_t kind = 0; kind < kKinds; ++kind) {
    tree.lowers[kind * kNodeEntries + 3 * 64 + kind] = 0;
    for (const std::uint32_t corner : {0, 7, 56, 63, 448, 455, 504, 511}) {
      tree.uppers[kind * kNodeEntries + corner] = static_cast<std::uint32_t>(random() % kKinds);
    }
  }
  VoxmapContent content;
  VoxmapHeader& h = content.header;
  h.voxel_size_m = 0.001;
  VoxelIndex low{INT64_MAX, INT64_MAX, INT64_MAX}, high{};
  for (std::int64_t cell = 0; cell < kCells * kCells * kCells; ++cell) {
    const auto upper = static_cast<std::uint32_t>(random() % kKinds);
    tree.directory.push_back(upper);
    h.surface_voxels += 8;
    h.proximity_voxels += 8 * 26;
    for (const std::int64_t corner : {0, 7, 56, 63, 448, 455, 504, 511}) {
      const std::int64_t kind =
          tree.uppers[upper * kNodeEntries + static_cast<std::uint32_t>(corner)];
      const VoxelIndex at{cell / kCells / kCells * 512 + (corner >> 6) * 64 + 24,
                          cell / kCells % kCells * 512 + (corner >> 3 & 7) * 64 + kind / 8 * 8,
                          cell % kCells * 512 + (corner & 7) * 64 + kind % 8 * 8};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], at[axis] + 2);
        high[axis] = std::max(high[axis], at[axis] + 5);
      }
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    h.directory_dims[axis] = kCells;
    h.origin_voxel[axis] = low[axis];
    h.dims_voxels[axis] = static_cast<std::uint64_t>(high[axis] - low[axis]);
    h.valid_min_voxel[axis] = low[axis];
    h.valid_max_voxel[axis] = high[axis];
  }
  content.values = tree.content();
  expect_strewn(audit_content(content));
}

// The same of distances: deep inside a solid, where any code below zero may stand beside any other,
// thousands of bricks beside each other in millions of ways.
TEST(VoxmapAudit, RefusesDistancesThatAreStrewn) {
  const DistanceCase one(1);
  const test::SceneFile file(one.scene);
  VoxmapContent content = file.content();
  std::mt19937_64 random(1);
  constexpr std::uint32_t kCells = 4, kUppers = 8, kLowers = 256, kBricks = 4096;
  Tree values, codes;
  for (std::uint32_t n = 0; n < kUppers * kNodeEntries; ++n) {
    codes.uppers.push_back(static_cast<std::uint32_t>(random() % kLowers));
  }
  for (std::uint32_t n = 0; n < kLowers * kNodeEntries; ++n) {
    codes.lowers.push_back(static_cast<std::uint32_t>(random() % kBricks));
  }
  for (std::uint32_t n = 0; n < kBricks * kNodeEntries / 4; ++n) {  // codes of 0 and 1
    codes.bricks.push_back(static_cast<std::uint32_t>(random()) & 0x01010101u);
  }
  VoxmapHeader& h = content.header;
  h.cropped_sides = 63;
  h.surface_voxels = h.proximity_voxels = 0;
  h.interior_voxels = kCells * kCells * kCells * (std::uint64_t{1} << 27);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    h.directory_dims[axis] = kCells;
    h.dims_voxels[axis] = 512 * kCells;
    h.origin_voxel[axis] = h.valid_min_voxel[axis] = h.directory_origin[axis] = 0;
    h.valid_max_voxel[axis] = 512 * kCells;
  }
  for (std::uint32_t n = 0; n < kCells * kCells * kCells; ++n) {
    values.directory.push_back(uniform_entry(1));
    codes.directory.push_back(n % kUppers);
  }
  content.values = values.content();
  content.distances = codes.content();
  expect_strewn(audit_content(content));
}

TEST(VoxmapAudit, NoticesObjectsThatAreNot) {
  AlignedBytes bytes = golden_file_bytes("v2_distances.vox");
  const std::size_t bricks =
      section_offset(bytes.bytes(), static_cast<std::uint32_t>(VoxmapSection::kObjectBricks));
  write_at(bytes.bytes(), bricks + 4, std::uint16_t{3});  // of the palette
  const Status status = audit(bytes);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().where, "object brick 0");
}

}  // namespace
}  // namespace forcelayer::testing
