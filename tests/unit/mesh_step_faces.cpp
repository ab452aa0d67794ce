// Faces of STEP files that OpenCASCADE does not tessellate: dropped, tried otherwise, or
// lost with a word, in a build with it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string_view>

#include "formats/mesh/mesh_facts.h"
#include "formats/mesh/scene.h"
#include "tests/support/mesh_files.h"
#include "tests/support/random_numbers.h"

#ifdef FORCELAYER_STEP
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepTools.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_Plane.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp_Explorer.hxx>

#include "formats/mesh/step/edge_cover.h"
#include "formats/mesh/step/holes.h"
#include "formats/mesh/step/sliver.h"
#include "formats/mesh/step/tessellator.h"
#include "tests/support/places.h"
#include "tests/support/step_shapes.h"
#endif

namespace forcelayer {
namespace {

using namespace test;

#ifdef FORCELAYER_STEP

const mesh::SourceFile kFile{"a.step", "", {}};

mesh::Tessellation tessellated(const TopoDS_Shape& shape, double deflection_mm) {
  return mesh::StepTessellator(kFile, deflection_mm).tessellate(shape, "node");
}

bool contains(const std::string& text, const std::string& word) {
  return text.find(word) != std::string::npos;
}

// How many lines hold `word`.
std::ptrdiff_t lines_with(const std::vector<std::string>& lines, const std::string& word) {
  return std::count_if(lines.begin(), lines.end(),
                       [&](const std::string& line) { return contains(line, word); });
}

// The n-th face of the shape, from 1.
TopoDS_Face face_of(const TopoDS_Shape& shape, int number) {
  TopExp_Explorer face(shape, TopAbs_FACE);
  for (; number > 1; --number) face.Next();
  return TopoDS::Face(face.Current());
}

TEST(StepTessellator, TakesSoundFacesAsTheyAre) {
  const auto made = tessellated(BRepPrimAPI_MakeBox(10, 10, 10).Shape(), 0.1);
  EXPECT_EQ(made.mesh.triangles.size(), 12u);
  EXPECT_TRUE(made.lost.empty());
  EXPECT_EQ(made.dropped, 0u);
  EXPECT_EQ(made.deflection_mm, 0.1);
  EXPECT_EQ(made.deviation_mm, 0.1);
}

TEST(StepTessellator, DropsAFaceWithoutAreaAndCountsIt) {
  for (const double width : {1e-8, 2e-11}) {  // the second has 1e-10 mm^2
    const auto made = tessellated(cube_with_sliver(width), 0.1);
    EXPECT_TRUE(made.lost.empty());
    ASSERT_EQ(made.dropped, 1u);
    // The sliver is as wide as it is; its edges count with the tolerance of their polygons.
    EXPECT_GE(made.dropped_reach_mm, width);
    EXPECT_LE(made.dropped_reach_mm, 0.1);
    EXPECT_GE(made.deviation_mm, 0.1 + made.dropped_reach_mm);
    EXPECT_NEAR(mesh::mesh_facts(made.mesh).area, 600, 1e-3);
  }
}

// Two shared vertices are no shared edges: nothing covers the sliver.
TEST(StepTessellator, DoesNotDropASliverThatStandsAlone) {
  Polyhedron sheets;
  sheets.add({{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}});
  sheets.add({{0, 0, 5}, {10, 0, 5}, {10, 1e-6, 5}, {0, 1e-6, 5}});
  const auto made = tessellated(sheets.shape(), 0.1);
  EXPECT_EQ(made.dropped, 0u);
  ASSERT_EQ(made.lost.size(), 1u);
  EXPECT_NEAR(made.lost[0].center_mm[0], 5, 1e-3);
  EXPECT_NEAR(made.lost[0].center_mm[2], 5, 1e-3);
  EXPECT_NEAR(made.lost[0].size_mm, 10, 1e-3);
}

// Its free side too is nowhere farther from the neighbor than the sliver is wide.
TEST(StepTessellator, DropsASliverWithAFreeSide) {
  Polyhedron sheet;
  sheet.add({{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}});
  sheet.add({{10, 0, 0}, {0, 0, 0}, {0, -1e-6, 0}, {10, -1e-6, 0}});
  const auto made = tessellated(sheet.shape(), 0.1);
  EXPECT_EQ(made.dropped, 1u);
  EXPECT_TRUE(made.lost.empty());
}

// Only one end of it touches the neighbor.
TEST(StepTessellator, DoesNotDropASliverThatSticksOut) {
  Polyhedron sheet;
  sheet.add({{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}});
  sheet.add({{0, 0, 0}, {0, 1e-6, 0}, {0, 1e-6, 10}, {0, 0, 10}});
  const auto made = tessellated(sheet.shape(), 0.1);
  EXPECT_EQ(made.dropped, 0u);
  EXPECT_EQ(made.lost.size(), 1u);
}

// Its area as an integral is zero, its lobes are not.
TEST(StepTessellator, IsNotFooledByLobesWhoseAreasCancel) {
  const auto made = tessellated(crossed_face(), 0.1);
  EXPECT_EQ(made.dropped, 0u);
  ASSERT_EQ(made.lost.size(), 1u);
  EXPECT_GT(made.lost[0].size_mm, 99);
}

// A face that no deflection gives triangles, and that is wider than a fine deflection: it is
// dropped where it is as thin as is dropped at the deflection by size, and its width is no secret.
TEST(StepTessellator, DropsASliverThatIsWiderThanAFineDeflection) {
  const auto with_sliver = [](double bulge_mm) {
    Polyhedron sheet;
    sheet.add({{-10, -50, 0}, {110, -50, 0}, {110, 50, 0}, {-10, 50, 0}});
    return together({sheet.shape(), crossed_face(bulge_mm)});
  };
  constexpr double kDeflectionMm = 0.005;
  const auto made = tessellated(with_sliver(0.1), kDeflectionMm);
  EXPECT_TRUE(made.lost.empty());
  ASSERT_EQ(made.dropped, 1u);
  EXPECT_GT(made.dropped_reach_mm, 2 * kDeflectionMm);
  EXPECT_LE(made.dropped_reach_mm, 0.1);
  EXPECT_GE(made.deviation_mm, kDeflectionMm + made.dropped_reach_mm);
  const auto wide = tessellated(with_sliver(1), kDeflectionMm);
  EXPECT_EQ(wide.dropped, 0u);
  EXPECT_EQ(wide.lost.size(), 1u);
}

// A crescent's top and bottom fail at this deflection and are thinner than it. They are not dropped
// where finer triangles serve; where none do, dropping deviates less than coarser triangles.
TEST(StepTessellator, DropsWhatIsThinnerThanTheDeflection) {
  const auto made = tessellated(crescent({48, -58, 37}, {-0.4, 0, -0.9}, 0.3), 1);
  EXPECT_TRUE(made.lost.empty());
  EXPECT_EQ(made.dropped, 2u);
  EXPECT_EQ(made.deflection_mm, 1);
  EXPECT_GT(made.dropped_reach_mm, 0.3);  // that the outlines are apart somewhere
  EXPECT_NEAR(made.deviation_mm, 1 + made.dropped_reach_mm, 1e-12);
}

TEST(StepTessellator, TriesFinerDeflections) {
  const TopoDS_Shape shape = crescent_for_finer();
  const auto made = tessellated(shape, 1);
  EXPECT_TRUE(made.lost.empty());
  EXPECT_EQ(made.deflection_mm, 0.5);
  EXPECT_EQ(made.wanted_deflection_mm, 1);
}

TEST(StepTessellator, TriesCoarserDeflectionsAndSaysWhatTheyDeviate) {
  mesh::StepTessellator tessellator(kFile, 0.1);
  const auto made = tessellator.tessellate(crescent_for_coarser(), "node");
  EXPECT_TRUE(made.lost.empty());
  EXPECT_EQ(made.deflection_mm, 0.2);
  EXPECT_EQ(made.dropped, 0u);
  EXPECT_GE(made.deviation_mm, 0.2);
}

// OpenCASCADE gives top and bottom triangles that leave out the better part of the face.
TEST(StepTessellator, DoesNotTakeTrianglesThatMissTheOutline) {
  const TopoDS_Shape shape = crescent({-48, -53, -14}, {-0.4, -0.4, -0.5}, 0.3);
  const TopoDS_Face top = face_of(shape, 3);
  BRepMesh_IncrementalMesh(shape, 0.2, false, 0.35, false);
  ASSERT_FALSE(mesh::triangles_of(top).empty());
  EXPECT_FALSE(mesh::has_whole_outline(top));
  EXPECT_FALSE(mesh::covers_edges(mesh::triangles_of(top), top, 0.8, 0.02));
  BRepTools::Clean(shape);
  EXPECT_EQ(tessellated(shape, 0.2).lost.size(), 2u);
  for (int number = 1; number <= 6; ++number) {
    const TopoDS_Shape box = BRepPrimAPI_MakeBox(10, 10, 10).Shape();
    BRepMesh_IncrementalMesh(box, 0.2, false, 0.35, false);
    EXPECT_TRUE(mesh::has_whole_outline(face_of(box, number)));
  }
}

TEST(StepTessellator, LosesAFaceWhoseOutlineCrossesItself) {
  EXPECT_EQ(tessellated(bow_tie(), 0.1).lost.size(), 1u);
}

// Waves over n x n control points that are 160 apart: a surface along which its parameter does not
// run evenly, so that OpenCASCADE takes its triangles for 80 mm off.
Handle(Geom_Surface) wavy_surface(int n) {
  TColgp_Array2OfPnt poles(1, n, 1, n);
  for (int i = 1; i <= n; ++i) {
    for (int j = 1; j <= n; ++j) {
      poles.SetValue(
          i, j, {160.0 * i, 160.0 * j, 100 * std::sin(1.5 * (i - 1)) * std::sin(1.2 * (j - 1))});
    }
  }
  TColStd_Array1OfReal knots(1, n - 2);
  TColStd_Array1OfInteger counts(1, n - 2);
  for (int k = 1; k <= n - 2; ++k) {
    knots.SetValue(k, k);
    counts.SetValue(k, k == 1 || k == n - 2 ? 4 : 1);
  }
  return new Geom_BSplineSurface(poles, knots, knots, counts, counts, 3, 3);
}

double distance_to(const mesh::Mesh& mesh, const gp_XYZ& place) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const mesh::Corners& triangle : mesh::triangles_of(mesh)) {
    nearest = std::min(nearest, mesh::distance_to_triangle(place, triangle));
  }
  return nearest;
}

