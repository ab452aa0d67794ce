// The separation guarantee's arithmetic.
#include "runtime/run/separation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "formats/guard.h"

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

VoxmapHeader scene_with_standoff(double standoff_voxels) {
  VoxmapHeader header = scene(0);
  header.metric = static_cast<std::uint32_t>(Metric::kEuclidean);
  header.zero_force_m = standoff_voxels * kVoxelSizeM;
  header.force_depth_m = 0.1 * kVoxelSizeM;
  header.distance_quantum_m = 0.03 * kVoxelSizeM;
  header.distance_zero_code = 90;
  return header;
}

// The guard stands 0.3 voxels behind the standoff, and the guarantee is what any shell of that
// covering radius proves from there; voxels add nothing.
TEST(Separation, FollowsTheStandoff) {
  for (const double standoff : {0.97, 1.1, 1.3, 1.7, 2.3, 4.0}) {
    SCOPED_TRACE(standoff);
    const VoxmapHeader map = scene_with_standoff(standoff);
    const double g = standoff - 0.3;
    ASSERT_NEAR(guard_distance_m(map), g * kVoxelSizeM, 1e-15);
    for (const double radius : {std::sqrt(3.0) / 2, std::sqrt(3.0) / 4}) {
      const PshellHeader shell = part(radius * kVoxelSizeM);
      DistanceGuard guard{guard_distance_m(map), {}};
      guard.shell.covering_radius_m = shell.covering_radius_m;
      guard.shell.convex_radius_m = 1;  // proves nothing more
      const auto bound = separation_guarantee(map, shell, 0, guard);
      const double swept = std::sqrt(g * g - 1.0 / 16) - radius;
      // 1e-9: the bound of the shell comes off rounded.
      EXPECT_NEAR(bound.tested_m.value_or(0), std::max(0.0, g - radius) * kVoxelSizeM, 1e-9);
      EXPECT_EQ(bound.tested_m.has_value(), g - radius > 0);
      EXPECT_EQ(bound.swept_m.has_value(), swept > 0);
      if (radius > 0.8) {
        EXPECT_NEAR(usual_separation_m(map), std::max(0.0, swept) * kVoxelSizeM, 1e-12);
      }
    }
  }
}

// 2.6 voxels of room and a tenth of a voxel proven for every shell of the usual covering radius.
TEST(Separation, AStandoffPassesGapsThatLayersClose) {
  const VoxmapHeader near = scene_with_standoff(1.3);
  EXPECT_NEAR(passed_gap_m(near), 2.6 * kVoxelSizeM, 1e-12);
  EXPECT_GT(usual_separation_m(near), 0.1 * kVoxelSizeM);
  // Nearer than this the guard is in the way before the force is: its own bound counts.
  const VoxmapHeader nearest = scene_with_standoff(0.97);
  EXPECT_GT(passed_gap_m(nearest), 2 * nearest.zero_force_m);
  EXPECT_LT(passed_gap_m(nearest), 2.1 * kVoxelSizeM);
}

TEST(Separation, AdvisesAStandoffThatIsEnough) {
  VoxmapHeader map = scene_with_standoff(1.0);
  map.static_deviation_m = 3e-4;
  PshellHeader shell = part(0.9 * kVoxelSizeM);
  DistanceGuard guard{guard_distance_m(map), {}};
  guard.shell.covering_radius_m = shell.covering_radius_m;
  guard.shell.convex_radius_m = 1;
  const Status refused = require_guarantee(map, shell, 1e-6, guard, "part.pshell");
  ASSERT_FALSE(refused);
  double standoff_mm = 0;
  ASSERT_EQ(std::sscanf(refused.error().mend.c_str(), "bake the scene with --standoff %lfmm",
                        &standoff_mm),
            1)
      << refused.error().mend;
  for (const double more_mm : {0.0, -0.1}) {  // that is enough; a tenth of a millimeter less is not
    map = scene_with_standoff((standoff_mm + more_mm) * 1e-3 / kVoxelSizeM);
    map.static_deviation_m = 3e-4;
    guard.distance_m = guard_distance_m(map);
    EXPECT_EQ(bool(require_guarantee(map, shell, 1e-6, guard, "part.pshell")), more_mm == 0);
  }
  guard.distance_m = 0;  // by another force than that of distances
  const Status other = require_guarantee(map, shell, 1e-6, guard, "part.pshell");
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().mend.find("--force"), std::string::npos);
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

// The layers that the advice names are enough, and one fewer is not.
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
  EXPECT_NE(text.find("deviate by 3 mm and the part's meshes by 2.5 mm"), std::string::npos)
      << text;
  shell.part_deviation_m = 0;
  map.static_deviation_m = 0.0051;
  const std::string exact = advice(map, shell);
  EXPECT_NE(exact.find("deviate by 5.1 mm and the part's meshes by 0 mm"), std::string::npos)
      << exact;
  shell.part_deviation_m = 1;
  EXPECT_NE(advice(map, shell).find("larger voxels"), std::string::npos);
}

}  // namespace
}  // namespace forcelayer::test
