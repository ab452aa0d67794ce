#include "pointshell/normals/orientation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "pointshell/part/mass_properties.h"
#include "tests/support/part_support.h"

namespace forcelayer {
namespace {

using namespace testing;

void turn(mesh::Mesh& mesh, std::size_t t) {
  std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
}

void turn_all(mesh::Mesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) turn(mesh, t);
}

double oriented_volume(part::Part part, normals::OrientationReport* report = nullptr) {
  const normals::OrientationReport oriented = normals::orient_outwards(part, 0);
  if (report) *report = oriented;
  return part::mass_properties(part, oriented.loose).volume_m3;
}

TEST(Orientation, LeavesAGoodMeshAlone) {
  normals::OrientationReport report;
  EXPECT_NEAR(oriented_volume(part_of(torus_mesh(1, 0.3, 20)), &report), 1.7, 0.1);
  EXPECT_EQ(report.flipped_triangles, 0u);
  EXPECT_EQ(report.patches, 1u);
  EXPECT_EQ(report.boundary_edges, 0u);
}

TEST(Orientation, TurnsAnInvertedMeshRound) {
  mesh::Mesh mesh = box_mesh(1, 2, 3);
  turn_all(mesh);
  normals::OrientationReport report;
  EXPECT_NEAR(oriented_volume(part_of(mesh), &report), 6, 1e-12);
  EXPECT_EQ(report.flipped_triangles, 12u);
}

TEST(Orientation, RepairsRandomlyTurnedTriangles) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    mesh::Mesh mesh = torus_mesh(1, 0.3, 16);
    const double volume = part::mass_properties(part_of(mesh)).volume_m3;
    std::mt19937_64 random(seed);
    std::uint64_t turned = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (random() % 3 != 0) continue;
      turn(mesh, t);
      ++turned;
    }
    normals::OrientationReport report;
    EXPECT_NEAR(oriented_volume(part_of(mesh), &report), volume, 1e-12);
    EXPECT_EQ(report.flipped_triangles, turned);
  }
}

TEST(Orientation, KeepsACavity) {
  mesh::Mesh outer = box_mesh(3, 3, 3);
  const mesh::Mesh inner = box_mesh(1, 1, 1);
  for (const mesh::Vec3d& v : inner.vertices) outer.vertices.push_back(v);
  for (const mesh::Triangle& t : inner.triangles)
    outer.triangles.push_back({t[0] + 8, t[2] + 8, t[1] + 8});
  normals::OrientationReport report;
  EXPECT_NEAR(oriented_volume(part_of(outer), &report), 26, 1e-12);
  EXPECT_EQ(report.flipped_triangles, 0u);
  turn_all(outer);
  EXPECT_NEAR(oriented_volume(part_of(outer), &report), 26, 1e-12);
  EXPECT_EQ(report.flipped_triangles, 24u);
}

TEST(Orientation, JudgesOverlappingBodiesEachByItself) {
  mesh::Mesh right = box_mesh(1, 1, 1), wrong = box_mesh(1, 1, 1);
  for (mesh::Vec3d& v : wrong.vertices) v[0] += 0.5;
  turn_all(wrong);
  normals::OrientationReport report;
  EXPECT_NEAR(oriented_volume(part_of({right, wrong}), &report), 2, 1e-12);
  EXPECT_EQ(report.flipped_triangles, 12u);
}

// Six faces as six bodies, some turned: each alone is an open sheet, together they tell.
TEST(Orientation, JudgesSheetsByTheWholePart) {
  const mesh::Mesh box = box_mesh(1, 1, 1);
  std::vector<mesh::Mesh> faces;
  for (std::size_t face = 0; face < 6; ++face) {
    mesh::Mesh mesh;
    mesh.vertices = box.vertices;
    mesh.triangles = {box.triangles[2 * face], box.triangles[2 * face + 1]};
    if (face == 3) turn_all(mesh);
    faces.push_back(mesh);
  }
  normals::OrientationReport report;
  oriented_volume(part_of(faces), &report);
  EXPECT_EQ(report.flipped_triangles, 2u);
}

