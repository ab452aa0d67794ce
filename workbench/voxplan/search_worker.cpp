#include "workbench/voxplan/search_worker.h"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/PlannerData.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/goals/GoalSampleableRegion.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/kpiece/KPIECE1.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <algorithm>
#include <array>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

#include "runtime/model/principal_inertia.h"
#include "workbench/exact/watch.h"
#include "workbench/voxplan/pose_space.h"
#include "workbench/voxplan/pose_tree.h"
#include "workbench/voxplan/slide.h"

namespace forcelayer::voxplan {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

constexpr double kSlides =
    0.75;  // fraction of the samples near a seat's pose that follow its floors
constexpr double kSlideVoxels = 4;  // length of a step
constexpr double kMinSlide = 0.05;  // of a step; a shorter slide is given up
constexpr int kLifts = 3;           // corrections of a pose off the floors, each to first order
constexpr int kDirections = 26;     // tried straight by the first worker,
constexpr int kAxes = 6;            // beginning with the world's axes
constexpr double kCellVoxels = 6;   // side of the cells in which KPIECE counts its visits
constexpr double kMinKept = 0.01;   // of a motion; a shorter kept piece is given up
constexpr unsigned kMaxGoals = 1000;
constexpr int kHeldBy = 20;  // random motions that show what blocks the part
// The clock is read once in so many poses or checks for the end, because processor time costs a
// system call.
constexpr std::uint64_t kClockEvery = 64;

// Whether a slide may follow the floors, or ends where it cannot go straight on.
enum class Turns { kNever, kToFloors };

// Moves the part by short steps in one direction until it is out of its seat: straight where the
// rule of the seat allows it, else as the floors allow. Returns the poses; each can be reached
// straight from the one before.
std::vector<Pose> slid(PoseCheck& check, const Pose& from, const Twist6& wanted, double length_m,
                       Turns turns) {
  const double radius_m = check.problem().part.header().bounding_radius_m;
  const double step_m = kSlideVoxels * check.problem().scene.voxel_size_m();
  Twist6 motion = of_length(wanted, step_m);
  bool turned = false;  // the direction now follows the floors
  std::vector<Pose> trail{from};
  for (double travel_m = 0; travel_m < length_m; travel_m += step_m) {
    Pose there = moved(trail.back(), motion, radius_m);
    if (!check.holds(Rule::kInSeat, there)) {
      if (turns == Turns::kNever) break;
      const Twist6 step = allowed_twist(motion, check.floors(trail.back()), radius_m);
      if (length_of(step) < kMinSlide * step_m) break;
      if (!turned) motion = of_length(step, step_m);
      turned = true;
      there = moved(trail.back(), step, radius_m);
      if (!check.holds(Rule::kInSeat, there)) break;
    }
    if (!check.is_kept(Rule::kInSeat, trail.back(), there)) break;
    trail.push_back(there);
    if (check.holds(Rule::kClear, there)) break;
  }
  return trail;
}

// A random direction for a slide, or one in which all floors resist little.
Twist6 slide_direction(PoseCheck& check, const Pose& from, Random& random) {
  const Twist6 any = random_twist(1, random);
  if (random.fraction() < 0.5) return any;
  const double radius_m = check.problem().part.header().bounding_radius_m;
  return free_twist(any, check.floors(from), radius_m);
}

// Draws the poses that a planner tries.
class Sampler final : public ob::StateSampler {
 public:
  Sampler(const ob::StateSpace* space, PoseCheck& check, const Destination& goal, Random& random)
      : StateSampler(space), check_(check), goal_(goal), random_(random) {}

