#include "pointshell/sample/order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "pointshell/sample/smallest_ball.h"
#include "pointshell/sample/stored_position.h"

namespace forcelayer {
namespace {

std::vector<part::Vec3> random_points(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<part::Vec3> points(count);
  for (part::Vec3& p : points) p = sample::as_stored({unit(random), unit(random), unit(random)});
  return points;
}

// A square of 128 x 128 points falls into squares of 8 x 8, and those into squares of 64 x 64.
TEST(BlockOrder, HalvesASquareIntoSquares) {
  std::vector<part::Vec3> points;
  for (int n = 0; n < 128 * 128; ++n) points.push_back({double(n % 128), double(n / 128), 0});
  std::vector<part::Vec3> ordered;
  for (const std::uint32_t n : sample::block_order(points, 64, 64)) ordered.push_back(points[n]);
  for (const BoundingSphere& s : sample::bounding_spheres(ordered, 64)) {
    EXPECT_NEAR(s.radius, 7 * std::sqrt(0.5), 1e-5);
  }
  for (const BoundingSphere& s : sample::bounding_spheres(ordered, 4096)) {
    EXPECT_NEAR(s.radius, 63 * std::sqrt(0.5), 1e-4);
  }
}

TEST(BlockOrder, HoldsEveryPointOnce) {
  for (const std::size_t count : {1u, 64u, 65u, 4096u, 4097u, 40000u}) {
    std::vector<std::uint32_t> order = sample::block_order(random_points(count, count), 64, 64);
    std::sort(order.begin(), order.end());
    ASSERT_EQ(order.size(), count);
    for (std::uint32_t n = 0; n < count; ++n) ASSERT_EQ(order[n], n);
  }
  EXPECT_TRUE(sample::block_order({}, 64, 64).empty());
}

TEST(BlockOrder, DependsOnTheSetOfPointsAlone) {
  std::vector<part::Vec3> points = random_points(20000, 3);
  points.insert(points.end(), points.begin(), points.begin() + 10);
  std::vector<part::Vec3> reversed(points.rbegin(), points.rend());
  const auto order = sample::block_order(points, 64, 64),
             other = sample::block_order(reversed, 64, 64);
  for (std::size_t n = 0; n < order.size(); ++n) {
    EXPECT_EQ(points[order[n]], reversed[other[n]]);
  }
}

TEST(BoundingSpheres, HoldTheirPoints) {
  for (const std::size_t count : {1u, 63u, 64u, 65u, 1000u}) {
    const std::vector<part::Vec3> points = random_points(count, count);
    const auto spheres = sample::bounding_spheres(points, 64);
    ASSERT_EQ(spheres.size(), (count + 63) / 64);
    for (std::size_t n = 0; n < count; ++n) {
      const BoundingSphere& s = spheres[n / 64];
      EXPECT_LE(part::length(points[n] - part::Vec3{s.x, s.y, s.z}), s.radius);
    }
  }
}

// The smallest ball through two, three or four of the points that holds them all.
double smallest_radius_by_trying(const std::vector<part::Vec3>& points) {
  double best = std::numeric_limits<double>::infinity();
  const std::size_t count = points.size();
  for (unsigned chosen = 1; chosen < 1u << count; ++chosen) {
    if (__builtin_popcount(chosen) > 4) continue;
    std::vector<part::Vec3> support;
    for (std::size_t n = 0; n < count; ++n) {
      if (chosen >> n & 1) support.push_back(points[n]);
    }
    const sample::Ball ball = sample::smallest_ball(support);
    bool holds = true;
    for (const part::Vec3& p : points) holds &= part::length(p - ball.center) <= ball.radius + 1e-9;
    if (holds) best = std::min(best, ball.radius);
  }
  return best;
}

TEST(SmallestBall, OfFewPointsIsThatOfSomeFourOfThem) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(seed);
    const std::vector<part::Vec3> points = random_points(8, seed);
    const sample::Ball ball = sample::smallest_ball(points);
    for (const part::Vec3& p : points)
      EXPECT_LE(part::length(p - ball.center), ball.radius * (1 + 1e-11));
    EXPECT_NEAR(ball.radius, smallest_radius_by_trying(points), 1e-8);
  }
}

TEST(SmallestBall, TakesPointsOnALineInAPlaneAndEqualOnes) {
  EXPECT_EQ(sample::smallest_ball(std::vector<part::Vec3>{{1, 2, 3}}).radius, 0);
  EXPECT_EQ(sample::smallest_ball(std::vector<part::Vec3>{{1, 2, 3}, {1, 2, 3}}).radius, 0);
  std::vector<part::Vec3> line, square;
  for (int n = 0; n <= 10; ++n) line.push_back({0.1 * n, 0.2 * n, 0.2 * n});
  EXPECT_NEAR(sample::smallest_ball(line).radius, 1.5, 1e-12);
  for (int n = 0; n < 25; ++n) square.push_back({double(n % 5), double(n / 5), 0});
  EXPECT_NEAR(sample::smallest_ball(square).radius, 2 * std::sqrt(2.0), 1e-12);
}

}  // namespace
}  // namespace forcelayer
