// Force over depth in soft scenes: the curve of the compliance table, and a part that rests on it.
#include "runtime/field/force_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/distance_scene.h"
#include "tests/support/motion_bench.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005;  // voxel size, m

constexpr float kAreaM2 = 2e-5f;  // of the part's only point

// A floor at height 0 under a soft layer of `layer_voxels`, with the table of the pressure at which
// the area of the point gives `force_n` over depth.
VoxelScene soft_floor(double layer_voxels, const std::function<double(double)>& force_n) {
  const DistanceDefinition definition(2, layer_voxels + 3, layer_voxels);
  VoxelScene scene = distance_scene(
      kS, {-16, -16, -4}, {32, 32, 18}, [](const glm::dvec3& p) { return p.z; }, 2, definition);
  const double quantum_m = definition.quantum * kS;
  for (std::uint32_t i = 0; i * quantum_m < layer_voxels * kS; ++i) {
    scene.distances.compliance.push_back(
        static_cast<float>(force_n(i * quantum_m) / double{kAreaM2}));
  }
  return scene;
}

// From 0 to 1 N/mm at three voxels.
double foam_n(double depth_m) { return 0.5 * 1000 * depth_m * depth_m / (3 * kS); }

TEST(ForceCurve, IsStraightWithoutATable) {
  const Voxmap voxmap =
      make_voxmap(offset_scene(kS, {0, 0, 0}, {16, 16, 16}, 2, [](Voxel v) { return v[2] == 4; }));
  for (const field::ForceCurve& curve : {field::ForceCurve(), field::ForceCurve(voxmap)}) {
    EXPECT_TRUE(curve.is_straight());
    EXPECT_EQ(curve.deepening_m(), 0);
    for (const double depth_m : {-0.01, 0.0, 0.001, 1.0}) {
      EXPECT_EQ(curve.force_m(depth_m), depth_m);
    }
    EXPECT_EQ(curve.energy_m2(0.5), 0.125);
  }
}

// The table itself, searched from its start, and the area under it in strips.
TEST(ForceCurve, IsTheTableAndItsIntegral) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    VoxelScene scene = soft_floor(1 + 4 * uniform(random), [](double) { return 0.0; });
    double pressure_pa = 0;
    for (float& entry : scene.distances.compliance) {
      entry = static_cast<float>(pressure_pa);
      if (random() % 3 != 0) pressure_pa += std::pow(10, -3 + 4 * uniform(random));
    }
    scene.distances.compliance.back() += 1;
    const Voxmap voxmap = make_voxmap(scene);
    const double step_m = voxmap.header().distance_quantum_m, stiffness = steepest_pa_per_m(voxmap);
    const auto table = voxmap.compliance();
    const auto table_pa = [&](double depth_m) {
      for (std::size_t i = 1; i < table.size(); ++i) {
        const double to_m = static_cast<double>(i) * step_m;
        if (depth_m > to_m) continue;
        return table[i] - (to_m - depth_m) / step_m * (double{table[i]} - double{table[i - 1]});
      }
      return double{table.back()};
    };
    // The steepest slope of the table within a distance of a depth, over that of the whole table.
    const auto steepest = [&](double depth_m, double reach_m) {
      double steepest_pa_per_m = 0;
      for (std::size_t i = 1; i < table.size(); ++i) {
        const double to_m = static_cast<double>(i) * step_m;
        if (to_m < depth_m - reach_m || to_m - step_m > depth_m + reach_m) continue;
        steepest_pa_per_m =
            std::max(steepest_pa_per_m, (double{table[i]} - double{table[i - 1]}) / step_m);
      }
      return steepest_pa_per_m / stiffness;
    };
    const double end_m = static_cast<double>(table.size() - 1) * step_m;
    const field::ForceCurve curve(voxmap);
    ASSERT_FALSE(curve.is_straight());
    const double max_pa = table.back();
    for (int n = 0; n < 40; ++n) {
      const double depth_m = 1.3 * static_cast<double>(table.size()) * step_m * uniform(random);
      EXPECT_NEAR(stiffness * curve.force_m(depth_m), table_pa(depth_m), 1e-9 * max_pa);
      EXPECT_LE(curve.force_m(depth_m + 1e-5) - curve.force_m(depth_m),
                1e-5 * curve.slope(depth_m) * (1 + 1e-9));
      EXPECT_LE(curve.slope(depth_m), 1);
      // That within a tenth of a voxel, which is rounded up to whole steps of the table.
      const double in_table_m = std::min(depth_m, end_m);
      EXPECT_GE(curve.slope(depth_m), steepest(in_table_m, 0.1 * kS) * (1 - 1e-9));
      EXPECT_LE(curve.slope(depth_m),
                std::max(1e-3, steepest(in_table_m, 0.1 * kS + 2 * step_m)) * (1 + 1e-9));
      constexpr int kStrips = 4000;
      const double strip_m = depth_m / kStrips;
      double area_pam = 0;
      for (int i = 0; i < kStrips; ++i) area_pam += table_pa((i + 0.5) * strip_m) * strip_m;
      // A strip with a corner in it is off by a quarter of its width times its rise.
      EXPECT_NEAR(stiffness * curve.energy_m2(depth_m), area_pam,
                  1e-9 * max_pa * depth_m + 0.25 * strip_m * max_pa);
    }
    EXPECT_EQ(curve.force_m(-0.001), -0.001);
    EXPECT_EQ(curve.force_m(0), 0);
  }
}

// One point, pressed straight down by the coupling: it rests where the layer's force is the
// hand's, and goes deeper than any other force layer would let it.
TEST(SoftLayer, APressRestsWhereTheTableHoldsIt) {
  PointPart part;
  part.add({0, 0, 0}, {0, 0, -1});
  part.areas_m2 = {kAreaM2};
  const VoxelScene scene = soft_floor(3, foam_n);
  double last_depth_m = 0;
  for (const double down_m : {0.002, 0.005, 0.01, 0.014}) {
    const Pose start{{0.001, 0.002, 7 * kS}, {1, 0, 0, 0}};
    MotionBench bench(scene, part, start);
    const double zero_m = (2 - 1 + std::sqrt(0.75) + 0.001 + 3) * kS;
    StepResult result;
    for (int frame = 0; frame < 3000; ++frame) {
      Pose hand = start;
      hand.position_m.z += std::min(1.0, frame / 500.0) * (zero_m - down_m - start.position_m.z);
      result = bench.step_to(hand);
      ASSERT_EQ(result.report.interior, 0u) << down_m << " frame " << frame;
    }
    ASSERT_EQ(result.report.contacts, 1u);
    const double depth_m = result.report.depth_m;
    // Codes are to the nearest half step, the table is straight between its entries.
    EXPECT_NEAR(depth_m, zero_m - bench.part().position_m.z,
                bench.simulation->voxmap().header().distance_quantum_m);
    EXPECT_NEAR(result.wrench.force_n.z, foam_n(depth_m), 0.001 + 0.01 * foam_n(depth_m));
    EXPECT_GT(depth_m, last_depth_m + 0.0005);
    last_depth_m = depth_m;
  }
  EXPECT_GT(last_depth_m, 1.5 * kS);
}

}  // namespace
}  // namespace forcelayer::test
