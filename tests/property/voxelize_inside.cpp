// The sign of a stored distance against the winding number of the snapped meshes, summed from solid
// angles: in walls and slots of any thickness, at edges and corners, whatever the voxels.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "formats/audit/voxmap_audit.h"
#include "tests/support/baked_scene.h"
#include "tests/support/mesh_scene.h"
#include "tests/support/reference_distance.h"
#include "voxelize/distance/surface_sides.h"

namespace forcelayer {
namespace {

using reference::BakedScene;
using reference::LatticeMesh;
using reference::Point;
using reference::Random;
using reference::real;
using reference::whole;

using Turn = std::array<double, 9>;  // rows

Turn random_turn(Random& random) {
  std::array<double, 4> q{};
  double squared = 0;
  for (double& component : q) {
    component = real(random, -1, 1);
    squared += component * component;
  }
  for (double& component : q) component /= std::sqrt(squared);
  const auto [w, x, y, z] = q;
  return {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
          2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
          2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
}

mesh::Vec3d placed(const Turn& turn, const mesh::Vec3d& p, const mesh::Vec3d& middle) {
  mesh::Vec3d out = middle;
  for (std::size_t d = 0; d < 3; ++d) {
    for (std::size_t axis = 0; axis < 3; ++axis) out[d] += turn[3 * d + axis] * p[axis];
  }
  return out;
}

// A prism over a polygon that runs to the left: two fans, which the polygon must allow, and walls.
void add_prism(mesh::Mesh& mesh, const std::vector<std::array<double, 2>>& outline, double half_z,
               const std::vector<mesh::Triangle>& cap) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const double z : {-half_z, half_z}) {
    for (const auto& [x, y] : outline) mesh.vertices.push_back({x, y, z});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = first + i, b = first + (i + 1) % n;
    mesh.triangles.push_back({a, b, b + n});
    mesh.triangles.push_back({a, b + n, a + n});
  }
  for (const auto& [a, b, c] : cap) {
    mesh.triangles.push_back({first + c, first + b, first + a});
    mesh.triangles.push_back({first + n + a, first + n + b, first + n + c});
  }
}

// A clip: two legs and a back, both of thickness t, around a slot.
void add_clip(mesh::Mesh& mesh, double t, double slot, double leg, double half_z) {
  const double a = slot / 2, b = a + t;
  add_prism(mesh, {{-b, -leg}, {-a, -leg}, {-a, 0}, {a, 0}, {a, -leg}, {b, -leg}, {b, t}, {-b, t}},
            half_z, {{0, 1, 2}, {0, 2, 7}, {2, 3, 7}, {3, 6, 7}, {3, 5, 6}, {3, 4, 5}});
}

void add_box(mesh::Mesh& mesh, double x, double y, double z) {
  add_prism(mesh, {{-x, -y}, {x, -y}, {x, y}, {-x, y}}, z, {{0, 1, 2}, {0, 2, 3}});
}

void place(mesh::Mesh& mesh, const Turn& turn, const mesh::Vec3d& middle) {
  for (mesh::Vec3d& v : mesh.vertices) v = placed(turn, v, middle);
}

// How often a mesh winds around a place (van Oosterom and Strackee, 1983).
double winding(const LatticeMesh& mesh, const Point& p) {
  double all = 0;
  for (const lattice::LatticeTriangle& triangle : mesh) {
    std::array<Point, 3> to;
    std::array<double, 3> length{};
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t d = 0; d < 3; ++d) {
        to[k][d] = static_cast<double>(triangle[k][d]) / lattice::kSnapUnits - p[d];
        length[k] += to[k][d] * to[k][d];
      }
      length[k] = std::sqrt(length[k]);
    }
    const auto dot = [&](int i, int j) {
      return to[i][0] * to[j][0] + to[i][1] * to[j][1] + to[i][2] * to[j][2];
    };
    const double volume = to[0][0] * (to[1][1] * to[2][2] - to[1][2] * to[2][1]) +
                          to[0][1] * (to[1][2] * to[2][0] - to[1][0] * to[2][2]) +
                          to[0][2] * (to[1][0] * to[2][1] - to[1][1] * to[2][0]);
    all += 2 * std::atan2(volume, length[0] * length[1] * length[2] + dot(0, 1) * length[2] +
                                      dot(1, 2) * length[0] + dot(2, 0) * length[1]);
  }
  return all / (4 * std::numbers::pi);
}

