// The rules of a plan against the proofs of voxcheck: what PoseCheck lets pass is clear by
// check_path(); what it cuts is kept up to there. Steps that floors allow are kept.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "runtime/clearance/path_check.h"
#include "runtime/voxplan/pose_check.h"
#include "runtime/voxplan/slide.h"
#include "runtime/voxplan/way.h"
#include "tests/support/distance_scene.h"
#include "tests/support/point_part.h"
#include "tests/support/shape_scene.h"

namespace forcelayer::test {
namespace {

using voxplan::PoseCheck;
using voxplan::Problem;
using voxplan::Rule;

constexpr double kS = 0.005;
constexpr double kHalf = 0.01;  // of the block's height

// A groove along x in a floor: as wide and as deep as the block that lies in it.
VoxelScene groove() {
  const auto distance = [](const glm::dvec3& p) {
    const double below = p.z, beside = std::abs(p.y) - 0.012;
    // The solid is z < 0, or beside the groove up to its top.
    const double wall = std::max(-beside, p.z - 2 * kHalf);
    return std::min(below, beside > 0 && p.z > 2 * kHalf ? std::hypot(0.0, p.z - 2 * kHalf) : wall);
  };
  VoxelScene scene =
      distance_scene(kS, {-24, -16, -8}, {48, 32, 28}, distance, 2, DistanceDefinition(2));
  return scene;
}

PointPart block() { return box_part({0.015, 0.012, kHalf}, 0.8 * kS, kS); }

struct Bench {
  Voxmap scene = make_voxmap(groove());
  Pshell part = make_pshell(block());
  Problem problem{scene, part, 0.004, {{0.0007, 0, kHalf}, {1, 0, 0, 0}}, {}};
  std::unique_ptr<PoseCheck> check;
  Bench() {
    auto made = PoseCheck::create(problem);
    if (!made) throw std::runtime_error(to_line(made.error()));
    check = std::move(*made);
  }
};

TEST(PoseCheck, MotionsThatAreKeptAreProvenByTheCheckOfPaths) {
  Bench bench;
  voxplan::Random random(11);
  int kept = 0, cut = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const auto pose = [&] {
      return Pose{
          {random.between(-0.05, 0.05), random.between(-0.05, 0.05), random.between(0.02, 0.1)},
          random.orientation()};
    };
    const Pose from = pose(), to = pose();
    const double share = bench.check->share_kept(Rule::kClear, from, to);
    EXPECT_EQ(bench.check->is_kept(Rule::kClear, from, to), share == 1) << trial;
    if (!bench.check->holds(Rule::kClear, from)) {
      EXPECT_EQ(share, 0) << trial;
      continue;
    }
    ++(share == 1 ? kept : cut);
    const Pose last = share == 1 ? to : voxplan::pose_between(from, to, share);
    const auto rows = voxplan::rows_of(bench.problem, {}, {from, last}, 0.1);
    const clearance::CenterPath path(rows, bench.part);
    const auto checked = clearance::check_path(bench.scene, bench.part, path,
                                               {bench.problem.clearance_m, 1, {}, {}, false});
    ASSERT_TRUE(checked) << to_line(checked.error());
    EXPECT_TRUE(checked->clear()) << trial << ": share " << share;
  }
  EXPECT_GT(kept, 20);
  EXPECT_GT(cut, 20);
}

}  // namespace
}  // namespace forcelayer::test
