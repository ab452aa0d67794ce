// The clearance of places, poses and paths against exact distances, on scenes that are formulas:
// never above them, never far below, and every pose that is too near is found, between the rows of
// a path as at them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "runtime/clearance/path_check.h"
#include "runtime/clearance/path_walk.h"
#include "tests/support/distance_scene.h"
#include "tests/support/point_part.h"
#include "tests/support/random_numbers.h"

namespace forcelayer::test {
namespace {

using clearance::CenterDistances;
using clearance::CenterPath;
using clearance::CheckRequest;
using clearance::CheckResult;
using clearance::LeftOut;
using clearance::PartDistance;

// A ball, or a box with its axes along the world's. In voxels.
struct Solid {
  glm::dvec3 center;
  glm::dvec3 half;  // of a ball: its radius, in x
  bool is_ball;

  double distance(const glm::dvec3& p) const {
    if (is_ball) return glm::length(p - center) - half.x;
    const glm::dvec3 beyond = glm::abs(p - center) - half;
    return glm::length(glm::max(beyond, glm::dvec3(0))) +
           std::min(0.0, std::max({beyond.x, beyond.y, beyond.z}));
  }
};

// Solids that are objects 1, 2, ... of a scene.
struct Solids {
  double voxel_size_m = 0.005;
  std::vector<Solid> all;

  // In voxels; infinity where all are left out.
  double distance(const glm::dvec3& p, const LeftOut& left_out = {}) const {
    double smallest = INFINITY;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i + 1 < left_out.size() && left_out[i + 1] != 0) continue;
      smallest = std::min(smallest, all[i].distance(p));
    }
    return smallest;
  }
  std::uint32_t nearest(const glm::dvec3& p) const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < all.size(); ++i) {
      if (all[i].distance(p) < all[best].distance(p)) best = i;
    }
    return static_cast<std::uint32_t>(best + 1);
  }
};

constexpr double kApart = 4;  // voxels between objects: nearer ones can hide each other

Solids random_solids(Random& random) {
  Solids solids;
  solids.voxel_size_m = std::pow(10, uniform(random, -3.5, -1.5));
  const auto wanted = static_cast<std::size_t>(integer(random, 1, 3));
  for (int tries = 0; tries < 200 && solids.all.size() < wanted; ++tries) {
    Solid solid{
        glm::dvec3(uniform(random, -11, 11), uniform(random, -11, 11), uniform(random, -11, 11)),
        glm::dvec3(uniform(random, 0.3, 5), uniform(random, 0.3, 5), uniform(random, 0.3, 5)),
        integer(random, 0, 1) == 0};
    const double size = solid.is_ball ? solid.half.x : glm::length(solid.half);
    const bool apart = std::all_of(solids.all.begin(), solids.all.end(), [&](const Solid& other) {
      return other.distance(solid.center) > size + kApart;
    });
    if (apart) solids.all.push_back(solid);
  }
  return solids;
}

// The file of the solids, with distances and objects.
Voxmap baked(const Solids& solids) {
  const DistanceDefinition definition(2);
  const Voxel low{-24, -24, -24}, dims{48, 48, 48};
  const VoxelScene scene = distance_scene(
      solids.voxel_size_m, low, dims,
      [&](const glm::dvec3& p) {
        return solids.voxel_size_m * solids.distance(p / solids.voxel_size_m);
      },
      2, definition);
  std::vector<std::string> names;
  for (std::size_t i = 1; i <= solids.all.size(); ++i)
    names.push_back("solid " + std::to_string(i));
  return make_voxmap_of_objects(scene, names, [&](const Voxel& v) -> std::uint32_t {
    return solids.nearest(glm::dvec3(v[0], v[1], v[2]) + 0.5);
  });
}

// A cloud of points, which is all that there is of the part.
PointPart cloud(Random& random, double voxel_size_m) {
  PointPart part;
  part.voxel_size_m = voxel_size_m;
  part.covering_radius_m = 1e-9 * voxel_size_m;
  part.block_points = 16;
  part.super_block_blocks = 4;
  part.center_m = {uniform(random, -3, 3) * voxel_size_m, 0, 0};
  const glm::dvec3 size = voxel_size_m * glm::dvec3(uniform(random, 0, 6), uniform(random, 0, 6),
                                                    uniform(random, 0, 6));
  for (int n = static_cast<int>(integer(random, 1, 150)); n > 0; --n) {
    const glm::dvec3 p = size * random_direction(random);
    part.add({p.x, p.y, p.z}, {1, 0, 0});
  }
  return part;
}

