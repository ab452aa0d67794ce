// The rules of a plan against the proofs of voxcheck: what PoseCheck lets pass is clear by
// check_path(); what it cuts is kept up to there. A search goes on where a way does not prove
// clear.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "runtime/clearance/path_check.h"
#include "runtime/coupling/coupling.h"
#include "runtime/guard/pose_guard.h"
#include "tests/support/distance_scene.h"
#include "tests/support/point_part.h"
#include "tests/support/shape_scene.h"
#include "workbench/exact/watch.h"
#include "workbench/voxplan/check/pose_check.h"
#include "workbench/voxplan/nearest/pose_index.h"
#include "workbench/voxplan/pose_path.h"
#include "workbench/voxplan/search.h"
#include "workbench/voxplan/slide.h"
#include "workbench/voxplan/smooth/smoothed.h"

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

// The same with a name, so that the block can be seated on it.
Voxmap named_groove() {
  return make_voxmap_of_objects(groove(), {"groove"}, [](const Voxel&) { return 1u; });
}

struct Bench {
  Voxmap scene;
  Pshell part = make_pshell(block());
  Problem problem;
  std::unique_ptr<PoseCheck> check;
  explicit Bench(double above_m = 0, bool is_named = false)
      : scene(is_named ? named_groove() : make_voxmap(groove())),
        problem{scene, part, 0.004, {{0.0007, 0, kHalf + above_m}, {1, 0, 0, 0}}, {}} {
    auto made = PoseCheck::create(problem);
    if (!made) throw std::runtime_error(to_line(made.error()));
    check = std::move(*made);
  }
};

// A floor, and a post on it with its face at x = 50 mm.
double above_floor(const glm::dvec3& p) { return p.z; }
double before_post(const glm::dvec3& p) {
  const double beside = 0.05 - p.x, over = p.z - 0.06;
  if (beside <= 0 && over <= 0) return std::max(beside, over);
  return std::hypot(std::max(beside, 0.0), std::max(over, 0.0));
}

TEST(PoseCheck, MeetsTheFloorOfItsSeatBeforeWhatIsBesideIt) {
  const Voxmap scene = make_voxmap_of_objects(
      distance_scene(
          kS, {-12, -12, -8}, {32, 24, 28},
          [](const glm::dvec3& p) { return std::min(above_floor(p), before_post(p)); }, 2,
          DistanceDefinition(2)),
      {"floor", "post"}, [](const Voxel& v) {
        const glm::dvec3 p = kS * (glm::dvec3(v[0], v[1], v[2]) + 0.5);
        return above_floor(p) <= before_post(p) ? 1u : 2u;
      });
  const Pshell part = make_pshell(block());
  Problem problem{scene, part, 0.004, {{0.0007, 0, kHalf}, {1, 0, 0, 0}}, {}};
  auto check = PoseCheck::create(problem);
  ASSERT_TRUE(check) << to_line(check.error());
  ASSERT_TRUE((*check)->has_seat());
  // As near to the post as the clearance allows: onward and down, both end the motion at once.
  Pose from = problem.world_from_start;
  while ((*check)->holds(Rule::kInSeat, from)) from.position_m.x += 0.01 * kS;
  from.position_m.x -= 0.01 * kS;
  const auto met = [&](const glm::dvec3& travel_m) {
    Pose to = from;
    to.position_m += travel_m;
    return (*check)->met(Rule::kInSeat, from, to);
  };
  EXPECT_EQ(met({0.05, 0, 0}), 2u);
  EXPECT_EQ(met({0, 0, -0.05}), 1u);
  EXPECT_EQ(met({0.05, 0, -0.05}), 1u);
  EXPECT_EQ(met({0, 0, 0.05}), 0u);
}

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
    const double fraction = bench.check->fraction_kept(Rule::kClear, from, to);
    EXPECT_EQ(bench.check->is_kept(Rule::kClear, from, to), fraction == 1) << trial;
    if (!bench.check->holds(Rule::kClear, from)) {
      EXPECT_EQ(fraction, 0) << trial;
      continue;
    }
    ++(fraction == 1 ? kept : cut);
    const Pose last = fraction == 1 ? to : voxplan::pose_between(from, to, fraction);
    const auto rows = voxplan::rows_of(bench.problem, {}, {from, last}, 0.1);
    const clearance::CenterPath path(rows, bench.part);
    const auto checked = clearance::check_path(bench.scene, bench.part, path,
                                               {bench.problem.clearance_m, 1, {}, {}, false});
    ASSERT_TRUE(checked) << to_line(checked.error());
    EXPECT_TRUE(checked->clear()) << trial << ": share " << fraction;
  }
  EXPECT_GT(kept, 20);
  EXPECT_GT(cut, 20);
}

