// The expected cost of a bake: told before it begins where it is more than a minute or a
// gigabyte.
#include <gtest/gtest.h>

#include "pointshell/bake.h"
#include "pointshell/cost.h"
#include "pointshell/report.h"
#include "tests/support/part_support.h"

namespace forcelayer {
namespace {

using namespace testing;

constexpr double kVoxelM = 0.05;

pointshell::ShellOptions options_of(double voxel_size_m = kVoxelM) {
  pointshell::ShellOptions options;
  options.voxel_size_m = voxel_size_m;
  options.threads = 1;
  return options;
}

// A ball of triangles smaller than a voxel, one vertex of which is far away.
mesh::Mesh ball_with_stray_vertex(double distance_m) {
  mesh::Mesh mesh = sphere_mesh(0.5, 120);
  mesh.vertices[mesh.vertices.size() / 2] = {distance_m, 0.1, 0.2};
  return mesh;
}

// A plate of needles side by side.
mesh::Mesh ribbed_plate(int ribs) {
  mesh::Mesh mesh;
  for (int n = 0; n <= ribs; ++n) {
    for (const double y : {0.0, 4.0}) mesh.vertices.push_back({2.0 * n / ribs, y, 0});
  }
  for (int n = 0; n < ribs; ++n) {
    const auto a = static_cast<std::uint32_t>(2 * n);
    mesh.triangles.push_back({a, a + 2, a + 3});
    mesh.triangles.push_back({a, a + 3, a + 1});
  }
  return mesh;
}

// Two triangles.
mesh::Mesh band(double length_m, double width_m) {
  mesh::Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {length_m, 0, 0}, {length_m, width_m, 0}, {0, width_m, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

// The points are within a factor of 1.7 of those that a bake makes: of a surface by its area, of
// needles by their length.
TEST(Cost, CountsThePointsOfSurfaceAndNeedles) {
  const std::pair<const char*, part::Part> cases[] = {
      {"box", part_of(box_mesh(1, 0.7, 0.5))},
      {"ball", part_of(sphere_mesh(0.5, 60))},
      {"ribs", part_of(ribbed_plate(500))},
      {"band", part_of(band(20, 0.1))},
      {"bundle", part_of(bundle_mesh(24, 0.005, 0.7, 8))},  // of rods: points cover its volume
      {"stray vertex", part_of(ball_with_stray_vertex(40))},
      {"stray vertex, farther", part_of(ball_with_stray_vertex(80))}};
  pointshell::ShellOptions options = options_of();
  options.effort = sample::Effort::kFast;  // about as many points in a third of the time
  for (const auto& [name, part] : cases) {
    const auto shell = pointshell::bake_shell(part, options, [](const std::string&, double) {});
    ASSERT_TRUE(shell.ok());
    const double factor =
        static_cast<double>(shell->x.size()) / pointshell::expected_cost(part, options).points;
    EXPECT_LT(factor, 1.7) << name;
    EXPECT_GT(factor, 1 / 1.7) << name;
  }
}

TEST(Cost, IsToldWhereItIsMoreThanAMinuteOrAGigabyte) {
  const part::Part box = part_of(box_mesh(1, 1, 1));
  const auto told = [&](double seconds, double bytes) {
    return !pointshell::cost_warning({1e6, seconds, seconds, bytes}, options_of(), box).empty();
  };
  EXPECT_FALSE(told(59, 0.9e9));
  EXPECT_TRUE(told(61, 0.1e9));
  EXPECT_TRUE(told(1, 1.1e9));
  const auto told_of = [](const part::Part& part, double voxel_size_m) {
    const auto cost = pointshell::expected_cost(part, options_of(voxel_size_m));
    return !pointshell::cost_warning(cost, options_of(), part).empty();
  };
  EXPECT_FALSE(told_of(box, 0.01));
  EXPECT_TRUE(told_of(box, 0.001));
  // A stray vertex: nothing but its length makes it long.
  EXPECT_FALSE(told_of(part_of(ball_with_stray_vertex(40)), kVoxelM));
  EXPECT_TRUE(told_of(part_of(ball_with_stray_vertex(40000)), kVoxelM));
  // A band: its open edges make it twice as long as its area.
  EXPECT_TRUE(told_of(part_of(band(1000, 0.1)), 0.01));
}

}  // namespace
}  // namespace forcelayer
