#include "tests/bench/puzzle_bench_fcl.h"

#include <fcl/narrowphase/collision.h>
#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/goals/GoalSampleableRegion.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <cmath>

#include "tests/bench/bench_report.h"
#include "tests/support/fcl_model.h"
#include "workbench/voxplan/random.h"

namespace forcelayer::bench {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

using Model = fcl::BVHModel<fcl::OBBRSSd>;

// A space whose motions are tested in steps of travel. OMPL's own divides the way and the turn each
// by a fraction of its extent, which makes the steps of a turn several times as short.
class Space final : public ob::SE3StateSpace {
 public:
  Space(double radius_m, double step_m) : step_m_(step_m) { setSubspaceWeight(1, 2 * radius_m); }
  unsigned validSegmentCount(const ob::State* a, const ob::State* b) const override {
    return static_cast<unsigned>(std::max(1.0, std::ceil(distance(a, b) / step_m_)));
  }

 private:
  double step_m_;
};

constexpr std::uint64_t kPosesARound = 4000;
constexpr std::uint64_t kClockEvery = 64;  // poses, as of voxplan
constexpr unsigned kMaxGoals = 1000;

Pose pose_of(const ob::State* state) {
  const auto& s = *state->as<ob::SE3StateSpace::StateType>();
  const auto& q = s.rotation();
  return {{s.getX(), s.getY(), s.getZ()}, {q.w, q.x, q.y, q.z}};
}

// OMPL's test of motions, which adds up what it keeps.
class Motions final : public ob::DiscreteMotionValidator {
 public:
  Motions(const ob::SpaceInformationPtr& space, Trial& result)
      : DiscreteMotionValidator(space), result_(result) {}
  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    ++result_.motions;
    if (!DiscreteMotionValidator::checkMotion(from, to)) return false;
    ++result_.kept;
    result_.kept_m += si_->distance(from, to);
    return true;
  }

 private:
  Trial& result_;
};

class OutOfScene final : public ob::GoalSampleableRegion {
 public:
  OutOfScene(const ob::SpaceInformationPtr& space, const voxplan::Destination& goal,
             voxplan::Random& random)
      : GoalSampleableRegion(space), goal_(goal), random_(random) {
    setThreshold(1e-9);
  }
  double distanceGoal(const ob::State* state) const override {
    return goal_.distance_m(pose_of(state));
  }
  void sampleGoal(ob::State* state) const override {
    const Pose pose = goal_.sample(random_);
    auto& s = *state->as<ob::SE3StateSpace::StateType>();
    s.setXYZ(pose.position_m.x, pose.position_m.y, pose.position_m.z);
    s.rotation().w = pose.orientation.w, s.rotation().x = pose.orientation.x;
    s.rotation().y = pose.orientation.y, s.rotation().z = pose.orientation.z;
  }
  unsigned maxSampleCount() const override { return kMaxGoals; }

 private:
  const voxplan::Destination& goal_;
  voxplan::Random& random_;
};

}  // namespace

struct MeshValidity::Models {
  std::shared_ptr<Model> scene, part;
  Pose center_from_part;
};

MeshValidity::MeshValidity(const Puzzle& puzzle, const voxplan::Problem& problem)
    : models_(new Models{testing::fcl_model<fcl::OBBRSSd>(puzzle.scene),
                         testing::fcl_model<fcl::OBBRSSd>(puzzle.part),
                         inverse(voxplan::part_from_center(problem.part))}) {}
MeshValidity::~MeshValidity() = default;

bool MeshValidity::is_free(const Pose& world_from_center) const {
  const fcl::CollisionRequestd request(1, false);
  fcl::CollisionResultd result;
  fcl::collide<double>(models_->scene.get(), fcl::Transform3d::Identity(), models_->part.get(),
                       testing::fcl_transform(world_from_center * models_->center_from_part),
                       request, result);
  return !result.isCollision();
}

Trial solve_by_meshes(const Puzzle& puzzle, const voxplan::Problem& problem, double step_m,
                      std::uint64_t seed, double max_s) {
  ompl::msg::noOutputHandler();
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed + 1));
  const MeshValidity validity(puzzle, problem);
  const auto goal = voxplan::Destination::out_of_scene(problem);
  voxplan::Random random(seed);
  const double radius_m = problem.part.header().bounding_radius_m;
  Trial result;
  auto poses = std::make_shared<Space>(radius_m, step_m);
  ob::RealVectorBounds bounds(3);
  for (unsigned axis = 0; axis < 3; ++axis) {
    bounds.setLow(axis, goal.bounds().low[static_cast<int>(axis)]);
    bounds.setHigh(axis, goal.bounds().high[static_cast<int>(axis)]);
  }
  poses->setBounds(bounds);
  auto space = std::make_shared<ob::SpaceInformation>(poses);
  space->setStateValidityChecker([&](const ob::State* state) {
    ++result.poses;
    return validity.is_free(pose_of(state));
  });
  poses->setup();
  space->setMotionValidator(std::make_shared<Motions>(space, result));
  space->setup();
  auto question = std::make_shared<ob::ProblemDefinition>(space);
  ob::ScopedState<ob::SE3StateSpace> start(space);
  const Pose& from = problem.world_from_start;
  start->setXYZ(from.position_m.x, from.position_m.y, from.position_m.z);
  start->rotation().w = from.orientation.w, start->rotation().x = from.orientation.x;
  start->rotation().y = from.orientation.y, start->rotation().z = from.orientation.z;
  question->addStartState(start);
  question->setGoal(std::make_shared<OutOfScene>(space, goal, random));
  std::vector<std::shared_ptr<og::RRTConnect>> planners;
  for (const double range : {1.0, 0.25, 1.0, 0.25}) {
    planners.push_back(std::make_shared<og::RRTConnect>(space));
    planners.back()->setRange(range * radius_m);
    planners.back()->setProblemDefinition(question);
    planners.back()->setup();
  }
  const double begin_s = cpu_s(), end_s = begin_s + max_s;
  while (!question->hasExactSolution() && cpu_s() < end_s) {
    for (const auto& planner : planners) {
      const std::uint64_t enough = result.poses + kPosesARound;
      std::uint64_t asked = 0, next_clock = 0;
      planner->solve(ob::PlannerTerminationCondition([&] {
        if (result.poses >= enough) return true;
        if (++asked < kClockEvery && result.poses < next_clock) return false;
        asked = 0;
        next_clock = result.poses + kClockEvery;
        return cpu_s() >= end_s;
      }));
      if (question->hasExactSolution()) break;
    }
  }
  result.found = question->hasExactSolution();
  result.seconds = cpu_s() - begin_s;
  return result;
}

}  // namespace forcelayer::bench
