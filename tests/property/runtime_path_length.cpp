// The length of a path against sums over all points of the part and many poses of the path.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "runtime/clearance/path_length.h"
#include "tests/support/point_part.h"
#include "tests/support/random_numbers.h"

namespace forcelayer::test {
namespace {

using clearance::CenterPath;
using clearance::PathLength;

PathRow row_of(double time_s, const glm::dvec3& p, const glm::dquat& q) {
  return {time_s, {p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}};
}

// Points in a box, by a random shape and centroid, with the box's corners.
PointPart random_part(Random& random) {
  PointPart part;
  const glm::dvec3 half_m(uniform(random, 0.001, 0.1), uniform(random, 0.001, 0.1), 0.05);
  for (int i = 0; i < 60; ++i) {
    glm::dvec3 point_m;
    for (int axis = 0; axis < 3; ++axis) {
      const double side = i < 8 ? (i >> axis & 1) * 2 - 1 : uniform(random, -1, 1);
      point_m[axis] = side * half_m[axis];
    }
    part.add({point_m.x, point_m.y, point_m.z}, {0, 0, 1});
  }
  part.center_m = {uniform(random, -0.2, 0.2), uniform(random, -0.2, 0.2), 0};
  return part;
}

// By the chords of every point between many moments of a step.
double slow_length_m(const CenterPath& path, const Pshell& part, std::size_t step) {
  constexpr int kMoments = 2000;
  const PshellView& v = part.view();
  double length_m = 0;
  const auto place_m = [&](const Pose& pose, std::uint64_t n) {
    return pose.position_m + pose.orientation * glm::dvec3(v.x[n], v.y[n], v.z[n]);
  };
  for (int k = 0; k < kMoments; ++k) {
    const Pose from = path.world_from_center({step, k / double{kMoments}});
    const Pose to = k + 1 < kMoments ? path.world_from_center({step, (k + 1) / double{kMoments}})
                                     : path.world_from_center({step + 1, 0});
    double fastest_m = 0;
    for (std::uint64_t n = 0; n < v.point_count; ++n) {
      fastest_m = std::max(fastest_m, glm::length(place_m(to, n) - place_m(from, n)));
    }
    length_m += fastest_m;
  }
  return length_m;
}

TEST(PathLength, IsTheTravelOfTheFastestPoint) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const Pshell part = make_pshell(random_part(random));
    std::vector<PathRow> rows;
    for (int n = 0; n < 4; ++n) {
      rows.push_back(row_of(n, random_direction(random) * uniform(random, 0, 0.3),
                            random_orientation(random)));
    }
    const CenterPath path(rows, part);
    const PathLength length(path, part);
    double slow_m = 0;
    for (std::size_t step = 0; step < 3; ++step) {
      EXPECT_NEAR(length.at_m({step, 0}), slow_m, 1e-3 * slow_m) << seed;
      slow_m += slow_length_m(path, part, step);
      // Never more than the bound that proofs take.
      EXPECT_LE(length.at_m({step + 1, 0}), path.travel_m({step + 1, 0})) << seed;
    }
    EXPECT_NEAR(length.whole_m(), slow_m, 1e-3 * slow_m) << seed;
    EXPECT_DOUBLE_EQ(length.at_m({1, 0.5}), (length.at_m({1, 0}) + length.at_m({2, 0})) / 2);
  }
}

// A lid of 0.3 by 0.8 m about the middle of its long edge: the corners across go along arcs of 0.5
// m radius. The bound of proofs adds the arc of the centroid and the half diagonal.
TEST(PathLength, OfALidIsTheArcOfTheCornersAcross) {
  PointPart lid;
  for (const double x : {-0.15, 0.15}) {
    for (const double y : {-0.4, 0.4}) lid.add({x, y, 0}, {0, 0, 1});
  }
  lid.center_m = {0.15, 0, 0};
  const Pshell part = make_pshell(lid);
  std::vector<PathRow> rows;
  constexpr int kSteps = 90;
  for (int n = 0; n <= kSteps; ++n) {
    const double turn_rad = n * M_PI / 2 / kSteps;
    rows.push_back(row_of(n, glm::dvec3(0), glm::angleAxis(turn_rad, glm::dvec3(0, 0, 1))));
  }
  const CenterPath path(rows, part);
  const double arc_m = 0.5 * M_PI / 2;
  // The centroid goes along chords, which are shorter than their arcs by 1.3e-5.
  EXPECT_NEAR(PathLength(path, part).whole_m(), arc_m, 2e-5 * arc_m);
  EXPECT_GT(path.travel_m({kSteps, 0}), 1.15 * arc_m);
}

TEST(PathLength, OfAShiftIsThatOfTheCentroid) {
  const Pshell part = make_pshell(sphere_part(0.1, 100, 0.005));
  const glm::dquat turned = glm::angleAxis(1.0, glm::dvec3(0, 0, 1));
  const std::vector<PathRow> rows{row_of(0, {0, 0, 0}, turned), row_of(1, {0.03, 0.04, 0}, turned),
                                  row_of(2, {0.03, 0.04, 0}, turned)};
  const CenterPath path(rows, part);
  const PathLength length(path, part);
  EXPECT_NEAR(length.at_m({0, 0.5}), 0.025, 1e-15);
  EXPECT_NEAR(length.whole_m(), 0.05, 1e-15);
  EXPECT_EQ(PathLength(CenterPath(std::span(rows).first(1), part), part).whole_m(), 0);
}

}  // namespace
}  // namespace forcelayer::test