// A face that has lost an edge of its outline: what is left of that has no area.
TEST(StepTessellator, DoesNotTakeAnOpenOutlineForOneWithoutArea) {
  BRepBuilderAPI_MakeWire wire;
  wire.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(10, 0, 0)));
  const BRep_Builder builder;
  TopoDS_Face face;
  builder.MakeFace(face, new Geom_Plane(gp_Pln()), 1e-7);
  builder.Add(face, wire.Wire());
  EXPECT_GT(mesh::reach_from_edges(face, 0.01), 9);
}

// A pyramid stands on its tip. Of the squares of its base random ones are taken out: no middle of
// those is farther from what is left.
TEST(StepHoles, ReachAsFarAsWhatIsMissing) {
  constexpr std::uint32_t kSeed = 72, kSquares = 8, kRow = kSquares + 1, kRounds = 40;
  for (std::uint32_t round = 0; round < kRounds; ++round) {
    Random random(kSeed + round);
    const std::int64_t tenths = integer(random, 1, 9);
    mesh::Mesh pyramid;
    for (std::uint32_t i = 0; i < kRow; ++i) {
      for (std::uint32_t j = 0; j < kRow; ++j)
        pyramid.vertices.push_back({1.0 * i, 3.0 * j, 0.5 * i});
    }
    const std::uint32_t tip = kRow * kRow;
    pyramid.vertices.push_back({4, 12, -1000});
    for (std::uint32_t i = 0; i < kSquares; ++i) {
      const std::uint32_t far = kSquares * kRow;
      pyramid.triangles.push_back({i + 1, i, tip});
      pyramid.triangles.push_back({far + i, far + i + 1, tip});
      pyramid.triangles.push_back({i * kRow, (i + 1) * kRow, tip});
      pyramid.triangles.push_back({(i + 1) * kRow + kSquares, i * kRow + kSquares, tip});
    }
    mesh::Mesh whole = pyramid;
    std::vector<gp_XYZ> missing;
    for (std::uint32_t i = 0; i < kSquares; ++i) {
      for (std::uint32_t j = 0; j < kSquares; ++j) {
        const std::uint32_t a = i * kRow + j, b = a + kRow;
        const bool is_left = integer(random, 0, 9) >= tenths;
        for (mesh::Mesh* mesh : {&whole, &pyramid}) {
          if (mesh == &pyramid && !is_left) continue;
          mesh->triangles.push_back({a, b + 1, b});
          mesh->triangles.push_back({a, a + 1, b + 1});
        }
        if (!is_left) missing.emplace_back(i + 0.5, 3 * (j + 0.5), 0.5 * (i + 0.5));
      }
    }
    EXPECT_EQ(mesh::widest_hole(whole, 0), 0);
    const double reach = mesh::widest_hole(pyramid, 0);
    // Triangles that meet within a tolerance hang together.
    constexpr double kNear = 1e-7;
    mesh::Mesh loose;
    for (const mesh::Triangle& triangle : pyramid.triangles) {
      const auto first = static_cast<std::uint32_t>(loose.vertices.size());
      for (const std::uint32_t corner : triangle) {
        mesh::Vec3d& vertex = loose.vertices.emplace_back(pyramid.vertices[corner]);
        for (double& x : vertex) x += uniform(random, -kNear, kNear);
      }
      loose.triangles.push_back({first, first + 1, first + 2});
    }
    const double loose_reach = mesh::widest_hole(loose, 10 * kNear);
    for (const gp_XYZ& place : missing) {
      EXPECT_LE(distance_to(pyramid, place), reach + 1e-12) << "seed " << kSeed + round;
      EXPECT_LE(distance_to(pyramid, place), loose_reach + kNear) << "seed " << kSeed + round;
    }
    EXPECT_LE(std::max(reach, loose_reach), 13);  // half across the base
  }
}

