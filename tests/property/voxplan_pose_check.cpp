// The rules of a plan against the proofs of voxcheck: what PoseCheck lets pass is clear by
// check_path(); what it cuts is kept up to there. A search goes on where a way does not prove
// clear.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "runtime/clearance/path_check.h"
#include "runtime/coupling/coupling.h"
#include "runtime/field/field_probe.h"
#include "runtime/voxplan/pose_check.h"
#include "runtime/voxplan/search.h"
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
  Problem problem;
  std::unique_ptr<PoseCheck> check;
  explicit Bench(double above_m = 0)
      : problem{scene, part, 0.004, {{0.0007, 0, kHalf + above_m}, {1, 0, 0, 0}}, {}} {
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
  field::FieldProbe probe(query, *field, points, samples);
  ASSERT_TRUE(probe.find_seat(bench.problem.world_from_start));
  ASSERT_FALSE(probe.seat().empty());
  probe.open_seat(true);
  voxplan::Random random(3);
  int barred = 0, free = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const double radius_m = bench.part.header().bounding_radius_m;
    const double length_m = kS * std::pow(random.share(), 2);
    const Pose pose = voxplan::moved(bench.problem.world_from_start,
                                     voxplan::random_twist(length_m, random), radius_m);
    probe.look_up(pose, contacts);
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
        voxplan::moved(seat, voxplan::random_twist(2 * kS * random.share(), random), radius_m);
    to.position_m.z += 4 * kS * random.share();
    const clearance::CenterPath path(
        std::vector<PathRow>{voxplan::row_of(0, seat), voxplan::row_of(1, to)}, glm::dvec3(0),
        radius_m);
    const auto verdict = stretch->first_pushed_in(path, {0, 0}, {1, 0}, {});
    const auto quick = stretch->first_moment_pushed_in(path, {0, 0}, {1, 0}, {});
    ASSERT_EQ(verdict.has_value(), quick.has_value()) << trial;
    ++(quick ? pushed : free);
    if (!quick) continue;
    EXPECT_EQ(verdict->moment.pose, quick->pose) << trial;
    EXPECT_EQ(verdict->moment.share, quick->share) << trial;
  }
  EXPECT_GT(pushed, 30);
  EXPECT_GT(free, 30);
}

TEST(PoseCheck, NoWayLeadsByARefusedPose) {
  Bench bench(0.03);
  const Pose start = bench.problem.world_from_start;
  const auto above = [&](double way_m) {
    return Pose{start.position_m + glm::dvec3(0, 0, way_m), start.orientation};
  };
  ASSERT_TRUE(bench.check->is_kept(Rule::kClear, start, above(0.04)));
  bench.check->refuse(above(0.02));
  EXPECT_TRUE(bench.check->holds(Rule::kClear, start));
  EXPECT_FALSE(bench.check->holds(Rule::kClear, above(0.02 + 0.9 * kS)));
  EXPECT_TRUE(bench.check->holds(Rule::kClear, above(0.02 + 1.1 * kS)));
  EXPECT_FALSE(bench.check->is_kept(Rule::kClear, start, above(0.04)));
  const double kept_m = 0.04 * bench.check->share_kept(Rule::kClear, start, above(0.04));
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
    request.most_s = 60;
    request.unproven_at = [&](const voxplan::Way&,
                              const voxplan::Way& beyond) -> Result<std::optional<Pose>> {
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
  request.most_s = 0.3;
  request.unproven_at = [](const voxplan::Way&, const voxplan::Way& beyond) {
    return Result<std::optional<Pose>>(std::optional<Pose>(beyond.back()));
  };
  const auto result = voxplan::search(bench.problem, goal, request);
  ASSERT_TRUE(result) << to_line(result.error());
  EXPECT_FALSE(result->found);
  EXPECT_GT(result->refused, 0u);
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
  request.most_s = 60;
  const auto result = voxplan::search(bench.problem, goal, request);
  ASSERT_TRUE(result) << to_line(result.error());
  EXPECT_FALSE(result->found);
  EXPECT_LT(result->seconds, 20);
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