double distance_from(const std::vector<LatticeMesh>& meshes, const Point& p) {
  double smallest = 1e300;
  for (const LatticeMesh& mesh : meshes) {
    for (const lattice::LatticeTriangle& triangle : mesh) {
      smallest = std::min(smallest, reference::point_distance(triangle, p));
    }
  }
  return smallest;
}

// Holds the signs of all voxels around against the windings, but where the center lies on the
// surface. In a narrow slot a place outside may count as inside, as the fill closes
// narrow passages; never the other way round. Returns how many centers lie inside, near the
// surface.
enum class Slots { kNone, kNarrow };
int expect_true_signs(const std::vector<mesh::Mesh>& parts, int reach, Slots slots = Slots::kNone) {
  std::vector<voxelize::SceneObject> objects;
  std::vector<LatticeMesh> meshes;
  for (const mesh::Mesh& part : parts) {
    objects.push_back({"part " + std::to_string(objects.size()), &part, mesh::Affine{}, {}, 0});
    meshes.push_back(reference::snapped(part, mesh::Affine{}, 1));
  }
  voxelize::BakeOptions options = reference::options_with(2, 1, Metric::kEuclidean);
  const BakedScene baked(objects, options);
  const VoxmapHeader& header = baked.map().header();
  EXPECT_TRUE(audit_voxmap(baked.map(), "baked scene"));
  int inside = 0;
  for (int x = -reach; x <= reach; ++x) {
    for (int y = -reach; y <= reach; ++y) {
      for (int z = -reach; z <= reach; ++z) {
        const Point p = reference::center_of({x, y, z});
        const double distance = distance_from(meshes, p);
        if (distance < 0.005 || distance > 3) continue;
        const bool holds = std::any_of(meshes.begin(), meshes.end(), [&](const LatticeMesh& mesh) {
          return std::abs(winding(mesh, p)) > 0.5;
        });
        const auto& origin = baked.map().view().directory_origin;
        const auto code = baked.map()
                              .distances()
                              ->lookup(static_cast<std::int32_t>(x - origin[0]),
                                       static_cast<std::int32_t>(y - origin[1]),
                                       static_cast<std::int32_t>(z - origin[2]))
                              .code;
        const bool negative = static_cast<std::int64_t>(code) < header.distance_zero_code;
        if (slots == Slots::kNarrow && negative && !holds) continue;
        EXPECT_EQ(negative, holds) << x << ' ' << y << ' ' << z << ", " << distance;
        if (negative != holds) return -1;
        inside += holds && distance < 0.5;
      }
    }
  }
  return inside;
}

TEST(InsideTest, WallsOfAnyThicknessHaveAnInside) {
  int inside = 0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    mesh::Mesh plate;
    add_box(plate, real(random, 0.05, 1.1), real(random, 1, 7), real(random, 1, 7));
    const Turn turn = seed % 3 == 0 ? Turn{1, 0, 0, 0, 1, 0, 0, 0, 1} : random_turn(random);
    place(plate, turn, {real(random, -1, 1), real(random, -1, 1), real(random, -1, 1)});
    if (seed % 4 == 1) {  // all sides turned in
      for (mesh::Triangle& t : plate.triangles) std::swap(t[1], t[2]);
    }
    if (seed % 5 == 1) {  // each triangle with corners of its own
      mesh::Mesh soup;
      for (const mesh::Triangle& t : plate.triangles) {
        const auto first = static_cast<std::uint32_t>(soup.vertices.size());
        for (const std::uint32_t corner : t) soup.vertices.push_back(plate.vertices[corner]);
        soup.triangles.push_back({first, first + 1, first + 2});
      }
      plate = soup;
    }
    inside += expect_true_signs({plate}, 12);
    if (HasFailure()) return;
  }
  EXPECT_GT(inside, 1000);
}