LeftOut random_left_out(Random& random, const Solids& solids) {
  LeftOut left_out(solids.all.size() + 1, 0);
  if (solids.all.size() > 1 && integer(random, 0, 1) == 0) left_out[1] = 1;
  return left_out;
}

TEST(ClearanceOfPlaces, IsNeverAboveTheExactDistanceAndNotFarBelow) {
  constexpr double kCap = 20;
  double max_slack = 0, max_slack_left_out = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const Solids solids = random_solids(random);
    const Voxmap voxmap = baked(solids);
    const LeftOut left_out = random_left_out(random, solids);
    const bool leaves_out = std::count(left_out.begin(), left_out.end(), 1) > 0;
    CenterDistances distances(voxmap, left_out, kCap);
    const auto& origin = voxmap.header().directory_origin;
    const glm::dvec3 directory(static_cast<double>(origin[0]), static_cast<double>(origin[1]),
                               static_cast<double>(origin[2]));
    for (int n = 0; n < 3000; ++n) {
      const glm::dvec3 p(uniform(random, -30, 30), uniform(random, -30, 30),
                         uniform(random, -30, 30));
      const double exact = std::abs(solids.distance(p, left_out));
      const double proven = distances.at(p - directory);
      ASSERT_LE(proven, exact + 1e-6) << p.x << " " << p.y << " " << p.z;
      ASSERT_LE(distances.free_around(p - directory), std::abs(solids.distance(p)) + 1e-6);
      if (solids.distance(p) < 1.5) continue;  // next to the surface little is known
      double& largest = leaves_out ? max_slack_left_out : max_slack;
      largest = std::max(largest, std::min(kCap, exact) - proven);
      if (exact > kCap - 2) continue;
      const auto nearest = distances.nearest(p - directory);
      ASSERT_GE(nearest.max_voxels, exact - 1e-6);
      ASSERT_LE(nearest.max_voxels, exact + 1.8);
      if (!leaves_out) {
        ASSERT_LE(solids.all[nearest.object - 1].distance(p), exact + 1.8);
      }
    }
  }
  RecordProperty("max_slack_voxels", std::to_string(max_slack));
  std::printf("most slack %.3f voxels, with objects left out %.3f\n", max_slack,
              max_slack_left_out);
  EXPECT_LT(max_slack, 0.75);
  EXPECT_LT(max_slack_left_out, 1.1);
}

// Within the stored distances what is kept in a byte a center (no search) tells what the floats of
// a search tell, bit for bit; beyond them the search may tell more.
TEST(ClearanceOfPlaces, BytesTellWhatFloatsTell) {
  int equal = 0, more = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const Solids solids = random_solids(random);
    const Voxmap voxmap = baked(solids);
    const LeftOut none;
    const double reach = clearance::reach_voxels(voxmap.header());
    CenterDistances stored(voxmap, none, 0), searched(voxmap, none, 20);
    const auto& origin = voxmap.header().directory_origin;
    const glm::dvec3 directory(static_cast<double>(origin[0]), static_cast<double>(origin[1]),
                               static_cast<double>(origin[2]));
    for (int n = 0; n < 3000; ++n) {
      const double half = n % 2 == 0 ? 13 : 30;
      const glm::dvec3 p = glm::dvec3(uniform(random, -half, half), uniform(random, -half, half),
                                      uniform(random, -half, half)) -
                           directory;
      const double by_bytes = stored.at(p), by_floats = searched.at(p);
      // No center of the cell is farther than its diagonal from the place.
      if (by_bytes < reach - 1.8) {
        ASSERT_EQ(by_bytes, by_floats) << p.x << " " << p.y << " " << p.z;
        equal += by_bytes > 0 ? 1 : 0;
      } else {
        ASSERT_GE(by_floats, by_bytes - 1e-3);
        more += by_floats > by_bytes ? 1 : 0;
      }
    }
  }
  EXPECT_GT(equal, 1000);
  EXPECT_GT(more, 1000);
}

