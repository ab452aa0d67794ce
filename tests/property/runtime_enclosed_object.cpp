// Objects inside the part, clear of its shell, against balls whose places are known.
#include "runtime/query/enclosed_object.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "formats/voxmap_walk.h"
#include "tests/support/distance_scene.h"
#include "tests/support/random_scenes.h"
#include "tests/support/shape_scene.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005, kRadiusM = 0.06;

// A sphere whose points stand for their fraction of its area (save_pshell: 1e-5 m^2 each).
PointPart sphere() {
  return sphere_part(kRadiusM, static_cast<std::size_t>(4 * M_PI * kRadiusM * kRadiusM / 1e-5), kS);
}

VoxelScene ball(const glm::dvec3& center_m, double radius_m, bool lean) {
  VoxelScene scene = distance_scene(
      kS, {-24, -24, -24}, {48, 48, 48},
      [=](const glm::dvec3& p) { return glm::length(p - center_m) - radius_m; }, 2,
      DistanceDefinition(2));
  if (lean) scene.codes.clear(), scene.distances = {};
  return scene;
}

TEST(EnclosedObject, IsFoundWhereAndOnlyWhereItIsInside) {
  const Pshell shell = make_pshell(sphere());
  int inside = 0, outside = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const bool lean = seed % 3 == 0;
    const glm::dvec3 center_m = random_direction(random) * uniform(random, 0, 0.08);
    const double radius_m = uniform(random, 0.5, 3) * kS;
    const glm::dvec3 part_m = random_direction(random) * uniform(random, 0, 0.03);
    const Voxmap voxmap = make_voxmap(ball(center_m, radius_m, lean));
    const auto found =
        *query::find_enclosed_object(voxmap, shell, {part_m, random_orientation(random)});
    const double apart_m = glm::length(center_m - part_m);
    // In a lean scene the object is known to two voxels' diagonals.
    const double room_m = lean ? std::sqrt(3.0) * 2 * kS : kS;
    if (apart_m + radius_m + room_m + 0.87 * kS + kS < kRadiusM) {
      ++inside;
      ASSERT_TRUE(found);
      EXPECT_LT(glm::length(found->world_m - center_m), radius_m + 2 * std::sqrt(3.0) * kS);
    } else if (apart_m - radius_m > kRadiusM) {
      ++outside;
      EXPECT_FALSE(found);
    }
  }
  EXPECT_GT(inside, 8);
  EXPECT_GT(outside, 3);
}

// A block of solid that fills whole bricks has no brick of mixed values about its middle.
TEST(EnclosedObject, IsFoundInUniformEntries) {
  PointPart part = sphere_part(0.3, 113097, kS);
  const Pshell shell = make_pshell(part);
  const Voxmap voxmap = make_voxmap(distance_scene(
      kS, {-24, -24, -24}, {48, 48, 48},
      [](const glm::dvec3& p) {
        const glm::dvec3 out = glm::abs(p) - 16 * kS;
        return std::max({out.x, out.y, out.z});
      },
      2, DistanceDefinition(2)));
  EXPECT_TRUE(*query::find_enclosed_object(voxmap, shell, {}));
  EXPECT_FALSE(*query::find_enclosed_object(voxmap, shell, {{0.5, 0, 0}, {1, 0, 0, 0}}));
}

// A small file can have more bricks than a search can look at: equal ones are stored once. The
// search ends with an error where there are more than it may look at, and only there.
TEST(EnclosedObject, IsNotSearchedForInMoreBricksThanAllowed) {
  const Pshell shell = make_pshell(sphere());
  const Voxmap voxmap = make_voxmap(ball({0.05, 0.05, 0.05}, 0.01, false));  // beside the part
  std::uint64_t bricks = 0;
  for_each_region(voxmap.view(), [&](const VoxmapRegion& region) {
    bool in_box = region.is_brick;  // of the part's points
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double low_m = kS * static_cast<double>(region.low[axis]);
      in_box = in_box && low_m <= kRadiusM && low_m + 8 * kS >= -kRadiusM;
    }
    bricks += in_box;
  });
  ASSERT_GT(bricks, 3u);
  const auto found = query::find_enclosed_object(voxmap, shell, {}, {}, bricks);
  ASSERT_TRUE(found) << to_line(found.error());
  EXPECT_FALSE(*found);
  const auto refused = query::find_enclosed_object(voxmap, shell, {}, {}, bricks - 1);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace forcelayer::test
