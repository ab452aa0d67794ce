// Shells cover the surface within their radius, and the certificate notices when they do not.
#include <gtest/gtest.h>

#include <random>

#include "pointshell/bake.h"
#include "pointshell/certificate/certificate.h"
#include "pointshell/certificate/point_grid.h"
#include "pointshell/report.h"
#include "pointshell/verify.h"
#include "tests/support/long_tests.h"
#include "tests/support/part_support.h"
#include "tests/support/stored_shell.h"

namespace forcelayer {
namespace {

using namespace testing;
using test::long_tests;

struct Case {
  const char* name;
  part::Part part;
  double voxel_size_m;
};

std::vector<Case> shapes() {
  std::vector<Case> cases;
  cases.push_back({"sphere", part_of(sphere_mesh(1, 60)), 0.11});
  cases.push_back({"torus", part_of(torus_mesh(1, 0.3, 30)), 0.06});
  cases.push_back({"box", part_of(box_mesh(1, 2, 3)), 0.1});
  cases.push_back({"box on the lattice", part_of(box_mesh(1.5, 1, 0.5)), 0.125});
  cases.push_back({"cylinder", part_of(cylinder_mesh(0.5, 2, 48)), 0.07});
  cases.push_back({"cone", part_of(cone_mesh(0.5, 0, 2, 48)), 0.07});
  cases.push_back({"thin plate", part_of(box_mesh(2, 1, 0.001)), 0.05});
  cases.push_back({"needle", part_of(box_mesh(2, 1e-4, 1e-4)), 0.05});
  cases.push_back({"smaller than a voxel", part_of(box_mesh(0.1, 0.1, 0.1)), 1});
  cases.push_back({"two bodies", part_of({box_mesh(1, 1, 1), torus_mesh(1.5, 0.3, 20)}), 0.09});
  mesh::Mesh spiked = box_mesh(1, 1, 1);  // with triangles that are a segment and a point
  spiked.vertices.insert(spiked.vertices.end(), {{0.5, 0.5, 2}, {0.2, 0.2, 0.7}});
  spiked.triangles.insert(spiked.triangles.end(), {{7, 8, 7}, {9, 9, 9}, {0, 2, 3}});
  cases.push_back({"degenerate", part_of(spiked), 0.1});
  return cases;
}

pointshell::BakedShell bake(const Case& c, ShellMethod method,
                            sample::Effort effort = sample::Effort::kFull) {
  pointshell::ShellOptions options;
  options.voxel_size_m = c.voxel_size_m;
  options.method = method;
  options.effort = effort;
  auto shell = pointshell::bake_shell(c.part, options, [](const std::string&, double) {});
  EXPECT_TRUE(shell.ok()) << (shell ? "" : to_line(shell.error()));
  return std::move(*shell);
}

part::Vec3 center(const pointshell::BakedShell& shell) {
  const auto& c = shell.header.center_m;
  return {c[0], c[1], c[2]};
}

// FORCELAYER_LONG_TESTS=1 throws a million places at every shell.
int samples() { return long_tests() ? 1000000 : 20000; }

// No sampled place is farther than the proven radius, but for the rounding of this very test.
void expect_sampled_covering(const part::Part& part, const pointshell::BakedShell& shell,
                             int count) {
  constexpr std::uint64_t kSeed = 20240611;
  SurfaceDice dice(part, kSeed);
  const double radius = shell.header.covering_radius_m;
  const std::vector<part::Vec3> points = positions_of(shell);
  const certificate::PointGrid grid(points, radius);
  for (int n = 0; n < count; ++n) {
    const part::Vec3 place = dice.throw_once() - center(shell);
    ASSERT_LE(grid.nearest_distance(place, 1.1 * radius), radius * (1 + 1e-12))
        << "seed " << kSeed << ", sample " << n;
  }
}

// A test for each shape and model, so that a time limit counts for one.
class CoveringOfShape : public ::testing::TestWithParam<std::size_t> {};

TEST_P(CoveringOfShape, HoldsAtRandomPlaces) {
  const Case c = std::move(shapes()[GetParam()]);
  SCOPED_TRACE(c.name);
  for (const ShellMethod method : {ShellMethod::kSurface, ShellMethod::kVoxelCenters}) {
    SCOPED_TRACE(pointshell::method_name(method));
    expect_sampled_covering(c.part, bake(c, method), samples());
  }
  expect_sampled_covering(c.part, bake(c, ShellMethod::kSurface, sample::Effort::kFast), samples());
}

INSTANTIATE_TEST_SUITE_P(, CoveringOfShape, ::testing::Range<std::size_t>(0, shapes().size()));

// CAD and scans as they come, at so many voxels across; all at 128 in the long run. Each is one
// body, so that nothing is hidden.
struct Model {
  const char* file;
  int voxels_across;
};

constexpr Model kModels[] = {
    {"plate_holes.stl", 48}, {"featuretype.stl", 48}, {"large_block.stl", 16}, {"kettle", 24},
    {"counter.drc", 12},     {"bunny.drc", 12},       {"dragon.drc", 12}};

class CoveringOfModel : public ::testing::TestWithParam<Model> {};

TEST_P(CoveringOfModel, HoldsAtRandomPlaces) {
  const auto& [file, voxels_across] = GetParam();
  const bool drawn = std::string(file) == "kettle";
  Case c{file, drawn ? part_of(kettle_mesh(60)) : part_of_model(file, 1e-3), 0};
  part::Box box;
  for (const part::Vec3& v : c.part.vertices) box.grow(v);
  const part::Vec3 size = box.high - box.low;
  c.voxel_size_m = std::max({size.x, size.y, size.z}) / (long_tests() ? 128 : voxels_across);
  for (const ShellMethod method : {ShellMethod::kSurface, ShellMethod::kVoxelCenters}) {
    SCOPED_TRACE(pointshell::method_name(method));
    expect_sampled_covering(c.part, bake(c, method), samples());
  }
}

INSTANTIATE_TEST_SUITE_P(, CoveringOfModel, ::testing::ValuesIn(kModels),
                         [](const auto& model) { return test::test_name_of(model.param.file); });

// A plate with grooves far finer than the covering radius on top, each as long as the plate.
mesh::Mesh grooved_mesh(double side, double pitch, double depth, double height) {
  mesh::Mesh mesh;
  const int grooves = static_cast<int>(std::lround(side / pitch));
  const auto add = [&](double x, double z) {
    for (const double y : {0.0, side}) mesh.vertices.push_back({x, y, z});
  };
  for (int n = 0; n <= 2 * grooves; ++n) {
    add(n * pitch / 2, n % 2 == 0 ? height : height - depth);
  }
  const auto strip = [&](std::uint32_t a, std::uint32_t b) {
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
  };
  const auto last = static_cast<std::uint32_t>(4 * grooves);
  for (std::uint32_t n = 0; n < last; n += 2) strip(n, n + 2);
  add(side, 0), add(0, 0);
  strip(last, last + 2), strip(last + 2, last + 4), strip(last + 4, 0);
  for (std::uint32_t n = 0; n < last + 2; n += 2) {  // the two ends, from the corner at the origin
    mesh.triangles.push_back({last + 4, n + 2, n});
    mesh.triangles.push_back({last + 5, n + 1, n + 3});
  }
  return mesh;
}

// Few pieces are looked at, and nothing is proven too much.
void expect_detail_is_proven_as_a_whole(const Case& c, std::uint64_t pieces_per_point) {
  SCOPED_TRACE(c.name);
  const pointshell::BakedShell shell = bake(c, ShellMethod::kSurface);
  EXPECT_EQ(shell.header.mass_source, static_cast<std::uint32_t>(MassSource::kVolume));
  expect_sampled_covering(c.part, shell, samples());
  // One by one the triangles would need a piece for each point that is near each of them.
  EXPECT_LT(shell.certificate_pieces, pieces_per_point * shell.header.point_count);
  EXPECT_LT(shell.loss_pieces, 400 * shell.header.point_count);
  const Pshell file = stored(shell);
  EXPECT_TRUE(pointshell::verify_shell(file, c.part).proven);
  EXPECT_TRUE(pointshell::verify_losses(file, c.part).proven);
  // The proof needs nearly every point on the grooves.
  const part::Part centered = part::relative_to(c.part, center(shell));
  int needed = 0;
  for (std::size_t n = 0; n < 15; ++n) {
    std::vector<part::Vec3> points = positions_of(shell);
    points.erase(points.begin() + static_cast<std::ptrdiff_t>(n * points.size() / 15));
    const auto proof =
        certificate::prove_covering(centered, points, shell.header.covering_radius_m);
    needed += proof.proven ? 0 : 1;
    if (proof.proven) continue;
    // Each hole is a place that no point covers.
    const certificate::PointGrid grid(points, shell.header.covering_radius_m);
    for (const certificate::Hole& hole : proof.holes) {
      EXPECT_GE(grid.nearest_distance(hole.position, 1.1 * shell.header.covering_radius_m),
                shell.header.covering_radius_m * (1 - 1e-9));
    }
  }
  EXPECT_GT(needed, 10);
}

// Patches stand for the grooves, boxes for the rods.
TEST(Covering, HoldsOverDetailFarFinerThanTheRadius) {
  expect_detail_is_proven_as_a_whole({"grooves", part_of(grooved_mesh(2, 0.004, 0.003, 0.1)), 0.1},
                                     100);
  expect_detail_is_proven_as_a_whole({"bundle", part_of(bundle_mesh(16, 0.01, 1, 12)), 0.1}, 400);
}

// A triangle that reaches far out costs what its length costs, not more.
TEST(Covering, OfANeedleTakesPointsAlongItsLength) {
  mesh::Mesh mesh = box_mesh(1, 1, 1);
  mesh.vertices.insert(mesh.vertices.end(), {{500, 0.3, 0.1}, {0, 0.01, 0.5}, {0.01, 0, 0.5}});
  mesh.triangles.push_back({8, 9, 10});
  const Case c{"needle", part_of(mesh), 0.2};
  const pointshell::BakedShell shell = bake(c, ShellMethod::kSurface);
  expect_sampled_covering(c.part, shell, samples());
  EXPECT_LT(shell.header.point_count, 500 / 0.2 + 400);
  EXPECT_LT(shell.certificate_pieces, 20 * shell.header.point_count);
}

// A box, and triangles without area all around it: corners in a line (exactly, or but for
// rounding), two equal corners, one position.
mesh::Mesh box_with_lines(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<int> whole(-40, 40), length(1, 24);
  mesh::Mesh mesh = box_mesh(1, 1, 1);
  for (int n = 0; n < 24; ++n) {
    const double x = whole(random), y = whole(random), z = whole(random);
    mesh::Vec3d from{x / 16, y / 16, z / 16}, along{0, 0, 0};
    for (int d = 0; d < 3; ++d) {
      if (n % 3 == 0 && d != n / 3 % 3) continue;  // along an axis
      along[d] = whole(random) < 0 ? -length(random) / 16.0 : length(random) / 16.0;
      if (n % 4 == 3) along[d] /= 3;
    }
    const double fraction = length(random) / (n % 2 == 0 ? 32.0 : 25.0);
    const double fractions[] = {fraction, fraction, 0, 1};
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const double way : {0.0, 1.0, fractions[n % 4]}) {
      mesh.vertices.push_back(
          {from[0] + way * along[0], from[1] + way * along[1], from[2] + way * along[2]});
    }
    mesh.triangles.push_back({first + n % 3, first + (n + 1) % 3, first + (n + 2) % 3});
    if (n % 8 == 0) mesh.triangles.push_back({first, first, first});
  }
  return mesh;
}

TEST(Covering, OfTrianglesWithoutAreaHoldsAllAlongThem) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    const Case c{"box with lines", part_of(box_with_lines(seed)), seed % 2 == 0 ? 0.1 : 0.06};
    ASSERT_GT(c.part.degenerate_triangles, 10u);
    for (const auto& [method, effort] : {std::pair(ShellMethod::kSurface, sample::Effort::kFull),
                                         {ShellMethod::kSurface, sample::Effort::kFast},
                                         {ShellMethod::kVoxelCenters, sample::Effort::kFull}}) {
      SCOPED_TRACE(pointshell::method_name(method));
      const pointshell::BakedShell shell = bake(c, method, effort);
      expect_sampled_covering(c.part, shell, 2000);
      const double radius = shell.header.covering_radius_m;
      const std::vector<part::Vec3> points = positions_of(shell);
      const certificate::PointGrid grid(points, radius);
      double farthest = 0;
      for (std::size_t t = 0; t < c.part.triangles.size(); ++t) {
        const part::Piece corners = part::triangle_piece(c.part, t);
        for (int n = 0; n < 3; ++n) {  // along all sides, also those of the box
          for (int step = 0; step <= 200; ++step) {
            const part::Vec3 place =
                corners[n] + (step / 200.0) * (corners[(n + 1) % 3] - corners[n]);
            farthest = std::max(farthest, grid.nearest_distance(place - center(shell), 2 * radius));
          }
        }
      }
      EXPECT_LE(farthest, radius * (1 + 1e-12));
      EXPECT_TRUE(pointshell::verify_shell(stored(shell), c.part).proven);
    }
  }
}