// The twin: a check that was asked nothing before.
TEST(PoseCheck, NoAnswerDependsOnEarlierQuestions) {
  Bench bench;
  voxplan::Random random(12);
  const auto any = [&](double low_m, double high_m) {
    Pose pose{{}, random.orientation()};
    for (int axis = 0; axis < 2; ++axis) pose.position_m[axis] = random.between(-0.04, 0.04);
    pose.position_m.z = random.between(low_m, high_m);
    return pose;
  };
  int free = 0;
  for (int trial = 0; trial < 200; ++trial) {
    // Far away, so that bounds that are still held would skip what is near now.
    bench.check->clearance_m(any(0.1, 0.3));
    bench.check->is_kept(Rule::kClear, any(0.06, 0.1), any(0.06, 0.1));
    const Pose pose = any(0.03, 0.07), to = any(0.03, 0.1);
    const auto fresh = PoseCheck::create(bench.problem);
    ASSERT_TRUE(fresh) << to_line(fresh.error());
    EXPECT_EQ(bench.check->clearance_m(pose), (*fresh)->clearance_m(pose)) << trial;
    EXPECT_EQ(bench.check->holds(Rule::kClear, pose), (*fresh)->holds(Rule::kClear, pose)) << trial;
    EXPECT_EQ(bench.check->fraction_kept(Rule::kClear, pose, to),
              (*fresh)->fraction_kept(Rule::kClear, pose, to))
        << trial;
    free += (*fresh)->holds(Rule::kClear, pose) ? 1 : 0;
  }
  EXPECT_GT(free, 50);
  EXPECT_LT(free, 150);
}

// The twin: the look-up of a frame, and what it bars. Edges between points: runtime_seat.cpp.
TEST(SeatLookUp, TheQuickOneBarsWhatThatOfAFrameBars) {
  Bench bench;
  query::ContactQuery query(bench.scene, bench.part);
  const auto field =
      field::make_force_field(Model::kDefault, ForceKind::kDistance, bench.scene).value();
  query::CollectedPoints points;
  field::FieldSamples samples;
  field::ContactSet contacts;
  const std::uint64_t count = bench.part.view().point_count;
  points.reserve(count), samples.reserve(count), contacts.reserve(count);
  guard::PoseGuard probe(query, *field, points, samples);
  ASSERT_TRUE(probe.find_seat(bench.problem.world_from_start));
  ASSERT_FALSE(probe.seat().empty());
  probe.open_seat(true);
  voxplan::Random random(3);
  int barred = 0, free = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const double radius_m = bench.part.header().bounding_radius_m;
    const double length_m = kS * std::pow(random.fraction(), 2);
    const Pose pose = voxplan::moved(bench.problem.world_from_start,
                                     voxplan::random_twist(length_m, random), radius_m);
    probe.query_pose(pose, contacts);
    bool is_barred = false;
    for (std::uint32_t i = 0; i < contacts.count; ++i) {
      is_barred = is_barred || (contacts.is_barred[i] != 0 && contacts.of_seat[i] != 0);
    }
    ++(is_barred ? barred : free);
    EXPECT_EQ(probe.is_pushed_into_seat(pose, {}), is_barred) << trial;
    const std::uint8_t all[] = {1};
    EXPECT_FALSE(probe.is_pushed_into_seat(pose, all)) << trial;
  }
  EXPECT_GT(barred, 500);
  EXPECT_GT(free, 500);
}

