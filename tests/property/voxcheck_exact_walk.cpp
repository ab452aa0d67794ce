// The exact distance against slow twins: every pair of triangles in long double; a path sampled
// densely.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <set>

#include "tests/support/ring_surface.h"
#include "workbench/exact/exact_walk.h"
#include "workbench/exact/triangle_distance.h"

namespace forcelayer::exact {
namespace {

using Wide = glm::vec<3, long double>;
using Corners = std::array<Wide, 3>;

long double to_segment(const Wide& p, const Wide& a, const Wide& b) {
  const Wide d = b - a;
  const long double square = glm::dot(d, d);
  const long double t = square > 0 ? std::clamp(glm::dot(p - a, d) / square, 0.0L, 1.0L) : 0.0L;
  return glm::length(p - a - t * d);
}

long double to_triangle(const Wide& p, const Corners& t) {
  const Wide normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const long double area = glm::length(normal);
  bool inside = area > 0;
  long double smallest = 1e30L;
  for (int n = 0; n < 3; ++n) {
    const Wide &a = t[n], &b = t[(n + 1) % 3];
    inside = inside && glm::dot(glm::cross(normal, b - a), p - a) >= 0;
    smallest = std::min(smallest, to_segment(p, a, b));
  }
  return inside ? std::min(smallest, std::abs(glm::dot(normal, p - t[0])) / area) : smallest;
}

// Convex in the place on the first segment: by ternary search.
long double between_segments(const Wide& a, const Wide& b, const Wide& c, const Wide& d) {
  long double low = 0, high = 1;
  for (int n = 0; n < 120; ++n) {
    const long double third = (high - low) / 3, left = low + third, right = high - third;
    if (to_segment(a + left * (b - a), c, d) < to_segment(a + right * (b - a), c, d)) {
      high = right;
    } else {
      low = left;
    }
  }
  return std::min({to_segment(a + low * (b - a), c, d), to_segment(a, c, d), to_segment(b, c, d)});
}

bool crosses(const Wide& a, const Wide& b, const Corners& t) {
  const Wide normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const long double from = glm::dot(normal, a - t[0]), to = glm::dot(normal, b - t[0]);
  if (from * to >= 0) return false;
  return to_triangle(a + from / (from - to) * (b - a), t) < 1e-15L;
}

long double between_triangles(const Corners& s, const Corners& t) {
  long double smallest = 1e30L;
  for (int i = 0; i < 3; ++i) {
    const Wide &a = s[i], &b = s[(i + 1) % 3];
    if (crosses(a, b, t) || crosses(t[i], t[(i + 1) % 3], s)) return 0;
    smallest = std::min({smallest, to_triangle(a, t), to_triangle(t[i], s)});
    for (int j = 0; j < 3; ++j) {
      smallest = std::min(smallest, between_segments(a, b, t[j], t[(j + 1) % 3]));
    }
  }
  return smallest;
}

Corners corners(const Surface& surface, std::size_t t, const Pose& pose) {
  Corners all;
  for (std::size_t n = 0; n < 3; ++n) {
    const glm::dvec3& v = surface.vertices_m[surface.triangles[t][n]];
    all[n] = Wide(pose.position_m + pose.orientation * v);
  }
  return all;
}

// Triangles of all shapes about the origin: fat ones, needles, and some on a coarse lattice, whose
// edges and planes are parallel.
Surface random_surface(std::mt19937& random, int count, double size_m) {
  Surface surface;
  std::uniform_real_distribution<double> unit(-1, 1);
  std::uniform_int_distribution<int> lattice(-2, 2), kind(0, 2);
  for (int n = 0; n < count; ++n) {
    const int shape = kind(random);
    const glm::dvec3 at(unit(random), unit(random), unit(random));
    for (int corner = 0; corner < 3; ++corner) {
      glm::dvec3 v(unit(random), unit(random), unit(random));
      if (shape == 1) v = at + (corner == 2 ? 1e-3 : 1.0) * v;
      if (shape == 2) v = glm::dvec3(lattice(random), lattice(random), lattice(random)) / 2.0;
      surface.vertices_m.push_back(size_m * v);
      surface.largest_m = std::max(surface.largest_m, 3 * size_m);
    }
    const auto first = static_cast<std::uint32_t>(3 * n);
    surface.triangles.push_back({first, first + 1, first + 2});
    surface.object.push_back(static_cast<std::uint32_t>(n + 1));
  }
  return surface;
}

TEST(MeshPair, IsTheDistanceOfTheNearestPairOfTriangles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  int meeting = 0;
  for (int trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(trial);
    const double scale_m = std::pow(10.0, trial % 10 - 6);  // from a micrometer to a kilometer
    const Surface scene = random_surface(random, 6, scale_m),
                  part = random_surface(random, 4, 0.5 * scale_m);
    Pose pose;
    pose.position_m = (trial % 3 == 0 ? 0.5 : 3.0) * scale_m *
                      glm::dvec3(unit(random), unit(random), unit(random));
    if (trial % 2 == 0) {
      pose.orientation =
          glm::normalize(glm::dquat(unit(random), unit(random), unit(random), unit(random)));
    }
    const MeshPair pair(scene, part);
    const MeshDistance measured = pair.at(pose, voxcheck::kNothingM);
    long double smallest = 1e30L;
    for (std::size_t s = 0; s < scene.triangles.size(); ++s) {
      for (std::size_t p = 0; p < part.triangles.size(); ++p) {
        smallest =
            std::min(smallest, between_triangles(corners(scene, s, {}), corners(part, p, pose)));
      }
    }
    const double rounding = 1e-14 * 5 * scale_m;
    EXPECT_NEAR(measured.distance_m, static_cast<double>(smallest), rounding);
    EXPECT_EQ(pair.at(pose, measured.distance_m * (1 + 1e-9) + rounding).distance_m,
              measured.distance_m);
    if (measured.distance_m == 0) {  // a place of both
      ++meeting;
      EXPECT_EQ(measured.part_m, measured.scene_m);
      long double away = 1e30L;
      for (std::size_t p = 0; p < part.triangles.size(); ++p) {
        away = std::min(away, to_triangle(Wide(measured.part_m), corners(part, p, pose)));
      }
      EXPECT_LE(away, rounding);
      EXPECT_LE(to_triangle(Wide(measured.scene_m), corners(scene, measured.scene_triangle, {})),
                rounding);
      continue;
    }
    EXPECT_NEAR(glm::length(measured.part_m - measured.scene_m), measured.distance_m, rounding);
    EXPECT_LE(to_triangle(Wide(measured.scene_m), corners(scene, measured.scene_triangle, {})),
              rounding);
  }
  EXPECT_GT(meeting, 20);
}

// A path that passes by and through a few triangles, in few poses.
TEST(ExactWalk, HoldsBetweenPosesAsAtThem) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  int apart = 0;
  for (int trial = 0; trial < 40; ++trial) {
    SCOPED_TRACE(trial);
    const Surface scene = random_surface(random, 4, 1), part = random_surface(random, 3, 0.3);
    std::vector<PathRow> rows;
    for (int n = 0; n < 4; ++n) {
      const glm::dquat q = glm::normalize(glm::dquat(2, unit(random), unit(random), unit(random)));
      rows.push_back({1.0 * n,
                      {2 * unit(random), 2 * unit(random), 1.8 + unit(random)},
                      {q.w, q.x, q.y, q.z}});
    }
    double radius_m = 0;
    for (const glm::dvec3& v : part.vertices_m) radius_m = std::max(radius_m, glm::length(v));
    const clearance::CenterPath path(rows, glm::dvec3(0), radius_m);
    const MeshPair pair(scene, part);
    const double rounding = kRounding * 5, within = 1e-3;
    ExactWalk walk(path, pair, pair, rounding);
    const Piece whole{{0, 0}, {3, 0}};
    const auto smallest = walk.smallest({whole}, within);
    const double required = smallest.sample.measured.distance_m + 0.2;
    const auto nearer = walk.nearer_than(whole, required, 0.01);
    double sampled = 1e30;
    for (int n = 0; n < 3000; ++n) {
      const Moment moment{static_cast<std::size_t>(n / 1000), n % 1000 / 1000.0};
      const double d = pair.at(path.world_from_center(moment), voxcheck::kNothingM).distance_m;
      sampled = std::min(sampled, d);
      if (d >= required - rounding) continue;
      const double t = path.time_s(moment);
      EXPECT_TRUE(std::any_of(nearer.begin(), nearer.end(), [&](const Piece& piece) {
        return path.time_s(piece.from) <= t && t <= path.time_s(piece.to);
      })) << t;
    }
    EXPECT_LE(smallest.at_least_m, sampled + rounding);
    EXPECT_GE(smallest.at_least_m, smallest.sample.measured.distance_m - within);
    EXPECT_LE(smallest.sample.measured.distance_m, sampled + within + rounding);
    EXPECT_FALSE(walk.contradiction());
    // A bound on a piece that the meshes contradict is noticed.
    if (sampled > 0) {
      ++apart;
      ExactWalk other(path, pair, pair, rounding);
      other.smallest({{{0, 0}, {3, 0}, 100}}, within, Sample{{0, 0}, {200, 0, {}, {}}, false});
      EXPECT_TRUE(other.contradiction());
    }
  }
  EXPECT_GT(apart, 5);
}

// A ring of slivers and a ball of random triangles: trees of some levels.
Surface ring(int sides, double radius_m, double half_m) {
  Surface surface = test::ring_surface(sides, radius_m, half_m);
  surface.largest_m = 3 * radius_m;
  return surface;
}

double nearest_of_all(const Surface& scene, const Surface& part, const Pose& pose) {
  const auto placed = [](const Surface& surface, std::size_t t, const Pose& at) {
    exact::Corners all;
    for (std::size_t n = 0; n < 3; ++n) {
      all[n] = at.position_m + at.orientation * surface.vertices_m[surface.triangles[t][n]];
    }
    return all;
  };
  double smallest = 1e300;
  for (std::size_t s = 0; s < scene.triangles.size(); ++s) {
    for (std::size_t p = 0; p < part.triangles.size(); ++p) {
      smallest = std::min(
          smallest, triangle_distance(placed(scene, s, {}), placed(part, p, pose)).distance_m);
    }
  }
  return smallest;
}

Pose turned(const glm::dvec3& at_m, double angle, const glm::dvec3& axis) {
  return {at_m, glm::angleAxis(angle, glm::normalize(axis))};
}

TEST(MeshPair, TreesFindTheNearestOfAllTriangles) {
  std::mt19937 random(52);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    const Surface scene = trial % 2 == 0 ? ring(60, 1, 0.5) : random_surface(random, 90, 1);
    const Surface part = trial % 3 == 0 ? random_surface(random, 40, 0.2) : ring(48, 0.9, 0.4);
    const double x = unit(random), y = unit(random), z = unit(random), angle = 3 * unit(random);
    const Pose pose = turned((trial % 4 == 0 ? 3 : 0.08) * glm::dvec3(x, y, z), angle, {x, z, 1});
    const double smallest = nearest_of_all(scene, part, pose);
    const MeshPair pair(scene, part);
    EXPECT_NEAR(pair.at(pose, voxcheck::kNothingM).distance_m, smallest, 1e-13);
    EXPECT_NEAR(pair.at(pose, smallest / 2).distance_m, smallest, 1e-13);  // a hint that is wrong
  }
}