  void sampleUniform(ob::State* state) override {
    Pose pose = check_.problem().world_from_start;
    if (random_.fraction() < 0.5) pose.orientation = random_.orientation();
    for (int axis = 0; axis < 3; ++axis) {
      pose.position_m[axis] = random_.between(goal_.bounds().low[axis], goal_.bounds().high[axis]);
    }
    put(pose, state);
  }

  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    const Pose from = pose_of(near);
    const double length_m = distance * std::pow(random_.fraction(), 2);
    const bool slides = check_.has_seat() && random_.fraction() < kSlides;
    put(slides ? slide(from, length_m) : moved(from, random_twist(length_m, random_), radius_m_),
        state);
    space_->enforceBounds(state);
  }

  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    sampleUniformNear(state, mean, deviation);
  }

 private:
  // Slides to a pose that can be reached straight.
  Pose slide(const Pose& from, double length_m) {
    std::vector<Pose> trail =
        slid(check_, from, slide_direction(check_, from, random_), length_m, Turns::kToFloors);
    while (trail.size() > 2 && !check_.is_kept(Rule::kInSeat, from, trail.back())) {
      trail.resize(trail.size() / 2 + 1);
    }
    return trail.back();
  }

  PoseCheck& check_;
  const Destination& goal_;
  Random& random_;
  double radius_m_ = check_.problem().part.header().bounding_radius_m;
};

class Validity final : public ob::StateValidityChecker {
 public:
  Validity(const ob::SpaceInformationPtr& space, PoseCheck& check, Rule rule)
      : StateValidityChecker(space), check_(check), rule_(rule) {}
  bool isValid(const ob::State* state) const override {
    return si_->satisfiesBounds(state) && check_.holds(rule_, pose_of(state), known_of(state));
  }

 private:
  PoseCheck& check_;
  Rule rule_;
};

class Motions final : public ob::MotionValidator {
 public:
  Motions(const ob::SpaceInformationPtr& space, PoseCheck& check, Rule rule)
      : MotionValidator(space), check_(check), rule_(rule) {}

  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    if (!si_->satisfiesBounds(to)) return false;
    clearance::KnownEnds known{known_of(from), known_of(to)};
    const bool is_kept = check_.is_kept(rule_, pose_of(from), pose_of(to), known);
    if (is_kept) known_of(from) = known.first, known_of(to) = known.last;
    return is_kept;
  }

  bool checkMotion(const ob::State* from, const ob::State* to,
                   std::pair<ob::State*, double>& last) const override {
    const double fraction = check_.fraction_kept(rule_, pose_of(from), pose_of(to));
    if (fraction == 1) return true;
    last.second = fraction;
    if (last.first != nullptr) put(pose_between(pose_of(from), pose_of(to), fraction), last.first);
    return false;
  }

 private:
  PoseCheck& check_;
  Rule rule_;
};

// The goal of the first planner: poses at which the clearance is proven.
class OutOfSeat final : public ob::Goal {
 public:
  OutOfSeat(const ob::SpaceInformationPtr& space, PoseCheck& check) : Goal(space), check_(check) {}
  bool isSatisfied(const ob::State* state) const override {
    return check_.holds(Rule::kClear, pose_of(state));
  }

 private:
  PoseCheck& check_;
};

class GoalRegion final : public ob::GoalSampleableRegion {
 public:
  GoalRegion(const ob::SpaceInformationPtr& space, const Destination& goal, Random& random)
      : GoalSampleableRegion(space), goal_(goal), random_(random) {
    setThreshold(1e-9);
  }
  double distanceGoal(const ob::State* state) const override {
    return goal_.distance_m(pose_of(state));
  }
  void sampleGoal(ob::State* state) const override { put(goal_.sample(random_), state); }
  unsigned maxSampleCount() const override { return goal_.is_one_pose() ? 1 : kMaxGoals; }

 private:
  const Destination& goal_;
  Random& random_;
};

