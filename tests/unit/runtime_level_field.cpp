// The level field where its values can be worked out by hand, and what it refuses.
#include "runtime/field/level_field.h"

#include <gtest/gtest.h>

#include <functional>

#include "runtime/model/simulation.h"
#include "tests/support/point_part.h"
#include "tests/support/reference_level.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.01;  // voxel size, m

// Interior below voxel k, force layer k, proximity k + 1 along z.
VoxelScene floor_scene(std::int64_t k) {
  return offset_scene(kS, {-12, -12, -3}, {24, 24, 12}, k, [](Voxel v) { return v[2] <= 0; });
}

field::FieldSamples sample_at(const Voxmap& voxmap, Voxel v, std::array<float, 3> fraction,
                              std::array<float, 3> normal,
                              VoxelValue value = VoxelValue::kSurface) {
  query::CollectedPoints points;
  points.reserve(1);
  collect(points, voxmap, v, value, fraction, normal);
  field::FieldSamples samples;
  samples.reserve(1);
  field::LevelField(voxmap).measure(points, samples);
  return samples;
}

TEST(LevelField, IsExactAboveAFloorAlongTheGrid) {
  for (std::int64_t k = 1; k <= 3; ++k) {
    const Voxmap voxmap = make_voxmap(floor_scene(k));
    for (const float f : {0.0f, 0.125f, 0.25f, 0.375f}) {
      const field::FieldSamples samples = sample_at(voxmap, {2, -5, k}, {0.3f, 0.9f, f}, {0, 0, 1});
      EXPECT_FLOAT_EQ(samples.depth_m[0], static_cast<float>(kS) * (0.5f - f)) << "k " << k;
      EXPECT_EQ(samples.dx[0], 0.0f);
      EXPECT_EQ(samples.dy[0], 0.0f);
      EXPECT_EQ(samples.dz[0], 1.0f);
    }
    EXPECT_LE(sample_at(voxmap, {2, -5, k}, {0.3f, 0.9f, 0.5f}, {0, 0, 1}).depth_m[0], 0);
    EXPECT_LE(sample_at(voxmap, {2, -5, k + 1}, {0.3f, 0.9f, 0.0f}, {0, 0, 1}).depth_m[0], 0);
  }
}

// Where the first interior voxel ends, phi is -1/2: sqrt(3)/2 voxels before that the push begins.
TEST(LevelField, BeginsEarlierWithEuclideanLayers) {
  VoxelScene scene = floor_scene(1);
  scene.metric = Metric::kEuclidean;
  const Voxmap voxmap = make_voxmap(scene);
  for (const float f : {0.0f, 0.25f, 0.5f, 0.75f}) {
    const field::FieldSamples samples = sample_at(voxmap, {2, -5, 1}, {0.3f, 0.9f, f}, {0, 0, 1});
    EXPECT_NEAR(samples.depth_m[0], kS * (std::sqrt(3.0) / 2 - f), 1e-6 * kS);
    EXPECT_EQ(samples.dz[0], 1.0f);
  }
  EXPECT_LE(sample_at(voxmap, {2, -5, 1}, {0.3f, 0.9f, 0.875f}, {0, 0, 1}).depth_m[0], 0);
}

// A point in value 3 beside `solid` is pushed along its normal with Euclidean layers, and not with
// Chebyshev ones.
void expect_push_in_proximity(const std::function<bool(Voxel)>& solid, Voxel v,
                              std::array<float, 3> fraction, std::array<float, 3> normal,
                              double depth_voxels) {
  VoxelScene scene = offset_scene(kS, {-8, -8, -8}, {16, 16, 16}, 1, solid);
  ASSERT_EQ(scene.at(v), VoxelValue::kProximity);
  for (const Metric metric : {Metric::kChebyshev, Metric::kEuclidean}) {
    scene.metric = metric;
    const field::FieldSamples samples =
        sample_at(make_voxmap(scene), v, fraction, normal, VoxelValue::kProximity);
    ASSERT_EQ(samples.depth_m[0] > 0, metric == Metric::kEuclidean);
    if (metric == Metric::kChebyshev) continue;
    EXPECT_NEAR(samples.depth_m[0], kS * depth_voxels, 1e-4 * kS);  // shares are in 2^-15
    EXPECT_EQ((std::array{samples.dx[0], samples.dy[0], samples.dz[0]}), normal);
  }
}

