// Parts with open sheets: which way their normals point says nothing.
#include <gtest/gtest.h>

#include "tests/support/distance_scene.h"
#include "tests/support/motion_bench.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005, kHalf = 0.01;

VoxelScene scene_of(const std::function<double(const glm::dvec3&)>& distance_m) {
  return distance_scene(kS, {-12, -12, -12}, {24, 24, 24}, distance_m, 2, DistanceDefinition(2));
}
VoxelScene floor_scene() {
  return scene_of([](const glm::dvec3& p) { return p.z; });
}
VoxelScene sheet_scene() {
  return scene_of([](const glm::dvec3& p) { return std::abs(p.z); });
}

PointPart sheets(bool turned) {
  PointPart part = box_part({0.015, 0.012, kHalf}, 0.8 * kS, kS);
  part.two_sided = true;
  if (!turned) return part;
  for (auto& normal : part.normals) {
    for (float& component : normal) component = -component;
  }
  return part;
}

Pose at_height(double z_m) { return {{0.0007, 0.0003, z_m}, {1, 0, 0, 0}}; }

// From `start`, seated where it touches: down, along, up. The wrench of every frame.
std::vector<glm::dvec3> forces_of(const VoxelScene& scene, const PointPart& part,
                                  const Pose& start_pose) {
  MotionBench bench(scene, part, start_pose);
  PartStart start;
  start.world_from_part = start_pose;
  bench.state = bench.simulation->begin(start, start_pose).value();
  std::vector<glm::dvec3> forces;
  const glm::dvec3 ways_m[] = {{0, 0, -0.03}, {0.01, 0.002, 0}, {0, 0, 0.06}};
  Pose to = start_pose;
  for (const glm::dvec3& way_m : ways_m) {
    for (int i = 0; i < 300; ++i) {
      to.position_m += way_m / 300.0;
      forces.push_back(bench.step_to(to).wrench.force_n);
      forces.push_back(bench.part().position_m);
    }
  }
  return forces;
}

TEST(TwoSided, WhichWayTheNormalsPointChangesNoBit) {
  for (const double height_m : {kHalf, kHalf + 4 * kS}) {  // seated, and in free space
    SCOPED_TRACE(height_m);
    const std::vector<glm::dvec3> forces =
        forces_of(floor_scene(), sheets(false), at_height(height_m));
    EXPECT_EQ(forces, forces_of(floor_scene(), sheets(true), at_height(height_m)));
    double max_n = 0;
    for (std::size_t n = 0; n < forces.size(); n += 2) max_n = std::max(max_n, forces[n].z);
    EXPECT_GT(max_n, 5);  // held off the floor
  }
}

// A sheet of the scene holds it off from both sides.
TEST(TwoSided, ASheetOfTheSceneIsNotCrossed) {
  MotionBench bench(sheet_scene(), sheets(true), at_height(kHalf + 4 * kS));
  Pose to = bench.part();
  for (int i = 0; i < 600; ++i) {
    to.position_m.z -= 0.0001;
    bench.step_to(to);
    ASSERT_GT(bench.part().position_m.z, kHalf);
  }
}

std::string refusal(const VoxelScene& scene, const BenchOptions& options) {
  try {
    MotionBench(scene, sheets(false), at_height(8 * kS), options);
    return "";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

TEST(TwoSided, NeedsStoredDistances) {
  EXPECT_EQ(refusal(floor_scene(), {}), "");
  BenchOptions paper;
  paper.model = Model::kPaper;
  EXPECT_NE(refusal(floor_scene(), paper).find("open sheets"), std::string::npos);
  VoxelScene lean = floor_scene();
  lean.codes.clear();
  lean.distances = {};
  EXPECT_NE(refusal(lean, {}).find("--kind lean"), std::string::npos);
}

// Where a sheet of the part starts in a sheet of the scene, nothing tells on which side it is.
TEST(TwoSided, AStartInASheetIsRefused) {
  MotionBench bench(sheet_scene(), sheets(false), at_height(kHalf));
  PartStart start;
  start.world_from_part = at_height(kHalf);
  const auto begun = bench.simulation->begin(start, at_height(kHalf));
  ASSERT_FALSE(begun);
  EXPECT_EQ(begun.error().code, ErrorCode::kUsage);
  EXPECT_NE(begun.error().what.find("open sheets"), std::string::npos);
}

}  // namespace
}  // namespace forcelayer::test