// RRT-Connect, whose trees find the nearest pose by PoseIndex.
class Connect final : public og::RRTConnect {
 public:
  Connect(const ob::SpaceInformationPtr& space, double turn_m) : RRTConnect(space) {
    tStart_ = std::make_shared<PoseTree<Motion*>>(turn_m);
    tGoal_ = std::make_shared<PoseTree<Motion*>>(turn_m);
  }
  // The path in the tree from the start to the pose that is farthest from `from_m`.
  std::vector<Pose> farthest_path(const glm::dvec3& from_m) const {
    std::vector<Motion*> motions;
    tStart_->list(motions);
    std::vector<Pose> path;
    double out_m = -1;
    const Motion* farthest = nullptr;
    for (const Motion* motion : motions) {
      const double travel_m = glm::length(pose_of(motion->state).position_m - from_m);
      if (travel_m > out_m) out_m = travel_m, farthest = motion;
    }
    for (; farthest != nullptr; farthest = farthest->parent) {
      path.push_back(pose_of(farthest->state));
    }
    std::reverse(path.begin(), path.end());
    return path;
  }
};

// The path by which a planner's tree leads from its start to the pose that is farthest from
// `from_m`. OMPL lists a tree with its edges in hash maps.
std::vector<Pose> farthest_path(const ob::Planner& planner, const glm::dvec3& from_m) {
  if (const auto* connect = dynamic_cast<const Connect*>(&planner)) {
    return connect->farthest_path(from_m);
  }
  ob::PlannerData tree(planner.getSpaceInformation());
  planner.getPlannerData(tree);
  std::vector<Pose> path;
  double out_m = -1;
  unsigned vertex = 0;
  for (unsigned i = 0; i < tree.numVertices(); ++i) {
    const double travel_m = glm::length(pose_of(tree.getVertex(i).getState()).position_m - from_m);
    if (travel_m > out_m) out_m = travel_m, vertex = i;
  }
  std::vector<unsigned> before{vertex};
  for (unsigned n = 0; n < tree.numVertices() && !before.empty(); ++n) {
    path.push_back(pose_of(tree.getVertex(before.front()).getState()));
    tree.getIncomingEdges(std::exchange(before, {}).front(), before);
  }
  std::reverse(path.begin(), path.end());
  return path;
}

std::vector<Pose> poses_of(const og::PathGeometric& path) {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < path.getStateCount(); ++i) poses.push_back(pose_of(path.getState(i)));
  return poses;
}

// The principal axes of the part's inertia, in its frame: a shaft comes out along one of them.
std::array<glm::dvec3, 3> principal_axes(const PshellHeader& header) {
  const auto& [xx, yy, zz, xy, xz, yz] = header.inertia_m2;
  const glm::dmat3 axes = model::principal_inertia({xx, xy, xz, xy, yy, yz, xz, yz, zz}).axes;
  return {axes[0], axes[1], axes[2]};
}

// The path without the poses that can be left out.
std::vector<Pose> without_needless(PoseCheck& check, const std::vector<Pose>& path) {
  std::vector<Pose> few{path.front()};
  for (std::size_t i = 0; i + 1 < path.size();) {
    std::size_t next = path.size() - 1;
    while (next > i + 1 && !check.is_kept(Rule::kInSeat, path[i], path[next])) {
      next = i + (next - i + 1) / 2;
    }
    few.push_back(path[next]);
    i = next;
  }
  return few;
}

}  // namespace

void seed_planners(std::uint64_t seed) {
  ompl::msg::noOutputHandler();
  ompl::RNG::setSeed(
      static_cast<std::uint_fast32_t>(seed % 0x7fffffff + 1));  // 0 is no seed to OMPL
}

struct SearchWorker::Parts {
  Parts(const Problem& of, const Destination& to, std::size_t its_number, std::uint64_t seed,
        std::unique_ptr<PoseCheck> pose_check)
      : problem(of),
        goal(to),
        number(its_number),
        random(seed * 1000003 + its_number),
        check(std::move(pose_check)) {}