// A body that another hides is judged by itself.
TEST(Orientation, TurnsAHiddenBodyRound) {
  mesh::Mesh inner = torus_mesh(1, 0.3, 16);
  turn_all(inner);
  normals::OrientationReport report;
  oriented_volume(part_of({box_mesh(5, 5, 5), inner}), &report);
  EXPECT_EQ(report.flipped_triangles, inner.triangles.size());
  EXPECT_EQ(report.hidden_triangles, 0u);
}

// The concave wall of a groove, as a body of its own, is no outside by itself but is in the part.
TEST(Orientation, JudgesAGrooveByTheWholePart) {
  mesh::Mesh groove = grid_mesh(24, 1, false, false, [](double u, double v) {
    const double turn = std::numbers::pi * u;
    return part::Vec3{std::cos(turn), 4 * v - 2, -std::sin(turn)};
  });
  mesh::Mesh rest = box_mesh(4, 4, 4);  // under the groove, without its top at z = 0
  for (mesh::Vec3d& v : rest.vertices) v[2] -= 2;
  rest.triangles.erase(rest.triangles.begin() + 2, rest.triangles.begin() + 4);
  for (mesh::Mesh* mesh : {&groove, &rest}) {
    normals::OrientationReport report;
    turn_all(*mesh);
    oriented_volume(part_of({groove, rest}), &report);
    turn_all(*mesh);
    const bool groove_faces_up = part::dot(part::doubled_area_normal(part_of(groove), 0),
                                           {0, 0, 1}) > 0;  // as grid_mesh makes it
    const std::uint64_t groove_turned = (mesh == &groove) == groove_faces_up ? 48 : 0;
    EXPECT_EQ(report.flipped_triangles, groove_turned + (mesh == &rest ? 10 : 0));
  }
}

TEST(Orientation, DecidesForAnOpenBowl) {
  mesh::Mesh mesh = sphere_mesh(1, 24);
  mesh.triangles.resize(mesh.triangles.size() / 2);
  normals::OrientationReport report;
  oriented_volume(part_of(mesh), &report);
  EXPECT_EQ(report.flipped_triangles, 0u);
  turn_all(mesh);
  oriented_volume(part_of(mesh), &report);
  EXPECT_EQ(report.flipped_triangles, mesh.triangles.size() - 24);  // at the pole 24 have no area
  EXPECT_GT(report.boundary_edges, 0u);
}

TEST(Orientation, TellsAnOpenSheet) {
  mesh::Mesh mesh = box_mesh(1, 1, 1);
  mesh.triangles.resize(2);
  part::Part part = part_of(mesh);
  const normals::OrientationReport report = normals::orient_outwards(part, 0.1);
  ASSERT_EQ(report.sheets.size(), 1u);
  EXPECT_EQ(report.sheets[0].body, "body 0");
  EXPECT_EQ(report.sheets[0].triangles, 2u);
  EXPECT_DOUBLE_EQ(report.sheets[0].area_m2, 1);
  EXPECT_EQ(report.of_sheet, std::vector<bool>({true, true}));
  EXPECT_EQ(report.undecided_triangles, 0u);
}

// The depth at which as many rays leave its inside as to be a sheet, 1.50 mm, follows from exact
// fractions over the area: few triangles are sampled all over.
TEST(Orientation, TellsAShallowDishFromADeepOne) {
  for (const double depth : {0.0014, 0.0016}) {
    mesh::Mesh dish;
    const double corners[4][2] = {
        {-0.015, -0.015}, {0.015, -0.015}, {0.015, 0.015}, {-0.015, 0.015}};
    for (const double z : {0.0, depth}) {
      for (const auto& corner : corners) dish.vertices.push_back({corner[0], corner[1], z});
    }
    dish.triangles = {{0, 1, 2}, {0, 2, 3}};
    for (std::uint32_t a = 0; a < 4; ++a) {
      const std::uint32_t b = (a + 1) % 4;
      dish.triangles.insert(dish.triangles.end(), {{a, a + 4, b + 4}, {a, b + 4, b}});
    }
    part::Part part = part_of(dish);
    EXPECT_EQ(normals::orient_outwards(part, 0.0026).sheets.size(), depth < 0.0015 ? 1u : 0u);
  }
}