// The twin: the verdict's own walk.
TEST(SeatLookUp, TheQuickWalkEndsWhereThatOfTheVerdictEnds) {
  Bench bench;
  const Pose seat = bench.problem.world_from_start;
  auto stretch = clearance::SeatStretch::find(bench.scene, bench.part, seat);
  ASSERT_TRUE(stretch);
  const double radius_m = bench.part.header().bounding_radius_m;
  voxplan::Random random(8);
  int pushed = 0, free = 0;
  for (int trial = 0; trial < 300; ++trial) {
    // Upward out of the groove, and somewhat aside.
    Pose to =
        voxplan::moved(seat, voxplan::random_twist(2 * kS * random.fraction(), random), radius_m);
    to.position_m.z += 4 * kS * random.fraction();
    const clearance::CenterPath path(
        std::vector<PathRow>{voxplan::row_of(0, seat), voxplan::row_of(1, to)}, glm::dvec3(0),
        radius_m);
    const auto verdict = stretch->first_pushed_in(path, {0, 0}, {1, 0}, {});
    const auto quick = stretch->first_moment_pushed_in(path, {0, 0}, {1, 0}, {});
    ASSERT_EQ(verdict.has_value(), quick.has_value()) << trial;
    ++(quick ? pushed : free);
    if (!quick) continue;
    EXPECT_EQ(verdict->moment.pose, quick->pose) << trial;
    EXPECT_EQ(verdict->moment.fraction, quick->fraction) << trial;
  }
  EXPECT_GT(pushed, 30);
  EXPECT_GT(free, 30);
}

TEST(PoseCheck, NoWayLeadsByARefusedPose) {
  Bench bench(0.03);
  const Pose start = bench.problem.world_from_start;
  const auto above = [&](double travel_m) {
    return Pose{start.position_m + glm::dvec3(0, 0, travel_m), start.orientation};
  };
  ASSERT_TRUE(bench.check->is_kept(Rule::kClear, start, above(0.04)));
  bench.check->refuse(above(0.02));
  EXPECT_TRUE(bench.check->holds(Rule::kClear, start));
  EXPECT_FALSE(bench.check->holds(Rule::kClear, above(0.02 + 0.9 * kS)));
  EXPECT_TRUE(bench.check->holds(Rule::kClear, above(0.02 + 1.1 * kS)));
  EXPECT_FALSE(bench.check->is_kept(Rule::kClear, start, above(0.04)));
  const double kept_m = 0.04 * bench.check->fraction_kept(Rule::kClear, start, above(0.04));
  EXPECT_LE(kept_m, 0.02 - kS);
  EXPECT_GE(kept_m, 0.02 - 2 * kS);
  // Not even that of a step away makes the start one.
  bench.check->refuse(above(1e-4));
  EXPECT_TRUE(bench.check->holds(Rule::kClear, start));
}