  // A turn counts as the distance that the part's farthest point moves.
  double turn_m() const { return 2 * problem.part.header().bounding_radius_m; }
  void begin();
  ob::SpaceInformationPtr make_space(Rule rule);
  void plan_in_seat();
  void plan_beyond(const Pose& from);
  void take_out_of_seat();
  void leave_seat(const std::vector<Pose>& path);
  bool leave_seat_straight();
  bool go_straight(const Pose& from);
  bool turn_and_go(const Pose& from);
  glm::dvec3 direction(int n);
  std::vector<Pose> off_the_floors(const std::vector<Pose>& path);
  void take_to_goal();
  bool is_farther(const Pose& pose);
  void note_farthest();

  const Problem& problem;
  const Destination& goal;
  std::size_t number;
  Random random;
  std::unique_ptr<PoseCheck> check;
  ob::SpaceInformationPtr space;
  ob::ProblemDefinitionPtr question;
  ob::PlannerPtr planner;
  Rule rule = Rule::kInSeat;
  std::vector<Pose> in_seat, beyond;
  bool done = false;
  std::vector<Pose> farthest{problem.world_from_start};  // the path to the farthest pose
  double out_m = 0;
};

ob::SpaceInformationPtr SearchWorker::Parts::make_space(Rule of) {
  auto poses = std::make_shared<PoseSpace>(
      goal.bounds(), turn_m(), kCellVoxels * problem.scene.voxel_size_m(),
      [this](const ob::StateSpace* of_space) {
        return std::make_shared<Sampler>(of_space, *check, goal, random);
      });
  poses->setup();
  auto made = std::make_shared<ob::SpaceInformation>(poses);
  made->setStateValidityChecker(std::make_shared<Validity>(made, *check, of));
  made->setMotionValidator(std::make_shared<Motions>(made, *check, of));
  made->setup();
  return made;
}

void SearchWorker::Parts::plan_in_seat() {
  rule = Rule::kInSeat;
  space = make_space(rule);
  question = std::make_shared<ob::ProblemDefinition>(space);
  PoseState start;
  start.pose = problem.world_from_start;
  question->addStartState(&start);
  question->setGoal(std::make_shared<OutOfSeat>(space, *check));
  auto kpiece = std::make_shared<og::KPIECE1>(space);
  const double radius_m = problem.part.header().bounding_radius_m;
  kpiece->setRange((number % 2 == 0 ? 4 : 1) * radius_m);
  kpiece->setMinValidPathFraction(kMinKept);
  planner = kpiece;
  planner->setProblemDefinition(question);
  planner->setup();
}

void SearchWorker::Parts::plan_beyond(const Pose& from) {
  rule = Rule::kClear;
  if (number == 0 && (go_straight(from) || turn_and_go(from))) return;
  space = make_space(rule);
  question = std::make_shared<ob::ProblemDefinition>(space);
  PoseState start;
  start.pose = from;
  question->addStartState(&start);
  question->setGoal(std::make_shared<GoalRegion>(space, goal, random));
  auto connect = std::make_shared<Connect>(space, turn_m());
  connect->setRange((number % 2 == 0 ? 1 : 0.25) * problem.part.header().bounding_radius_m);
  planner = connect;
  planner->setProblemDefinition(question);
  planner->setup();
}

// Whether a pose is farther from the start than all before. Notes how far.
bool SearchWorker::Parts::is_farther(const Pose& pose) {
  const double travel_m = glm::length(pose.position_m - problem.world_from_start.position_m);
  if (travel_m <= out_m) return false;
  out_m = travel_m;
  return true;
}

// In the tree that grows from the start, which may be the end of the seat.
void SearchWorker::Parts::note_farthest() {
  if (planner == nullptr) return;  // the time was over before
  const glm::dvec3& start_m = problem.world_from_start.position_m;
  const std::vector<Pose> path = farthest_path(*planner, start_m);
  if (path.empty() || !is_farther(path.back())) return;
  farthest = rule == Rule::kInSeat ? std::vector<Pose>() : in_seat;
  if (!farthest.empty()) farthest.pop_back();  // the root of the tree
  farthest.insert(farthest.end(), path.begin(), path.end());
}