// Sharp edges inside and outside, slots narrower than a voxel among them.
TEST(InsideTest, ClipsAndSlotsHaveTheirSides) {
  int inside = 0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    mesh::Mesh clip, tab;
    const double slot = real(random, 0.1, 7), gap = 0.4 * std::min(1.0, slot) * real(random, 0, 1);
    add_clip(clip, real(random, 0.1, 2.5), slot, real(random, 3, 7), real(random, 1, 4));
    add_box(tab, slot / 2 - gap, 4, 5);
    for (mesh::Vec3d& v : tab.vertices) v[1] -= 4 + gap;
    const Turn turn = seed % 3 == 0 ? Turn{1, 0, 0, 0, 1, 0, 0, 0, 1} : random_turn(random);
    const mesh::Vec3d middle{real(random, -1, 1), real(random, -1, 1), real(random, -1, 1)};
    place(clip, turn, middle);
    place(tab, turn, middle);
    const bool is_alone = seed % 2 == 0;
    const Slots slots = slot > 4 && is_alone ? Slots::kNone : Slots::kNarrow;
    inside +=
        is_alone ? expect_true_signs({clip}, 12, slots) : expect_true_signs({clip, tab}, 12, slots);
    if (HasFailure()) return;
  }
  EXPECT_GT(inside, 1000);
}

// A ball of sheet: a wall around a room, whose sides face into the room. And many triangles meet at
// its poles.
TEST(InsideTest, HollowBallsHaveAWall) {
  int inside = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const double radius = real(random, 3, 7), wall = real(random, 0.3, 1.5);
    const mesh::Vec3d middle{real(random, -1, 1), real(random, -1, 1), real(random, -1, 1)};
    mesh::Mesh ball;
    reference::add_sphere(ball, middle, radius, 16);
    const std::size_t outer = ball.triangles.size();
    reference::add_sphere(ball, middle, radius - wall, 16);
    for (std::size_t t = outer; t < ball.triangles.size(); ++t) {
      std::swap(ball.triangles[t][1], ball.triangles[t][2]);
    }
    // The room is closed, so the fill takes it for solid: only the wall's own signs are compared.
    const std::vector<voxelize::SceneObject> objects{{"ball", &ball, mesh::Affine{}, {}, 0}};
    const std::vector<LatticeMesh> meshes{reference::snapped(ball, mesh::Affine{}, 1)};
    const BakedScene baked(objects, reference::options_with(2, 1, Metric::kEuclidean));
    for (int n = 0; n < 4000; ++n) {
      const lattice::VoxelIndex v{whole(random, -9, 9), whole(random, -9, 9), whole(random, -9, 9)};
      const Point p = reference::center_of(v);
      const double off = std::hypot(p[0] - middle[0], p[1] - middle[1], p[2] - middle[2]);
      if (off > radius || off < 0.9 * (radius - wall)) continue;
      if (distance_from(meshes, p) < 0.005 || winding(meshes[0], p) < 0.5) continue;
      ++inside;
      const auto& origin = baked.map().view().directory_origin;
      const auto code = baked.map()
                            .distances()
                            ->lookup(static_cast<std::int32_t>(v[0] - origin[0]),
                                     static_cast<std::int32_t>(v[1] - origin[1]),
                                     static_cast<std::int32_t>(v[2] - origin[2]))
                            .code;
      ASSERT_LT(static_cast<std::int64_t>(code), baked.map().header().distance_zero_code)
          << v[0] << ' ' << v[1] << ' ' << v[2];
    }
  }
  EXPECT_GT(inside, 100);
}

