// The points near a place, and whether there is one, against all points.
#include "pointshell/certificate/point_grid.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "pointshell/part/parallel.h"
#include "pointshell/sample/sparse_set.h"

namespace forcelayer {
namespace {

using Visits = std::vector<std::pair<std::uint32_t, part::Vec3>>;

std::vector<part::Vec3> random_points(std::size_t count, double extent, std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-extent, extent);
  std::vector<part::Vec3> points;
  for (std::size_t n = 0; n < count; ++n) {
    points.push_back({coordinate(random), coordinate(random), coordinate(random)});
  }
  return points;
}

// Those within the radius that the grid visits.
Visits near_of_grid(const certificate::PointGrid& grid, const part::Vec3& place, double radius) {
  Visits near;
  grid.visit_near(place, radius, [&](std::uint32_t n, const part::Vec3& p) {
    if (part::length(p - place) <= radius) near.push_back({n, p});
  });
  return near;
}

// The same of all points: by cell, and in each by index.
Visits near_of_all(const std::vector<part::Vec3>& points, double cell, const part::Vec3& place,
                   double radius) {
  Visits near;
  for (std::uint32_t n = 0; n < points.size(); ++n) {
    if (part::length(points[n] - place) <= radius) near.push_back({n, points[n]});
  }
  const auto cell_of = [cell](const part::Vec3& p) {
    const double inverse = 1 / cell;
    return std::array{std::floor(p.x * inverse), std::floor(p.y * inverse),
                      std::floor(p.z * inverse)};
  };
  std::stable_sort(near.begin(), near.end(), [&](const auto& a, const auto& b) {
    return cell_of(a.second) < cell_of(b.second);
  });
  return near;
}

TEST(PointGrid, VisitsEveryNearPointOnceByCell) {
  std::mt19937_64 random(11);
  for (const std::size_t count : {0, 1, 3, 50, 4000}) {
    for (const double extent : {0.7, 9.0, 1e5}) {
      const std::vector<part::Vec3> points = random_points(count, extent, random);
      for (const double cell : {1.0, 2.5}) {
        const certificate::PointGrid grid(points, cell);
        std::vector<part::Vec3> places = random_points(20, extent, random);
        for (std::size_t n = 0; n < std::min<std::size_t>(count, 20); ++n) {
          places.push_back(points[n] + part::Vec3{0.3, -0.2, 0.1});
        }
        for (const part::Vec3& place : places) {
          for (const double radius : {0.4, 1.0, 4.0}) {
            EXPECT_EQ(near_of_grid(grid, place, radius), near_of_all(points, cell, place, radius))
                << count << " points within " << extent << ", cells of " << cell;
          }
        }
      }
    }
  }
}

// So few that cells of a column share buckets.
TEST(PointGrid, VisitsAFewPointsInTheSameOrder) {
  std::mt19937_64 random(14);
  for (int n = 0; n < 300; ++n) {
    const std::vector<part::Vec3> points = random_points(6, 2.5, random);
    const certificate::PointGrid grid(points, 0.5);
    EXPECT_EQ(near_of_grid(grid, points[0], 3), near_of_all(points, 0.5, points[0], 3));
  }
}

TEST(PointGrid, FindsADistanceFarBeyondACell) {
  std::mt19937_64 random(12);
  const std::vector<part::Vec3> points = random_points(40, 1, random);
  const certificate::PointGrid grid(points, 0.01);
  const part::Vec3 place{0.5, 0.5, 0.5};
  double nearest = 3;
  for (const part::Vec3& p : points) nearest = std::min(nearest, part::length(p - place));
  EXPECT_EQ(grid.nearest_distance(place, 3), nearest);
  EXPECT_EQ(near_of_grid(grid, place, 3).size(), points.size());
  EXPECT_EQ(grid.nearest_distance(place, nearest / 2), nearest / 2);
}

TEST(PointGrid, IsTheSameForAnyNumberOfThreads) {
  std::mt19937_64 random(13);
  const std::vector<part::Vec3> points = random_points(30000, 20, random);
  const part::Vec3 place{1, 2, 3};
  const Visits one = near_of_all(points, 2, place, 15);
  for (const unsigned threads : {1, 2, 3, 8, 16}) {
    part::with_threads(threads, [&] {
      const certificate::PointGrid grid(points, 2);
      EXPECT_EQ(near_of_grid(grid, place, 15), one) << threads << " threads";
    });
  }
}

// Against all points, in steps of a fortieth of the separation, along a line and in a cube.
TEST(SparseSet, FindsAnyPointWithinTheSeparation) {
  std::mt19937_64 random(15);
  for (const int aside : {2, 120}) {
    std::uniform_int_distribution<int> along(aside == 2 ? -4000 : -aside,
                                             aside == 2 ? 4000 : aside),
        across(-aside, aside);
    const double separation = 0.7;
    sample::SparseSet set(separation);
    std::vector<part::Vec3> points;
    int near = 0;
    for (int n = 0; n < 3000; ++n) {
      const part::Vec3 p =
          separation / 40 *
          part::Vec3{1.0 * along(random), 1.0 * across(random), 1.0 * across(random)};
      const bool any = std::any_of(points.begin(), points.end(), [&](const part::Vec3& q) {
        return part::length_squared(p - q) < separation * separation;
      });
      EXPECT_EQ(set.any_within_separation(p), any);
      near += any;
      if (any) continue;
      set.add(p);
      points.push_back(p);
    }
    EXPECT_GT(near, 1000);
    EXPECT_GT(points.size(), 50);
  }
}

}  // namespace
}  // namespace forcelayer