void SearchWorker::Parts::take_out_of_seat() {
  og::PathGeometric path(*question->getSolutionPath()->as<og::PathGeometric>());
  og::PathSimplifier(space).reduceVertices(path);
  leave_seat(off_the_floors(poses_of(path)));
}

// Keeps the path up to the first pose with a proven clearance. There the seat is left for good.
void SearchWorker::Parts::leave_seat(const std::vector<Pose>& path) {
  in_seat = up_to_first(path, problem,
                        [&](const Pose& pose) { return check->holds(Rule::kClear, pose); });
  plan_beyond(in_seat.back());
}

// Finds a straight motion out of the seat: along the axes of the world, because people pull that
// way; else along the floors and the part's principal axes; else along the flat sides of the
// meshes, which are many, and each takes time; else of slides in some directions. Of these, takes
// the shortest that leads straight on to the goal, else the shortest. Returns whether it found one.
bool SearchWorker::Parts::leave_seat_straight() {
  const Pose& start = problem.world_from_start;
  const Box& bounds = goal.bounds();
  std::vector<Pose> nearest;
  double nearest_m = glm::length(bounds.high - bounds.low);
  const auto go = [&](const Twist6& motion, Turns turns, double max_m) -> std::optional<Pose> {
    std::vector<Pose> trail = slid(*check, start, motion, max_m, turns);
    if (is_farther(trail.back())) farthest = trail;
    if (!check->holds(Rule::kClear, trail.back())) return {};
    const Pose out = trail.back();
    const double travel_m = travel_between_m(problem, start, out);
    if (travel_m < nearest_m) nearest_m = travel_m, nearest = std::move(trail);
    return out;
  };
  const auto along = [](const glm::dvec3& d) { return Twist6{d.x, d.y, d.z, 0, 0, 0}; };
  std::vector<glm::dvec3> axes;
  for (int n = 0; n < kAxes; ++n) axes.push_back(direction(n));
  std::vector<glm::dvec3> of_floors = free_directions(check->floors(start)), of_meshes;
  for (const glm::dvec3& axis : principal_axes(problem.part.header())) {
    for (const double sign : {1.0, -1.0}) of_floors.push_back(start.orientation * (sign * axis));
  }
  if (problem.seat_meshes != nullptr) of_meshes = problem.seat_meshes->directions();
  check->test_meshes_every(kSlideVoxels);  // a part in its bore touches it all along
  const auto is_clear = [&](const Pose& pose) { return check->holds(Rule::kClear, pose); };
  double straight_m = nearest_m;
  for (const auto* directions : {&axes, &of_floors, &of_meshes}) {
    for (const glm::dvec3& d : *directions) {
      const auto out = go(along(d), Turns::kNever, goal.is_one_pose() ? nearest_m : straight_m);
      if (!out || goal.is_one_pose()) continue;
      const std::vector<Pose> path = up_to_first({start, *out}, problem, is_clear);
      const double travel_m = travel_between_m(problem, start, path.back());
      const std::optional<Pose> there = goal.straight_from(path.back(), d);
      if (!there || travel_m >= straight_m) continue;
      if (!check->is_kept(Rule::kClear, path.back(), *there)) continue;
      in_seat = path;
      beyond = {path.back(), *there};
      straight_m = travel_m;
      done = true;
    }
    if (!nearest.empty()) break;
  }
  check->test_meshes_every(PoseCheck::kMeshStepVoxels);
  if (done) return true;
  if (!nearest.empty()) {
    leave_seat({start, nearest.back()});
    return true;
  }
  for (int n = 0; n < kDirections; ++n) {
    Twist6 motion = along(direction(n));
    if (n >= kAxes && n % 2 == 0) motion = slide_direction(*check, start, random);
    go(motion, Turns::kToFloors, nearest_m);
  }
  if (nearest.empty()) return false;
  leave_seat(off_the_floors(without_needless(*check, nearest)));
  return true;
}