// A proof is held against the nearest of all triangles at many moments of the motion.
TEST(MeshPair, WhatStaysApartIsNowhereNearer) {
  std::mt19937 random(53);
  std::uniform_real_distribution<double> unit(-1, 1);
  int proven = 0, close = 0;
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    const Surface scene = trial % 2 == 0 ? ring(24, 1, 0.5) : random_surface(random, 8, 1);
    const Surface part = trial % 2 == 0 ? ring(24, 0.9, 0.4) : random_surface(random, 4, 0.3);
    const double x = unit(random), y = unit(random), z = unit(random), angle = 0.2 * unit(random);
    const glm::dvec3 at_m = (trial % 2 == 0 ? 0.03 : 2.0) * glm::dvec3(x, y, z);
    const glm::dvec3 way_m(0.02 * x, 0.01 * z, 0.3 * y);
    const glm::dvec3 axis = trial % 2 == 0 ? glm::dvec3(0, 0, 1) : glm::dvec3(z, x, y);
    double smallest = 1e300;
    for (int n = 0; n <= 20; ++n) {
      const Pose pose = turned(at_m + n / 20.0 * way_m, n / 20.0 * angle, axis);
      smallest = std::min(smallest, nearest_of_all(scene, part, pose));
    }
    double radius_m = 0;
    for (const glm::dvec3& v : part.vertices_m) radius_m = std::max(radius_m, glm::length(v));
    const double bend_m = radius_m * (1 - std::cos(angle / 2));
    const MeshPair pair(scene, part);
    const Pose from = turned(at_m, 0, axis), to = turned(at_m + way_m, angle, axis);
    for (const double fraction : {0.3, 0.8, 0.95, 1.001}) {
      if (!pair.stays_apart(from, to, bend_m, fraction * smallest)) continue;
      ++proven;
      close += fraction > 0.9;
      EXPECT_LT(fraction, 1);
    }
  }
  EXPECT_GT(proven, 60);
  EXPECT_GT(close, 5);
}