// In a tunnel whose force layers leave one voxel between them, phi is 1/4.
TEST(LevelField, PushesInANarrowTunnelWithEuclideanLayers) {
  expect_push_in_proximity([](Voxel v) { return std::abs(v[0]) > 1 || std::abs(v[1]) > 1; },
                           {0, 0, 0}, {0.125f, 0.5f, 0.5f}, {1, 0, 0}, std::sqrt(3.0) / 2 - 0.75);
}

// Beside a step of the lattice phi is between that of its lower and its upper side: 0.3 here.
TEST(LevelField, PushesBesideAStepWithEuclideanLayers) {
  expect_push_in_proximity([](Voxel v) { return v[2] < (v[0] < 0 ? 0 : -1); }, {1, 0, 0},
                           {0.2f, 0.5f, 0}, {0, 0, 1}, std::sqrt(3.0) / 2 - 0.8);
}

TEST(LevelField, NormalThatPointsIntoTheWallIsOverruled) {
  const Voxmap voxmap = make_voxmap(floor_scene(2));
  for (const std::array<float, 3> n :
       {std::array<float, 3>{0, 0, -1}, {1, 0, 0}, {0.8f, 0, 0.6f}}) {
    const field::FieldSamples samples = sample_at(voxmap, {2, -5, 2}, {0.5f, 0.5f, 0.25f}, n);
    EXPECT_FLOAT_EQ(samples.dz[0], 1.0f);
    EXPECT_FLOAT_EQ(samples.depth_m[0], static_cast<float>(kS) * 0.25f);
  }
}

TEST(LevelField, DeepInsideOnlyTheNormalIsLeft) {
  const Voxmap voxmap = make_voxmap(floor_scene(2));
  const field::FieldSamples samples =
      sample_at(voxmap, {2, -5, -1}, {0.5f, 0.5f, 0.5f}, {0.6f, 0, 0.8f});
  EXPECT_FLOAT_EQ(samples.dx[0], 0.6f);
  EXPECT_FLOAT_EQ(samples.dz[0], 0.8f);
  EXPECT_FLOAT_EQ(samples.depth_m[0], static_cast<float>(kS) * 0.5f * 1.4f);
}

TEST(LevelField, RefusesAMapWithoutOffsetLayers) {
  VoxelScene scene = offset_scene(kS, {0, 0, 0}, {8, 8, 8}, 1, [](Voxel v) { return v[2] < 2; });
  EXPECT_FALSE(field::LevelField::unreadable(make_voxmap(scene)));
  scene.layers = 0;
  const Voxmap bare = make_voxmap(scene);
  const auto error = field::LevelField::unreadable(bare);
  ASSERT_TRUE(error);
  EXPECT_EQ(exit_status(error->code), 2);
  EXPECT_NE(to_line(*error).find("--layers"), std::string::npos) << to_line(*error);
  EXPECT_EQ(field::usual_force(Model::kPaper, bare), ForceKind::kTangentPlane);
}

TEST(LevelField, GoesWithTheRightModelOnly) {
  const Voxmap voxmap = make_voxmap(floor_scene(2));
  EXPECT_EQ(field::usual_force(Model::kPaper, voxmap), ForceKind::kTangentPlane);
  EXPECT_TRUE(field::make_force_field(Model::kPaper, ForceKind::kTangentPlane, voxmap));
  const auto refused = field::make_force_field(Model::kPaper, ForceKind::kLevel, voxmap);
  ASSERT_FALSE(refused);
  EXPECT_EQ(exit_status(refused.error().code), 2);
  Parameters parameters;
  parameters.model = Model::kPaper;
  parameters.force = ForceKind::kLevel;
  const auto simulation = model::Simulation::create(
      make_voxmap(floor_scene(2)), make_pshell(sphere_part(kS, 10, kS)), parameters);
  EXPECT_FALSE(simulation);
}

TEST(ForceField, MeanPointAreaIsTheShellsAreaOverItsPoints) {
  const Pshell shell = make_pshell(sphere_part(kS, 130, kS));
  EXPECT_NEAR(field::mean_point_area_m2(shell), shell.header().area_m2 / 130, 1e-12);
}

}  // namespace
}  // namespace forcelayer::test