// Finds the shortest straight motion to the goal, like leave_seat_straight().
bool SearchWorker::Parts::go_straight(const Pose& from) {
  std::optional<Pose> nearest;
  for (int n = 0; n < kDirections; ++n) {
    const std::optional<Pose> there = goal.straight_from(from, direction(n));
    if (!there) continue;
    const double travel_m = travel_between_m(problem, from, *there);
    if (nearest && travel_m >= travel_between_m(problem, from, *nearest)) continue;
    if (check->is_kept(Rule::kClear, from, *there)) nearest = there;
  }
  if (!nearest) return false;
  beyond = {from, *nearest};
  done = true;
  return true;
}

// Finds the shortest motion of a quarter turn about an axis of the world, then straight along an
// axis. It finds windows that the part fits only in that attitude, which random poses rarely hit.
bool SearchWorker::Parts::turn_and_go(const Pose& from) {
  std::vector<Pose> shortest;
  double shortest_m = std::numeric_limits<double>::infinity();
  for (int n = 0; n < kAxes; ++n) {
    const glm::dquat turn = glm::angleAxis(std::numbers::pi / 2, direction(n));
    const Pose turned{from.position_m, turn * from.orientation};
    if (!check->is_kept(Rule::kClear, from, turned)) continue;
    for (int axis = 0; axis < kAxes; ++axis) {
      const std::optional<Pose> there = goal.straight_from(turned, direction(axis));
      if (!there) continue;
      const double travel_m =
          travel_between_m(problem, from, turned) + travel_between_m(problem, turned, *there);
      if (travel_m >= shortest_m || !check->is_kept(Rule::kClear, turned, *there)) continue;
      shortest = {from, turned, *there};
      shortest_m = travel_m;
    }
  }
  if (shortest.empty()) return false;
  beyond = std::move(shortest);
  done = true;
  return true;
}

// Direction number `n`; the axes come first.
glm::dvec3 SearchWorker::Parts::direction(int n) {
  glm::dvec3 d(0);
  if (n >= kAxes) return random.direction();
  d[n / 2] = n % 2 == 0 ? 1 : -1;
  return d;
}

// The path, moved off the floors where possible. Poses pressed on floors are at the limit of the
// rule, and smoothing would push them over it.
std::vector<Pose> SearchWorker::Parts::off_the_floors(const std::vector<Pose>& path) {
  const double radius_m = problem.part.header().bounding_radius_m;
  std::vector<Pose> shallow =
      with_more_poses(problem, path, kSlideVoxels * problem.scene.voxel_size_m());
  for (std::size_t i = 1; i < shallow.size(); ++i) {
    for (int n = 0; n < kLifts; ++n) {
      shallow[i] =
          moved(shallow[i], allowed_twist({}, check->floors(shallow[i]), radius_m), radius_m);
    }
    if (!check->is_kept(Rule::kInSeat, shallow[i - 1], shallow[i])) return path;
  }
  return shallow;
}

void SearchWorker::Parts::take_to_goal() {
  og::PathGeometric path(*question->getSolutionPath()->as<og::PathGeometric>());
  og::PathSimplifier simplifier(space);
  simplifier.reduceVertices(path);
  simplifier.shortcutPath(path);
  simplifier.reduceVertices(path);
  beyond = poses_of(path);
  done = true;
}

SearchWorker::SearchWorker(const Problem& problem, const Destination& goal, std::size_t number,
                           std::uint64_t seed, std::unique_ptr<PoseCheck> check)
    : parts_(std::make_unique<Parts>(problem, goal, number, seed, std::move(check))) {}
SearchWorker::~SearchWorker() = default;

void SearchWorker::begin() { parts_->begin(); }