TEST(Covering, OfAPartTooFarAcrossIsRefusedBeforeItBegins) {
  mesh::Mesh mesh = box_mesh(1, 1, 1);
  mesh.vertices.push_back({1e8, 0, 0});
  mesh.triangles.push_back({0, 1, 8});
  pointshell::ShellOptions options;
  options.voxel_size_m = 0.2;
  const auto shell =
      pointshell::bake_shell(part_of(mesh), options, [](const std::string&, double) {});
  ASSERT_FALSE(shell);
  EXPECT_EQ(shell.error().code, ErrorCode::kBakeTooLarge);
  EXPECT_NE(shell.error().what.find("(1e+08, 0, 0)"), std::string::npos);
}

TEST(Covering, RadiusIsTheOneAskedFor) {
  for (const Case& c : shapes()) {
    SCOPED_TRACE(c.name);
    const double asked = std::sqrt(0.75) * c.voxel_size_m;
    EXPECT_EQ(bake(c, ShellMethod::kSurface).header.covering_radius_m, asked);
    // The rounding of centers to floats is added: below 1e-4 voxel for parts of this size.
    EXPECT_NEAR(bake(c, ShellMethod::kVoxelCenters).header.covering_radius_m, asked, 1e-4 * asked);
  }
}

// Removing any point that alone covers some place is noticed, and the hole is where it says.
TEST(Covering, FailsWithoutANeededPoint) {
  const Case torus{"torus", part_of(torus_mesh(1, 0.3, 30)), 0.12};
  const pointshell::BakedShell shell = bake(torus, ShellMethod::kSurface);
  const part::Part centered = part::relative_to(torus.part, center(shell));
  const std::vector<part::Vec3> points = positions_of(shell);
  const double radius = shell.header.covering_radius_m;
  ASSERT_TRUE(certificate::prove_covering(centered, points, radius).proven);
  SurfaceDice dice(centered, 7);
  std::vector<part::Vec3> samples(20000);
  for (part::Vec3& place : samples) place = dice.throw_once();
  int needed = 0;
  for (std::size_t removed = 0; removed < points.size(); removed += 7) {
    std::vector<part::Vec3> rest = points;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(removed));
    const certificate::PointGrid grid(rest, radius);
    const bool sampled_hole =
        std::any_of(samples.begin(), samples.end(), [&](const part::Vec3& place) {
          return grid.nearest_distance(place, 1.1 * radius) > radius;
        });
    const certificate::CoveringProof proof = certificate::prove_covering(centered, rest, radius);
    if (sampled_hole) {
      ++needed;
      EXPECT_FALSE(proof.proven) << removed;
    }
    for (const certificate::Hole& hole : proof.holes) {
      EXPECT_GE(grid.nearest_distance(hole.position, 1.1 * radius), radius * (1 - 1e-6));
    }
  }
  EXPECT_GT(needed, 10);
}