TEST(Search, GoesOnWhereAWayDoesNotProveClear) {
  Bench bench(0.03);
  const auto goal = voxplan::Destination::out_of_scene(bench.problem);
  for (const int failing : {0, 1, 3}) {
    std::vector<Pose> refused;
    voxplan::SearchRequest request;
    request.max_s = 60;
    request.unproven_at = [&](const voxplan::PosePath&,
                              const voxplan::PosePath& beyond) -> Result<std::optional<Pose>> {
      for (const Pose& pose : refused) {
        for (const Pose& at : voxplan::with_more_poses(bench.problem, beyond, 0.1 * kS)) {
          EXPECT_GT(voxplan::travel_between_m(bench.problem, at, pose), 0.8 * kS);
        }
      }
      if (static_cast<int>(refused.size()) == failing) return std::optional<Pose>();
      refused.push_back(voxplan::pose_between(beyond[beyond.size() - 2], beyond.back(), 0.5));
      return std::optional<Pose>(refused.back());
    };
    const auto result = voxplan::search(bench.problem, goal, request);
    ASSERT_TRUE(result) << to_line(result.error());
    EXPECT_TRUE(result->found) << failing;
    EXPECT_EQ(result->refused, static_cast<std::uint64_t>(failing));
  }
  // Until the time is up; then it says so.
  voxplan::SearchRequest request;
  request.max_s = 0.3;
  request.unproven_at = [](const voxplan::PosePath&, const voxplan::PosePath& beyond) {
    return Result<std::optional<Pose>>(std::optional<Pose>(beyond.back()));
  };
  const auto result = voxplan::search(bench.problem, goal, request);
  ASSERT_TRUE(result) << to_line(result.error());
  EXPECT_FALSE(result->found);
  EXPECT_GT(result->refused, 0u);
}

// A check by meshes that take for ever once the time of the search is almost over.
class SlowCheck : public PoseCheck {
 public:
  SlowCheck(const Problem& problem, double& now_s, const double& slow_from_s)
      : PoseCheck(problem, {}), now_s_(now_s), slow_from_s_(slow_from_s) {}

 protected:
  double fraction_kept(Rule rule, const Pose& from, const Pose& to, bool or_nothing,
                       clearance::KnownEnds& known) override {
    if (now_s_ <= slow_from_s_) now_s_ += 0.001;
    try {
      while (now_s_ > slow_from_s_) exact::keep_going();
    } catch (const exact::Stopped&) {  // as the real check does, below OMPL
      return 0;
    }
    return PoseCheck::fraction_kept(rule, from, to, or_nothing, known);
  }

 private:
  double& now_s_;
  const double& slow_from_s_;
};

// The search for what blocks the part ends with the time, but for a second.
TEST(Search, EndsWithItsTimeWhereNoPathIsFound) {
  Bench bench(0.03);
  const auto goal = voxplan::Destination::out_of_scene(bench.problem);
  for (const double max_s : {0.5, 20.0}) {
    voxplan::SearchRequest request;
    double now_s = 0;
    const double slow_from_s = 0.9 * max_s + 0.02;
    request.max_s = max_s;
    request.clock_s = [&] { return now_s += 1e-5; };
    request.make_check = [&](const Problem& problem) -> Result<std::unique_ptr<PoseCheck>> {
      return std::unique_ptr<PoseCheck>(new SlowCheck(problem, now_s, slow_from_s));
    };
    request.unproven_at = [](const voxplan::PosePath&, const voxplan::PosePath& beyond) {
      return Result<std::optional<Pose>>(std::optional<Pose>(beyond.back()));
    };
    const auto result = voxplan::search(bench.problem, goal, request);
    ASSERT_TRUE(result) << to_line(result.error());
    EXPECT_FALSE(result->found);
    EXPECT_TRUE(result->is_out_of_time);
    EXPECT_GT(now_s, slow_from_s);
    EXPECT_LT(now_s, max_s + 1 + 0.2) << max_s;
  }
}

// A clock that makes the first round the last one.
TEST(Search, TellsItsProgressWithinARound) {
  Bench bench(0.03);
  const auto goal = voxplan::Destination::out_of_scene(bench.problem);
  voxplan::SearchRequest request;
  request.unproven_at = [](const voxplan::PosePath&, const voxplan::PosePath& beyond) {
    return Result<std::optional<Pose>>(std::optional<Pose>(beyond.back()));
  };
  int read = 0;
  request.clock_s = [&] { return ++read; };
  request.max_s = 40;
  std::vector<double> told;
  request.progress = [&](double fraction, double) { told.push_back(fraction); };
  const auto result = voxplan::search(bench.problem, goal, request);
  ASSERT_TRUE(result) << to_line(result.error());
  EXPECT_LT(result->poses_tested, 4 * 4000u);
  EXPECT_GT(told.size(), 5u);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
}

