// The level field where its values can be worked out by hand, and what it refuses.
#include "runtime/level_field.h"

#include <gtest/gtest.h>

#include "runtime/simulation.h"
#include "tests/support/point_part.h"
#include "tests/support/reference_level.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.01;  // voxel size, m

// Interior below voxel k, force layer k, proximity k + 1 along z.
VoxelScene floor_scene(std::int64_t k) {
  return offset_scene(kS, {-12, -12, -3}, {24, 24, 12}, k, [](Voxel v) { return v[2] <= 0; });
}

FieldSamples push_at(const Voxmap& voxmap, Voxel v, std::array<float, 3> fraction,
                     std::array<float, 3> normal) {
  CollectedPoints points;
  points.reserve(1);
  collect(points, voxmap, v, VoxelValue::kSurface, fraction, normal);
  FieldSamples samples;
  samples.reserve(1);
  LevelField(voxmap).evaluate(points, samples);
  return samples;
}

TEST(LevelField, IsExactAboveAFloorAlongTheGrid) {
  for (std::int64_t k = 1; k <= 3; ++k) {
    const Voxmap voxmap = make_voxmap(floor_scene(k));
    for (const float f : {0.0f, 0.125f, 0.25f, 0.375f}) {
      const FieldSamples samples = push_at(voxmap, {2, -5, k}, {0.3f, 0.9f, f}, {0, 0, 1});
      ASSERT_EQ(samples.count, 1u);
      EXPECT_FLOAT_EQ(samples.depth_m[0], static_cast<float>(kS) * (0.5f - f)) << "k " << k;
      EXPECT_EQ(samples.dx[0], 0.0f);
      EXPECT_EQ(samples.dy[0], 0.0f);
      EXPECT_EQ(samples.dz[0], 1.0f);
    }
    EXPECT_EQ(push_at(voxmap, {2, -5, k}, {0.3f, 0.9f, 0.5f}, {0, 0, 1}).count, 0u);
    EXPECT_EQ(push_at(voxmap, {2, -5, k + 1}, {0.3f, 0.9f, 0.0f}, {0, 0, 1}).count, 0u);
  }
}

TEST(LevelField, NormalThatPointsIntoTheWallIsOverruled) {
  const Voxmap voxmap = make_voxmap(floor_scene(2));
  for (const std::array<float, 3> n :
       {std::array<float, 3>{0, 0, -1}, {1, 0, 0}, {0.8f, 0, 0.6f}}) {
    const FieldSamples samples = push_at(voxmap, {2, -5, 2}, {0.5f, 0.5f, 0.25f}, n);
    ASSERT_EQ(samples.count, 1u);
    EXPECT_FLOAT_EQ(samples.dz[0], 1.0f);
    EXPECT_FLOAT_EQ(samples.depth_m[0], static_cast<float>(kS) * 0.25f);
  }
}

TEST(LevelField, DeepInsideOnlyTheNormalIsLeft) {
  const Voxmap voxmap = make_voxmap(floor_scene(2));
  const FieldSamples samples = push_at(voxmap, {2, -5, -1}, {0.5f, 0.5f, 0.5f}, {0.6f, 0, 0.8f});
  ASSERT_EQ(samples.count, 1u);
  EXPECT_FLOAT_EQ(samples.dx[0], 0.6f);
  EXPECT_FLOAT_EQ(samples.dz[0], 0.8f);
  EXPECT_FLOAT_EQ(samples.depth_m[0], static_cast<float>(kS) * 0.5f * 1.4f);
}

TEST(LevelField, RefusesAMapWithoutOffsetLayers) {
  VoxelScene scene = offset_scene(kS, {0, 0, 0}, {8, 8, 8}, 1, [](Voxel v) { return v[2] < 2; });
  EXPECT_FALSE(LevelField::unreadable(make_voxmap(scene)));
  scene.layers = 0;
  const Voxmap bare = make_voxmap(scene);
  const auto error = LevelField::unreadable(bare);
  ASSERT_TRUE(error);
  EXPECT_EQ(exit_status(error->code), 2);
  EXPECT_NE(to_line(*error).find("--layers"), std::string::npos) << to_line(*error);
  EXPECT_EQ(usual_force(Model::kPaper, bare), ForceKind::kTangentPlane);
}

TEST(LevelField, GoesWithTheRightModelOnly) {
  const Voxmap voxmap = make_voxmap(floor_scene(2));
  EXPECT_EQ(usual_force(Model::kPaper, voxmap), ForceKind::kTangentPlane);
  EXPECT_TRUE(make_force_field(Model::kPaper, ForceKind::kTangentPlane, voxmap));
  const auto refused = make_force_field(Model::kPaper, ForceKind::kLevel, voxmap);
  ASSERT_FALSE(refused);
  EXPECT_EQ(exit_status(refused.error().code), 2);
  Parameters parameters;
  parameters.force = ForceKind::kLevel;
  const auto simulation = Simulation::create(make_voxmap(floor_scene(2)),
                                             make_pshell(sphere_part(kS, 10, kS)), parameters);
  EXPECT_FALSE(simulation);
}

TEST(ForceField, MeanPointAreaIsTheShellsAreaOverItsPoints) {
  const Pshell shell = make_pshell(sphere_part(kS, 130, kS));
  EXPECT_NEAR(mean_point_area_m2(shell), shell.header().area_m2 / 130, 1e-12);
}

}  // namespace
}  // namespace forcelayer::test
