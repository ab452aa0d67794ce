// A part that a closed surface encloses: cubes in and around a box with a cavity, against the
// formula for boxes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/box_surface.h"
#include "workbench/exact/enclosure.h"

namespace forcelayer::exact {
namespace {

constexpr std::uint32_t kOther = 1, kCase = 2;

void add_box(Surface& surface, double low_m, double high_m, std::uint32_t object, bool is_inward) {
  test::add_box(surface, glm::dvec3(low_m), glm::dvec3(high_m), object, is_inward);
  surface.largest_m = std::max({surface.largest_m, std::abs(low_m), std::abs(high_m)});
}

constexpr double kOutside = 0.025, kInside = 0.02, kHalf = 0.005;

// A case with a cavity of 40 mm and walls of 5 mm, and an object beside it.
Surface hollow_case() {
  Surface scene;
  add_box(scene, 0.1, 0.12, kOther, false);
  add_box(scene, -kOutside, kOutside, kCase, false);
  add_box(scene, -kInside, kInside, kCase, true);
  return scene;
}
Surface cube(double half_m) {
  Surface part;
  add_box(part, -half_m, half_m, 1, false);
  return part;
}
Pose at(const glm::dvec3& position_m) { return {position_m, {1, 0, 0, 0}}; }

TEST(Enclosure, IsOfACubeWithinTheOutsideOfTheCase) {
  std::mt19937_64 random(7);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const Surface scene = hollow_case();
  int enclosed = 0, free = 0;
  for (int repeat = 0; repeat < 400; ++repeat) {
    const double half_m = repeat % 4 == 0 ? 0.001 : kHalf;
    const glm::dvec3 place(between(-0.04, 0.04), between(-0.04, 0.04), between(-0.04, 0.04));
    const double from_m = std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)});
    // The outside of the case encloses a cube that lies within it, also where that meets the
    // cavity.
    const bool expected = from_m + half_m < kOutside;
    const auto object = enclosing_object(scene, cube(half_m), at(place), 1e-9);
    EXPECT_EQ(object.has_value(), expected) << place.x << " " << place.y << " " << place.z;
    EXPECT_EQ(object.value_or(kCase), kCase);
    ++(expected ? enclosed : free);
  }
  EXPECT_GT(enclosed, 20);
  EXPECT_GT(free, 20);
}

TEST(Enclosure, IsNoneOfAnOpenSurfaceNorOfOneWithinTheMargin) {
  Surface torn;  // the cavity alone, without a triangle
  add_box(torn, -kInside, kInside, kCase, true);
  EXPECT_TRUE(enclosing_object(torn, cube(kHalf), at({0, 0, 0}), 1e-9));
  EXPECT_FALSE(enclosing_object(torn, cube(kHalf), at({0, 0, 0.015 - 1e-4}), 1.1e-4));
  EXPECT_TRUE(enclosing_object(torn, cube(kHalf), at({0, 0, 0.015 - 1e-4}), 0.9e-4));
  torn.triangles.pop_back();
  torn.object.pop_back();
  EXPECT_FALSE(enclosing_object(torn, cube(kHalf), at({0, 0, 0}), 1e-9));
}

TEST(Enclosure, TellsHowFarThePartGoesStraight) {
  std::mt19937_64 random(8);
  const Surface scene = hollow_case();
  for (int repeat = 0; repeat < 50; ++repeat) {
    std::uniform_real_distribution<double> off(-0.0149, 0.0149);
    const glm::dvec3 place(off(random), off(random), off(random));
    const double most_m = std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)});
    EXPECT_NEAR(farthest_straight_m(scene, cube(kHalf), at(place), 1), kInside - kHalf + most_m,
                2e-6);
  }
  EXPECT_EQ(farthest_straight_m(scene, cube(kHalf), at({0, 0, 0}), 0.004), 0.004);
}

}  // namespace
}  // namespace forcelayer::exact