// However far a flat face slides along another, the proof is as close as doubles are.
TEST(MeshPair, OfAFaceThatSlidesAlongAnotherIsCloseHoweverFarItGoes) {
  Surface floor, plate;
  floor.vertices_m = {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}};
  plate.vertices_m = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  for (Surface* surface : {&floor, &plate}) {
    surface->triangles = {{0, 1, 2}, {0, 2, 3}};
    surface->object = {1, 1};
  }
  const MeshPair pair(floor, plate);
  const Pose from{{-7, 3, 0.25}, {1, 0, 0, 0}}, to{{7, -4, 0.25}, {1, 0, 0, 0}};
  EXPECT_TRUE(pair.stays_apart(from, to, 0, 0.25 - 1e-11));
  EXPECT_FALSE(pair.stays_apart(from, to, 0, 0.25 + 1e-11));
  EXPECT_TRUE(pair.stays_apart(from, to, 0.01, 0.24 - 1e-11));
  EXPECT_FALSE(pair.stays_apart(from, to, 0.01, 0.24 + 1e-11));
}

// A ring that is turned in another one with little play.
struct TurningRing {
  Surface scene = ring(96, 1, 0.5), part = ring(96, 0.99, 0.4);
  std::vector<PathRow> rows{{0, {0, 0, 0}, {1, 0, 0, 0}},
                            {1, {0, 0, 0.05}, {std::cos(0.4), 0, 0, std::sin(0.4)}}};
  clearance::CenterPath path{rows, glm::dvec3(0), 1.1};
  MeshPair pair{scene, part};
  ExactWalk walk{path, pair, pair, 1e-7};
};