// Bodies whose boxes are farther apart than twice the negligible size do not shade each other: a
// sheet before a wall is one, though hardly a ray leaves its front.
TEST(Orientation, BodiesOfAnotherGroupCastNoShadow) {
  constexpr double kSize = 0.02;
  for (const bool is_near : {true, false}) {
    mesh::Mesh sheet;
    sheet.vertices = {{-0.05, -0.05, 0}, {0.05, -0.05, 0}, {0.05, 0.05, 0}, {-0.05, 0.05, 0}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh::Mesh wall = box_mesh(1, 1, 0.1);
    const double gap = std::nextafter(2 * kSize, is_near ? 0 : 1);
    for (auto& [x, y, z] : wall.vertices) z = z < 0 ? gap : gap + 0.1;
    part::Part part = part_of({sheet, wall});
    EXPECT_EQ(normals::orient_outwards(part, kSize).sheets.size(), is_near ? 0u : 1u) << gap;
  }
}

// A box, and beside it two open sheets of two triangles and one.
mesh::Mesh box_with_sheets() {
  mesh::Mesh mesh = box_mesh(1, 1, 1);
  mesh.vertices.insert(
      mesh.vertices.end(),
      {{3, 0, 0}, {4, 0, 0}, {4, 1, 0}, {3, 1, 0}, {6, 0, 0}, {7, 0, 0}, {6, 0, 1}});
  mesh.triangles.insert(mesh.triangles.end(), {{8, 9, 10}, {8, 10, 11}, {12, 13, 14}});
  return mesh;
}

TEST(Orientation, TellsAllSheetsAtOnceAndNoFaceOfASolid) {
  part::Part part = part_of(box_with_sheets());
  const normals::OrientationReport report = normals::orient_outwards(part, 0.1);
  ASSERT_EQ(report.sheets.size(), 2u);
  EXPECT_DOUBLE_EQ(report.sheets[0].area_m2, 1);
  EXPECT_DOUBLE_EQ(report.sheets[1].area_m2, 0.5);
  EXPECT_EQ(report.sheets[0].middle, (part::Vec3{3.5, 0.5, 0}));
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    EXPECT_EQ(report.of_sheet[t], part.vertices[part.triangles[t][0]].x > 1) << t;
  }
  const part::MassProperties mass = part::mass_properties(part, report.loose);
  EXPECT_EQ(mass.source, MassSource::kArea);
  EXPECT_DOUBLE_EQ(mass.area_m2, 7.5);
}

// Twelve triangles and the same twelve turned inside out, as one body and as two.
TEST(Orientation, FacesBackToBackAreNoSecondVolume) {
  mesh::Mesh doubled = box_mesh(1, 2, 3), inverted = box_mesh(1, 2, 3);
  turn_all(inverted);
  const part::Part two_bodies = part_of({doubled, inverted});
  EXPECT_EQ(two_bodies.triangles.size(), 12u);
  EXPECT_NEAR(oriented_volume(two_bodies), 6, 1e-12);
  doubled.triangles.insert(doubled.triangles.end(), inverted.triangles.begin(),
                           inverted.triangles.end());
  const part::Part one_body = part_of(doubled);
  EXPECT_EQ(one_body.triangles.size(), 12u);
  EXPECT_EQ(one_body.duplicate_triangles, 12u);
  EXPECT_NEAR(oriented_volume(one_body), 6, 1e-12);
  EXPECT_DOUBLE_EQ(part::mass_properties(one_body).area_m2, 22);
}

TEST(Orientation, ASheetWithBothItsFacesIsOneSheet) {
  mesh::Mesh mesh = box_mesh(1, 1, 1);
  mesh.triangles.resize(2);
  mesh.triangles.insert(mesh.triangles.end(), mesh.triangles.begin(), mesh.triangles.begin() + 2);
  turn(mesh, 2), turn(mesh, 3);
  part::Part part = part_of(mesh);
  const normals::OrientationReport report = normals::orient_outwards(part, 0.1);
  ASSERT_EQ(report.sheets.size(), 1u);
  EXPECT_DOUBLE_EQ(report.sheets[0].area_m2, 1);
  EXPECT_DOUBLE_EQ(part::mass_properties(part).area_m2, 1);
}