TEST(StepForecast, IsWithinAFactorOfTwo) {
  for (const auto& [name, shape] :
       {std::pair<const char*, TopoDS_Shape>{"box", BRepPrimAPI_MakeBox(10, 20, 30).Shape()},
        {"cylinder", BRepPrimAPI_MakeCylinder(10, 30).Shape()},
        {"sphere", BRepPrimAPI_MakeSphere(20).Shape()},
        {"torus", BRepPrimAPI_MakeTorus(30, 5).Shape()},
        {"waves", BRepBuilderAPI_MakeFace(wavy_surface(12), 1e-6).Face()}}) {
    const bool is_large = std::string_view(name) == "waves";
    for (const double deflection : {is_large ? 8 : 0.5, is_large ? 4 : 0.1, is_large ? 2 : 0.02}) {
      mesh::StepTessellator tessellator(kFile, deflection);
      const double forecast = tessellator.forecast(shape);
      BRepTools::Clean(shape);
      const auto made =
          static_cast<double>(tessellator.tessellate(shape, name).mesh.triangles.size());
      EXPECT_LE(forecast, 2 * made) << name << " at " << deflection;
      EXPECT_GE(forecast, made / 2) << name << " at " << deflection;
    }
  }
}

TEST(StepTessellator, ProvesHowFarTheTrianglesOfAFreeFormSurfaceLie) {
  constexpr int kPoles = 12, kSeed = 71;
  const Handle(Geom_Surface) surface = wavy_surface(kPoles);
  const TopoDS_Face face = BRepBuilderAPI_MakeFace(surface, 1e-6).Face();
  for (const double deflection : {0.5, 2.0, 8.0}) {
    BRepTools::Clean(face);
    const auto made = tessellated(face, deflection);
    TopLoc_Location ignored;
    ASSERT_GT(BRep_Tool::Triangulation(face, ignored)->Deflection(), 70);
    EXPECT_EQ(made.edge_gap_mm, 0);
    EXPECT_LT(made.deviation_mm, 10 * deflection);
    Random random(kSeed);
    double farthest = 0;
    for (int n = 0; n < 300; ++n) {
      const gp_Pnt place =
          surface->Value(uniform(random, 1, kPoles - 2), uniform(random, 1, kPoles - 2));
      farthest = std::max(farthest, distance_to(made.mesh, place.XYZ()));
    }
    EXPECT_LE(farthest, made.deviation_mm) << "seed " << kSeed;
    EXPECT_GT(farthest, 0.05 * made.deviation_mm) << "a bound without worth at " << deflection;
  }
}