// A path that takes longer to prove than the search may take is given up.
TEST(Search, EndsAProofThatTakesTooLong) {
  Bench bench(0.03);
  const auto goal = voxplan::Destination::out_of_scene(bench.problem);
  voxplan::SearchRequest request;
  int read = 0;
  request.clock_s = [&] { return ++read; };
  request.max_s = 400;
  int steps = 0;
  request.unproven_at = [&](const voxplan::PosePath&, const voxplan::PosePath&) {
    for (; steps < 1'000'000; ++steps) exact::keep_going();
    return Result<std::optional<Pose>>(std::optional<Pose>());
  };
  const auto result = voxplan::search(bench.problem, goal, request);
  ASSERT_TRUE(result) << to_line(result.error());
  EXPECT_FALSE(result->found);
  EXPECT_GT(steps, 400);
  EXPECT_LT(steps, 100'000);  // 16 for each time that the clock is read
}

// OMPL's trees ask for no less: a pose that is apart from itself was freed twice.
TEST(PoseDistance, IsAMetricAndNothingFromAPoseToItself) {
  voxplan::Random random(9);
  const auto any = [&] {
    return Pose{{random.normal(), random.normal(), random.normal()}, random.orientation()};
  };
  for (int n = 0; n < 2000; ++n) {
    const Pose a = any(), b = any(), c = any();
    const auto apart = [](const Pose& p, const Pose& q) {
      return voxplan::pose_distance_m(p, q, 0.7);
    };
    EXPECT_EQ(apart(a, a), 0) << n;
    EXPECT_EQ(apart(a, {a.position_m, -a.orientation}), 0) << n;
    EXPECT_EQ(apart(a, b), apart(b, a)) << n;
    EXPECT_LE(apart(a, c), (apart(a, b) + apart(b, c)) * (1 + 1e-12)) << n;
    // Next to a pose as far as half the turn, as OMPL has it.
    const double turn_rad = random.between(0, 0.1);
    const Pose turned{a.position_m,
                      coupling::rotation_by(turn_rad * random.direction()) * a.orientation};
    EXPECT_NEAR(apart(a, turned), 0.7 * turn_rad / 2, 1e-4 * turn_rad) << n;
  }
}

// From a start at which the part may not be no planner explores.
TEST(Search, EndsAtOnceWhereTheStartIsRefused) {
  Bench bench(0.03);
  bench.problem.clearance_m = 0.05;  // more than there is
  const auto goal = voxplan::Destination::out_of_scene(bench.problem);
  voxplan::SearchRequest request;
  request.max_s = 60;
  const auto result = voxplan::search(bench.problem, goal, request);
  ASSERT_TRUE(result) << to_line(result.error());
  EXPECT_FALSE(result->found);
  EXPECT_LT(result->seconds, 20);
}

// The sharpest turn of a way between three poses: of the centroid's way and the turn times the
// part's radius.
double sharpest_rad(const Problem& problem, const voxplan::PosePath& path) {
  const double radius_m = problem.part.header().bounding_radius_m;
  std::vector<std::array<double, 6>> legs;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const glm::dvec3 step = path[i].position_m - path[i - 1].position_m;
    const glm::dvec3 turn =
        radius_m *
        coupling::rotation_vector(path[i].orientation * glm::conjugate(path[i - 1].orientation));
    if (glm::length(step) + glm::length(turn) < 1e-9) continue;
    legs.push_back({step.x, step.y, step.z, turn.x, turn.y, turn.z});
  }
  const auto dot = [](const auto& a, const auto& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
  };
  double largest = 0;
  for (std::size_t i = 1; i < legs.size(); ++i) {
    const auto &a = legs[i - 1], &b = legs[i];
    largest = std::max(
        largest, std::acos(std::clamp(dot(a, b) / std::sqrt(dot(a, a) * dot(b, b)), -1.0, 1.0)));
  }
  return largest;
}