// Two boxes of one body, and the faces of both between them.
TEST(Orientation, AWallBetweenTwoRoomsBoundsNothing) {
  mesh::Mesh mesh = box_mesh(1, 1, 1), right = box_mesh(1, 1, 1);
  for (const mesh::Vec3d& v : right.vertices) mesh.vertices.push_back({v[0] + 1, v[1], v[2]});
  for (const mesh::Triangle& t : right.triangles)
    mesh.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  const part::Part part = part_of(mesh);
  // The diagonals of the two faces may cross, or be one.
  EXPECT_LE(part.duplicate_triangles, 2u);
  EXPECT_NEAR(oriented_volume(part), 2, 1e-12);
}

// A triangle within, on its own or on an edge of the solid, does not make it a sheet.
TEST(Orientation, AHiddenTriangleBoundsNothing) {
  for (const bool on_an_edge : {false, true}) {
    SCOPED_TRACE(on_an_edge);
    mesh::Mesh mesh = box_mesh(1, 1, 1);
    const mesh::Vec3d a = mesh.vertices[0], b = mesh.vertices[1];
    mesh.vertices.insert(mesh.vertices.end(), {on_an_edge ? a : mesh::Vec3d{-0.2, 0.1, 0},
                                               on_an_edge ? b : mesh::Vec3d{0.2, 0.1, 0.1},
                                               {0, 0.01, 0.02}});
    mesh.triangles.push_back({8, 9, 10});
    part::Part part = part_of(mesh);
    const normals::OrientationReport report = normals::orient_outwards(part, 0.1);
    EXPECT_TRUE(report.sheets.empty());
    const part::MassProperties mass = part::mass_properties(part, report.loose);
    EXPECT_EQ(mass.source, MassSource::kVolume);
    EXPECT_NEAR(mass.volume_m3, 1, 1e-12);
    EXPECT_EQ(mass.loose_triangles, 1u);
    EXPECT_NEAR(part::length(mass.centroid), 0, 1e-12);
  }
}

// A triangle along an edge, with a vertex at its middle, and one with two equal corners: an
// exporter leaves them where it split a neighbor.
TEST(Orientation, ATriangleWithoutAreaBoundsNothing) {
  mesh::Mesh mesh = box_mesh(1, 1, 1);
  const mesh::Vec3d a = mesh.vertices[0], b = mesh.vertices[1];
  mesh.vertices.push_back({(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2});
  mesh.triangles.push_back({0, 8, 1});
  mesh.triangles.push_back({0, 0, 1});
  part::Part part = part_of(mesh);
  const normals::OrientationReport report = normals::orient_outwards(part, 0.1);
  EXPECT_TRUE(report.sheets.empty());
  const part::MassProperties mass = part::mass_properties(part, report.loose);
  EXPECT_EQ(mass.source, MassSource::kVolume);
  EXPECT_NEAR(mass.volume_m3, 1, 1e-12);
}

// Three wedges around a line from the origin along `line`. Two sides of theirs have a vertex at its
// middle and the others do not, so that triangle `filler` of its ends and its middle closes them,
// as one that no neighbor links to a patch.
mesh::Mesh wedges_around(const part::Vec3& line, const mesh::Triangle& filler) {
  const part::Vec3 along = part::normalized(line), x = part::any_perpendicular(along),
                   y = part::cross(along, x);
  mesh::Mesh mesh;
  const auto add = [&](const part::Vec3& p) { mesh.vertices.push_back({p.x, p.y, p.z}); };
  add({}), add(0.5 * line), add(line);
  const bool split_sides[3][2] = {{false, true}, {true, true}, {false, false}};
  for (int wedge = 0; wedge < 3; ++wedge) {
    const auto a = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const int side : {0, 1}) {
      const double turn = (2 * wedge + side) * std::numbers::pi / 3;
      const part::Vec3 foot = std::cos(turn) * x + std::sin(turn) * y;
      add(foot), add(foot + line);
    }
    const std::uint32_t top_a = a + 1, b = a + 2, top_b = a + 3;
    mesh.triangles.insert(mesh.triangles.end(),
                          {{0, b, a}, {2, top_a, top_b}, {a, b, top_b}, {a, top_b, top_a}});
    const auto add_side = [&](bool split, std::uint32_t low, std::uint32_t high, bool turned) {
      std::vector<mesh::Triangle> side{{0, low, high}, {0, high, 2}};
      if (split) side = {{0, low, 1}, {low, high, 1}, {1, high, 2}};
      for (mesh::Triangle& t : side) {
        if (turned) std::swap(t[1], t[2]);
        mesh.triangles.push_back(t);
      }
    };
    add_side(split_sides[wedge][0], a, top_a, false);
    add_side(split_sides[wedge][1], b, top_b, true);
  }
  mesh.triangles.push_back(filler);
  return mesh;
}