// By how far points travel it takes 605 moments.
TEST(ExactWalk, OfARingThatTurnsInAnotherMeasuresFewMoments) {
  TurningRing turning;
  ExactWalk& walk = turning.walk;
  const auto smallest = walk.smallest({{{0, 0}, {1, 0}}}, 1e-5);
  EXPECT_TRUE(walk.nearer_than({{0, 0}, {1, 0}}, 0.009, 1e-4).empty());
  EXPECT_GE(smallest.at_least_m, smallest.sample.measured.distance_m - 1e-5);
  EXPECT_LT(walk.measured(), 150u);
  for (int n = 0; n <= 400; ++n) {
    const double d =
        turning.pair.at(turning.path.world_from_center({0, n / 400.0 - (n == 400 ? 1e-12 : 0)}), 1)
            .distance_m;
    EXPECT_GE(d, smallest.at_least_m - 1e-7);
  }
}

// Both searches say how far they are: never less than before, and in steps that a person sees.
TEST(ExactWalk, TellsHowFarItIs) {
  TurningRing turning;
  ExactWalk& walk = turning.walk;
  const Piece whole{{0, 0}, {1, 0}};
  std::vector<double> told;
  walk.tell([&](double fraction) { told.push_back(fraction); });
  const auto is_progress = [&](const char* search) {
    SCOPED_TRACE(search);
    ASSERT_GT(std::set<double>(told.begin(), told.end()).size(), 5u);
    EXPECT_TRUE(std::ranges::is_sorted(told));
    EXPECT_GE(told.front(), 0);
    EXPECT_LE(told.back(), 1);
    EXPECT_GT(told.back(), 0.5);
  };
  const Sample begin = walk.at(whole.from, false);
  walk.smallest({whole}, 1e-5, begin);
  is_progress("the least distance");
  told.clear();
  walk.nearer_than(whole, 0.009, 1e-4);
  is_progress("what is too near");
}

}  // namespace
}  // namespace forcelayer::exact
