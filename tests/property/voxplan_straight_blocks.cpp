// The objects in the way of a straight motion, against a twin: boxes, whose distance has a formula,
// at many poses.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <set>
#include <vector>

#include "tests/support/box_surface.h"
#include "tests/support/point_part.h"
#include "tests/support/random_numbers.h"
#include "tests/support/shape_scene.h"
#include "workbench/voxplan/check/straight_blocks.h"

namespace forcelayer::test {
namespace {

using voxplan::StraightBlock;
using voxplan::StraightBlocks;

struct Block {
  glm::dvec3 low_m, high_m;
};

double distance_m(const Block& a, const Block& b) {
  return glm::length(glm::max(glm::max(a.low_m - b.high_m, b.low_m - a.high_m), 0.0));
}

Block shifted(const Block& block, const glm::dvec3& by_m) {
  return {block.low_m + by_m, block.high_m + by_m};
}

constexpr double kS = 0.005;
constexpr double kWayM = 0.15;

struct Case {
  Voxmap scene_voxels = make_voxmap(shape_scene(
      kS, {-4, -4, -4}, {8, 8, 8}, [](const glm::dvec3& p) { return glm::length(p) < 0.01; }));
  Pshell shell = make_pshell(box_part({0.01, 0.01, 0.01}, kS, kS));
  Block part{{-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01}};
  exact::Surface part_surface, scene;
  std::vector<Block> blocks;  // of objects 1, 2 ...
  voxplan::Problem problem{scene_voxels, shell, 0, {{0, 0, 0}, {1, 0, 0, 0}}, {}};

  Case() {
    add_box(part_surface, part.low_m, part.high_m, 0);
    part_surface.largest_m = 0.01;
    scene.largest_m = 1;
  }
  void add(const Block& block) {
    blocks.push_back(block);
    add_box(scene, block.low_m, block.high_m, static_cast<std::uint32_t>(blocks.size()));
  }
};

TEST(StraightBlocks, AreThoseOfADenseLookAtBoxes) {
  Random random(68001);
  std::size_t blocked = 0;
  for (int round = 0; round < 200; ++round) {
    Case test;
    test.problem.clearance_m = uniform(random, 0.0005, 0.004);
    // Thicker than a step of the way, and farther from the part than the clearance.
    while (test.blocks.size() < 6) {
      glm::dvec3 middle(uniform(random, -0.04, 0.04), uniform(random, -0.04, 0.04),
                        uniform(random, -0.04, 0.04));
      middle[static_cast<int>(integer(random, 0, 2))] = uniform(random, -0.15, 0.15);
      const glm::dvec3 half(uniform(random, 0.004, 0.03), uniform(random, 0.004, 0.03),
                            uniform(random, 0.004, 0.03));
      const Block block{middle - half, middle + half};
      if (distance_m(test.part, block) > test.problem.clearance_m) test.add(block);
    }
    test.problem.allowed.assign(7, 0);
    test.problem.allowed[6] = 1;  // may be near
    StraightBlocks straight(test.problem, test.scene, test.part_surface);
    for (int axis = 0; axis < 6; ++axis) {
      glm::dvec3 direction(0);
      direction[axis / 2] = axis % 2 == 0 ? 1 : -1;
      double first_m = std::numeric_limits<double>::infinity();
      std::set<std::uint32_t> met;
      constexpr int kPoses = 20000;
      for (int n = 0; n <= kPoses; ++n) {
        const double at_m = kWayM * n / kPoses;
        for (std::uint32_t object = 1; object < test.blocks.size(); ++object) {
          const Block there = shifted(test.part, at_m * direction);
          if (distance_m(there, test.blocks[object - 1]) >= test.problem.clearance_m) continue;
          met.insert(object);
          first_m = std::min(first_m, at_m);
        }
      }
      const StraightBlock found = straight.along({kWayM * direction, {1, 0, 0, 0}});
      EXPECT_EQ(std::set<std::uint32_t>(found.objects.begin(), found.objects.end()), met)
          << "round " << round << ", direction " << axis;
      // Within a step of the twin, and of the last bisection.
      if (met.empty()) {
        EXPECT_EQ(found.at_m, first_m);
      } else {
        EXPECT_NEAR(found.at_m, first_m, 2 * kWayM / kPoses);
      }
      blocked += !met.empty();
    }
  }
  EXPECT_GT(blocked, 200u);
}

TEST(StraightBlocks, OfTheSeatAreInTheWayWhereThePartGoesDeeper) {
  Case test;
  test.problem.clearance_m = 0.001;
  test.add({{-0.05, -0.05, -0.02}, {0.05, 0.05, -0.01}});   // a plate that it stands on
  test.add({{-0.05, -0.05, 0.02}, {0.05, 0.05, 0.03}});     // a lid 10 mm above it
  test.add({{0.01, -0.01, -0.005}, {0.012, 0.01, 0.005}});  // a thin rib that it leans against
  const std::vector<std::uint32_t> objects{1, 3};
  const exact::SeatMeshes seat(test.scene, test.part_surface, objects,
                               test.problem.world_from_start, 0);
  test.problem.seat_meshes = &seat;
  StraightBlocks straight(test.problem, test.scene, test.part_surface);
  const auto along = [&](const glm::dvec3& direction) {
    return straight.along({kWayM * direction, {1, 0, 0, 0}});
  };
  const StraightBlock up = along({0, 0, 1}), down = along({0, 0, -1}), right = along({1, 0, 0}),
                      left = along({-1, 0, 0});
  EXPECT_EQ(up.objects, (std::vector<std::uint32_t>{2}));
  EXPECT_NEAR(up.at_m, 0.009, 1e-5);  // the last bisection is of a 32nd of the way
  EXPECT_EQ(down.objects, (std::vector<std::uint32_t>{1}));
  EXPECT_LT(down.at_m, 1e-6);
  EXPECT_EQ(right.objects, (std::vector<std::uint32_t>{3}));
  EXPECT_LT(right.at_m, 1e-6);
  EXPECT_TRUE(left.objects.empty());
  EXPECT_EQ(left.at_m, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace forcelayer::test
