// Places of the surface are never nearer to a scene than the shell's points prove, and what a file
// claims beyond that is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "pointshell/bake.h"
#include "pointshell/certificate/hidden_surface.h"
#include "pointshell/verify.h"
#include "tests/support/long_tests.h"
#include "tests/support/part_support.h"
#include "tests/support/stored_shell.h"

namespace forcelayer {
namespace {

using namespace testing;

// An L of two arms, `thick` wide, extruded by `height`.
mesh::Mesh l_mesh(double arm, double thick, double height) {
  const double outline[6][2] = {{0, 0},         {arm, 0},     {arm, thick},
                                {thick, thick}, {thick, arm}, {0, arm}};
  mesh::Mesh mesh;
  for (const double z : {0.0, height}) {
    for (const auto& corner : outline) mesh.vertices.push_back({corner[0], corner[1], z});
  }
  for (const auto& [a, b, c] :
       std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({a + 6, b + 6, c + 6});
  }
  for (std::uint32_t n = 0; n < 6; ++n) {
    const std::uint32_t next = (n + 1) % 6;
    mesh.triangles.push_back({n, next, next + 6});
    mesh.triangles.push_back({n, next + 6, n + 6});
  }
  return mesh;
}

// A sphere whose vertices are moved along their radii: concave, with edges of every kind.
mesh::Mesh rough_mesh(double radius, double roughness, int steps, std::uint64_t seed) {
  mesh::Mesh mesh = sphere_mesh(radius, steps);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> scale(1 - roughness, 1 + roughness);
  for (auto& vertex : mesh.vertices) {
    const double s = scale(random);
    for (double& coordinate : vertex) coordinate *= s;
  }
  return mesh;
}

mesh::Mesh without_last_triangles(mesh::Mesh mesh, std::size_t count) {
  mesh.triangles.resize(mesh.triangles.size() - count);
  return mesh;
}

struct Case {
  std::string name;
  part::Part part;
};

std::vector<Case> cases_of(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto length = [&] { return 0.2 + unit(random); };
  std::vector<Case> cases;
  cases.push_back({"box", part_of(box_mesh(length(), length(), length()))});
  cases.push_back({"plate", part_of(box_mesh(length(), length(), 0.02 + 0.1 * unit(random)))});
  cases.push_back({"L", part_of(l_mesh(0.8 + unit(random), 0.1 + 0.3 * unit(random), length()))});
  cases.push_back({"sphere", part_of(sphere_mesh(0.2 + 0.5 * unit(random), 24))});
  cases.push_back({"cone", part_of(cone_mesh(length() / 2, 0, length(), 24))});
  cases.push_back({"rough", part_of(rough_mesh(0.6, 0.4 * unit(random), 8, seed))});
  cases.push_back({"open box", part_of(without_last_triangles(box_mesh(1, 1, 1), 2))});
  cases.push_back({"bundle", part_of(bundle_mesh(12, 0.008, 0.15 + 0.1 * unit(random), 8))});
  cases.push_back({"two bodies", part_of({box_mesh(0.5, 0.5, 0.5), sphere_mesh(0.35, 20)})});
  return cases;
}

using Distance = std::function<double(const part::Vec3&)>;

// A scene near `place`: the distance to it from anywhere.
Distance random_scene(const part::Vec3& place, double voxel, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  const part::Vec3 direction =
      part::normalized(part::Vec3{normal(random), normal(random), normal(random)});
  const part::Vec3 near = place + (3 * unit(random) * voxel) * direction;
  switch (random() % 4) {
    case 0:
      return [near](const part::Vec3& x) { return part::length(x - near); };
    case 1:
      return [near, direction](const part::Vec3& x) {
        return std::abs(part::dot(x - near, direction));
      };
    case 2: {
      const double radius = 3 * unit(random) * voxel;
      const part::Vec3 center = near + radius * direction;
      return [center, radius](const part::Vec3& x) {
        return std::abs(part::length(x - center) - radius);
      };
    }
    default: {
      part::Box box;
      box.grow(near);
      box.grow(near + (2 * voxel) * part::Vec3{normal(random), normal(random), normal(random)});
      return [box](const part::Vec3& x) { return std::sqrt(box.distance_squared(x)); };
    }
  }
}

double min_distance(std::span<const part::Vec3> places, const Distance& distance) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const part::Vec3& place : places) smallest = std::min(smallest, distance(place));
  return smallest;
}

struct Tally {
  int tried = 0, broken = 0, broken_by_half = 0;
};

