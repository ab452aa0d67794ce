// Tessellated geometry of AP242.
#include <gtest/gtest.h>

#include "formats/mesh/mesh_facts.h"
#include "tests/support/step_files.h"

namespace forcelayer {
namespace {

using namespace test;

#ifdef FORCELAYER_STEP

// A tetrahedron of volume 1000/6 beside the box of step_box(), as solid #9103.
constexpr const char* kTetrahedron =
    "#9101=COORDINATES_LIST('',4,((100.,0.,0.),(110.,0.,0.),(100.,10.,0.),(100.,0.,10.)));\n"
    "#9102=TRIANGULATED_FACE('',#9101,4,(),$,(),((1,3,2),(1,2,4),(2,3,4),(1,4,3)));\n"
    "#9103=TESSELLATED_SOLID('lid',(#9102),$);\n";
constexpr const char* kItsShape = "#9104=TESSELLATED_SHAPE_REPRESENTATION('',(#9103),#345);\n";
constexpr double kBoxMm3 = 6000, kTetrahedronMm3 = 1000.0 / 6;

// The box's product with the shape #`shape` in place of the box.
std::string without_box(const std::string& shape) {
  // Everything from the shape #10 to the context #345 is the box.
  std::string text = step_box();
  const auto begin = text.find("#10 = ADVANCED_BREP"), end = text.find("#345 = ");
  text.erase(begin, end - begin);
  return replaced(text, R"(REPRESENTATION\(#4,#10\))", "REPRESENTATION(#4," + shape + ")");
}

Result<mesh::Assembly> read_text_as_step(const std::string& text) {
  const ScratchFolder folder;
  return mesh::read_assembly(write_file(folder / "a.step", text));
}

void expect_mesh(const std::string& text, std::size_t triangles, double volume_mm3) {
  const auto assembly = read_text_as_step(text);
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  ASSERT_EQ(assembly->instances.size(), 1u);
  const mesh::MeshFacts facts = mesh::mesh_facts(assembly->meshes[0]);
  EXPECT_EQ(facts.triangles, triangles);
  EXPECT_TRUE(facts.closed);
  EXPECT_TRUE(facts.consistently_oriented);
  EXPECT_NEAR(facts.signed_volume / volume_mm3, 1, 1e-12);
}

void expect_lost(const std::string& text, const std::string& what) {
  const auto assembly = read_text_as_step(text);
  ASSERT_FALSE(assembly);
  EXPECT_EQ(assembly.error().code, ErrorCode::kMeshIncomplete);
  EXPECT_NE(assembly.error().what.find(what), std::string::npos) << to_line(assembly.error());
}

TEST(StepTriangles, BesideAnExactSolidAreRead) {
  const std::string listed = with_entities(
      replaced(step_box(), R"((ADVANCED_BREP_SHAPE_REPRESENTATION\('',\([^)]*)\))", "$1,#9103)"),
      kTetrahedron);
  const std::string related =
      with_entities(step_box(), std::string(kTetrahedron) + kItsShape +
                                    "#9105=SHAPE_REPRESENTATION_RELATIONSHIP('','',#10,#9104);\n");
  for (const std::string& text : {listed, related}) {
    expect_mesh(text, 12 + 4, kBoxMm3 + kTetrahedronMm3);
    const auto assembly = read_text_as_step(text);
    ASSERT_EQ(assembly->warnings.size(), 1u);
    EXPECT_NE(assembly->warnings[0].find("triangles in place of exact surfaces"),
              std::string::npos);
  }
}

TEST(StepTriangles, AloneAreRead) {
  const std::string text =
      with_entities(without_box("#9104"), std::string(kTetrahedron) + kItsShape);
  expect_mesh(text, 4, kTetrahedronMm3);
  const std::string related = with_entities(
      without_box("#9106"),
      std::string(kTetrahedron) + kItsShape +
          "#9105=SHAPE_REPRESENTATION_RELATIONSHIP('','',#9104,#9106);\n"
          "#9106=SHAPE_REPRESENTATION('',(#9107),#345);\n"
          "#9107=AXIS2_PLACEMENT_3D('',#9108,$,$);\n#9108=CARTESIAN_POINT('',(0.,0.,0.));\n");
  expect_mesh(related, 4, kTetrahedronMm3);
}

TEST(StepTriangles, HaveTheUnitOfTheirShape) {
  const std::string text =
      with_entities(without_box("#9104"), std::string(kTetrahedron) + kItsShape);
  expect_mesh(replaced(text, R"(SI_UNIT\(\.MILLI\.,\.METRE\.\))", "SI_UNIT($,.METRE.)"), 4,
              kTetrahedronMm3 * 1e9);
}

// The exact solid that they stand for is there; they are not a second one.
TEST(StepTriangles, ThatStandForAnExactSolidAreNotReadTwice) {
  const std::string related =
      std::string(kItsShape) + "#9105=SHAPE_REPRESENTATION_RELATIONSHIP('','',#10,#9104);\n";
  const std::string of_solid =
      replaced(kTetrahedron, R"(\(#9102\),\$)", "(#9102),#15");                // the box's solid
  const std::string of_face = replaced(kTetrahedron, R"(\(\),\$)", "(),#17");  // one of its faces
  expect_mesh(with_entities(step_box(), of_solid + related), 12, kBoxMm3);
  expect_mesh(with_entities(step_box(), of_face + related), 12, kBoxMm3);
}

TEST(StepTriangles, ThatAreDamagedOrNowhereAreNamed) {
  const std::string lost = "1 solid: #9103 TESSELLATED_SOLID 'lid'";
  const std::string shape = kItsShape;
  for (const std::string& damaged :
       {replaced(kTetrahedron, R"(\(1,4,3\))", "(1,4,5)"),
        replaced(kTetrahedron, R"(\(1,4,3\))", "(1,4,0)"),
        replaced(kTetrahedron, R"(\(1,4,3\))", "(1,4)"),
        replaced(kTetrahedron, R"(\(1,4,3\))", "(1,4,3.5)"),
        replaced(kTetrahedron, "'',#9101", "'',$"),
        replaced(kTetrahedron, R"(,\(\(1,3)", ",(),((1,3"),
        replaced(kTetrahedron, "TRIANGULATED_FACE", "CUBIC_BEZIER_TRIANGULATED_FACE")}) {
    expect_lost(with_entities(without_box("#9104"), damaged + shape), lost);
  }
  // No shape lists it.
  expect_lost(with_entities(step_box(), kTetrahedron),
              "1 productless solid: #9103 TESSELLATED_SOLID 'lid'");
  for (const char* no_point :
       {"$1(0.,0.,$$)", "$1(0.,0.,'x')", "$1(0.,0.)", "$1()", "$1(0.,0.,/*one*/0.,0.)"}) {
    const std::string damaged =
        replaced(kTetrahedron, R"((COORDINATES_LIST\('',4,\()\([^)]*\))", no_point);
    expect_lost(with_entities(without_box("#9104"), damaged + shape),
                "1 damaged entity: #9101 COORDINATES_LIST");
  }
  const std::string of_itself = replaced(kTetrahedron, R"(\(#9102\))", "(#9103)");
  expect_lost(with_entities(without_box("#9104"), of_itself + shape), "#9103 TESSELLATED_SOLID");
}

// The eight corners of a cube of 10 mm, and its sides, counterclockwise from outside.
constexpr const char* kCorners =
    "#9101=COORDINATES_LIST('',8,((0.,0.,0.),(10.,0.,0.),(0.,10.,0.),(10.,10.,0.),"
    "(0.,0.,10.),(10.,0.,10.),(0.,10.,10.),(10.,10.,10.)));\n";
constexpr int kSides[6][4] = {{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5},
                              {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}};
constexpr const char* kNormals[6] = {"(0.,0.,-1.)", "(0.,0.,1.)",  "(0.,-1.,0.)",
                                     "(0.,1.,0.)",  "(-1.,0.,0.)", "(1.,0.,0.)"};

// The cube with a face for each side, each with its corners in the order `order` as a strip or, in
// every other face, a fan; with normals where asked for.
std::string cube_of_faces(const std::array<int, 4>& strip, const std::array<int, 4>& fan,
                          bool has_normals) {
  std::string text = kCorners, faces;
  for (int side = 0; side < 6; ++side) {
    const bool is_fan = side % 2 == 1;
    std::string corners;
    for (const int corner : is_fan ? fan : strip) {
      corners += (corners.empty() ? "" : ",") + std::to_string(kSides[side][corner]);
    }
    // Points of a face are counted in its own list: here backwards through the corners.
    std::string numbers;
    for (const int corner : is_fan ? fan : strip) {
      numbers += (numbers.empty() ? "" : ",") + std::to_string(9 - kSides[side][corner]);
    }
    const bool has_list = side < 3;
    const std::string number = "#" + std::to_string(9110 + side);
    text += number + "=COMPLEX_TRIANGULATED_FACE('',#9101,8,(" +
            (has_normals ? kNormals[side] : "") + "),$,(" + (has_list ? "8,7,6,5,4,3,2,1" : "") +
            ")," + (is_fan ? "()," : "") + "((" + (has_list ? numbers : corners) + "))" +
            (is_fan ? "" : ",()") + ");\n";
    faces += (faces.empty() ? "" : ",") + number;
  }
  return with_entities(without_box("#9104"),
                       text + "#9109=TESSELLATED_SHELL('',(" + faces + "),$);\n" +
                           "#9103=TESSELLATED_SOLID('cube',(#9109),$);\n" + kItsShape);
}

TEST(StepTriangles, InStripsAndFansFaceOutwards) {
  constexpr std::array<int, 4> kStrip = {0, 3, 1, 2}, kStripTurned = {0, 1, 3, 2};
  constexpr std::array<int, 4> kFan = {0, 3, 2, 1}, kFanTurned = {0, 1, 2, 3};
  expect_mesh(cube_of_faces(kStrip, kFan, false), 12, 1000);
  expect_mesh(cube_of_faces(kStrip, kFan, true), 12, 1000);
  expect_mesh(cube_of_faces(kStripTurned, kFanTurned, true), 12, 1000);
}

TEST(StepTriangles, OfAnAnnotationAreNoShape) {
  const std::string surface =
      std::string(kCorners) +
      "#9102=COMPLEX_TRIANGULATED_SURFACE_SET('',#9101,8,(),(),((1,2,3,4)),());\n"
      "#9103=TESSELLATED_GEOMETRIC_SET('',(#9102));\n";
  expect_mesh(
      with_entities(step_box(), surface + "#9104=TESSELLATED_ANNOTATION_OCCURRENCE('',(),#9103);\n"
                                          "#9105=DRAUGHTING_MODEL('',(#9104),#345);\n"),
      12, kBoxMm3);
  // In the shape they are one, and one that is not read is named.
  expect_lost(
      with_entities(step_box(), surface + kItsShape +
                                    "#9105=SHAPE_REPRESENTATION_RELATIONSHIP('','',#10,#9104);\n"),
      "#9102 COMPLEX_TRIANGULATED_SURFACE_SET");
}

// A part of an assembly that is nothing but triangles stands where its occurrences are.
TEST(StepTriangles, StandInAssemblies) {
  const ScratchFolder folder;
  run_in(folder.path(), "make_step_assembly clamp.step MM external");
  const std::string nut = "#75 = ";  // the shape of the nut, empty: its file holds it
  const std::string text = with_entities(
      replaced(read_text(folder / "clamp.step"), nut + R"(SHAPE_REPRESENTATION\('',\(#11\))",
               nut + "TESSELLATED_SHAPE_REPRESENTATION('',(#11,#9103)"),
      kTetrahedron);
  const auto assembly = mesh::read_assembly(write_file(folder / "a.step", text));
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  ASSERT_EQ(assembly->instances.size(), 18u);
  const mesh::MeshInstance& second = assembly->instances[1];
  EXPECT_EQ(second.name, "clamp/rod-assembly_1/nut_2");
  EXPECT_EQ(assembly->meshes[second.mesh].triangles.size(), 4u);
  EXPECT_NEAR(second.assembly_from_mesh.translation[2], 202, 1e-9);
  ASSERT_EQ(assembly->warnings.size(), 2u);
  EXPECT_NE(assembly->warnings[0].find("its file 'nut.stp' was not read"), std::string::npos);
}

#endif

}  // namespace
}  // namespace forcelayer