// Ways with corners over the groove's walls: the same ends, no motion that is not kept, no nearer
// to the scene than before, and hardly a corner that a hand would feel.
TEST(Smoothing, RoundsCornersAndKeepsTheClearance) {
  Bench bench(0.03);
  voxplan::Random random(21);
  const auto min_m = [&](const voxplan::PosePath& path) {
    double smallest = 1;
    for (const Pose& pose : path) smallest = std::min(smallest, bench.check->clearance_m(pose));
    return smallest;
  };
  int ways = 0, round = 0;
  for (int trial = 0; trial < 400 && ways < 12; ++trial) {
    // Zigzags near the walls, of motions that are kept.
    voxplan::PosePath path{bench.problem.world_from_start};
    while (path.size() < 6) {
      Pose next = path.back();
      // One after the other: compilers draw the arguments of a call in different orders.
      const double step_m = random.between(0.01, 0.03);
      next.position_m += random.direction() * step_m;
      const double turn_rad = random.between(0, 0.4);
      next.orientation =
          glm::normalize(coupling::rotation_by(random.direction() * turn_rad) * next.orientation);
      if (next.position_m.z > 0.08 || !bench.check->is_kept(Rule::kClear, path.back(), next)) break;
      path.push_back(next);
    }
    if (path.size() < 6 || sharpest_rad(bench.problem, path) < 0.7) continue;
    ++ways;
    SCOPED_TRACE(trial);
    const auto wide = voxplan::widened(bench.problem, path, 3);
    ASSERT_TRUE(wide) << to_line(wide.error());
    const auto all = voxplan::smoothed(bench.problem, {{}, *wide});
    ASSERT_TRUE(all) << to_line(all.error());
    const voxplan::PosePath& smooth = all->front().beyond;
    EXPECT_EQ(voxplan::travel_between_m(bench.problem, smooth.front(), path.front()), 0);
    EXPECT_EQ(voxplan::travel_between_m(bench.problem, smooth.back(), path.back()), 0);
    // Where walls leave no room for a cut a corner stays.
    EXPECT_LT(sharpest_rad(bench.problem, smooth), sharpest_rad(bench.problem, path) / 4);
    round += sharpest_rad(bench.problem, smooth) < 0.25;
    // Between the poses of a straight way the clearance may be less than at both: by a tenth of a
    // voxel, for steps of two.
    EXPECT_GE(min_m(smooth), min_m(*wide) - 0.1 * kS);
    const auto checked = voxplan::proven(
        bench.problem, voxplan::rows_of(bench.problem, {}, smooth, 0.1), Rule::kClear, 1);
    ASSERT_TRUE(checked) << to_line(checked.error());
    EXPECT_TRUE(checked->clear());
  }
  EXPECT_EQ(ways, 12);
  EXPECT_GE(round, 9);  // 10 to 12, by the compiler, which orders the smoothing's own draws
}