// From the file to the assembly.
class StepFaces : public testing::Test {
 protected:
  void SetUp() override {
    const std::string command = test::command_path("make_step_faces ") + path_;
    ASSERT_EQ(std::system(command.c_str()), 0);
  }

  Result<mesh::Assembly> read(std::uint64_t missing_faces,
                              std::vector<std::string> without = {}) const {
    return mesh::read_assembly(path_,
                               {.missing_faces = missing_faces, .without = std::move(without)});
  }

  ScratchFolder folder_;
  std::string path_ = folder_ / "tray.step";
};

TEST_F(StepFaces, ALostFaceIsAnErrorThatNamesNodePlaceAndWayOut) {
  const auto tray = read(0);
  ASSERT_FALSE(tray);
  EXPECT_EQ(tray.error().code, ErrorCode::kMeshIncomplete);
  const std::string line = to_line(tray.error());
  for (const char* word : {"1 face:", "tray/bad at (450, 10, 40) mm", "--missing-faces 1"}) {
    EXPECT_TRUE(contains(line, word)) << line << " has no " << word;
  }
}

TEST_F(StepFaces, AcceptsAsManyLostFacesAsItIsTold) {
  const auto tray = read(1);
  ASSERT_TRUE(tray) << to_line(tray.error());
  EXPECT_EQ(tray->instances.size(), 3u);
  ASSERT_EQ(tray->missing_faces.size(), 1u);
  const mesh::MissingFace& face = tray->missing_faces[0];
  EXPECT_EQ(face.node, "tray/bad");
  EXPECT_NEAR(face.center[0], 450, 0.1);
  EXPECT_NEAR(face.center[1], 10, 0.1);
  EXPECT_NEAR(face.center[2], 40, 0.1);
  EXPECT_NEAR(face.size, 101, 2);  // 100 x 12
  EXPECT_EQ(lines_with(tray->warnings, "no guarantee covers it"), 1);
  EXPECT_EQ(lines_with(tray->warnings, "tray/seam: 1 face is left out, because it is too thin"), 1);
}

