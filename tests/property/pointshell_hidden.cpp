// In a part of overlapping bodies, surface inside another body is left out, and nothing else.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>

#include "pointshell/bake.h"
#include "pointshell/certificate/hidden_surface.h"
#include "pointshell/certificate/point_grid.h"
#include "pointshell/normals/orientation.h"
#include "pointshell/report.h"
#include "pointshell/verify.h"
#include "tests/support/part_support.h"
#include "tests/support/stored_shell.h"

namespace forcelayer {
namespace {

using namespace testing;

mesh::Mesh moved(mesh::Mesh mesh, const part::Vec3& by) {
  for (mesh::Vec3d& v : mesh.vertices) v = {v[0] + by.x, v[1] + by.y, v[2] + by.z};
  return mesh;
}

mesh::Mesh inside_out(mesh::Mesh mesh) {
  for (mesh::Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

mesh::Mesh joined(mesh::Mesh a, const mesh::Mesh& b) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const mesh::Triangle& t : b.triangles) {
    a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return a;
}

pointshell::BakedShell bake(const part::Part& part, double voxel_size_m, ShellMethod method) {
  pointshell::ShellOptions options;
  options.voxel_size_m = voxel_size_m;
  options.method = method;
  auto shell = pointshell::bake_shell(part, options, [](const std::string&, double) {});
  EXPECT_TRUE(shell.ok()) << (shell ? "" : to_line(shell.error()));
  return std::move(*shell);
}

// Two bodies, and how deep a place is inside each of them (negative: outside).
struct Pair {
  const char* name;
  part::Part part;
  std::function<double(const part::Vec3&)> depth_in_a, depth_in_b;
};

double depth_in_box(const part::Vec3& p, const part::Vec3& middle, const part::Vec3& half) {
  const part::Vec3 d = p - middle;
  return std::min({half.x - std::abs(d.x), half.y - std::abs(d.y), half.z - std::abs(d.z)});
}

std::vector<Pair> overlapping_pairs() {
  const auto cube = [](const part::Vec3& p) { return depth_in_box(p, {}, {0.5, 0.5, 0.5}); };
  const auto bar = [](const part::Vec3& p) { return depth_in_box(p, {0.1, 0, 0}, {1, 0.3, 0.3}); };
  const auto ball = [](const part::Vec3& p) {
    return 0.7 - part::length(p - part::Vec3{0.6, 0.2, 0});
  };
  const mesh::Mesh bar_mesh = moved(box_mesh(2, 0.6, 0.6), {0.1, 0, 0});
  const mesh::Mesh ball_mesh = moved(sphere_mesh(0.7, 60), {0.6, 0.2, 0});
  std::vector<Pair> pairs;
  pairs.push_back({"cube and bar", part_of({box_mesh(1, 1, 1), bar_mesh}), cube, bar});
  pairs.push_back(
      {"cube and bar inside out", part_of({box_mesh(1, 1, 1), inside_out(bar_mesh)}), cube, bar});
  pairs.push_back({"cube and ball", part_of({box_mesh(1, 1, 1), ball_mesh}), cube, ball});
  return pairs;
}

// The twin: the analytic depth. All that is not deep inside the other body is covered, and no point
// that is deep inside is left.
TEST(Hidden, PointsInsideAnotherBodyAreLeftOutAndNoOthers) {
  constexpr std::uint64_t kSeed = 31;
  constexpr double kVoxel = 0.06;
  for (const Pair& pair : overlapping_pairs()) {
    for (const ShellMethod method : {ShellMethod::kSurface, ShellMethod::kVoxelCenters}) {
      SCOPED_TRACE(std::string(pair.name) + ", " + pointshell::method_name(method));
      const pointshell::BakedShell shell = bake(pair.part, kVoxel, method);
      EXPECT_GT(shell.hidden_points, 20u);
      const double radius = shell.header.covering_radius_m;
      const part::Vec3 center{shell.header.center_m[0], shell.header.center_m[1],
                              shell.header.center_m[2]};
      const std::vector<part::Vec3> points = positions_of(shell);
      for (const part::Vec3& point : points) {
        const part::Vec3 p = point + center;
        // The ball's facets lie inside it by less than 0.002.
        EXPECT_LT(std::max(pair.depth_in_a(p), pair.depth_in_b(p)), 1.25 * radius + 0.002);
      }
      const certificate::PointGrid grid(points, radius);
      SurfaceDice dice(pair.part, kSeed);
      int outer = 0;
      for (int n = 0; n < 20000; ++n) {
        const part::Vec3 p = dice.throw_once();
        if (std::max(pair.depth_in_a(p), pair.depth_in_b(p)) > 0.002) continue;
        ++outer;
        ASSERT_LE(grid.nearest_distance(p - center, 1.1 * radius), radius * (1 + 1e-12))
            << "seed " << kSeed << ", sample " << n;
      }
      EXPECT_GT(outer, 5000);
    }
  }
}

double sum_of_weights(const pointshell::BakedShell& shell) {
  return std::accumulate(shell.weight_m2.begin(), shell.weight_m2.end(), 0.0);
}

// The twin: places thrown on the surface, of which those inside another body do not count.
TEST(Hidden, WeightsSumToTheOuterSurface) {
  constexpr std::uint64_t kSeed = 5;
  constexpr int kThrown = 400000;  // the fraction is known to 0.0008
  for (const Pair& pair : overlapping_pairs()) {
    for (const ShellMethod method : {ShellMethod::kSurface, ShellMethod::kVoxelCenters}) {
      SCOPED_TRACE(std::string(pair.name) + ", " + pointshell::method_name(method));
      SurfaceDice dice(pair.part, kSeed);
      int outer = 0;
      for (int n = 0; n < kThrown; ++n) {
        const part::Vec3 p = dice.throw_once();
        // On its own body a place is as deep as rounding and the ball's facets make it.
        outer += std::max(pair.depth_in_a(p), pair.depth_in_b(p)) < 0.002;
      }
      const pointshell::BakedShell shell = bake(pair.part, 0.06, method);
      const double fraction = static_cast<double>(outer) / kThrown;
      EXPECT_LT(fraction, 0.95);
      // On a lattice the pieces along an edge err the same way, by up to a quarter of the radius.
      const double error = method == ShellMethod::kSurface ? 0.004 : 0.01;
      EXPECT_NEAR(sum_of_weights(shell) / shell.header.area_m2, fraction, error);
      EXPECT_NEAR(shell.covered_area_m2, sum_of_weights(shell), 1e-6 * shell.header.area_m2);
    }
  }
  // The cube has 6 less 2 x 0.36. The bar has 2.4 around 1 m of it, and its ends.
  const pointshell::BakedShell shell =
      bake(overlapping_pairs()[0].part, 0.06, ShellMethod::kSurface);
  EXPECT_NEAR(sum_of_weights(shell), 8.4, 0.005 * 8.4);
  // Copies of a body are points of their own; what hides them is known of the whole.
  const part::Part balls = part_of({box_mesh(1, 1, 1), moved(sphere_mesh(0.2, 24), {0.5, 0, 0}),
                                    moved(sphere_mesh(0.2, 24), {-0.5, 0, 0})});
  const double box_m2 = 6 - 2 * M_PI * 0.04, halves_m2 = 4 * M_PI * 0.04;
  const double sum = sum_of_weights(bake(balls, 0.03, ShellMethod::kSurface));
  EXPECT_NEAR(sum, box_m2 + halves_m2, 0.01 * (box_m2 + halves_m2));
}

TEST(Hidden, TheFileIsProvenAgainAndFailsWithoutAnOuterPoint) {
  for (const Pair& pair : overlapping_pairs()) {
    SCOPED_TRACE(pair.name);
    const pointshell::BakedShell shell = bake(pair.part, 0.1, ShellMethod::kSurface);
    EXPECT_TRUE(pointshell::verify_shell(stored(shell), pair.part).proven);
    // The point that is farthest out along x alone covers some of the end there.
    const auto farthest = std::max_element(shell.x.begin(), shell.x.end()) - shell.x.begin();
    const pointshell::BakedShell mutated = without_point(shell, static_cast<std::size_t>(farthest));
    EXPECT_FALSE(pointshell::verify_shell(stored(mutated), pair.part).proven);
  }
}

// Points that no closed body holds stay: on a body beside another or in its cavity, and everywhere
// around an open body.
TEST(Hidden, NothingElseIsLeftOut) {
  const mesh::Mesh ball = sphere_mesh(0.3, 24);
  const mesh::Mesh hollow = joined(box_mesh(2, 2, 2), inside_out(box_mesh(1, 1, 1)));
  mesh::Mesh open = box_mesh(2, 2, 2);
  open.triangles.pop_back();
  const std::pair<const char*, part::Part> cases[] = {
      {"beside", part_of({box_mesh(1, 1, 1), moved(ball, {2, 0, 0})})},
      {"touching", part_of({box_mesh(1, 1, 1), moved(box_mesh(1, 1, 1), {1, 0, 0})})},
      {"the same twice", part_of({ball, ball})},
      {"in a cavity", part_of({hollow, ball})},
      {"in an open box", part_of({open, ball})},
      {"one body of two", part_of(joined(box_mesh(2, 2, 2), ball))}};
  for (const auto& [name, part] : cases) {
    SCOPED_TRACE(name);
    const pointshell::BakedShell shell = bake(part, 0.08, ShellMethod::kSurface);
    EXPECT_EQ(shell.hidden_points, 0u);
    EXPECT_NEAR(sum_of_weights(shell), shell.header.area_m2, 1e-5 * shell.header.area_m2);
  }
  EXPECT_GT(bake(part_of({box_mesh(2, 2, 2), ball}), 0.08, ShellMethod::kSurface).hidden_points,
            0u);
}

TEST(Hidden, BallsAreInsideOnlyWithTheirWholeRadius) {
  part::Part part = part_of({box_mesh(1, 1, 1), moved(box_mesh(1, 1, 1), {0.5, 0, 0})});
  normals::orient_outwards(part, 0.1);
  const certificate::HiddenSurface hidden(part);
  EXPECT_TRUE(hidden.holds_ball({-0.2, 0, 0}, 0.29));
  EXPECT_FALSE(hidden.holds_ball({-0.2, 0, 0}, 0.31));
  EXPECT_FALSE(hidden.holds_ball({2, 0, 0}, 0.01));
  EXPECT_FALSE(hidden.holds_ball({0.5, 0.5, 0}, 0.01));  // on both surfaces
  // Where the ball and the surface are off by 0.01 each.
  const certificate::HiddenSurface off(part, 0.01);
  EXPECT_TRUE(off.holds_ball({-0.2, 0, 0}, 0.279));
  EXPECT_FALSE(off.holds_ball({-0.2, 0, 0}, 0.281));
}

// Where may_hold() denies it, no ball that deep is inside a body: at random places of boxes at
// random, the touching faces of two bodies among them.
TEST(Hidden, BoxesThatReachIntoNoBodyHoldNothingHidden) {
  part::Part part = part_of({box_mesh(1, 1, 1), moved(box_mesh(1, 1, 1), {1, 0, 0}),
                             moved(sphere_mesh(0.3, 24), {0.4, 0.6, 0})});
  normals::orient_outwards(part, 0.1);
  const certificate::HiddenSurface hidden(part);
  const part::Box face{{0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}};  // between the two boxes
  EXPECT_TRUE(hidden.may_hold(face, 0));
  EXPECT_TRUE(hidden.may_hold(face, 0.05));  // the ball reaches across it
  const part::Box outer{{-0.5, -0.5, -0.5}, {-0.5, 0.5, 0.5}};
  EXPECT_FALSE(hidden.may_hold(outer, 0.05));
  constexpr std::uint64_t kSeed = 32;
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> at(-1, 2), size(0, 0.3), fraction(0, 1);
  int denied = 0, held = 0;
  for (int n = 0; n < 20000; ++n) {
    part::Box box;
    box.low = {at(random), at(random), at(random)};
    box.high = box.low + part::Vec3{size(random), size(random), size(random)};
    const double depth = size(random) / 4;
    const part::Vec3 s = box.high - box.low;
    const part::Vec3 p = box.low + part::Vec3{fraction(random) * s.x, fraction(random) * s.y,
                                              fraction(random) * s.z};
    const bool inside = hidden.holds_ball(p, depth);
    held += inside;
    if (hidden.may_hold(box, depth)) continue;
    ++denied;
    ASSERT_FALSE(inside) << "seed " << kSeed << ", box " << n;
  }
  EXPECT_GT(denied, 5000);
  EXPECT_GT(held, 100);
}

// A piece that no point covers is let pass only where all of it is inside.
TEST(Hidden, APieceThatLooksOutIsAHole) {
  part::Part part = part_of({box_mesh(1, 1, 1), moved(box_mesh(1, 1, 1), {0.5, 0, 0})});
  normals::orient_outwards(part, 0.1);
  const certificate::HiddenSurface hidden(part);
  const auto passes = [&](const part::Vec3& a, const part::Vec3& b, const part::Vec3& c) {
    certificate::CoveringProof failed;
    failed.holes.push_back({a, 1, {a, b, c}});
    return certificate::continue_proof(part, {}, 0.2, failed, &hidden).proven;
  };
  EXPECT_TRUE(passes({0.1, -0.1, 0}, {0.9, 0, 0}, {0.3, 0.3, 0}));
  EXPECT_TRUE(passes({-0.4, 0.4, 0.4}, {0.4, 0.4, 0.4}, {0, -0.4, -0.4}));
  EXPECT_FALSE(passes({0.5, 0, 0}, {0.5, 0.2, 0}, {1.05, 0.1, 0}));  // its middle is inside
  EXPECT_FALSE(passes({1.1, 0, 0}, {1.2, 0.2, 0}, {1.3, 0.1, 0}));
  // Each half in another body, and the seam of both between.
  EXPECT_FALSE(passes({-0.3, 0.4, 0}, {0.8, 0.4, 0}, {0.2, 0.6, 0}));
}

}  // namespace
}  // namespace forcelayer