// Over a ridge: evened without regard to the clearance, the way would come down to what is
// required.
TEST(Smoothing, ComesNoNearerToARidge) {
  const auto distance = [](const glm::dvec3& p) {
    const double beside = std::abs(p.x) - 0.005, above = p.z - 0.04;
    const double ridge = std::max(beside, above) > 0
                             ? std::hypot(std::max(beside, 0.0), std::max(above, 0.0))
                             : std::max(beside, above);
    return std::min(ridge, p.z);
  };
  const Voxmap scene = make_voxmap(
      distance_scene(kS, {-24, -16, -8}, {48, 32, 28}, distance, 2, DistanceDefinition(2)));
  const Pshell part = make_pshell(block());
  const auto at = [](double x, double z) { return Pose{{x, 0, z}, {1, 0, 0, 0}}; };
  const Problem problem{scene, part, 0.002, at(-0.045, 0.04), {}};
  const auto made = PoseCheck::create(problem);
  ASSERT_TRUE(made) << to_line(made.error());
  const voxplan::PosePath path{at(-0.045, 0.04), at(-0.045, 0.075), at(0.045, 0.075),
                               at(0.045, 0.04)};
  const auto min_m = [&](const voxplan::PosePath& of) {
    double smallest = 1;
    for (const Pose& pose : voxplan::with_more_poses(problem, of, 0.2 * kS)) {
      smallest = std::min(smallest, (*made)->clearance_m(pose));
    }
    return smallest;
  };
  const voxplan::PosePath fine = voxplan::with_more_poses(problem, path, 2 * kS);
  const auto smooth = voxplan::smoothed(problem, {{}, fine});
  ASSERT_TRUE(smooth) << to_line(smooth.error());
  EXPECT_GT(min_m(fine), 0.015);
  EXPECT_GE(min_m(smooth->front().beyond), min_m(fine) - 0.1 * kS);
  EXPECT_LT(sharpest_rad(problem, smooth->front().beyond), 0.1);
}

// Along a groove, up and aside: corners in the seat, where it is left, and beyond. Each motion
// keeps its rule, and the whole proves clear.
TEST(Smoothing, RoundsCornersInASeatAndWhereItIsLeft) {
  Bench bench(0, true);
  const Pose start = bench.problem.world_from_start;
  const auto at = [&](double x, double z) {
    return Pose{start.position_m + glm::dvec3(x, 0, z), start.orientation};
  };
  const voxplan::PosePath corners{start, at(0.02, 0), at(0.02, 0.01), at(0.04, 0.02),
                                  at(0.04, 0.06)};
  const auto is_clear = [&](const Pose& pose) { return bench.check->holds(Rule::kClear, pose); };
  const voxplan::PosePath in_seat = voxplan::up_to_first(corners, bench.problem, is_clear);
  ASSERT_GE(in_seat.size(), 4u);
  const Pose joint = in_seat.back();
  const voxplan::PlannedPath path{in_seat, {joint, at(-0.02, 0.06), at(-0.02, 0.09)}};
  const auto whole = [&](const voxplan::PlannedPath& of) {
    voxplan::PosePath poses = of.in_seat;
    poses.insert(poses.end(), of.beyond.begin() + 1, of.beyond.end());
    return poses;
  };
  const auto smooth = voxplan::smoothed(bench.problem, path);
  ASSERT_TRUE(smooth) << to_line(smooth.error());
  EXPECT_EQ(whole(smooth->back()).size(), whole(path).size());  // itself is the last resort
  EXPECT_GT(sharpest_rad(bench.problem, whole(path)), 1.3);
  EXPECT_LT(sharpest_rad(bench.problem, whole(smooth->front())), 0.2);
  for (const voxplan::PlannedPath& each : *smooth) {
    EXPECT_EQ(voxplan::travel_between_m(bench.problem, each.in_seat.front(), start), 0);
    EXPECT_EQ(voxplan::travel_between_m(bench.problem, each.beyond.back(), path.beyond.back()), 0);
    EXPECT_EQ(voxplan::travel_between_m(bench.problem, each.in_seat.back(), each.beyond.front()),
              0);
    EXPECT_TRUE(is_clear(each.beyond.front()));
    for (std::size_t i = 1; i < each.in_seat.size(); ++i) {
      EXPECT_TRUE(bench.check->is_kept(Rule::kInSeat, each.in_seat[i - 1], each.in_seat[i]));
    }
    for (std::size_t i = 1; i < each.beyond.size(); ++i) {
      EXPECT_TRUE(bench.check->is_kept(Rule::kClear, each.beyond[i - 1], each.beyond[i]));
    }
    const auto checked = voxplan::proven(
        bench.problem, voxplan::rows_of(bench.problem, each.in_seat, each.beyond, 0.1),
        Rule::kInSeat, 1);
    ASSERT_TRUE(checked) << to_line(checked.error());
    EXPECT_TRUE(checked->clear());
  }
}