TEST_F(StepFaces, CountsADroppedFaceAsDeviation) {
  const auto plain = mesh::read_assembly(path_ + "#cube");
  const auto seam = mesh::read_assembly(path_ + "#seam");
  ASSERT_TRUE(plain && seam);
  EXPECT_EQ(plain->deviation_units(), 0.1);
  EXPECT_GT(seam->deviation_units(), 0.1);
  EXPECT_LE(seam->deviation_units(), 0.2);
  // In one file, each keeps its own.
  const auto both = read(0, {"bad"});
  ASSERT_TRUE(both) << to_line(both.error());
  for (const mesh::MeshInstance& instance : both->instances) {
    const auto& alone = instance.name.ends_with("cube") ? plain : seam;
    EXPECT_EQ(instance.deviation_units, alone->deviation_units()) << instance.name;
  }
}

TEST_F(StepFaces, LeavesANodeOutBeforeItIsTessellated) {
  const auto tray = read(0, {"bad"});
  ASSERT_TRUE(tray) << to_line(tray.error());
  EXPECT_EQ(tray->instances.size(), 2u);
  EXPECT_EQ(tray->left_out, std::vector<std::string>{"bad"});
  EXPECT_TRUE(tray->missing_faces.empty());
}

TEST_F(StepFaces, SaysWithTheLostFaceWhichNameFitsNoNode) {
  const auto tray = read(0, {"bda"});
  ASSERT_FALSE(tray);
  EXPECT_TRUE(contains(to_line(tray.error()), "no node of this file is called 'bda'"))
      << to_line(tray.error());
}