TEST(ClearanceOfPoses, IsBetweenThatOfAllPointsAndTheTruth) {
  int told = 0, near = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const Solids solids = random_solids(random);
    const Voxmap voxmap = baked(solids);
    const double s = voxmap.voxel_size_m();
    const Pshell shell = make_pshell(cloud(random, s));
    const LeftOut left_out = random_left_out(random, solids);
    constexpr double kCap = 12;
    PartDistance part(voxmap, shell, left_out, kCap);
    CenterDistances distances(voxmap, left_out, kCap);
    const auto& origin = voxmap.header().directory_origin;
    const glm::dvec3 directory(static_cast<double>(origin[0]), static_cast<double>(origin[1]),
                               static_cast<double>(origin[2]));
    Pose pose{random_direction(random) * 20.0 * s, random_orientation(random)};
    double travel_m = 0;
    for (int n = 0; n < 300; ++n) {
      const glm::dvec3 way = random_direction(random) * uniform(random, 0, 2) * s;
      if (glm::length(pose.position_m + way) < 30 * s) pose.position_m += way;
      travel_m += glm::length(way);
      const double enough = uniform(random, 0, 2 * kCap);
      const auto smallest = part.at(pose, travel_m, enough);
      double slow = INFINITY, exact = INFINITY;
      for (std::uint32_t i = 0; i < shell.view().point_count; ++i) {
        const glm::dvec3 at = part.place_m(pose, i) / s;
        slow = std::min(slow, distances.at(at - directory));
        exact = std::min(exact, std::abs(solids.distance(at, left_out)));
      }
      ASSERT_GE(smallest.voxels, std::min({enough, kCap, slow}) - 1e-6) << "step " << n;
      ASSERT_LE(smallest.voxels, exact + 1e-6) << "step " << n;
      // With an end to the search only whether it is near is known.
      const double stop = uniform(random, 0, kCap);
      const auto stopped = part.at(pose, travel_m, stop, stop);
      if (stopped.voxels < stop) {
        ASSERT_LT(slow, stop) << "step " << n;
        const glm::dvec3 found = part.place_m(pose, stopped.point) / s;
        ASSERT_LE(distances.at(found - directory), stopped.voxels + 1e-9) << "step " << n;
      } else {
        ASSERT_LE(stop, exact + 1e-6) << "step " << n;
      }
      near += stopped.voxels < stop;
      if (smallest.point == clearance::MinDistance::kNone) continue;
      ASSERT_LT(smallest.voxels, enough);
      const glm::dvec3 at = part.place_m(pose, smallest.point) / s;
      ASSERT_GE(std::abs(solids.distance(at, left_out)), smallest.voxels - 1e-6) << "step " << n;
      ++told;
    }
  }
  EXPECT_GT(told, 500);
  EXPECT_GT(near, 500);
}

// A path that comes near the solids: sparse rows, so that most happens between them, or dense ones.
std::vector<PathRow> random_path(Random& random, double voxel_size_m) {
  std::vector<PathRow> rows;
  const bool is_dense = integer(random, 0, 2) == 0;
  const int count = static_cast<int>(is_dense ? integer(random, 50, 400) : integer(random, 1, 8));
  Pose pose{random_direction(random) * 16.0 * voxel_size_m, random_orientation(random)};
  double time_s = uniform(random, -1, 1);
  for (int n = 0; n < count; ++n) {
    const glm::dvec3& p = pose.position_m;
    const glm::dquat& q = pose.orientation;
    rows.push_back({time_s, {p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}});
    time_s += uniform(random, 0.001, 1);
    const bool rests = integer(random, 0, 9) == 0;
    if (rests) continue;
    if (is_dense) {
      pose.position_m += random_direction(random) * uniform(random, 0, 0.7) * voxel_size_m;
      pose.orientation = glm::normalize(
          glm::angleAxis(uniform(random, 0, 0.05), random_direction(random)) * pose.orientation);
    } else {
      pose = {random_direction(random) * uniform(random, 0, 25) * voxel_size_m,
              random_orientation(random)};
    }
  }
  return rows;
}

// The exact clearance at many moments: the slow twin.
struct DenseClearance {
  struct At {
    double time_s, clearance_m;
  };
  std::vector<At> all;

  DenseClearance(const CenterPath& path, const Pshell& shell, const Solids& solids,
                 const LeftOut& left_out) {
    const std::size_t motions = path.poses() - 1;
    const int each =
        static_cast<int>(std::max<std::size_t>(3, 1500 / std::max<std::size_t>(1, motions)));
    for (std::size_t pose = 0; pose < path.poses(); ++pose) {
      for (int n = 0; n < (pose < motions ? each : 1); ++n) {
        const clearance::Moment moment{pose, static_cast<double>(n) / each};
        all.push_back(
            {path.time_s(moment), at(path.world_from_center(moment), shell, solids, left_out)});
      }
    }
  }

