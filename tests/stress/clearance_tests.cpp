// The proven clearance of a frame against the exact distance of the meshes, which FCL measures: at
// random poses beside scenes that try to break the proof. FORCELAYER_LONG_TESTS=1 multiplies the
// poses by a hundred.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

#include "forcelayer/run.h"
#include "runtime/coupling/coupling.h"
#include "runtime/model/simulation.h"
#include "runtime/run/derive_parameters.h"
#include "tests/stress/baked.h"
#include "tests/stress/exact_distance.h"
#include "tests/stress/shapes.h"

namespace forcelayer::stress {
namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  glm::dvec3 vector(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  Pose pose(double size_m) {
    return {vector(size_m), coupling::rotation_by(glm::normalize(vector(1)) * uniform(0, 3))};
  }

 private:
  std::mt19937_64 engine_;
};

// Overlapping solids, open sheets and thin walls, turned at random; about 20 voxels across.
mesh::Mesh random_scene(Random& random, double voxel_size_m) {
  const double v = voxel_size_m;
  mesh::Mesh scene;
  for (int n = static_cast<int>(random.uniform(1, 5)); n > 0; --n) {
    const Pose pose = random.pose(8 * v);
    switch (static_cast<int>(random.uniform(0, 6))) {
      case 0:
        append(scene, sphere(random.uniform(0.3, 8) * v, 20), pose);
        break;
      case 1:
        append(scene, box(glm::abs(random.vector(8 * v)) + 0.05 * v), pose);
        break;
      case 2:
        append(scene, sheet(random.uniform(0.2, 12) * v, random.uniform(0.2, 12) * v), pose);
        break;
      case 3:
        append(scene, tube(5 * v, random.uniform(5.1, 8) * v, random.uniform(1, 9) * v, 18), pose);
        break;
      case 4:
        append(scene, cylinder(random.uniform(0.1, 4) * v, random.uniform(0.5, 12) * v, 12), pose);
        break;
      default:
        append(scene, thread(5 * v, 1.5 * v, 3 * v, 3, 16), pose);
    }
  }
  return scene;
}

mesh::Mesh random_part(Random& random, double voxel_size_m) {
  const double v = voxel_size_m;
  switch (static_cast<int>(random.uniform(0, 4))) {
    case 0:
      return sphere(random.uniform(2, 6) * v, 18);
    case 1:
      return box(glm::abs(random.vector(6 * v)) + 0.3 * v);
    case 2:
      return cylinder(random.uniform(0.5, 4) * v, random.uniform(1, 9) * v, 14);
    default:
      return prism({{0, 0}, {8 * v, 0}, {8 * v, v}, {v, v}, {v, 6 * v}, {0, 6 * v}}, 3 * v);
  }
}

std::unique_ptr<model::Simulation> simulation_of(const BakedScene& scene, const BakedPart& part) {
  Voxmap map = scene.open(test::VoxelKind::kFull);
  Pshell shell = part.open();
  const auto derived = derive_parameters(RunRequest{}, map, shell);
  if (!derived) throw std::runtime_error(to_line(derived.error()));
  auto simulation = model::Simulation::create(std::move(map), std::move(shell), derived->values);
  if (!simulation) throw std::runtime_error(to_line(simulation.error()));
  return std::move(*simulation);
}

// Whose force begins here, in voxels; 0: two layers.
class Clearance : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Standoffs, Clearance, ::testing::Values(0, 1.9), [](const auto& standoff) {
  return standoff.param > 0 ? "Near" : "TwoLayers";
});

TEST_P(Clearance, IsNeverAboveTheExactDistanceAndNotFarBelow) {
  const int scenes = std::getenv("FORCELAYER_LONG_TESTS") != nullptr ? 1200 : 12;
  constexpr int kPoses = 100;
  std::vector<double> slack;  // voxels, where the exact distance is 1.2 voxels or more
  int proven = 0, open = 0;
  for (int seed = 1; seed <= scenes; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(static_cast<std::uint64_t>(seed));
    const double s = std::pow(10, random.uniform(-3.5, -1.5));
    const BakedScene scene(random_scene(random, s), s, GetParam() * s);
    const BakedPart part(random_part(random, s), s);
    const auto simulation = simulation_of(scene, part);
    const ExactDistance exact(scene.mesh(), part.mesh());
    for (int n = 0; n < kPoses; ++n) {
      // Near the scene, by approach along a line from outside.
      Pose pose = random.pose(s);
      const glm::dvec3 way = glm::normalize(random.vector(1));
      pose.position_m += 60 * s * way;
      const double wanted_m = random.uniform(0, 6) * s;
      for (int i = 0; i < 40; ++i) {
        const double at_m = exact.at(pose);
        if (at_m < wanted_m + 0.05 * s) break;
        pose.position_m -= (at_m - wanted_m) * way;
      }
      const Pose handle = pose;
      State state = simulation->registered(pose, handle);
      StepInput input;
      input.world_from_handle = handle;
      input.valid = kInputValid;
      const StepReport report = simulation->step(state, input, 0.001).report;
      const double exact_m = exact.at(simulation->world_from_part(report.world_from_center));
      if (report.clearance_kind == ClearanceKind::kNone) continue;
      // 1e-6: FCL's own rounding, of a part's size.
      ASSERT_LE(report.clearance_m, exact_m + 1e-6 * s) << "pose " << n;
      if (report.clearance_kind == ClearanceKind::kAtLeast) {
        ++open;
        continue;
      }
      ++proven;
      if (exact_m >= 1.2 * s) slack.push_back((exact_m - report.clearance_m) / s);
    }
  }
  ASSERT_GT(slack.size(), 200u);
  EXPECT_GT(open, 20);
  std::sort(slack.begin(), slack.end());
  const double median = slack[slack.size() / 2], high = slack[slack.size() * 99 / 100];
  std::printf(
      "%d clearances proven, %d at least so much; slack in voxels from 1.2 voxels on: median "
      "%.3f, 99%% %.3f, most %.3f\n",
      proven, open, median, high, slack.back());
  EXPECT_LE(median, 0.4);
  EXPECT_LE(high, 0.9);
}

}  // namespace
}  // namespace forcelayer::stress
