// The flat bound of a brick: all non-free voxels lie behind it, and behind a wall it is close.
#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "runtime/query/brick_bounds.h"
#include "tests/support/random_scenes.h"

namespace forcelayer::test {
namespace {

using Brick = std::array<std::uint32_t, 32>;  // two bits a voxel

Brick filled(const std::function<std::uint32_t(glm::dvec3)>& value) {
  Brick brick{};
  for (std::uint32_t n = 0; n < 512; ++n) {
    const glm::dvec3 middle(n / 64 + 0.5, n / 8 % 8 + 0.5, n % 8 + 0.5);
    brick[n / 16] |= value(middle) << (n % 16 * 2);
  }
  return brick;
}

// The largest normal . x of any corner of a non-free voxel, corner by corner.
double farthest(const Brick& brick, const glm::dvec3& normal) {
  double largest = -100;
  for (std::uint32_t n = 0; n < 512; ++n) {
    if ((brick[n / 16] >> (n % 16 * 2) & 3) == 0) continue;
    for (std::uint32_t corner = 0; corner < 8; ++corner) {
      const glm::dvec3 at(n / 64 + (corner & 1), n / 8 % 8 + (corner >> 1 & 1),
                          n % 8 + (corner >> 2 & 1));
      largest = std::max(largest, glm::dot(normal, at));
    }
  }
  return largest;
}

glm::dvec3 normal_of(const query::BrickBound& bound) {
  return {bound.normal[0], bound.normal[1], bound.normal[2]};
}

TEST(BrickBounds, HoldEveryVoxelOfRandomBricks) {
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    const double fraction = uniform(random, 0, 1);
    const Brick brick = filled([&](glm::dvec3) {
      return uniform(random, 0, 1) < fraction ? static_cast<std::uint32_t>(random() % 4) : 0u;
    });
    const query::BrickBound bound = query::brick_bound(brick.data());
    const glm::dvec3 normal = normal_of(bound);
    if (glm::length(normal) == 0) continue;
    EXPECT_NEAR(glm::length(normal), 1, 1e-6);
    EXPECT_LE(farthest(brick, normal), bound.offset) << "brick " << i;
    EXPECT_GE(farthest(brick, normal), bound.offset - 1e-4) << "brick " << i;
  }
}

// A wall through the brick's middle, or nearly so: its steps are at most a voxel's diagonal high.
TEST(BrickBounds, LieCloseToWalls) {
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 wall = random_direction(random);
    const double offset = glm::dot(wall, glm::dvec3(4)) + uniform(random, -1.5, 1.5);
    const Brick brick =
        filled([&](glm::dvec3 middle) { return glm::dot(wall, middle) < offset ? 3u : 0u; });
    const query::BrickBound bound = query::brick_bound(brick.data());
    EXPECT_GT(glm::dot(normal_of(bound), wall), std::cos(0.2)) << "wall " << i;
    // In the brick's middle the bound is at most this far off the wall.
    const double middle = glm::dot(normal_of(bound), glm::dvec3(4));
    EXPECT_LT((bound.offset - middle) - (offset - glm::dot(wall, glm::dvec3(4))), 1.8)
        << "wall " << i;
  }
}

TEST(BrickBounds, KnowNothingWhereNoSideIsFree) {
  const Brick ball =
      filled([](glm::dvec3 at) { return glm::length(at - glm::dvec3(4)) < 2 ? 1u : 0u; });
  EXPECT_EQ(glm::length(normal_of(query::brick_bound(ball.data()))), 0);
}

}  // namespace
}  // namespace forcelayer::test