// Which way it is wound decides whether the body is closed; also where it is flat but for rounding,
// and where the body is inside out.
TEST(Orientation, FlatTrianglesStayAsTheyAre) {
  for (const part::Vec3& line : {part::Vec3{0, 0, 1},
                                 {1 / 3.0, 1 / 7.0, 1 / 11.0},
                                 {0.1, -0.7, 1 / 3.0},
                                 {-1 / 7.0, 0.3, 0.9}}) {
    SCOPED_TRACE(line.x);
    for (const bool inside_out : {false, true}) {
      int closed = 0;
      for (const mesh::Triangle& filler : {mesh::Triangle{0, 1, 2}, {0, 2, 1}}) {
        mesh::Mesh mesh = wedges_around(line, filler);
        if (inside_out) turn_all(mesh);
        part::Part part = part_of(mesh);
        EXPECT_EQ(part.degenerate_triangles, 1u);
        const bool was_closed = part::is_closed(part.triangles);
        normals::orient_outwards(part, 0.01);
        // Turned, the three wedges need the filler turned too.
        EXPECT_EQ(part::is_closed(part.triangles), was_closed != inside_out);
        closed += was_closed;
      }
      EXPECT_EQ(closed, 1);
    }
  }
}

// Rays start from all over a face: only its corners look out of the ball.
TEST(Orientation, FewTrianglesAreJudgedByAllOfTheirArea) {
  for (const bool same_body : {false, true}) {
    for (const double radius : {1.12, 1.152, 1.25, 1.33}) {
      SCOPED_TRACE(radius);
      mesh::Mesh box = box_mesh(2, 2, 2), ball = sphere_mesh(radius, 32);
      turn_all(box);
      std::vector<mesh::Mesh> bodies{ball, box};
      if (same_body) {
        const auto first = static_cast<std::uint32_t>(ball.vertices.size());
        for (const mesh::Vec3d& v : box.vertices) ball.vertices.push_back(v);
        for (const mesh::Triangle& t : box.triangles) {
          ball.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
        }
        bodies = {ball};
      }
      part::Part part = part_of(bodies);
      EXPECT_EQ(normals::orient_outwards(part, 0.1).flipped_triangles, 12u);
      EXPECT_EQ(normals::orient_outwards(part, 0.1).flipped_triangles, 0u);
    }
  }
}

TEST(Orientation, LeavesASheetTooSmallToMatter) {
  mesh::Mesh mesh = box_mesh(1, 1, 1);
  mesh.vertices.insert(mesh.vertices.end(), {{5, 0, 0}, {5.01, 0, 0}, {5, 0.01, 0}});
  mesh.triangles.push_back({8, 9, 10});
  part::Part part = part_of(mesh);
  const normals::OrientationReport report = normals::orient_outwards(part, 0.1);
  EXPECT_EQ(report.undecided_triangles, 1u);
  EXPECT_TRUE(report.sheets.empty());
  EXPECT_NEAR(part::mass_properties(part, report.loose).volume_m3, 1, 1e-12);
}

TEST(Orientation, TakesTrianglesWithoutArea) {
  mesh::Mesh mesh = box_mesh(1, 1, 1);
  mesh.vertices.push_back({5, 0, 0});
  mesh.triangles.insert(mesh.triangles.end(), {{0, 0, 8}, {8, 8, 8}, {1, 8, 1}});
  EXPECT_NEAR(oriented_volume(part_of(mesh)), 1, 1e-12);
}

TEST(Orientation, OfTheModelsIsAsTheFilesGiveIt) {
  std::vector<part::Part> parts = {part_of(kettle_mesh(24))};
  for (const char* file : {"bunny.drc", "dragon.drc", "counter.drc", "large_block.stl"}) {
    parts.push_back(part_of_model(file, 0.001));
  }
  for (part::Part& part : parts) {
    SCOPED_TRACE(part.triangles.size());
    const auto report = normals::orient_outwards(part, 0);
    EXPECT_EQ(report.flipped_triangles, 0u);
  }
}

}  // namespace
}  // namespace forcelayer