TEST_F(StepFaces, GoThroughTheSceneToTheWorld) {
  mesh::SceneReading reading;
  reading.missing_faces = 1;
  const auto scene = mesh::read_scene(std::array{path_}, std::nullopt, reading);
  ASSERT_TRUE(scene) << to_line(scene.error());
  ASSERT_EQ(scene->missing_faces.size(), 1u);
  EXPECT_NEAR(scene->missing_faces[0].center[0], 0.45, 1e-4);
  EXPECT_NEAR(scene->missing_faces[0].size, 0.101, 0.002);
  reading.without = {"bad", "sem"};
  const auto misspelled = mesh::read_scene(std::array{path_}, std::nullopt, reading);
  ASSERT_FALSE(misspelled);
  EXPECT_EQ(misspelled.error().code, ErrorCode::kSceneInvalid);
  const std::string line = to_line(misspelled.error());
  EXPECT_TRUE(contains(line, "no file has a node called 'sem'")) << line;
  EXPECT_TRUE(contains(line, "the nearest names are: tray/seam")) << line;
}

#endif

// Nodes left out of glTF, in any build.
constexpr const char* kNodes =
    R"([{"name":"top","children":[1,2,3]},{"name":"a","mesh":0},{"name":"b","children":[4]},)"
    R"({"name":"a","mesh":0},{"name":"leaf","mesh":0}])";

Result<mesh::Assembly> read_glb(std::vector<std::string> without) {
  const std::string bytes = as_glb(gltf_json(cube(), kNodes), gltf_binary(cube()));
  mesh::SourceFile file{"mesh.glb", bytes, {}};
  file.options.without = std::move(without);
  return mesh::read_source(file);
}

std::vector<std::string> names_of(const mesh::Assembly& assembly) {
  std::vector<std::string> names;
  for (const mesh::MeshInstance& instance : assembly.instances) names.push_back(instance.name);
  return names;
}

TEST(Without, LeavesOutANodeWithAllBelowIt) {
  using Names = std::vector<std::string>;
  const auto all = read_glb({});
  ASSERT_TRUE(all) << to_line(all.error());
  EXPECT_EQ(names_of(*all), (Names{"top/a", "top/b/leaf", "top/a[2]"}));
  const auto by_label = read_glb({"b", "a[2]"});
  ASSERT_TRUE(by_label);
  EXPECT_EQ(names_of(*by_label), Names{"top/a"});
  EXPECT_EQ(by_label->left_out, (Names{"b", "a[2]"}));
  EXPECT_TRUE(by_label->warnings.empty());
  const auto by_path = read_glb({"top/b/leaf"});
  ASSERT_TRUE(by_path);
  EXPECT_EQ(names_of(*by_path), (Names{"top/a", "top/a[2]"}));
}

TEST(Without, SaysThatNothingIsLeft) {
  const auto nothing = read_glb({"top"});
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, ErrorCode::kMeshEmpty);
  EXPECT_NE(nothing.error().what.find("--without leaves out all nodes"), std::string::npos);
}

TEST(Without, TakesNamesOfOtherFilesForUnknown) {
  const auto all = read_glb({"elsewhere"});
  ASSERT_TRUE(all);
  EXPECT_EQ(all->instances.size(), 3u);
  EXPECT_TRUE(all->left_out.empty());
}

TEST(Without, RefusesANameOfSeveralNodes) {
  const std::string nodes =
      R"([{"name":"top","children":[1,2]},{"name":"l","children":[3]},{"name":"r","children":[4]},)"
      R"({"name":"x","mesh":0},{"name":"x","mesh":0}])";
  const std::string bytes = as_glb(gltf_json(cube(), nodes), gltf_binary(cube()));
  mesh::SourceFile file{"mesh.glb", bytes, {}};
  file.options.without = {"x"};
  const auto several = mesh::read_source(file);
  ASSERT_FALSE(several);
  EXPECT_EQ(several.error().code, ErrorCode::kSceneInvalid);
  EXPECT_NE(to_line(several.error()).find("top/l/x, top/r/x"), std::string::npos);
}

// One length decides for the scene and for the part.
TEST(BakedDeflection, IsAHundredthOfAVoxel) {
  EXPECT_DOUBLE_EQ(mesh::baked_deflection_m(0.005), 5e-5);
}

}  // namespace
}  // namespace forcelayer
