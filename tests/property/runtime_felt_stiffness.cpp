// The stiffness that a hand feels through the coupling: the same for one contact point and for
// thousands, and at every voxel size; on a soft scene it grows with the area.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <random>
#include <vector>

#include "tests/support/distance_scene.h"
#include "tests/support/motion_bench.h"
#include "tests/support/point_part.h"
#include "tests/support/sanitized.h"

namespace forcelayer::test {
namespace {

// Smaller ones run the same code over more voxels and points.
std::vector<double> voxel_sizes_m() {
  return kSanitized ? std::vector{0.005} : std::vector{0.005, 0.0025, 0.00125};
}

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
  for (const double voxel_m : voxel_sizes_m()) {
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

// A foam of 5 kPa at 2 mm, 40 kPa at 6 mm, and straight between and beyond.
double foam_pa(double depth_m) {
  return depth_m < 0.002 ? 2.5e6 * depth_m : 5e3 + 8.75e6 * (depth_m - 0.002);
}

// A solid under a covering of `depth_m` with the pressure `pa`.
VoxelScene covered_scene(double voxel_m, double depth_m,
                         const std::function<double(const glm::dvec3&)>& distance_m,
                         const std::function<double(double)>& pa) {
  const double layer = depth_m / voxel_m;
  const DistanceDefinition definition(2, 4, layer);
  const auto half = static_cast<std::int64_t>(std::ceil(0.05 / voxel_m));
  VoxelScene scene = distance_scene(voxel_m, {-half, -half, -half}, {2 * half, 2 * half, 2 * half},
                                    distance_m, 2, definition);
  for (int i = 0; (i - 1) * definition.quantum < layer * (1 - 1e-9); ++i) {
    scene.distances.compliance.push_back(static_cast<float>(pa(i * definition.quantum * voxel_m)));
  }
  return scene;
}

// A flat face of an area that looks down, over the points (x, y) for which `inside` holds: sampled
// as a shell of a covering radius is, on a hexagonal grid that is turned and shifted anyhow. Each
// point has the area for which it is the nearest one, and stands in the middle of it.
PointPart flat_face(const std::function<bool(double, double)>& inside, double area_m2,
                    double covering_m, double voxel_m, std::mt19937_64& random) {
  const double turn = uniform(random, 0, M_PI), dx = uniform(random, 0, covering_m),
               dy = uniform(random, 0, covering_m);
  const double wide_m = std::sqrt(3.0) * covering_m, high_m = 1.5 * covering_m;
  struct Cell {
    double x = 0, y = 0;
    int samples = 0;
  };
  std::map<std::pair<int, int>, Cell> cells;
  int samples = 0;
  constexpr int kSamples = 200;  // per side
  constexpr double kReachM = 0.03, kSampleM = 2 * kReachM / kSamples;
  for (int i = 0; i < kSamples * kSamples; ++i) {
    const double x = (i / kSamples + 0.5) * kSampleM - kReachM,
                 y = (i % kSamples + 0.5) * kSampleM - kReachM;
    if (!inside(x, y)) continue;
    const double u = std::cos(turn) * x + std::sin(turn) * y + dx,
                 v = std::cos(turn) * y - std::sin(turn) * x + dy;
    std::pair<int, int> nearest;
    double least = 1e300;
    for (int row = static_cast<int>(std::floor(v / high_m)); row <= v / high_m + 1; ++row) {
      const double shift_m = row % 2 == 0 ? 0 : 0.5 * wide_m;
      const double column = std::round((u - shift_m) / wide_m);
      const double off = std::hypot(u - shift_m - column * wide_m, v - row * high_m);
      if (off < least) least = off, nearest = {row, static_cast<int>(column)};
    }
    Cell& cell = cells[nearest];
    cell.x += x, cell.y += y, ++cell.samples, ++samples;
  }
  PointPart part;
  part.voxel_size_m = voxel_m;
  part.covering_radius_m = covering_m;
  for (const auto& [at, cell] : cells) {
    part.add({cell.x / cell.samples, cell.y / cell.samples, 0}, {0, 0, 1});
    part.areas_m2.push_back(static_cast<float>(area_m2 * cell.samples / samples));
  }
  return part;
}

// The force on a hand that holds the face parallel to the surface, at a depth in the covering. The
// coupling is so stiff that the face is where the hand is.
double force_at_depth_n(const VoxelScene& scene, const PointPart& part, const glm::dquat& turn,
                        double depth_m) {
  const glm::dvec3 up = turn * glm::dvec3(0, 0, 1);
  const double zero_m = scene.zero_force_voxels * scene.voxel_size_m;
  BenchOptions options;
  options.settings = {{"coupling_n_per_m", 1e7},
                      {"coupling_force_limit_n", 1e4},
                      {"coupling_nm_per_rad", 1e5},
                      {"coupling_torque_limit_nm", 1e3}};
  MotionBench bench(scene, part, {(zero_m + 0.001) * up, turn}, options);
  StepResult result;
  // The first frame is at rest, so that no stretch is held back from the hand.
  for (int frame = 0; frame <= 60; ++frame) {
    const double fraction = std::min(1.0, frame / 30.0);
    result = bench.step_to({(zero_m + 0.001 - fraction * (0.001 + depth_m)) * up, turn});
  }
  EXPECT_EQ(result.report.contacts, part.points.size());
  return glm::dot(result.wrench.force_n, up);
}

// Twice the area at one depth presses twice as hard, for faces of any shape, shells of any covering
// radius, and voxels of any size. A depth is stored to half a step, at most 0.02 voxel: of a voxel
// of 5 mm that is a few per cent of the pressure here, the same for both areas at one depth where
// the surface lies along the lattice. Elsewhere the points' errors differ, and their mean is small.
// The coupling gives way by less than 5 um.
TEST(SoftCovering, OfTwiceTheAreaPressesTwiceAsHardAtOneDepth) {
  constexpr double kAreaM2 = 5e-4;
  using Inside = std::function<bool(double, double)>;
  const std::pair<const char*, Inside> shapes[] = {
      {"square", [](double x, double y) { return std::max(std::abs(x), std::abs(y)) < 0.012; }},
      {"disc", [](double x, double y) { return std::hypot(x, y) < 0.014; }},
      {"ring", [](double x, double y) { return std::abs(std::hypot(x, y) - 0.014) < 0.004; }},
      {"bar", [](double x, double y) { return std::abs(x) < 0.017 && std::abs(y) < 0.006; }},
      {"L", [](double x, double y) {
         return std::max(std::abs(x), std::abs(y)) < 0.014 && std::min(x, y) < -0.002;
       }}};
  for (const double voxel_m : voxel_sizes_m()) {
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      std::mt19937_64 random(seed);
      const glm::dvec3 normal = seed == 1 ? glm::dvec3(0, 0, 1) : random_direction(random);
      const glm::dquat turn(glm::dvec3(0, 0, 1), normal);
      const VoxelScene scene = covered_scene(
          voxel_m, 0.012, [&](const glm::dvec3& p) { return glm::dot(p, normal); }, foam_pa);
      for (const auto& [name, inside] : shapes) {
        for (const double covering_voxels : {0.866, 0.433}) {
          const double depth_m = uniform(random, 0.004, 0.007);
          SCOPED_TRACE(::testing::Message()
                       << name << ", voxels of " << voxel_m << " m, seed " << seed
                       << ", covering radius " << covering_voxels << ", depth " << depth_m);
          double force_n[2];
          for (const int areas : {1, 2}) {
            const double scale = 1 / std::sqrt(areas);
            const PointPart face =
                flat_face([scale, &shape = inside](
                              double x, double y) { return shape(scale * x, scale * y); },
                          areas * kAreaM2, covering_voxels * voxel_m, voxel_m, random);
            force_n[areas - 1] = force_at_depth_n(scene, face, turn, depth_m);
          }
          EXPECT_NEAR(force_n[1] / force_n[0], 2.00, 0.02);
          const double half_step_m = 0.5 * scene.distances.quantum_m;
          EXPECT_NEAR(force_n[0], kAreaM2 * foam_pa(depth_m),
                      kAreaM2 * (foam_pa(depth_m + half_step_m + 5e-6) - foam_pa(depth_m)));
        }
      }
    }
  }
}

// How stiff a hand feels a covering does not depend on how many points the shell has: discs of the
// two usual covering radii, and of 20 to 5,000 points.
TEST(SoftCovering, FeelsTheSameForAnyNumberOfPointsAndVoxelSize) {
  std::vector<double> felt;
  for (const double voxel_m : voxel_sizes_m()) {
    const VoxelScene scene =
        covered_scene(voxel_m, 0.015, above_floor_m, [](double depth_m) { return 8e5 * depth_m; });
    for (const int count : {1, 20, 200, 5000}) {
      felt.push_back(felt_stiffness(scene, disc(0.02, count, voxel_m), 0.0175 + 3 * voxel_m));
    }
    for (const double covering_voxels : {0.866, 0.433}) {
      std::mt19937_64 random(1);
      const PointPart part =
          flat_face([](double x, double y) { return std::hypot(x, y) < 0.02; }, M_PI * 0.02 * 0.02,
                    covering_voxels * voxel_m, voxel_m, random);
      felt.push_back(felt_stiffness(scene, part, 0.0175 + 3 * voxel_m));
    }
  }
  const auto [min, max] = std::minmax_element(felt.begin(), felt.end());
  EXPECT_GT(*min, 0.99 * *max);
}

// Beneath a covering lies a rigid core. A hand that goes on pressing feels no jump where the part
// meets it, and from there on no less than a rigid scene. The guard goes by voxels: where they lie
// otherwise, it stops the part before the core, by less than half a voxel.
TEST(SoftCovering, GivesWayToItsRigidCoreWithoutAJump) {
  constexpr double kStepM = 1e-4, kDepthM = 0.006;
  for (const double voxel_m : voxel_sizes_m()) {
    for (const double shift_voxels : {0.0, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8}) {
      const bool meets_core = shift_voxels >= 0.2 && shift_voxels <= 0.6;
      const VoxelScene scene = covered_scene(
          voxel_m, kDepthM, [=](const glm::dvec3& p) { return p.z - shift_voxels * voxel_m; },
          foam_pa);
      for (const int count : {1, 7, 50}) {
        SCOPED_TRACE(::testing::Message() << "voxels of " << voxel_m << " m, shifted by "
                                          << shift_voxels << ", " << count << " points");
        const double zero_m = (scene.zero_force_voxels + shift_voxels) * voxel_m;
        MotionBench bench(scene, disc(0.005, count, voxel_m),
                          {{0.0003, 0.0004, zero_m + 0.0002}, {1, 0, 0, 0}});
        const double coupling = bench.simulation->parameters().coupling_n_per_m;
        Pose hand = bench.input.world_from_handle;
        std::vector<double> force_n;
        double deepest_m = 0;
        for (double down_m = 0; down_m < kDepthM + 0.009; down_m += kStepM) {
          hand.position_m.z = zero_m - down_m;
          StepResult result;
          for (int frame = 0; frame < 150; ++frame) result = bench.step_to(hand);
          force_n.push_back(result.wrench.force_n.z);
          deepest_m = std::max(deepest_m, result.report.depth_m);
        }
        EXPECT_GT(deepest_m, meets_core ? kDepthM : kDepthM - 0.5 * voxel_m);
        EXPECT_LT(deepest_m, kDepthM + 0.2 * voxel_m);
        for (std::size_t i = 1; meets_core && i < force_n.size(); ++i) {
          const double rise = (force_n[i] - force_n[i - 1]) / (kStepM * coupling);
          EXPECT_GE(rise, -1e-6) << i;
          EXPECT_LE(rise, 1 + 1e-6) << i;
        }
        const std::size_t last = force_n.size() - 1, before = last - 20;
        EXPECT_GT((force_n[last] - force_n[before]) / (20 * kStepM * coupling), 50.0 / 51);
      }
    }
  }
}

// However steep a covering is, with a foot that is up to a thousand times softer: a ball that a
// hand drives into it stays out of the core and comes to rest within two seconds.
TEST(SoftCovering, StopsAndRestsHoweverSteepItIs) {
  constexpr double kS = 0.0025, kDepthM = 2 * kS;
  PointPart ball = sphere_part(0.02, 600, kS);
  ball.areas_m2.assign(600, static_cast<float>(4 * M_PI * 0.02 * 0.02 / 600));
  for (const double pa_per_m : {1e6, 1e8, 1e10, 1e12, 1e14}) {
    for (std::uint64_t seed = 1; seed <= 6; seed += seed_step(4)) {
      SCOPED_TRACE(::testing::Message() << pa_per_m << " Pa/m, seed " << seed);
      std::mt19937_64 random(seed);
      const glm::dvec3 normal = random_direction(random);
      const double foot_m = uniform(random, 0, 0.9) * kDepthM;  // where the steepest part begins
      const double foot_pa_per_m = pa_per_m * std::pow(10, uniform(random, -3, 0));
      const VoxelScene scene = covered_scene(
          kS, kDepthM, [&](const glm::dvec3& p) { return glm::dot(p, normal); },
          [=](double depth_m) {
            const double foot_pa = foot_pa_per_m * std::min(depth_m, foot_m);
            return std::min(1e9, foot_pa + pa_per_m * std::max(0.0, depth_m - foot_m));
          });
      const double zero_m = scene.zero_force_voxels * kS;
      MotionBench bench(scene, ball, {(zero_m + 0.022) * normal, random_orientation(random)});
      Pose hand = bench.input.world_from_handle;
      const glm::dvec3 along = glm::normalize(random_direction(random) - 0.8 * normal);
      const double speed_mps = std::pow(10, uniform(random, -2, 0)),
                   way_m = uniform(random, 0.004, 0.02);
      StepResult result;
      for (int frame = 0; frame * 0.001 * speed_mps < way_m; ++frame) {
        hand.position_m += 0.001 * speed_mps * along;
        result = bench.step_to(hand);
        ASSERT_EQ(result.report.interior, 0u) << frame;
      }
      glm::dvec3 low(1e9), high(-1e9);
      for (int frame = 0; frame < 2000; ++frame) {
        result = bench.step_to(hand);
        ASSERT_EQ(result.report.interior, 0u) << frame;
        ASSERT_LE(glm::length(result.wrench.force_n), 15 * (1 + 1e-9)) << frame;
        if (frame < 1800) continue;
        low = glm::min(low, bench.part().position_m);
        high = glm::max(high, bench.part().position_m);
      }
      EXPECT_LT(glm::length(high - low), 1e-6 * kS);
    }
  }
}

// A foot that presses on a floor, while two thousand points above it are squeezed in a slot: the
// hand feels the foot as stiff as without the walls of the slot.
TEST(FeltStiffness, OfACornerIsNotChangedByASlotElsewhere) {
  constexpr double kS = 0.0025, kSlotM = 0.01;  // half of the slot
  PointPart part;
  part.voxel_size_m = kS;
  part.add({0, 0, 0}, {0, 0, 1});  // at the grip, so that it does not tip over
  std::mt19937_64 random(20261129);
  for (int i = 0; i < 2000; ++i) {
    const double side = i % 2 == 0 ? 1 : -1;
    part.add({uniform(random, -0.02, 0.02), side * kSlotM, uniform(random, 0.03, 0.05)},
             {0, -side, 0});
  }
  const double zero_m = DistanceDefinition(2).zero_force * kS;
  const double wall_m =
      kSlotM + zero_m - 0.1 * kS;  // squeezes by a tenth of a voxel on either side
  double felt[2];
  for (const bool walls : {false, true}) {
    const VoxelScene scene = distance_scene(
        kS, {-24, -24, -24}, {48, 48, 48},
        [&](const glm::dvec3& p) {
          const double floor_m = p.z + 0.02;
          // The walls begin well above the foot.
          const double aside_m = wall_m - std::abs(p.y), below_m = -p.z;
          const double to_wall_m = aside_m > 0 && below_m > 0 ? std::hypot(aside_m, below_m)
                                                              : std::max(aside_m, below_m);
          return walls ? std::min(floor_m, to_wall_m) : floor_m;
        },
        2, DistanceDefinition(2));
    MotionBench bench(scene, part, {{0, 0, 0}, {1, 0, 0, 0}});
    Pose hand = bench.input.world_from_handle;
    double force_n[2];
    for (const int press : {0, 1}) {
      const double to_m = zero_m - 0.02 - (press == 0 ? 0.002 : 0.006);
      StepResult result;
      while (hand.position_m.z > to_m) {
        hand.position_m.z -= 2e-5;
        result = bench.step_to(hand);
      }
      for (int frame = 0; frame < 500; ++frame) result = bench.step_to(hand);
      force_n[press] = result.wrench.force_n.z;
      EXPECT_GT(result.report.contacts, walls ? 2000u : 0u);
    }
    felt[walls] = (force_n[1] - force_n[0]) / 0.004;
  }
  EXPECT_NEAR(felt[1] / felt[0], 1, 0.01);
}

}  // namespace
}  // namespace forcelayer::test
