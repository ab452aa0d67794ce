// The separation guarantee's arithmetic.
#include "runtime/run/separation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

namespace forcelayer::test {
namespace {

constexpr double kVoxelSizeM = 0.005;

VoxmapHeader scene(std::uint32_t layers) {
  VoxmapHeader header{};
  header.voxel_size_m = kVoxelSizeM;
  header.offset_layers = layers;
  return header;
}

PshellHeader part(double covering_radius_m) {
  PshellHeader header{};
  header.covering_radius_m = covering_radius_m;
  header.bounding_radius_m = 1e6;  // so large that arcs are chords
  return header;
}

TEST(Separation, IsThatOfThePaperForTwoLayersAndVoxelCentres) {
  const auto bound = separation_guarantee(scene(2), part(std::sqrt(3.0) / 2 * kVoxelSizeM), 0, {});
  ASSERT_TRUE(bound.tested_m && bound.swept_m);
  EXPECT_NEAR(*bound.tested_m / kVoxelSizeM, 0.134, 0.0005);
  EXPECT_NEAR(*bound.swept_m / kVoxelSizeM, 0.102, 0.0005);
}

TEST(Separation, LosesEveryDeviationInFull) {
  VoxmapHeader map = scene(3);
  PshellHeader shell = part(0.002);
  const double before_m = *separation_guarantee(map, shell, 0, {}).tested_m;
  map.static_deviation_m = 1e-4;
  shell.part_deviation_m = 2e-4;
  EXPECT_NEAR(*separation_guarantee(map, shell, 4e-4, {}).tested_m, before_m - 7e-4, 1e-15);
}

TEST(Separation, TakesTheArcOffBetweenPoses) {
  PshellHeader shell = part(0.003);
  const double chord_m = *separation_guarantee(scene(2), shell, 0, {}).swept_m;
  shell.bounding_radius_m = 0.05;
  // Turning 0.05 m by s/2 of arc: 0.05 (1 - cos(0.025)) = 1.5625e-5 m at most.
  EXPECT_NEAR(chord_m - *separation_guarantee(scene(2), shell, 0, {}).swept_m, 1.5625e-5, 1e-9);
}

// The guard's distance less what the shell spends; between poses a quarter of half a voxel comes
// off under the root. Voxels alone prove what they did, where that is more.
TEST(Separation, IsWhatTheGuardHoldsWhereThatIsMore) {
  const PshellHeader shell = part(0.004);
  DistanceGuard guard{1.667 * kVoxelSizeM, {}};
  guard.shell.covering_radius_m = guard.shell.convex_gap_m = 0.004;
  const auto bound = separation_guarantee(scene(2), shell, 1e-4, guard);
  const double g = guard.distance_m;
  // 1e-9: the bound of the shell comes off rounded.
  EXPECT_NEAR(*bound.tested_m, g - 0.004 - 1e-4, 1e-9);
  EXPECT_NEAR(*bound.swept_m, std::sqrt(g * g - std::pow(kVoxelSizeM / 4, 2)) - 0.004 - 1e-4, 1e-9);
  guard.distance_m = 0.5 * kVoxelSizeM;
  EXPECT_EQ(*separation_guarantee(scene(2), shell, 0, guard).tested_m,
            *separation_guarantee(scene(2), shell, 0, {}).tested_m);
}

TEST(Separation, IsNoneWhereTheBoundIsNotPositive) {
  EXPECT_FALSE(separation_guarantee(scene(0), part(0.001), 0, {}).tested_m);
  EXPECT_FALSE(separation_guarantee(scene(1), part(0.001), 0, {}).tested_m);
  EXPECT_FALSE(separation_guarantee(scene(2), part(kVoxelSizeM), 0, {}).tested_m);
  const auto between = separation_guarantee(scene(2), part(0.98 * kVoxelSizeM), 0, {});
  EXPECT_TRUE(between.tested_m);
  EXPECT_FALSE(between.swept_m);
}

std::string advice(const VoxmapHeader& map, const PshellHeader& shell) {
  const Status ensured = require_guarantee(map, shell, 0, {}, "part.pshell");
  return ensured ? "" : ensured.error().mend;
}

bool ensured(const VoxmapHeader& map, const PshellHeader& shell) {
  return bool(require_guarantee(map, shell, 0, {}, "part.pshell"));
}

// What the advice names is enough, and a layer fewer is not.
TEST(Separation, AdvisesLayersThatAreEnough) {
  for (const double deviation_m : {0.0, 0.002, 0.006, 0.02}) {
    VoxmapHeader map = scene(1);
    PshellHeader shell = part(0.9 * kVoxelSizeM);
    shell.part_deviation_m = deviation_m;
    unsigned layers = 0;
    const std::string text = advice(map, shell);
    ASSERT_EQ(std::sscanf(text.c_str(), "bake the scene with --layers %u", &layers), 1) << text;
    map.offset_layers = layers;
    EXPECT_TRUE(ensured(map, shell)) << text;
    map.offset_layers = layers - 1;
    EXPECT_FALSE(ensured(map, shell)) << text;
  }
}

TEST(Separation, AdvisesACoveringRadiusThatIsSmallEnough) {
  VoxmapHeader map = scene(2);
  map.static_deviation_m = 0.001;
  PshellHeader shell = part(0.9 * kVoxelSizeM);
  double radius_mm = 0;
  const std::string text = advice(map, shell);
  ASSERT_EQ(std::sscanf(text.c_str(), "bake the part with --covering-radius %lfmm", &radius_mm), 1)
      << text;
  shell.covering_radius_m = 1e-3 * radius_mm;
  EXPECT_TRUE(ensured(map, shell)) << text;
}

// Where the deviations alone are too much, a smaller covering radius is no help.
TEST(Separation, AdvisesCloserMeshesWhereNoCoveringRadiusHelps) {
  VoxmapHeader map = scene(2);
  map.static_deviation_m = 0.003;
  PshellHeader shell = part(0.001);
  shell.part_deviation_m = 0.0025;
  PshellHeader dense = shell;
  dense.covering_radius_m = 1e-9;
  ASSERT_FALSE(ensured(map, dense));
  const std::string text = advice(map, shell);
  EXPECT_EQ(text.find("--covering-radius"), std::string::npos) << text;
  EXPECT_NE(text.find("deviates by 3 mm and the part's by 2.5 mm"), std::string::npos) << text;
  shell.part_deviation_m = 1;
  EXPECT_NE(advice(map, shell).find("larger voxels"), std::string::npos);
}

}  // namespace
}  // namespace forcelayer::test
