// A baked shell's normals, weights and blocks, and its reproducibility.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "pointshell/bake.h"
#include "pointshell/certificate/point_grid.h"
#include "pointshell/certificate/ray_winding.h"
#include "pointshell/certificate/winding_number.h"
#include "pointshell/normals/normals.h"
#include "pointshell/report.h"
#include "pointshell/sample/weights.h"
#include "pointshell/verify.h"
#include "tests/support/part_support.h"
#include "tests/support/stored_shell.h"

namespace forcelayer {
namespace {

using namespace testing;

pointshell::BakedShell bake(part::Part part, double voxel_size_m, ShellMethod method,
                            unsigned threads = 0) {
  pointshell::ShellOptions options;
  options.voxel_size_m = voxel_size_m;
  options.method = method;
  options.threads = threads;
  return std::move(
             pointshell::bake_shell(std::move(part), options, [](const std::string&, double) {}))
      .value();
}

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

void expect_same(const pointshell::BakedShell& a, const pointshell::BakedShell& b) {
  EXPECT_EQ(std::memcmp(&a.header, &b.header, sizeof a.header), 0);
  EXPECT_TRUE(same_bytes(a.x, b.x) && same_bytes(a.y, b.y) && same_bytes(a.z, b.z));
  EXPECT_TRUE(same_bytes(a.nx, b.nx) && same_bytes(a.ny, b.ny) && same_bytes(a.nz, b.nz));
  EXPECT_TRUE(same_bytes(a.weight_m2, b.weight_m2));
  EXPECT_TRUE(same_bytes(a.cone_cos, b.cone_cos));
  EXPECT_TRUE(same_bytes(a.blocks, b.blocks));
  EXPECT_TRUE(same_bytes(a.super_blocks, b.super_blocks));
  EXPECT_TRUE(same_bytes(a.losses, b.losses));
}

TEST(Shell, IsTheSameForAnyThreadsAndTriangleOrder) {
  const mesh::Mesh mesh = torus_mesh(1, 0.3, 24);
  for (const ShellMethod method : {ShellMethod::kSurface, ShellMethod::kVoxelCenters}) {
    const pointshell::BakedShell one = bake(part_of(mesh), 0.05, method, 1);
    for (const unsigned threads : {2, 3, 8, 16}) {
      expect_same(one, bake(part_of(mesh), 0.05, method, threads));
    }
    expect_same(one, bake(part_of(shuffled(mesh, 11)), 0.05, method, 3));
  }
}

TEST(Shell, WeightsAddUpToTheArea) {
  for (const ShellMethod method : {ShellMethod::kSurface, ShellMethod::kVoxelCenters}) {
    const pointshell::BakedShell shell = bake(part_of(cone_mesh(0.5, 0, 2, 48)), 0.05, method);
    double sum = 0;
    for (const float weight : shell.weight_m2) sum += weight;
    EXPECT_NEAR(sum, shell.header.area_m2, 1e-6 * shell.header.area_m2);
  }
}

TEST(Shell, WeightsAreTheAreasNearestToThePoints) {
  constexpr std::uint64_t kSeed = 4;
  const part::Part part = part_of(torus_mesh(1, 0.3, 24));
  const pointshell::BakedShell shell = bake(part, 0.2, ShellMethod::kSurface);
  const auto& c = shell.header.center_m;
  std::vector<part::Vec3> points;
  for (std::size_t n = 0; n < shell.x.size(); ++n) {
    points.push_back({shell.x[n], shell.y[n], shell.z[n]});
  }
  std::vector<double> hits(points.size());
  SurfaceDice dice(part, kSeed);
  constexpr int kSamples = 200000;
  for (int n = 0; n < kSamples; ++n) {
    const part::Vec3 place = dice.throw_once() - part::Vec3{c[0], c[1], c[2]};
    const auto nearest = std::min_element(points.begin(), points.end(), [&](auto& p, auto& q) {
      return part::length_squared(p - place) < part::length_squared(q - place);
    });
    ++hits[static_cast<std::size_t>(nearest - points.begin())];
  }
  for (std::size_t n = 0; n < points.size(); ++n) {
    // Six standard deviations of the number of hits.
    const double expected = shell.weight_m2[n] / shell.header.area_m2 * kSamples;
    EXPECT_NEAR(hits[n], expected, 6 * std::sqrt(expected) + 1) << "seed " << kSeed;
  }
}

// A box with two open sheets: their points, and no others, have no inside.
TEST(Shell, PointsOfOpenSheetsHaveNoInside) {
  mesh::Mesh mesh = box_mesh(1, 1, 1);
  mesh.vertices.insert(mesh.vertices.end(), {{3, 0, 0}, {4, 0, 0}, {4, 1, 0}, {3, 1, 0}});
  mesh.triangles.insert(mesh.triangles.end(), {{8, 9, 10}, {8, 10, 11}});
  const part::Part part = part_of(mesh);
  pointshell::ShellOptions options;
  options.voxel_size_m = 0.15;
  const auto shell = pointshell::bake_shell(part, options, [](const std::string&, double) {});
  ASSERT_TRUE(shell) << to_line(shell.error());
  EXPECT_EQ(shell->header.mass_source, static_cast<std::uint32_t>(MassSource::kArea));
  ASSERT_EQ(shell->orientation.sheets.size(), 1u);
  ASSERT_EQ(shell->two_sided.size(), shell->x.size());
  for (std::size_t n = 0; n < shell->x.size(); ++n) {
    const bool on_sheet = shell->x[n] + shell->header.center_m[0] > 1;
    EXPECT_EQ(shell->two_sided[n] != 0, on_sheet) << n;
    if (on_sheet) {
      EXPECT_EQ(shell->cone_cos[n], -1);
    }
  }
  EXPECT_NE(pointshell::sheet_warning(*shell).find("1 open sheet: body 0, 2 triangles"),
            std::string::npos);
  EXPECT_TRUE(pointshell::verify_shell(stored(*shell), part).proven);
  mesh.triangles.resize(12);
  const auto closed =
      pointshell::bake_shell(part_of(mesh), options, [](const std::string&, double) {});
  EXPECT_TRUE(closed->two_sided.empty());
}

// The progress never goes back, and no stage is silent for long.
TEST(Shell, TellsItsProgressThroughout) {
  for (const auto& [method, effort] :
       {std::pair{ShellMethod::kSurface, sample::Effort::kFull},
        std::pair{ShellMethod::kSurface, sample::Effort::kFast},
        std::pair{ShellMethod::kVoxelCenters, sample::Effort::kFull}}) {
    pointshell::ShellOptions options;
    options.voxel_size_m = 0.02;
    options.method = method;
    options.effort = effort;
    std::vector<double> told;
    const auto shell =
        pointshell::bake_shell(part_of(torus_mesh(1, 0.3, 24)), options,
                               [&](const std::string&, double done) { told.push_back(done); });
    ASSERT_TRUE(shell) << to_line(shell.error());
    ASSERT_EQ(told.front(), 0);
    EXPECT_GT(told.back(), 0.9);
    double widest = 0;
    for (std::size_t n = 1; n < told.size(); ++n) {
      EXPECT_GE(told[n], told[n - 1] - 1e-12) << n;
      widest = std::max(widest, told[n] - told[n - 1]);
    }
    EXPECT_LE(told.back(), 1);
    EXPECT_LT(widest, 0.26);  // the normals of voxel centers
  }
}

TEST(Shell, SpheresHoldTheirPoints) {
  const pointshell::BakedShell shell =
      bake(part_of(torus_mesh(1, 0.3, 24)), 0.02, ShellMethod::kSurface);
  ASSERT_GT(shell.super_blocks.size(), 1u);
  for (std::size_t n = 0; n < shell.x.size(); ++n) {
    const part::Vec3 p{shell.x[n], shell.y[n], shell.z[n]};
    for (const BoundingSphere& s : {shell.blocks[n / 64], shell.super_blocks[n / 4096]}) {
      EXPECT_LE(part::length(p - part::Vec3{s.x, s.y, s.z}), s.radius);
    }
    EXPECT_LE(part::length(p), shell.header.bounding_radius_m);
  }
}

TEST(Winding, EqualsTheSumOverAllTriangles) {
  const part::Part part = part_of(torus_mesh(1, 0.3, 24));
  const part::TriangleTree tree(part);
  const certificate::WindingNumber winding(tree);
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> unit(-1.5, 1.5);
  int decided = 0;
  for (int n = 0; n < 500; ++n) {
    const part::Vec3 place{unit(random), unit(random), unit(random)};
    double sum = 0;
    for (const mesh::Triangle& t : part.triangles) {
      sum += certificate::triangle_winding(place, part.vertices[t[0]], part.vertices[t[1]],
                                           part.vertices[t[2]]);
    }
    EXPECT_NEAR(winding.at(place), sum, 0.01);
    const std::optional<int> by_ray = certificate::windings_by_ray(tree, place);
    EXPECT_EQ(by_ray.value_or(std::lround(sum)), std::lround(sum));
    decided += by_ray.has_value();
    EXPECT_NEAR(sum, std::round(sum), 1e-9);
  }
  EXPECT_GT(decided, 490);
}

void expect_nearest_of_all(const part::Part& part) {
  const part::TriangleTree tree(part);
  std::mt19937_64 random(10);
  std::uniform_real_distribution<double> unit(-1.5, 1.5);
  for (int n = 0; n < 500; ++n) {
    const part::Vec3 place{unit(random), unit(random), unit(random)};
    double best = std::numeric_limits<double>::infinity();
    for (const mesh::Triangle& t : part.triangles) {
      best = std::min(
          best, part::length(part::nearest_on_triangle(place, part.vertices[t[0]],
                                                       part.vertices[t[1]], part.vertices[t[2]]) -
                             place));
    }
    const auto nearest = tree.nearest(place);
    ASSERT_TRUE(nearest.found);
    EXPECT_DOUBLE_EQ(part::length(nearest.point.position - place), best);
    for (const double radius : {0.5 * best, std::nextafter(best, 0.0), best, 2 * best}) {
      EXPECT_EQ(tree.is_within(place, radius), tree.nearest(place, radius).found);
    }
  }
}

TEST(TriangleTree, FindsTheNearestPointOfAllTriangles) {
  expect_nearest_of_all(part_of(torus_mesh(1, 0.3, 12)));
  expect_nearest_of_all(part_of(torus_mesh(1, 0.3, 100)));  // halves are built at the same time
}

TEST(TriangleTree, IsTheSameForAnyNumberOfThreads) {
  const part::Part part = part_of(torus_mesh(1, 0.3, 100));
  std::vector<part::TriangleTree> trees;
  for (const unsigned threads : {1, 2, 3, 8, 16}) {
    part::with_threads(threads, [&] { trees.emplace_back(part); });
    const auto one = trees.front().nodes(), nodes = trees.back().nodes();
    ASSERT_EQ(nodes.size(), one.size());
    EXPECT_EQ(std::memcmp(nodes.data(), one.data(), nodes.size_bytes()), 0) << threads;
    EXPECT_TRUE(
        std::ranges::equal(trees.back().ordered_triangles(), trees.front().ordered_triangles()));
  }
}

// Against a fine barycentric grid of sample points.
TEST(Normals, AreaWithinABallIsExact) {
  constexpr std::uint64_t kSeed = 12;
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int n = 0; n < 200; ++n) {
    const part::Vec3 a{unit(random), unit(random), unit(random)}, b{unit(random), unit(random), 0},
        c{unit(random), 0, unit(random)}, center = 0.5 * part::Vec3{unit(random), unit(random), 0};
    const double radius = 0.7 + 0.5 * unit(random);
    constexpr int kSteps = 300;
    int inside = 0, all = 0;
    for (int i = 0; i < kSteps; ++i) {
      for (int j = 0; i + j < kSteps; ++j, ++all) {
        const double u = (i + 1.0 / 3) / kSteps, v = (j + 1.0 / 3) / kSteps;
        inside += part::length(a + u * (b - a) + v * (c - a) - center) <= radius;
      }
    }
    const double area = part::length(part::cross(b - a, c - a)) / 2;
    EXPECT_NEAR(normals::area_within_ball(center, radius, a, b, c), area * inside / all,
                0.01 * area + 1e-12)
        << "seed " << kSeed << ", case " << n;
  }
}

struct Shape {
  const char* name;
  mesh::Mesh mesh;
  std::function<part::Vec3(const part::Vec3&)>
      outward;  // of the smooth surface, at a place near it
  double worst_degrees;
};

// Angle between each point's normal and that of the smooth shape. Tessellation errs by half a
// facet's angle at most; smoothing over the covering radius removes most of it.
TEST(Normals, OfSmoothShapes) {
  const Shape shapes[] = {
      {"sphere", sphere_mesh(1, 80), [](const part::Vec3& p) { return part::normalized(p); }, 1.0},
      {"torus", torus_mesh(1, 0.3, 60),
       [](const part::Vec3& p) {
         const double from_axis = std::hypot(p.x, p.y);
         return part::normalized(p - part::Vec3{p.x / from_axis, p.y / from_axis, 0});
       },
       2.0}};
  for (const Shape& shape : shapes) {
    SCOPED_TRACE(shape.name);
    const pointshell::BakedShell shell = bake(part_of(shape.mesh), 0.05, ShellMethod::kSurface);
    const auto& c = shell.header.center_m;
    for (std::size_t n = 0; n < shell.x.size(); ++n) {
      const part::Vec3 p{shell.x[n] + c[0], shell.y[n] + c[1], shell.z[n] + c[2]};
      const part::Vec3 outward = -part::Vec3{shell.nx[n], shell.ny[n], shell.nz[n]};
      EXPECT_NEAR(part::length(outward), 1, 1e-6);
      const double cosine = std::min(1.0, part::dot(outward, shape.outward(p)));
      EXPECT_LE(std::acos(cosine) * 180 / std::numbers::pi, shape.worst_degrees) << n;
    }
  }
}

// Lines in the faces of a turned box, flat but for rounding: their normals are noise and count
// neither for the points' normals nor for their cones.
TEST(Normals, TakeNothingFromFlatTriangles) {
  constexpr std::uint64_t kSeed = 3;
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> unit(-0.4, 0.4);
  const part::Vec3 x = part::normalized({0.3, 0.5, 0.8}), y = part::any_perpendicular(x),
                   z = part::cross(x, y);
  const auto turned = [&](const mesh::Vec3d& p) {
    const part::Vec3 t = p[0] * x + p[1] * y + p[2] * z;
    return mesh::Vec3d{t.x, t.y, t.z};
  };
  mesh::Mesh mesh = box_mesh(1, 1, 1);
  for (int n = 0; n < 40; ++n) {
    const double u = unit(random), v = unit(random), to_u = unit(random), to_v = unit(random);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const double way : {0.0, 0.3, 1.0}) {
      mesh.vertices.push_back({u + way * (to_u - u), v + way * (to_v - v), 0.5});
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  for (mesh::Vec3d& v : mesh.vertices) v = turned(v);
  const part::Part part = part_of(mesh);
  EXPECT_EQ(part.degenerate_triangles, 40u);
  const pointshell::BakedShell shell = bake(part, 0.05, ShellMethod::kSurface);
  EXPECT_TRUE(shell.two_sided.empty());
  int on_the_face = 0;
  for (std::size_t n = 0; n < shell.x.size(); ++n) {
    const part::Vec3 p{shell.x[n], shell.y[n], shell.z[n]};
    if (part::dot(p, z) < 0.49 || std::abs(part::dot(p, x)) > 0.44 ||
        std::abs(part::dot(p, y)) > 0.44) {
      continue;
    }
    ++on_the_face;
    EXPECT_NEAR(part::dot({shell.nx[n], shell.ny[n], shell.nz[n]}, -z), 1, 1e-6);
    EXPECT_NEAR(shell.cone_cos[n], 1, 1e-6);
  }
  EXPECT_GT(on_the_face, 100);
}

// A corner of a steep triangle at the radius of a cone, and just beyond it.
TEST(Normals, ConesHoldATriangleWhoseCornerJustReachesIn) {
  const double radius = 0.25;
  for (const double off : {-1e-2, -1e-6, -1e-9, -1e-12, 1e-12, 1e-9, 1e-2}) {
    SCOPED_TRACE(off);
    mesh::Mesh mesh = box_mesh(4, 4, 2);  // its top is at z = 1
    const double tip = 1 + radius * (1 + off);
    mesh.vertices.insert(mesh.vertices.end(),
                         {{0, 0, tip}, {0, 1e-3, tip + 0.5}, {1e-5, 0, tip + 0.5}});
    mesh.triangles.push_back({8, 9, 10});
    const part::Part part = part_of(mesh);
    const part::TriangleTree tree(part);
    const std::vector<part::Vec3> points{{0, 0, 1}};
    sample::RestrictedCells cells(tree, radius);
    cells.find_lists(points);
    const normals::ShellNormals normals =
        normals::shell_normals(cells, points, radius, std::vector<bool>(part.triangles.size()));
    EXPECT_EQ(normals.cone_cos[0] < 0.9, off < 0);
  }
}

// Faces keep their own normal up to the edge; on edges and corners it is the mean of the faces.
TEST(Normals, OfABoxKeepItsEdges) {
  const pointshell::BakedShell shell =
      bake(part_of(box_mesh(1, 1, 1)), 0.05, ShellMethod::kSurface);
  for (std::size_t n = 0; n < shell.x.size(); ++n) {
    const double coordinates[] = {shell.x[n], shell.y[n], shell.z[n]};
    part::Vec3 expected;
    double* const components[] = {&expected.x, &expected.y, &expected.z};
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(coordinates[axis]) > 0.5 - 1e-6) *components[axis] = coordinates[axis];
    }
    const part::Vec3 outward = -part::Vec3{shell.nx[n], shell.ny[n], shell.nz[n]};
    EXPECT_NEAR(part::length(outward - part::normalized(expected)), 0, 1e-5) << n;
  }
}

}  // namespace
}  // namespace forcelayer
