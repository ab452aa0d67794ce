// The nearest pose of a planner's tree is exactly that of OMPL's linear search, its twin, for every
// width of vectors: among poses of a search, beside each other, the same ones again, and turned by
// nearly a whole turn, while the tree grows and shrinks.
#include <gtest/gtest.h>

#include <cmath>
#include <deque>

#include "runtime/coupling/coupling.h"
#include "tests/support/every_target.h"
#include "workbench/voxplan/pose_tree.h"
#include "workbench/voxplan/random.h"

namespace forcelayer::test {
namespace {

using voxplan::PoseState;
using voxplan::Random;

struct Motion {
  PoseState* state;
};

constexpr double kTurnM = 0.1;

// Both trees, and the poses that they hold.
struct Trees {
  voxplan::PoseTree<const Motion*> tree{kTurnM};
  ompl::NearestNeighborsLinear<const Motion*> linear;
  std::deque<PoseState> states;
  std::deque<Motion> motions;

  Trees() {
    const auto distance = [](const Motion* a, const Motion* b) {
      return voxplan::pose_distance_m(a->state->pose, b->state->pose, kTurnM);
    };
    tree.setDistanceFunction(distance);
    linear.setDistanceFunction(distance);
  }
  const Motion* make(const Pose& pose) {
    states.emplace_back();
    states.back().pose = pose;
    motions.push_back({&states.back()});
    return &motions.back();
  }
  void add(const Pose& pose) {
    const Motion* const motion = make(pose);
    tree.add(motion);
    linear.add(motion);
  }
  bool agree(const Pose& pose) {
    PoseState state;
    state.pose = pose;
    const Motion asked{&state};
    return tree.nearest(&asked) == linear.nearest(&asked);
  }
};

class PoseIndexOfTarget : public EveryTarget {};

INSTANTIATE_TEST_SUITE_P(Targets, PoseIndexOfTarget,
                         ::testing::ValuesIn(hwy::SupportedAndGeneratedTargets()));

Pose any(Random& random, double side_m) {
  const glm::dvec3 position_m(random.between(-side_m, side_m), random.between(-side_m, side_m),
                              random.between(-side_m, side_m));
  return {position_m, random.fraction() < 0.5 ? glm::dquat(1, 0, 0, 0) : random.orientation()};
}

Pose beside(const Pose& pose, double length_m, Random& random) {
  const glm::dvec3 path = random.direction(), axis = random.direction();
  const double travel_m = length_m * random.fraction(), turn_rad = length_m * random.normal();
  return {pose.position_m + travel_m * path,
          glm::normalize(coupling::rotation_by(turn_rad * axis) * pose.orientation)};
}

TEST_P(PoseIndexOfTarget, FindsWhatALinearSearchFinds) {
  for (const double side_m : {0.0, 1e-7, 0.2, 3e3}) {
    Random random(17);
    Trees trees;
    trees.add(any(random, side_m));
    int differ = 0;
    for (int n = 0; n < 3000; ++n) {
      const Pose& old = trees.states[random.below(trees.states.size())].pose;
      const double kind = random.fraction();
      const Pose asked = kind < 0.4   ? any(random, side_m)
                         : kind < 0.8 ? beside(old, std::pow(10, random.between(-9, -1)), random)
                                      : old;
      differ += trees.agree(asked) ? 0 : 1;
      differ += trees.agree({asked.position_m, -asked.orientation}) ? 0 : 1;
      // Some are added while the same pose is asked for again and again.
      for (std::size_t more = random.below(3); more > 0; --more) {
        trees.add(random.fraction() < 0.9 ? beside(asked, 0.01, random) : asked);
        differ += trees.agree(asked) ? 0 : 1;
      }
    }
    EXPECT_EQ(differ, 0) << side_m;
    EXPECT_GT(trees.tree.size(), 2000u);
  }
}

// Half a turn from the start w is 0: one side of it lies in the tree as the negative of the other.
TEST_P(PoseIndexOfTarget, FindsANeighborOnTheOtherSideOfHalfATurn) {
  Random random(4);
  Trees trees;
  const auto about_half = [&] {
    return Pose{{0, 0, 0},
                coupling::rotation_by((M_PI + random.between(-1e-3, 1e-3)) * random.direction())};
  };
  int differ = 0;
  for (int n = 0; n < 2000; ++n) {
    trees.add(about_half());
    differ += trees.agree(about_half()) ? 0 : 1;
  }
  EXPECT_EQ(differ, 0);
}

// As many equal poses as no cut parts; the first of them is the nearest.
TEST_P(PoseIndexOfTarget, HoldsAPoseManyTimes) {
  Trees trees;
  for (int n = 0; n < 500; ++n) trees.add({{1, 2, 3}, {1, 0, 0, 0}});
  EXPECT_TRUE(trees.agree({{1, 2, 3}, {1, 0, 0, 0}}));
  EXPECT_TRUE(trees.agree({{0, 2, 3}, {0, 1, 0, 0}}));
}

TEST(PoseTree, ForgetsWhatIsTakenOut) {
  Random random(6);
  Trees trees;
  EXPECT_THROW(trees.agree({}), ompl::Exception);
  for (int n = 0; n < 300; ++n) trees.add(any(random, 0.2));
  for (std::size_t n = 0; n < 200; ++n) {
    const Pose pose = trees.motions[n].state->pose;
    EXPECT_TRUE(trees.agree(pose));
    EXPECT_TRUE(trees.tree.remove(&trees.motions[n]));
    EXPECT_TRUE(trees.linear.remove(&trees.motions[n]));
    EXPECT_TRUE(trees.agree(pose)) << n;
  }
  EXPECT_FALSE(trees.tree.remove(&trees.motions[0]));
  trees.tree.clear();
  trees.linear.clear();
  for (int n = 0; n < 100; ++n) {
    trees.add(any(random, 0.2));
    EXPECT_TRUE(trees.agree(any(random, 0.2))) << n;
  }
}

}  // namespace
}  // namespace forcelayer::test
