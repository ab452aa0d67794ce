// Polygons as triangles: the triangles' signed areas sum to the polygon's and none is inverted, so
// that they cover a simple polygon once and nothing else.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "formats/mesh/readers/polygon_splitter.h"
#include "tests/support/mesh_files.h"

namespace forcelayer {
namespace {

struct Flat {
  double x, y;
};

double doubled_area(const Flat& a, const Flat& b, const Flat& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

double doubled_area(const std::vector<Flat>& outline) {
  double sum = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Flat &a = outline[i], &b = outline[(i + 1) % outline.size()];
    sum += a.x * b.y - a.y * b.x;
  }
  return sum;
}

// The outline in a plane of the given axes.
mesh::Mesh lift(const std::vector<Flat>& outline, const mesh::Vec3d& x_axis,
                const mesh::Vec3d& y_axis) {
  mesh::Mesh mesh;
  for (const Flat& p : outline) {
    mesh::Vec3d& vertex = mesh.vertices.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) vertex[i] = p.x * x_axis[i] + p.y * y_axis[i];
  }
  return mesh;
}

void expect_covered(const std::vector<Flat>& outline, const mesh::Vec3d& x_axis,
                    const mesh::Vec3d& y_axis, const std::string& which) {
  mesh::Mesh mesh = lift(outline, x_axis, y_axis);
  std::vector<std::uint32_t> corners(outline.size());
  std::iota(corners.begin(), corners.end(), 0u);
  mesh::PolygonSplitter splitter;
  splitter.split(corners, mesh);
  ASSERT_EQ(mesh.triangles.size(), outline.size() - 2) << which;
  const double total = doubled_area(outline);
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const double area = doubled_area(outline[a], outline[b], outline[c]);
    EXPECT_GE(area, -1e-12 * total) << which;  // rounding of the lifted coordinates
    sum += area;
  }
  EXPECT_NEAR(sum, total, 1e-12 * total) << which;
  std::vector<std::string> warnings;
  splitter.add_warnings(warnings);
  EXPECT_TRUE(warnings.empty()) << which << ": " << warnings[0];
}

void expect_covered_in_all_planes(const std::vector<Flat>& outline, const std::string& which) {
  const mesh::Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  expect_covered(outline, x, y, which + " xy");
  expect_covered(outline, y, x, which + " yx");
  expect_covered(outline, y, z, which + " yz");
  expect_covered(outline, z, x, which + " zx");
  expect_covered(outline, {0.6, 0.8, 0}, {0, 0.1, 1}, which + " oblique");
}

// A star-shaped outline around the origin: simple, and as jagged as it gets.
std::vector<Flat> random_star(std::mt19937_64& random, std::size_t corners) {
  std::uniform_real_distribution<double> radius(0.1, 10), jitter(0.05, 0.95);
  std::vector<Flat> outline;
  for (std::size_t i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * (static_cast<double>(i) + jitter(random)) /
                         static_cast<double>(corners);
    const double r = radius(random);
    outline.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  return outline;
}

// A comb on whole numbers: many reflex corners, many corners in a line.
std::vector<Flat> random_comb(std::mt19937_64& random, int teeth) {
  std::vector<Flat> outline{{0, -1}, {2.0 * teeth, -1}};
  for (int i = teeth; i-- > 0;) {
    const double height = static_cast<double>(1 + random() % 5);
    outline.push_back({2.0 * i + 2, 0});
    outline.push_back({2.0 * i + 1, height});
    outline.push_back({2.0 * i + static_cast<double>(random() % 2), 0});
  }
  return outline;
}

TEST(PolygonSplitter, CoversStarsOnce) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    std::mt19937_64 random(seed);
    expect_covered_in_all_planes(random_star(random, 4 + random() % 60),
                                 "star " + std::to_string(seed));
  }
}

TEST(PolygonSplitter, CoversCombsOnce) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    std::mt19937_64 random(seed);
    expect_covered_in_all_planes(random_comb(random, 1 + static_cast<int>(random() % 12)),
                                 "comb " + std::to_string(seed));
  }
}