void SearchWorker::Parts::begin() {
  done = false;
  in_seat.clear();
  if (check->holds(Rule::kClear, problem.world_from_start)) {
    plan_beyond(problem.world_from_start);
  } else if (number != 0 || !leave_seat_straight()) {
    plan_in_seat();
  }
}

void SearchWorker::refuse(const Pose& pose) {
  parts_->check->refuse(pose);
  if (parts_->done) parts_->begin();
}

void SearchWorker::work(std::uint64_t poses, const std::function<bool()>& is_over) {
  Parts& p = *parts_;
  if (p.done) return;
  const std::uint64_t enough = p.check->poses_tested() + poses;
  std::uint64_t asked = 0, next_clock = 0;
  const ob::PlannerTerminationCondition stop([&] {
    const std::uint64_t tested = p.check->poses_tested();
    if (tested >= enough) return true;
    if (++asked < kClockEvery && tested < next_clock) return false;
    asked = 0;
    next_clock = tested + kClockEvery;
    return is_over();
  });
  p.planner->solve(stop);
}

void SearchWorker::take_stock() {
  Parts& p = *parts_;
  if (p.done || !p.question->hasExactSolution()) return;
  p.note_farthest();
  if (p.rule == Rule::kInSeat) {
    p.take_out_of_seat();
  } else {
    p.take_to_goal();
  }
}

void SearchWorker::note_farthest() {
  if (!parts_->done) parts_->note_farthest();
}

bool SearchWorker::is_done() const { return parts_->done; }
const std::vector<Pose>& SearchWorker::in_seat() const { return parts_->in_seat; }
const std::vector<Pose>& SearchWorker::beyond() const { return parts_->beyond; }
double SearchWorker::out_m() const { return parts_->out_m; }
const PosePath& SearchWorker::farthest() const { return parts_->farthest; }
std::uint64_t SearchWorker::poses_tested() const { return parts_->check->poses_tested(); }
std::uint64_t SearchWorker::motions_tested() const { return parts_->check->motions_tested(); }
std::uint64_t SearchWorker::motions_kept() const { return parts_->check->motions_kept(); }
double SearchWorker::kept_m() const { return parts_->check->kept_m(); }

// Tries motions of a planner's length from the farthest pose: away from the start, and in random
// directions, with and without turns. The object that ends the way so far counts most.
Blockers SearchWorker::blocked_by() const {
  Parts& p = *parts_;
  const double radius_m = p.problem.part.header().bounding_radius_m;
  const Pose& farthest = p.farthest.back();
  const glm::dvec3 shift_m = farthest.position_m - p.problem.world_from_start.position_m;
  std::vector<Twist6> motions;
  if (p.out_m > 0) motions.push_back({shift_m.x, shift_m.y, shift_m.z, 0, 0, 0});
  for (std::size_t n = 0; n < 6; ++n) {
    for (const double sign : {1.0, -1.0}) motions.emplace_back()[n] = sign;
  }
  Random random(1);
  for (int n = 0; n < kHeldBy; ++n) motions.push_back(random_twist(1, random));
  std::map<std::uint32_t, std::size_t> refused;
  Blockers found;
  try {
    for (std::size_t n = 0; n < motions.size(); ++n) {
      const Pose there = moved(farthest, of_length(motions[n], 2 * radius_m), radius_m);
      const bool goes_on = n == 0 && p.out_m > 0;
      refused[p.check->met(p.rule, farthest, there)] += goes_on ? motions.size() : 1;
    }
    found.is_complete = true;
  } catch (const exact::Stopped&) {
    // The time is over: the objects that were met by then are known.
  }
  refused.erase(0);
  for (const auto& [object, times] : refused) found.objects.push_back(object);
  std::stable_sort(found.objects.begin(), found.objects.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return refused.at(a) > refused.at(b); });
  return found;
}

}  // namespace forcelayer::voxplan