// Behind a seat the way goes on in the direction in which it came out.
TEST(Smoothing, GoesStraightOnOutOfASeat) {
  Bench bench(0.03);
  const Pose start = bench.problem.world_from_start;
  const auto at = [&](double x, double z) {
    return Pose{start.position_m + glm::dvec3(x, 0, z), start.orientation};
  };
  const auto smooth = voxplan::smoothed(
      bench.problem, {{at(0, -0.01), start}, {start, at(0.03, 0.005), at(0.03, 0.04)}});
  ASSERT_TRUE(smooth) << to_line(smooth.error());
  const voxplan::PosePath& beyond = smooth->front().beyond;
  const glm::dvec3 first = beyond[1].position_m - beyond[0].position_m;
  EXPECT_GT(first.z, 0);
  EXPECT_LT(std::abs(first.x), 1e-9);
}

// A pin in a hole, of whose floors some are tilted along it, as at the hole's edges.
TEST(Slide, AFreeTwistGoesAlongAPinsHoleOrTurnsInIt) {
  std::vector<clearance::SeatStretch::Floor> floors;
  voxplan::Random random(5);
  for (int n = 0; n < 300; ++n) {
    const double angle = random.between(0, 2 * M_PI), x = random.between(-0.02, 0.02);
    const glm::vec3 out(0, std::cos(angle), std::sin(angle));
    const glm::vec3 tilted = glm::normalize(out + glm::vec3(n % 30 == 0 ? 0.4 : 0.0, 0, 0));
    floors.push_back({glm::vec3(x, 0, 0) - 0.005f * out, tilted, 0});
  }
  int free = 0, along = 0, about = 0;
  for (int n = 0; n < 200; ++n) {
    const voxplan::Twist6 twist =
        voxplan::free_twist(voxplan::random_twist(1, random), floors, 0.02);
    EXPECT_NEAR(voxplan::length_of(twist), 1, 1e-9);
    free += std::hypot(twist[1], twist[2], std::hypot(twist[4], twist[5])) < 0.3 ? 1 : 0;
    along += std::abs(twist[0]) > 0.5 ? 1 : 0;
    about += std::abs(twist[3]) > 0.5 ? 1 : 0;
  }
  EXPECT_GT(free, 180);  // all but those that go neither along nor about to begin with
  EXPECT_GT(along, 20);
  EXPECT_GT(about, 20);
}

TEST(Slide, AFreeDirectionIsExactlyAlongAPinsHole) {
  voxplan::Random random(6);
  for (int trial = 0; trial < 50; ++trial) {
    const glm::dquat turn = random.orientation();
    const glm::dvec3 axis = turn * glm::dvec3(1, 0, 0);
    std::vector<clearance::SeatStretch::Floor> floors;
    for (int n = 0; n < 300; ++n) {
      const double angle = random.between(0, 2 * M_PI);
      const glm::dvec3 out(n % 10 == 0 ? 0.4 : 0.0, std::cos(angle), std::sin(angle));
      floors.push_back({glm::vec3(0), glm::vec3(turn * glm::normalize(out)), 0});
    }
    const auto directions = voxplan::free_directions(floors);
    ASSERT_EQ(directions.size(), 3u);
    EXPECT_LT(glm::length(glm::cross(directions[1], axis)), 1e-6) << trial;
    EXPECT_EQ(directions[1], -directions[2]);
    // A cover: away from all floors.
    floors.resize(1);
    EXPECT_LT(glm::length(voxplan::free_directions(floors)[0] - glm::dvec3(floors[0].direction)),
              1e-6);
  }
  EXPECT_TRUE(voxplan::free_directions({}).empty());
}

}  // namespace
}  // namespace forcelayer::test