// A square with a square hole, cut open along a bridge that the outline runs along twice.
TEST(PolygonSplitter, CoversAPolygonWithABridgeToItsHole) {
  expect_covered_in_all_planes(
      {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}}, "bridge");
}

TEST(PolygonSplitter, CoversQuadsWithAReflexCornerAnywhere) {
  const std::vector<Flat> dart{{0, 0}, {4, 1}, {1, 1}, {1, 4}};
  for (std::size_t first = 0; first < 4; ++first) {
    std::vector<Flat> outline;
    for (std::size_t i = 0; i < 4; ++i) outline.push_back(dart[(first + i) % 4]);
    expect_covered_in_all_planes(outline, "dart " + std::to_string(first));
  }
}

TEST(PolygonSplitter, FansAConvexPolygonWithCornersInALine) {
  expect_covered_in_all_planes({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}}, "square");
}

// The rule of clipping as it is stated, each time by a look at all corners: from a corner on the
// first ear, where there is none the widest corner; then on from the second corner behind it.
std::vector<mesh::Triangle> clipped_slowly(const std::vector<Flat>& outline) {
  std::vector<std::uint32_t> ring(outline.size());
  std::iota(ring.begin(), ring.end(), 0u);
  const auto is_same = [](const Flat& a, const Flat& b) { return a.x == b.x && a.y == b.y; };
  const auto turn_at = [&](std::size_t n) {
    const std::size_t count = ring.size();
    return doubled_area(outline[ring[(n + count - 1) % count]], outline[ring[n]],
                        outline[ring[(n + 1) % count]]);
  };
  const auto is_ear = [&](std::size_t n) {
    const std::size_t count = ring.size();
    const Flat &a = outline[ring[(n + count - 1) % count]], &b = outline[ring[n]],
               &c = outline[ring[(n + 1) % count]];
    if (turn_at(n) <= 0) return turn_at(n) == 0;
    return std::none_of(ring.begin(), ring.end(), [&](std::uint32_t corner) {
      const Flat& p = outline[corner];
      if (is_same(p, a) || is_same(p, b) || is_same(p, c)) return false;
      return doubled_area(a, b, p) >= 0 && doubled_area(b, c, p) >= 0 && doubled_area(c, a, p) >= 0;
    });
  };
  std::vector<mesh::Triangle> triangles;
  for (std::size_t from = 1; ring.size() >= 3;) {
    const std::size_t count = ring.size();
    std::size_t tip = from, steps = 0;
    while (steps < count && !is_ear((from + steps) % count)) {
      if (turn_at((from + steps) % count) > turn_at(tip)) tip = (from + steps) % count;
      ++steps;
    }
    if (steps < count) tip = (from + steps) % count;
    triangles.push_back({ring[(tip + count - 1) % count], ring[tip], ring[(tip + 1) % count]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(tip));
    from = (tip % (count - 1) + 1) % (count - 1);
  }
  return triangles;
}

// A band that winds around a center: outwards along one side, back along the other.
std::vector<Flat> spiral(int corners) {
  std::vector<Flat> outline;
  for (int n = 0; n < corners; ++n) {
    const bool outwards = n < corners / 2;
    const double angle = 0.05 * (outwards ? n : corners - 1 - n);
    const double radius = 1 + 0.01 * angle + (outwards ? 0 : 0.03);
    outline.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return outline;
}

// Corners on a small grid: an outline that crosses and touches itself.
std::vector<Flat> random_tangle(std::mt19937_64& random) {
  std::vector<Flat> outline(5 + random() % 40);
  for (Flat& p : outline) {
    p = {static_cast<double>(random() % 12), static_cast<double>(random() % 12)};
  }
  return outline;
}

TEST(PolygonSplitter, ClipsByTheRule) {
  int clipped = 0;
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::vector<Flat> outline = seed % 3 == 0   ? random_star(random, 4 + random() % 60)
                                : seed % 3 == 1 ? random_tangle(random)
                                                : spiral(50 + static_cast<int>(random() % 400));
    if (doubled_area(outline) < 0) std::reverse(outline.begin(), outline.end());
    mesh::Mesh mesh = lift(outline, {1, 0, 0}, {0, 1, 0});
    std::vector<std::uint32_t> corners(outline.size());
    std::iota(corners.begin(), corners.end(), 0u);
    mesh::PolygonSplitter().split(corners, mesh);
    std::vector<mesh::Triangle> fan;
    for (std::uint32_t n = 1; n + 1 < outline.size(); ++n) fan.push_back({0, n, n + 1});
    if (mesh.triangles == fan) continue;
    EXPECT_EQ(mesh.triangles, clipped_slowly(outline));
    ++clipped;
  }
  EXPECT_GT(clipped, 500);
}

// A comb of thin teeth that lean to the right: ears in the box of all other corners.
std::vector<Flat> leaning_comb(int teeth) {
  std::vector<Flat> outline{{0, -1}, {static_cast<double>(teeth), -1}};
  for (int i = teeth; i-- > 0;) {
    outline.push_back({i + 1.0, 0});
    outline.push_back({i + 0.5 + teeth, static_cast<double>(teeth)});
    outline.push_back({i + 0.2, 0});
  }
  return outline;
}

// Three corners again and again, a winding spiral, leaning teeth, a jagged star and a tangle, of so
// many corners that the square of their number is the work of many minutes.
TEST(PolygonSplitter, TakesNoSquareOfTheCorners) {
  constexpr int kCorners = 60'000;
  std::mt19937_64 random(1);
  std::vector<Flat> repeated, tangle;
  for (int n = 0; n < kCorners; ++n) {
    repeated.push_back(
        std::array{Flat{0, 0}, Flat{1, 0}, Flat{0, 1}}[static_cast<std::size_t>(n % 3)]);
    tangle.push_back({static_cast<double>(random() % 4096), static_cast<double>(random() % 4096)});
  }
  std::vector<Flat> outlines[] = {repeated, tangle, spiral(kCorners), leaning_comb(kCorners / 3),
                                  random_star(random, kCorners)};
  for (std::vector<Flat>& outline : outlines) {
    if (doubled_area(outline) < 0) std::reverse(outline.begin(), outline.end());
    mesh::Mesh mesh = lift(outline, {1, 0, 0}, {0, 1, 0});
    std::vector<std::uint32_t> corners(outline.size());
    std::iota(corners.begin(), corners.end(), 0u);
    mesh::PolygonSplitter().split(corners, mesh);
    ASSERT_EQ(mesh.triangles.size(), outline.size() - 2);
    const double total = doubled_area(outline);
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
      sum += doubled_area(outline[a], outline[b], outline[c]);
    }
    EXPECT_NEAR(sum, total, 1e-6 * total);
  }
}

