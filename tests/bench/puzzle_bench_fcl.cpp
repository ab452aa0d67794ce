#include "tests/bench/puzzle_bench_fcl.h"

#include <fcl/narrowphase/collision.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/goals/GoalSampleableRegion.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include "runtime/voxplan/random.h"
#include "tests/bench/bench_report.h"
#include "tests/support/fcl_model.h"

namespace forcelayer::bench {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

using Model = fcl::BVHModel<fcl::OBBRSSd>;
using Space = ob::SE3StateSpace;

constexpr std::uint64_t kPosesARound = 4000;
constexpr unsigned kMostGoals = 1000;

Pose pose_of(const ob::State* state) {
  const auto& s = *state->as<Space::StateType>();
  const auto& q = s.rotation();
  return {{s.getX(), s.getY(), s.getZ()}, {q.w, q.x, q.y, q.z}};
}

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
    auto& s = *state->as<Space::StateType>();
    s.setXYZ(pose.position_m.x, pose.position_m.y, pose.position_m.z);
    s.rotation().w = pose.orientation.w, s.rotation().x = pose.orientation.x;
    s.rotation().y = pose.orientation.y, s.rotation().z = pose.orientation.z;
  }
  unsigned maxSampleCount() const override { return kMostGoals; }

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

PeerResult solve_by_meshes(const Puzzle& puzzle, const voxplan::Problem& problem, double step_m,
                           std::uint64_t seed, double most_s) {
  ompl::msg::noOutputHandler();
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed + 1));
  const MeshValidity validity(puzzle, problem);
  const auto goal = voxplan::Destination::out_of_scene(problem);
  voxplan::Random random(seed);
  const double radius_m = problem.part.header().bounding_radius_m;
  PeerResult result;
  auto poses = std::make_shared<Space>();
  ob::RealVectorBounds bounds(3);
  for (unsigned axis = 0; axis < 3; ++axis) {
    bounds.setLow(axis, goal.bounds().low[static_cast<int>(axis)]);
    bounds.setHigh(axis, goal.bounds().high[static_cast<int>(axis)]);
  }
  poses->setBounds(bounds);
  poses->setSubspaceWeight(1, 2 * radius_m);
  auto space = std::make_shared<ob::SpaceInformation>(poses);
  space->setStateValidityChecker([&](const ob::State* state) {
    ++result.poses;
    return validity.is_free(pose_of(state));
  });
  poses->setup();
  space->setStateValidityCheckingResolution(step_m / poses->getMaximumExtent());
  space->setup();
  auto question = std::make_shared<ob::ProblemDefinition>(space);
  ob::ScopedState<Space> start(space);
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
  const double begin_s = cpu_s();
  while (!question->hasExactSolution() && cpu_s() < begin_s + most_s) {
    for (const auto& planner : planners) {
      const std::uint64_t enough = result.poses + kPosesARound;
      planner->solve(ob::PlannerTerminationCondition(
          [&] { return result.poses >= enough || cpu_s() >= begin_s + most_s; }));
      if (question->hasExactSolution()) break;
    }
  }
  result.found = question->hasExactSolution();
  result.seconds = cpu_s() - begin_s;
  const ob::MotionValidatorPtr motions = space->getMotionValidator();
  result.motions = motions->getValidMotionCount() + motions->getInvalidMotionCount();
  return result;
}

}  // namespace forcelayer::bench