// Compares the bound with the exact distances of places of the surface. Half of the losses must be
// too little somewhere, or the comparison could not fail.
Tally compare(const part::Part& part, const pointshell::BakedShell& shell, int scenes,
              std::uint64_t seed) {
  const std::vector<part::Vec3> points = positions_of(shell);
  const auto& c = shell.header.center_m;
  SurfaceDice dice(part, seed);
  // A scene does not reach surface within another body.
  const certificate::HiddenSurface hidden(part);
  std::vector<part::Vec3> places;
  const auto add = [&](const part::Vec3& place) {
    if (!hidden.holds_ball(place, 1e-9)) places.push_back(place - part::Vec3{c[0], c[1], c[2]});
  };
  for (int n = 0; n < 2000; ++n) add(dice.throw_once());
  for (const part::Vec3& vertex : part.vertices) add(vertex);
  const SurfaceDistanceTerms terms = shell.surface_distance_terms();
  std::vector<DistanceLoss> halves = shell.losses;
  for (DistanceLoss& entry : halves) entry.loss_m /= 2;
  SurfaceDistanceTerms half = terms;
  half.losses = halves;
  std::mt19937_64 random(seed);
  Tally tally;
  for (int n = 0; n < scenes; ++n) {
    const part::Vec3& place = places[random() % places.size()];
    const Distance distance = random_scene(place, shell.header.voxel_size_m, random);
    const double of_points = min_distance(points, distance);
    const double of_surface = min_distance(places, distance);
    ++tally.tried;
    // The distances of this test and the vertices of the part are rounded.
    tally.broken += of_surface < surface_distance_bound_m(terms, of_points) - 1e-12;
    tally.broken_by_half += of_surface < surface_distance_bound_m(half, of_points) - 1e-12;
  }
  return tally;
}

pointshell::BakedShell bake(const part::Part& part, ShellMethod method, double covering_radius_m) {
  pointshell::ShellOptions options;
  options.voxel_size_m = 0.1;
  options.method = method;
  options.covering_radius_m = covering_radius_m;
  auto shell = pointshell::bake_shell(part, options, [](const std::string&, double) {});
  EXPECT_TRUE(shell.ok()) << (shell ? "" : to_line(shell.error()));
  return std::move(*shell);
}

TEST(Losses, NoPlaceIsNearerThanThePointsProve) {
  const std::uint64_t seeds = test::long_tests() ? 50 : 2;
  const int scenes = test::long_tests() ? 2000 : 150;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Tally all;
    for (const Case& c : cases_of(seed)) {
      for (const auto& [method, radius] :
           {std::pair{ShellMethod::kSurface, 0.0}, std::pair{ShellMethod::kSurface, 0.05},
            std::pair{ShellMethod::kVoxelCenters, 0.0}}) {
        SCOPED_TRACE(c.name + ", radius " + std::to_string(radius) + ", seed " +
                     std::to_string(seed));
        const Tally tally = compare(c.part, bake(c.part, method, radius), scenes, seed);
        EXPECT_EQ(tally.broken, 0) << "of " << tally.tried;
        all.broken_by_half += tally.broken_by_half;
      }
    }
    EXPECT_GT(all.broken_by_half, 20) << "seed " << seed;
  }
}

// Points on corners and edges, and wherever the hull of points cuts off too much.
TEST(Losses, ShellPointsAt164VoxelsProve12OfTheWholeSurface) {
  for (const Case& c : cases_of(7)) {
    const pointshell::BakedShell shell = bake(c.part, ShellMethod::kSurface, 0);
    EXPECT_GE(surface_distance_bound_m(shell.surface_distance_terms(), 0.164), 0.12) << c.name;
    EXPECT_LT(shell.header.convex_gap_m, shell.header.covering_radius_m) << c.name;
  }
}

TEST(Losses, EveryCornerOfABoxHasAPoint) {
  const part::Part part = part_of(box_mesh(1, 0.7, 0.5));
  const pointshell::BakedShell shell = bake(part, ShellMethod::kSurface, 0);
  const auto& c = shell.header.center_m;
  const std::vector<part::Vec3> points = positions_of(shell);
  for (const part::Vec3& vertex : part.vertices) {
    const part::Vec3 corner = vertex - part::Vec3{c[0], c[1], c[2]};
    const double nearest =
        min_distance(points, [&](const part::Vec3& p) { return part::length(p - corner); });
    EXPECT_LT(nearest, 1e-6);  // rounded to floats
  }
}

