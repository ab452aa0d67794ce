// The stiffness that a hand feels through the coupling: the same for one contact point and for
// thousands, and at every voxel size; on a soft scene it grows with the area.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/distance_scene.h"
#include "tests/support/motion_bench.h"
#include "tests/support/point_part.h"

namespace forcelayer::test {
namespace {

VoxelScene floor_scene(double voxel_m, const std::function<double(const glm::dvec3&)>& distance_m) {
  const auto half = static_cast<std::int64_t>(std::ceil(0.05 / voxel_m));
  return distance_scene(voxel_m, {-half, -half, -4}, {2 * half, 2 * half, 2 * half}, distance_m, 2,
                        DistanceDefinition(2));
}

double above_floor_m(const glm::dvec3& p) { return p.z; }

// Points of a flat disc, looking down, evenly over it: `count` of them, each of its area.
PointPart disc(double radius_m, int count, double voxel_m) {
  PointPart part;
  part.voxel_size_m = voxel_m;
  const double golden = M_PI * (3 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double r = count == 1 ? 0 : radius_m * std::sqrt((i + 0.5) / count), a = golden * i;
    part.add({r * std::cos(a), r * std::sin(a), 0}, {0, 0, 1});
    part.areas_m2.push_back(static_cast<float>(M_PI * radius_m * radius_m / count));
  }
  return part;
}

// The force's rise between two presses over the handle's way between them and the coupling's
// stiffness; 1 where the contact does not yield.
double felt_stiffness(const VoxelScene& scene, const PointPart& part, double start_m) {
  MotionBench bench(scene, part, {{0.0003, 0.0004, start_m}, {1, 0, 0, 0}});
  const Pose start = bench.input.world_from_handle;
  Pose hand = start;
  double force_n[2];
  StepResult result;
  const auto hold = [&] {
    for (int frame = 0; frame < 500; ++frame) result = bench.step_to(hand);
    return result.wrench.force_n.z;
  };
  for (int frame = 0; frame < 5000 && result.wrench.force_n.z < 0.05; ++frame) {
    hand.position_m.z -= 2e-5;
    result = bench.step_to(hand);
  }
  double down_m[] = {0.002, 0.008};
  const double touch_m = hand.position_m.z;
  for (int i = 0; i < 2; ++i) {
    while (hand.position_m.z > touch_m - down_m[i]) {
      hand.position_m.z -= 2e-5;
      bench.step_to(hand);
    }
    force_n[i] = hold();
    down_m[i] = hand.position_m.z;
  }
  EXPECT_GT(force_n[0], 0.5);
  return (force_n[1] - force_n[0]) / (down_m[0] - down_m[1]) /
         bench.simulation->parameters().coupling_n_per_m;
}

TEST(FeltStiffness, IsTheSameForAnyNumberOfPointsAndVoxelSize) {
  std::vector<double> felt;
  for (const double voxel_m : {0.005, 0.0025, 0.00125}) {
    const VoxelScene scene = floor_scene(voxel_m, above_floor_m);
    for (const int count : {1, 10, 200, 5000}) {
      felt.push_back(felt_stiffness(scene, disc(0.02, count, voxel_m), 6 * voxel_m));
    }
    for (const double covering_voxels : {0.866, 0.433}) {
      // A hexagonal covering has 3 sqrt(3) / 2 of the squared radius for each point.
      const double spacing_m = covering_voxels * voxel_m;
      const int count = static_cast<int>(M_PI * 0.02 * 0.02 / (2.598 * spacing_m * spacing_m));
      felt.push_back(felt_stiffness(scene, disc(0.02, count, voxel_m), 6 * voxel_m));
    }
  }
  const auto [min, max] = std::minmax_element(felt.begin(), felt.end());
  EXPECT_GT(*min, 0.99 * *max);
  EXPECT_GT(*min, 50.0 / 51);  // no contact is softer than 50 times the coupling
}

// Foam of half the points presses with half the force at one depth: it rests on each at the depth
// at which the table times the points is the hand's force.
TEST(FeltStiffness, OfTwiceTheAreaOfFoamIsTwiceThatOfOnce) {
  constexpr double kS = 0.005, kLayer = 3;
  const DistanceDefinition definition(2, kLayer + 3, kLayer);
  VoxelScene scene = distance_scene(kS, {-16, -16, -4}, {32, 32, 18}, above_floor_m, 2, definition);
  const double quantum_m = definition.quantum * kS;
  for (int i = 0; i * quantum_m < kLayer * kS; ++i) {
    scene.distances.compliance.push_back(static_cast<float>(2.0 * i * quantum_m));  // 2 N/m
  }
  double per_depth[2];
  for (const int i : {0, 1}) {
    PointPart part = disc(i == 0 ? 0.02 : 0.02 * std::sqrt(2.0), 500 * (i + 1), kS);
    MotionBench bench(scene, part, {{0.0003, 0.0004, 7 * kS}, {1, 0, 0, 0}});
    Pose hand = bench.input.world_from_handle;
    StepResult result;
    for (int frame = 0; frame < 3000; ++frame) {
      if (frame < 1200) hand.position_m.z -= 2e-5;
      result = bench.step_to(hand);
    }
    ASSERT_GT(result.report.depth_m, 0.001);
    per_depth[i] = result.wrench.force_n.z / result.report.depth_m;
  }
  EXPECT_NEAR(per_depth[1] / per_depth[0], 2.00, 0.02);
}

}  // namespace
}  // namespace forcelayer::test
