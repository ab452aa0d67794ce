// Where a part may be in its seat by the meshes: against formulas for plates and boxes, on both
// sides of each threshold. The whole check of a path is a slow twin of its own
// (voxcheck_seat_depth.cpp).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "tests/support/box_surface.h"
#include "workbench/exact/seat_meshes.h"

namespace forcelayer::exact {
namespace {

constexpr std::uint32_t kWall = 1, kOther = 2;

void add_box(Surface& surface, const glm::dvec3& low_m, const glm::dvec3& high_m,
             std::uint32_t object, const glm::dquat& turn = {1, 0, 0, 0}) {
  const std::size_t first = surface.vertices_m.size();
  test::add_box(surface, low_m, high_m, object);
  for (std::size_t n = first; n < surface.vertices_m.size(); ++n) {
    surface.vertices_m[n] = turn * surface.vertices_m[n];
  }
  for (const glm::dvec3& v : surface.vertices_m) {
    for (int axis = 0; axis < 3; ++axis) {
      surface.largest_m = std::max(surface.largest_m, std::abs(v[axis]));
    }
  }
}

Pose at(const glm::dvec3& position_m) { return {position_m, {1, 0, 0, 0}}; }

// A block of 20 mm before a wall of so thick: a gap of 0.1 mm is between them.
struct BeforeWall {
  explicit BeforeWall(double thick_m, double gap_m = 1e-4, double depth_m = 0)
      : thick(thick_m), gap(gap_m) {
    add_box(scene, {0.01 + gap, -0.05, -0.05}, {0.01 + gap + thick, 0.05, 0.05}, kWall);
    add_box(scene, {-0.05, -0.05, -0.03}, {0.005, 0.05, -0.02}, kOther);
    add_box(part, glm::dvec3(-0.01), glm::dvec3(0.01), 1);
    const std::uint32_t objects[] = {kWall};
    seat = std::make_unique<SeatMeshes>(scene, part, objects, at({0, 0, 0}), depth_m);
  }
  // How deep the block is in the wall, pushed by so much: as far as it came in, or has yet to go
  // out.
  double depth_m(double x) const {
    return std::max(0.0, std::min(x - gap, gap + thick + 0.02 - x));
  }