// Two boxes of one object, one of them wound the wrong way round: its outside stays outside.
TEST(InsideTest, ABodyThatIsWoundTheWrongWayRoundIsNotTurnedInsideOut) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    mesh::Mesh mesh, other;
    add_box(mesh, 3.5, 4, 3);
    add_box(other, 2, real(random, 2, 3), 3);
    for (mesh::Triangle& t : other.triangles) std::swap(t[1], t[2]);
    for (mesh::Vec3d& v : other.vertices)
      v[0] += 9.1;  // a gap of 3.6, which the fill keeps open at any turn
    for (const mesh::Triangle& t : other.triangles) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
    const Turn turn = random_turn(random);
    place(mesh, turn, {real(random, -1, 1), real(random, -1, 1), real(random, -1, 1)});
    EXPECT_GT(expect_true_signs({mesh}, 12), 100);
    if (HasFailure()) return;
  }
}

// A plate of less than a voxel that lies on a block, as an object of its own.
TEST(InsideTest, APlateOnABlockHasAnInside) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const double half = real(random, 0.1, 0.8);
    mesh::Mesh block, plate;
    add_box(block, 4, 5, 4);
    add_box(plate, half, real(random, 3, 6), real(random, 3, 6));
    for (mesh::Vec3d& v : plate.vertices) v[0] += 4 + half;
    const Turn turn = seed % 3 == 0 ? Turn{1, 0, 0, 0, 1, 0, 0, 0, 1} : random_turn(random);
    const mesh::Vec3d middle{real(random, -1, 1), real(random, -1, 1), real(random, -1, 1)};
    place(block, turn, middle);
    place(plate, turn, middle);
    EXPECT_GT(expect_true_signs({block, plate}, 12), 100);
    if (HasFailure()) return;
  }
}

TEST(InsideTest, KnowsWhatIsClosedAndHowItWinds) {
  mesh::Mesh box;
  add_box(box, 0.5, 2, 3);
  enum Side { kOpen, kAsWound, kReversed };
  const auto side_of = [](const mesh::Mesh& mesh) {
    const auto snapped = scan::snap_object(mesh, mesh::Affine{}, 1, "mesh");
    EXPECT_TRUE(snapped);
    const distance::SurfaceSides sides(*snapped);
    EXPECT_TRUE(sides.is_uniform());
    return !sides[0].is_closed() ? kOpen : sides[0].is_reversed() ? kReversed : kAsWound;
  };
  EXPECT_EQ(side_of(box), kAsWound);
  mesh::Mesh inwards = box;
  for (mesh::Triangle& t : inwards.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(side_of(inwards), kReversed);
  for (std::size_t n = 0; n < box.triangles.size(); ++n) {
    mesh::Mesh open = box, mixed = box;
    open.triangles.erase(open.triangles.begin() + static_cast<std::ptrdiff_t>(n));
    EXPECT_EQ(side_of(open), kOpen) << n;
    std::swap(mixed.triangles[n][1], mixed.triangles[n][2]);
    EXPECT_EQ(side_of(mixed), kOpen) << n;
  }
  // A corner that is off by less than half of a lattice unit is closed there, by one it is not.
  for (const bool is_near : {true, false}) {
    mesh::Mesh moved = box;
    const std::uint32_t corner = moved.triangles[0][0];
    moved.vertices.push_back(moved.vertices[corner]);
    moved.vertices.back()[0] += is_near ? 0.0004 : 0.001;
    moved.triangles[0][0] = static_cast<std::uint32_t>(moved.vertices.size() - 1);
    EXPECT_EQ(side_of(moved), is_near ? kAsWound : kOpen);
  }
  // A sheet with two sides has no inside.
  mesh::Mesh sheet;
  sheet.vertices = {{0.1, 0.2, 0.3}, {3.3, 0.4, 0.7}, {0.7, 3.1, 1.9}};
  sheet.triangles = {{0, 1, 2}, {1, 0, 2}};
  EXPECT_EQ(side_of(sheet), kOpen);
}

}  // namespace
}  // namespace forcelayer