TEST(Covering, IsNotProvenForASmallerRadius) {
  const Case box{"box", part_of(box_mesh(1, 2, 3)), 0.2};
  const pointshell::BakedShell shell = bake(box, ShellMethod::kSurface);
  EXPECT_FALSE(certificate::prove_covering(part::relative_to(box.part, center(shell)),
                                           positions_of(shell),
                                           0.9 * shell.header.covering_radius_m)
                   .proven);
}

// The pieces of a part without number, for a radius that only a hostile file would name.
TEST(Covering, GivesUpOnARadiusFarTooSmall) {
  const Case box{"box", part_of(box_mesh(1, 2, 3)), 0.2};
  const pointshell::BakedShell shell = bake(box, ShellMethod::kSurface);
  const part::Part centered = part::relative_to(box.part, center(shell));
  for (const double radius : {1e-9, 1e-15, 1e-300, 0.0}) {
    const certificate::CoveringProof proof =
        certificate::prove_covering(centered, positions_of(shell), radius, 1000);
    EXPECT_FALSE(proof.proven) << radius;
    EXPECT_TRUE(proof.given_up) << radius;
    EXPECT_FALSE(proof.holes.empty()) << radius;
  }
}

TEST(Covering, OfNoPointsFails) {
  EXPECT_FALSE(certificate::prove_covering(part_of(box_mesh(1, 1, 1)), {}, 10).proven);
}

}  // namespace
}  // namespace forcelayer