  double thick, gap;
  Surface scene, part;
  std::unique_ptr<SeatMeshes> seat;
};

TEST(SeatMeshes, HasTheLeewayOfTheGap) {
  const BeforeWall bench(1e-3);
  EXPECT_NEAR(bench.seat->leeway_m(at({0, 0, 0})), 1e-4, 1e-9);
  EXPECT_NEAR(bench.seat->leeway_m(at({-0.002, 0, 0})), 2.1e-3, 1e-9);
  EXPECT_FALSE(bench.seat->blocked_by(at({5e-5, 0, 0})));
  // The other object, which is not of the seat, does not count.
  EXPECT_GT(bench.seat->leeway_m(at({-0.002, 0, -0.02})), 0);
}

// However thin the wall, and whatever the voxels: from where it is touched on, until it is behind
// the block.
TEST(SeatMeshes, NoWallIsTooThin) {
  for (const double thick_m : {3e-3, 5e-4, 2e-5, 1e-6}) {
    const BeforeWall bench(thick_m);
    const double rounding_m = 0.1 * kRounding;
    EXPECT_GE(bench.seat->leeway_m(at({bench.gap - rounding_m, 0, 0})), 0) << thick_m;
    for (const double into_m : {4 * rounding_m, 0.4 * thick_m, 0.005, 0.0199}) {
      const Pose pose = at({bench.gap + into_m, 0, 0});
      EXPECT_LT(bench.seat->leeway_m(pose), 0) << thick_m << " " << into_m;
      EXPECT_EQ(bench.seat->blocked_by(pose), kWall) << thick_m << " " << into_m;
    }
    EXPECT_GT(bench.seat->leeway_m(at({bench.gap + thick_m + 0.02 + 1e-5, 0, 0})), 0) << thick_m;
  }
}

TEST(SeatMeshes, GoesAsDeepAsInstalledAndAsIsAllowed) {
  const BeforeWall overlaps(3e-3, -2e-4);
  EXPECT_GE(overlaps.seat->leeway_m(at({0, 0, 0})), 0);
  EXPECT_GE(overlaps.seat->leeway_m(at({0, 1e-3, 0})), 0);  // along the wall
  EXPECT_LT(overlaps.seat->leeway_m(at({1e-6, 0, 0})), 0);
  const BeforeWall allowed(3e-3, 1e-4, 5e-4);
  EXPECT_GE(allowed.seat->leeway_m(at({5.999e-4, 0, 0})), 0);
  EXPECT_LT(allowed.seat->leeway_m(at({6.001e-4, 0, 0})), 0);
}

TEST(SeatMeshes, AnswersByTheDepthOfBoxes) {
  std::mt19937_64 random(5);
  const auto fraction = [&] { return std::uniform_real_distribution<double>(0, 1)(random); };
  const BeforeWall bench(2e-3, 1e-4, 3e-4);
  int refused = 0;
  for (int n = 0; n < 300; ++n) {
    const double x = -1e-3 + 3e-3 * fraction();
    const double beyond_m = bench.depth_m(x) - 3e-4;
    if (std::abs(beyond_m) < 1e-8) continue;
    const Pose pose = at({x, 2e-3 * (fraction() - 0.5), 2e-3 * (fraction() - 0.5)});
    EXPECT_EQ(bench.seat->leeway_m(pose) < 0, beyond_m > 0) << x;
    refused += beyond_m > 0;
  }
  EXPECT_GT(refused, 100);
}

// A block in a slot that is turned at random: along it, exactly, it may go, and its meshes say so.
TEST(SeatMeshes, KnowsTheDirectionOfASlot) {
  std::mt19937_64 random(6);
  const auto normal = [&] { return std::normal_distribution<double>()(random); };
  for (int n = 0; n < 50; ++n) {
    const glm::dquat turn = glm::normalize(glm::dquat{normal(), normal(), normal(), normal()});
    Surface scene, part;
    add_box(scene, {-0.02, 0.0101, -0.02}, {0.02, 0.015, 0.02}, kWall, turn);
    add_box(scene, {-0.02, -0.015, -0.02}, {0.02, -0.0101, 0.02}, kWall, turn);
    add_box(scene, {-0.02, -0.015, -0.03}, {0.02, 0.015, -0.0101}, kWall, turn);
    add_box(part, glm::dvec3(-0.01), glm::dvec3(0.01), 1, turn);
    const std::uint32_t objects[] = {kWall};
    const SeatMeshes seat(scene, part, objects, at({0, 0, 0}), 0);
    for (const glm::dvec3& free : {glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1)}) {
      const glm::dvec3 way = turn * free;
      const bool knows =
          std::any_of(seat.directions().begin(), seat.directions().end(),
                      [&](const glm::dvec3& d) { return glm::length(d - way) < 1e-6; });
      EXPECT_TRUE(knows) << n;
      for (double way_m = 0; way_m < 0.05; way_m += 1e-3) {
        ASSERT_GE(seat.leeway_m(at(way_m * way)), 0) << n << " " << way_m;
      }
    }
  }
}

// A sheet has no inside, but the block has. Two sheets that meet settle nothing.
TEST(SeatMeshes, SheetsAreNotPassedEither) {
  Surface sheet, part, open;
  sheet.vertices_m = {{0.0101, -1, -1}, {0.0101, 1, -1}, {0.0101, 0, 1}};
  sheet.triangles = {{0, 1, 2}};
  sheet.object = {kWall};
  sheet.largest_m = 1;
  add_box(part, glm::dvec3(-0.01), glm::dvec3(0.01), 1);
  open = part;
  open.triangles.resize(10), open.object.resize(10);  // without the side at x = 10 mm
  const std::uint32_t objects[] = {kWall};
  const SeatMeshes seat(sheet, part, objects, at({0, 0, 0}), 0);
  EXPECT_TRUE(seat.never_settled().empty());
  EXPECT_GE(seat.leeway_m(at({0.9e-4, 0, 0})), 0);
  EXPECT_LT(seat.leeway_m(at({1.1e-4, 0, 0})), 0);
  const SeatMeshes apart(sheet, open, objects, at({0, 0, 0}), 0);
  EXPECT_TRUE(apart.never_settled().empty());
  EXPECT_GE(apart.leeway_m(at({0.9e-4, 0, 0})), 0);
  EXPECT_LT(apart.leeway_m(at({0.01, 0, 0})), 0);
  const SeatMeshes met(sheet, open, objects, at({1e-3, 0, 0}), 0);
  EXPECT_EQ(met.never_settled(), std::vector<std::uint32_t>{kWall});
}

}  // namespace
}  // namespace forcelayer::exact