  static double at(const Pose& pose, const Pshell& shell, const Solids& solids,
                   const LeftOut& left_out) {
    double min_m = INFINITY;
    const PshellView& v = shell.view();
    for (std::uint32_t i = 0; i < v.point_count; ++i) {
      const glm::dvec3 place =
          pose.orientation * glm::dvec3(v.x[i], v.y[i], v.z[i]) + pose.position_m;
      min_m = std::min(
          min_m, solids.voxel_size_m * solids.distance(place / solids.voxel_size_m, left_out));
    }
    return std::max(0.0, min_m);
  }
};

double curve_at(const CheckResult& result, double time_s) {
  double min_m = INFINITY;
  for (const auto& piece : result.curve) {
    if (piece.from_s <= time_s && time_s <= piece.to_s) {
      min_m = std::min(min_m, piece.clearance_m);
    }
  }
  return min_m;
}

bool is_in_violation(const CheckResult& result, double time_s) {
  return std::any_of(result.violations.begin(), result.violations.end(),
                     [&](const auto& v) { return v.from_s <= time_s && time_s <= v.to_s; });
}

void expect_equal(const CheckResult& a, const CheckResult& b) {
  EXPECT_EQ(a.clearance_m, b.clearance_m);
  EXPECT_EQ(a.smallest.time_s, b.smallest.time_s);
  EXPECT_EQ(a.moments_tested, b.moments_tested);
  EXPECT_EQ(a.motions_subdivided, b.motions_subdivided);
  ASSERT_EQ(a.violations.size(), b.violations.size());
  for (std::size_t i = 0; i < a.violations.size(); ++i) {
    EXPECT_EQ(a.violations[i].from_s, b.violations[i].from_s);
    EXPECT_EQ(a.violations[i].to_s, b.violations[i].to_s);
    EXPECT_EQ(a.violations[i].clearance_m, b.violations[i].clearance_m);
    EXPECT_EQ(a.violations[i].worst.point_m, b.violations[i].worst.point_m);
  }
  ASSERT_EQ(a.curve.size(), b.curve.size());
}

TEST(ClearanceOfPaths, EveryMomentThatIsTooNearIsFound) {
  int clear = 0, found = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const Solids solids = random_solids(random);
    const Voxmap voxmap = baked(solids);
    const double s = voxmap.voxel_size_m();
    const Pshell shell = make_pshell(cloud(random, s));
    const LeftOut left_out = random_left_out(random, solids);
    const CenterPath path(random_path(random, s), shell);
    const DenseClearance exact(path, shell, solids, left_out);
    // Inside an object that is left out, nothing tells how near the others are.
    LeftOut others = left_out;
    for (auto& is_left_out : others) is_left_out = is_left_out != 0 ? 0 : 1;
    const DenseClearance allowed(path, shell, solids, others);
    double min_m = INFINITY;
    for (const auto& at : exact.all) min_m = std::min(min_m, at.clearance_m);
    // Near what there is, so that the answer is not plain.
    const double required_m = integer(random, 0, 1) == 0
                                  ? uniform(random, 0, 14) * s
                                  : std::max(0.0, min_m + uniform(random, -0.8, 0.8) * s);
    const auto result = check_path(voxmap, shell, path, {required_m, 1, left_out, {}});
    ASSERT_TRUE(result) << to_line(result.error());
    const auto shared = check_path(voxmap, shell, path, {required_m, 3, left_out, {}});
    ASSERT_TRUE(shared);
    expect_equal(*result, *shared);
    const double rounding_m = 1e-5 * s;
    ASSERT_LE(result->clearance_m, min_m + rounding_m);
    ASSERT_LE(result->smallest.clearance_m, min_m + 2 * s);
    for (const auto& at : exact.all) {
      ASSERT_LE(curve_at(*result, at.time_s), at.clearance_m + rounding_m) << at.time_s;
      if (at.clearance_m < required_m) {
        ASSERT_TRUE(is_in_violation(*result, at.time_s)) << at.time_s;
      }
    }
    const double slack_m = (std::count(left_out.begin(), left_out.end(), 1) > 0 ? 2.1 : 0.85) * s;
    if (min_m > required_m + slack_m) {
      ASSERT_TRUE(result->clear()) << min_m << " " << required_m;
    }
    for (const auto& violation : result->violations) {
      // 1 voxel: the clearance may change by its travel between two moments of the twin.
      double near_m = INFINITY, allowed_m = INFINITY;
      for (std::size_t i = 0; i < exact.all.size(); ++i) {
        const double time_s = exact.all[i].time_s;
        if (time_s >= violation.from_s - 1e-9 && time_s <= violation.to_s + 1e-9) {
          near_m = std::min(near_m, exact.all[i].clearance_m);
          allowed_m = std::min(allowed_m, allowed.all[i].clearance_m);
        }
      }
      if (near_m < INFINITY) {
        if (allowed_m > slack_m) {
          ASSERT_LE(near_m, required_m + slack_m + s);
        }
        ASSERT_LE(violation.clearance_m, near_m + rounding_m);
      }
    }
    if (!result->at_least && std::isfinite(result->smallest.max_m)) {
      ASSERT_GE(result->smallest.max_m, min_m - 0.06 * s);
    }
    (result->clear() ? clear : found) += 1;
  }
  EXPECT_GT(clear, 10);
  EXPECT_GT(found, 10);
}