std::vector<std::string> warnings_of(const mesh::Mesh& outline) {
  mesh::Mesh mesh = outline;
  std::vector<std::uint32_t> corners(outline.vertices.size());
  std::iota(corners.begin(), corners.end(), 0u);
  mesh::PolygonSplitter splitter;
  splitter.split(corners, mesh);
  EXPECT_EQ(mesh.triangles.size(), corners.size() - 2);
  std::vector<std::string> warnings;
  splitter.add_warnings(warnings);
  return warnings;
}

TEST(PolygonSplitter, WarnsOfAPolygonThatIsNotPlanar) {
  const auto warnings = warnings_of({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5}, {0, 1, 0}}, {}, false});
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("1 polygon is not planar"), std::string::npos) << warnings[0];
}

TEST(PolygonSplitter, WarnsOfAnOutlineThatCrossesItself) {
  // A pentagram: five corners that turn the same way, twice around.
  mesh::Mesh star;
  for (int i = 0; i < 5; ++i) {
    const double angle = 4 * std::numbers::pi * i / 5;
    star.vertices.push_back({std::cos(angle), std::sin(angle), 0});
  }
  EXPECT_EQ(warnings_of(star).size(), 1u);
  // A bow tie whose lobes differ, so that it has an area.
  EXPECT_EQ(warnings_of({{{0, 0, 0}, {3, 3, 0}, {3, 0, 0}, {0, 1, 0}}, {}, false}).size(), 1u);
}

TEST(PolygonSplitter, KeepsPolygonsWithoutArea) {
  EXPECT_TRUE(warnings_of({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 0, 0}}, {}, false}).empty());
}

}  // namespace
}  // namespace forcelayer
