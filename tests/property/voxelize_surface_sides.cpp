// Which side of a triangle is outside, against nests of boxes whose sides are known: bodies with
// cavities with bodies, each body wound the right way or the wrong way round.
#include "voxelize/distance/surface_sides.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/mesh_scene.h"

namespace forcelayer {
namespace {

using distance::SurfaceSides;
using reference::Random;
using reference::real;
using reference::whole;

struct Nest {
  mesh::Mesh mesh;
  std::vector<bool> is_reversed;  // [triangles]
};

// The normals point out of the box, or into it.
void add_box(Nest& nest, const mesh::Vec3d& low, const mesh::Vec3d& high, bool points_in,
             bool is_reversed) {
  const auto first = static_cast<std::uint32_t>(nest.mesh.vertices.size());
  for (int n = 0; n < 8; ++n) {
    nest.mesh.vertices.push_back({(n & 4) != 0 ? high[0] : low[0], (n & 2) != 0 ? high[1] : low[1],
                                  (n & 1) != 0 ? high[2] : low[2]});
  }
  constexpr std::uint32_t kFaces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                          {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
  for (const auto& [a, b, c, d] : kFaces) {
    for (mesh::Triangle t : {mesh::Triangle{a, b, c}, mesh::Triangle{a, c, d}}) {
      if (points_in) std::swap(t[1], t[2]);
      nest.mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      nest.is_reversed.push_back(is_reversed);
    }
  }
}

// Fills a box of space with up to four bodies side by side, and each body with cavities.
void fill(Nest& nest, Random& random, const mesh::Vec3d& low, const mesh::Vec3d& high, int depth,
          bool in_material, bool is_reversed) {
  const auto axis = static_cast<std::size_t>(whole(random, 0, 2));
  const auto count = whole(random, depth == 0 ? 2 : 0, 4);
  for (std::int64_t n = 0; n < count; ++n) {
    mesh::Vec3d a, b;
    for (std::size_t d = 0; d < 3; ++d) {
      const double step = (high[d] - low[d]) / (d == axis ? static_cast<double>(count) : 1.0);
      const double from = low[d] + (d == axis ? static_cast<double>(n) * step : 0.0);
      a[d] = from + real(random, 0.05, 0.2) * step;
      b[d] = from + real(random, 0.8, 0.95) * step;
    }
    // A cavity is wound as its body is.
    const bool turned = in_material ? is_reversed : whole(random, 0, 1) == 1;
    add_box(nest, a, b, in_material != turned, turned);
    if (depth < 4) fill(nest, random, a, b, depth + 1, !in_material, turned);
  }
}

void expect_sides(const Nest& nest, const mesh::Mesh& mesh) {
  const auto object = scan::snap_object(mesh, mesh::Affine{}, 1, "nest");
  ASSERT_TRUE(object);
  scan::SpillFile spill;
  const SurfaceSides sides(*object), on_disk(*object, &spill);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    ASSERT_TRUE(sides[t].is_closed()) << t;
    ASSERT_EQ(sides[t], on_disk[t]) << t;
    ASSERT_EQ(sides[t].is_reversed(), nest.is_reversed[t]) << t;
  }
}

TEST(SurfaceSides, OfNestsOfBodiesAndCavities) {
  std::size_t boxes = 0, reversed = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    Nest nest;
    // Below 1024 voxels, and so large that products of coordinates need 128 bits.
    const double extent = seed % 2 == 0 ? 900 : 1e8;
    const mesh::Vec3d low{real(random, -1e3, 1e3), real(random, -1e3, 1e3),
                          real(random, -1e3, 1e3)};
    fill(nest, random, low, {low[0] + extent, low[1] + extent, low[2] + extent}, 0, false, false);
    boxes += nest.is_reversed.size() / 12;
    reversed += static_cast<std::size_t>(
                    std::count(nest.is_reversed.begin(), nest.is_reversed.end(), true)) /
                12;
    expect_sides(nest, nest.mesh);
    if (HasFatalFailure()) return;
    mesh::Mesh soup;  // each triangle with corners of its own
    for (const mesh::Triangle& t : nest.mesh.triangles) {
      const auto first = static_cast<std::uint32_t>(soup.vertices.size());
      for (const std::uint32_t corner : t) soup.vertices.push_back(nest.mesh.vertices[corner]);
      soup.triangles.push_back({first, first + 1, first + 2});
    }
    expect_sides(nest, soup);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(boxes, 2000u);
  EXPECT_GT(reversed, 500u);
}

// Bodies that lie against each other, on each side of each other, do not enclose each other.
TEST(SurfaceSides, OfBodiesThatTouch) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Nest nest;
      add_box(nest, {-4, -4, -4}, {4, 4, 4}, false, false);
      mesh::Vec3d low{-1, -1, -1}, high{1, 1, 1};
      low[axis] += 5 * side, high[axis] += 5 * side;
      add_box(nest, low, high, true, true);
      expect_sides(nest, nest.mesh);
      if (HasFatalFailure()) return;
    }
  }
}

bool all_are_closed(const Nest& nest) {
  const auto object = scan::snap_object(nest.mesh, mesh::Affine{}, 1, "nest");
  EXPECT_TRUE(object);
  const SurfaceSides sides(*object);
  std::size_t closed = 0;
  for (std::uint32_t t = 0; t < nest.mesh.triangles.size(); ++t) closed += sides[t].is_closed();
  EXPECT_TRUE(closed == 0 || closed == nest.mesh.triangles.size());
  return closed > 0;
}

TEST(SurfaceSides, AnObjectThatTakesTooLongIsOpen) {
  for (const int count : {100, 3000}) {
    for (const bool is_reversed : {false, true}) {
      Nest nest;
      for (int n = 0; n < count; ++n) {
        add_box(nest, {3.0 * n, 0, 0}, {3.0 * n + 1, 1000, 1}, is_reversed && n == 7, false);
      }
      EXPECT_EQ(all_are_closed(nest), count == 100 || !is_reversed);
    }
  }
}

TEST(SurfaceSides, AnObjectThatIsTooWideIsOpen) {
  const double wide = 1 << 30;
  for (const bool is_wide : {false, true}) {
    Nest nest;
    add_box(nest, {0.5, 0, 0}, {wide - 0.5 + is_wide, 1, 1}, false, false);
    EXPECT_EQ(all_are_closed(nest), !is_wide);
  }
}

}  // namespace
}  // namespace forcelayer