PathRow at_x(double time_s, double x_m) { return {time_s, {x_m, 0, 0}, {1, 0, 0, 0}}; }

// A way of 1e13 m has no moments within 2 mm of each other, one of 1e160 m overflows. Near the
// scene it is as for any other path: what is not proven is found.
TEST(ClearanceOfPaths, TooFarForDoublePrecisionIsRefused) {
  const Solids solids{0.005, {{{0, 0, 0}, glm::dvec3(5), true}}};
  const Voxmap voxmap = baked(solids);
  Random random(1);
  const Pshell shell = make_pshell(cloud(random, voxmap.voxel_size_m()));
  const auto checked = [&](double from_m, double to_m) {
    const std::vector<PathRow> rows{at_x(0, from_m), at_x(1, to_m)};
    return check_path(voxmap, shell, CenterPath(rows, shell), {voxmap.voxel_size_m(), 1, {}, {}});
  };
  for (const double far_m : {1e9, 1e13, 1e17, 1e160, 1e308}) {
    const auto through = checked(-far_m, 1.1377 * far_m);
    ASSERT_FALSE(through) << far_m;
    EXPECT_EQ(through.error().code, ErrorCode::kUsage);
    EXPECT_FALSE(checked(far_m, far_m)) << far_m;
  }
  for (const double far_m : {1.0, 1e3, 1e6}) {
    const auto through = checked(-far_m, 1.1377 * far_m);
    ASSERT_TRUE(through) << to_line(through.error());
    EXPECT_EQ(through->clearance_m, 0) << far_m;
    EXPECT_FALSE(through->clear()) << far_m;
  }
}

// Each step is shorter than half of the last digit of the way behind it.
TEST(ClearanceOfPaths, TravelIsNeverLessThanItsSteps) {
  std::vector<PathRow> rows{at_x(0, -1e6), at_x(1, 0)};
  for (int n = 2; n < 1000; ++n) rows.push_back(at_x(n, rows.back().position_m[0] + 5e-11));
  const CenterPath path(rows, glm::dvec3(0), 0.1);
  EXPECT_GE(path.travel_m({999, 0}) - path.travel_m({1, 0}), 998 * 5e-11);
  EXPECT_LE(path.travel_m({999, 0}) - path.travel_m({1, 0}), 998 * path.rounding_m());
}

// A part that stands far from its frame's origin, moved back to the world's.
TEST(ClearanceOfPaths, RoundingCountsTheArmOfTheCentroid) {
  const std::vector<PathRow> rows{at_x(0, -1e6), at_x(1, -1e6)};
  EXPECT_GE(CenterPath(rows, glm::dvec3(1e6, 0, 0), 0.1).rounding_m(), 1e6 * 0x1p-50);
  EXPECT_LE(CenterPath(rows, glm::dvec3(1e6, 0, 0), 0.1).rounding_m(), 1e6 * 0x1p-46);
}

TEST(ClearanceOfPaths, NothingOfAStillPartIsLookedAtTwice) {
  Random random(3);
  const Solids solids = random_solids(random);
  const Voxmap voxmap = baked(solids);
  const Pshell shell = make_pshell(cloud(random, voxmap.voxel_size_m()));
  std::vector<PathRow> rows(10000);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].time_s = static_cast<double>(i);
  const CenterPath path(rows, shell);
  const auto result = check_path(voxmap, shell, path, {voxmap.voxel_size_m(), 1, {}, {}});
  ASSERT_TRUE(result);
  EXPECT_LT(result->moments_tested, 1100u);
  EXPECT_EQ(result->poses, 10000u);
}

}  // namespace
}  // namespace forcelayer::test