// Copies of bodies: their points are off by some slack.
TEST(Losses, WithSlackHoldForPointsThatAreOff) {
  const pointshell::BakedShell shell =
      bake(part_of(box_mesh(1, 0.7, 0.5)), ShellMethod::kSurface, 0);
  const auto& c = shell.header.center_m;
  const part::Part part =
      part::relative_to(part_of(box_mesh(1, 0.7, 0.5)), part::Vec3{c[0], c[1], c[2]});
  const std::vector<part::Vec3> points = positions_of(shell);
  const double radius = shell.header.covering_radius_m, slack = 0.03 * radius;
  for (const double claimed_slack : {slack, 0.0}) {
    const certificate::SurfaceLosses losses = certificate::find_losses(
        {part, points, radius + slack, shell.header.voxel_size_m, nullptr, claimed_slack},
        [](double) {});
    const SurfaceDistanceTerms terms{radius + slack, losses.convex_radius, losses.convex_gap,
                                     losses.losses};
    int proven = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      std::mt19937_64 random(seed);
      std::normal_distribution<double> normal;
      std::vector<part::Vec3> off = points;
      for (part::Vec3& p : off) {
        p += slack * part::normalized(part::Vec3{normal(random), normal(random), normal(random)});
      }
      const certificate::LossProof proof =
          certificate::prove_losses({part, off, radius + slack, shell.header.voxel_size_m}, terms);
      proven += proof.proven ? 1 : 0;
    }
    if (claimed_slack > 0) {
      EXPECT_EQ(proven, 6);
    } else {
      EXPECT_LT(proven, 6);
    }
  }
}

bool verified(const part::Part& part, const pointshell::BakedShell& shell) {
  return pointshell::verify_losses(stored(shell), part).proven;
}

TEST(Losses, VerifyProvesWhatIsStoredAndRefusesMore) {
  for (const Case& c : cases_of(3)) {
    SCOPED_TRACE(c.name);
    const pointshell::BakedShell shell = bake(c.part, ShellMethod::kSurface, 0);
    EXPECT_TRUE(verified(c.part, shell));
    pointshell::BakedShell claims_more = shell;
    for (DistanceLoss& entry : claims_more.losses) entry.loss_m *= 0.7;
    EXPECT_FALSE(verified(c.part, claims_more));
    claims_more = shell;
    claims_more.header.convex_radius_m *= 0.5;
    claims_more.header.convex_gap_m *= 0.5;
    EXPECT_FALSE(verified(c.part, claims_more));
  }
}

// Whatever way the triangles of the file face, and whatever the radius: what a bake writes is
// verified from the same file.
TEST(Losses, VerifyProvesEveryShellThatABakeWrites) {
  int refused = 0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto plate = [&] {  // with corners on a grid, as plates of sheet metal
      mesh::Mesh mesh = box_mesh(1 + random() % 12, 1 + random() % 12, 1 + random() % 3);
      for (mesh::Triangle& triangle : mesh.triangles) {
        if (random() % 3 == 0) std::swap(triangle[0], triangle[1]);
        std::rotate(triangle.begin(), triangle.begin() + random() % 3, triangle.end());
      }
      if (random() % 2 == 0) mesh.vertices[random() % 8][random() % 3] += 5 * unit(random);
      return mesh;
    };
    mesh::Mesh united = plate();
    for (std::uint64_t more = random() % 4; more > 0; --more) {
      const mesh::Mesh other = plate();
      const auto first = static_cast<std::uint32_t>(united.vertices.size());
      united.vertices.insert(united.vertices.end(), other.vertices.begin(), other.vertices.end());
      for (const auto& [a, b, c] : other.triangles) {
        united.triangles.push_back({a + first, b + first, c + first});
      }
    }
    std::vector<mesh::Mesh> bodies{std::move(united)};
    if (seed % 3 == 0) bodies.push_back(plate());
    const part::Part part = part_of(std::move(bodies), 0.01);
    pointshell::ShellOptions options;
    options.voxel_size_m = 0.01 * (1 + 2 * unit(random));
    options.covering_radius_m = options.voxel_size_m * (0.15 + unit(random));
    options.effort = sample::Effort::kFast;
    const auto shell = pointshell::bake_shell(
        part, options, [](const std::string&, double) {}, 0);
    ASSERT_TRUE(shell) << to_line(shell.error());
    EXPECT_TRUE(pointshell::verify_shell(stored(*shell), part).proven);
    EXPECT_TRUE(verified(part, *shell));
    pointshell::BakedShell claims_more = *shell;
    for (DistanceLoss& entry : claims_more.losses) entry.loss_m *= 0.7;
    refused += verified(part, claims_more) ? 0 : 1;
  }
  EXPECT_GE(refused, 22);  // a stored loss is a bound, and may be above what holds
}

}  // namespace
}  // namespace forcelayer
