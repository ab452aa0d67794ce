// Constructive solids of STEP: their volumes and boxes are those of the primitives that they are
// made of, by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/mesh/mesh_facts.h"
#include "tests/support/step_files.h"

namespace forcelayer {
namespace {

using namespace test;

#ifdef FORCELAYER_STEP

constexpr double kPi = std::numbers::pi;
constexpr double kBoxMm3 = 10 * 20 * 30;  // of step_box()

// The box of step_box() with the solid #9000 beside it, at a corner (100, 0, 0) named #9001, with
// axes #9002 and a line along z through it, #9003.
std::string with_solid(const std::string& entities) {
  const std::string text =
      replaced(step_box(), R"((ADVANCED_BREP_SHAPE_REPRESENTATION\('',\([^)]*)\))", "$1,#9000)");
  return with_entities(text,
                       "#9001=CARTESIAN_POINT('',(100.,0.,0.));\n"
                       "#9002=AXIS2_PLACEMENT_3D('',#9001,$,$);\n"
                       "#9003=AXIS1_PLACEMENT('',#9001,#9004);\n"
                       "#9004=DIRECTION('',(0.,0.,1.));\n" +
                           entities);
}

struct Read {
  double volume_mm3 = 0;  // beside the box
  mesh::Vec3d high_mm{};
};

Read read(const std::string& text) {
  const ScratchFolder folder;
  mesh::ReadOptions options;
  options.deflection_m = 1e-5;
  const auto assembly = mesh::read_assembly(write_file(folder / "a.step", text), options);
  if (!assembly) throw std::runtime_error(to_line(assembly.error()));
  Read read{-kBoxMm3, {-1e9, -1e9, -1e9}};
  for (const mesh::Mesh& mesh : assembly->meshes) {
    const mesh::MeshFacts facts = mesh::mesh_facts(mesh);
    EXPECT_TRUE(facts.closed);
    read.volume_mm3 += facts.signed_volume;
    for (const mesh::Vec3d& v : mesh.vertices) {
      for (int n = 0; n < 3; ++n) read.high_mm[n] = std::max(read.high_mm[n], v[n]);
    }
  }
  return read;
}

// Flat faces are exact; curved ones deviate by the deflection, 0.01 mm.
void expect_volume(double volume_mm3, const std::string& entities) {
  EXPECT_NEAR(read(with_solid(entities)).volume_mm3, volume_mm3, 1e-2 * volume_mm3) << entities;
}

TEST(StepConstructive, PrimitivesAreRead) {
  expect_volume(2 * 3 * 5, "#9000=CSG_SOLID('',#9005);\n#9005=BLOCK('',#9002,2.,3.,5.);\n");
  expect_volume(4.0 / 3 * kPi * 27, "#9000=CSG_SOLID('',#9005);\n#9005=SPHERE('',3.,#9001);\n");
  expect_volume(kPi * 4 * 7,
                "#9000=CSG_SOLID('',#9005);\n"
                "#9005=RIGHT_CIRCULAR_CYLINDER('',#9003,7.,2.);\n");
  expect_volume(2 * kPi * kPi * 5 * 4,
                "#9000=CSG_SOLID('',#9005);\n#9005=TORUS('',#9003,5.,2.);\n");
  // A trapezoid of 6 below and 2 above, 3 high, 5 deep.
  expect_volume((6 + 2) / 2.0 * 3 * 5,
                "#9000=CSG_SOLID('',#9005);\n"
                "#9005=RIGHT_ANGULAR_WEDGE('',#9002,6.,3.,5.,2.);\n");
}

TEST(StepConstructive, ThePrimitiveIsWhereItsAxesSay) {
  const Read wedge =
      read(with_solid("#9000=CSG_SOLID('',#9005);\n"
                      "#9005=RIGHT_ANGULAR_WEDGE('',#9002,6.,3.,50.,2.);\n"));
  EXPECT_NEAR(wedge.high_mm[0], 106, 1e-9);
  EXPECT_NEAR(wedge.high_mm[2], 50, 1e-9);
  const Read rod =
      read(with_solid("#9000=CSG_SOLID('',#9005);\n"
                      "#9005=RIGHT_CIRCULAR_CYLINDER('',#9003,70.,2.);\n"));
  EXPECT_NEAR(rod.high_mm[2], 70, 1e-9);
}

TEST(StepConstructive, BooleanResultsAreRead) {
  const std::string block = "#9000=CSG_SOLID('',#9010);\n#9005=BLOCK('',#9002,5.,5.,5.);\n";
  const double octant = 4.0 / 3 * kPi * 27 / 8;
  const std::string sphere = "#9006=SPHERE('',3.,#9001);\n";
  expect_volume(125 - octant,
                block + sphere + "#9010=BOOLEAN_RESULT('',.DIFFERENCE.,#9005,#9006);\n");
  expect_volume(7 * octant,
                block + sphere + "#9010=BOOLEAN_RESULT('',.DIFFERENCE.,#9006,#9005);\n");
  expect_volume(octant, block + sphere + "#9010=BOOLEAN_RESULT('',.INTERSECTION.,#9005,#9006);\n");
  expect_volume(125 + 7 * octant,
                block + sphere + "#9010=BOOLEAN_RESULT('',.UNION.,#9006,#9005);\n");
}

TEST(StepConstructive, HalfSpacesCut) {
  // The block below and above the plane z = 2: the flag is set where the normal leaves the
  // material.
  const std::string entities =
      "#9000=CSG_SOLID('',#9010);\n#9005=BLOCK('',#9002,5.,5.,5.);\n"
      "#9006=CARTESIAN_POINT('',(0.,0.,2.));\n#9007=AXIS2_PLACEMENT_3D('',#9006,#9004,$);\n"
      "#9008=PLANE('',#9007);\n";
  expect_volume(50, entities +
                        "#9009=HALF_SPACE_SOLID('',#9008,.T.);\n"
                        "#9010=BOOLEAN_RESULT('',.INTERSECTION.,#9005,#9009);\n");
  expect_volume(75, entities +
                        "#9009=HALF_SPACE_SOLID('',#9008,.F.);\n"
                        "#9010=BOOLEAN_RESULT('',.INTERSECTION.,#9009,#9005);\n");
  expect_volume(75, entities +
                        "#9009=HALF_SPACE_SOLID('',#9008,.T.);\n"
                        "#9010=BOOLEAN_RESULT('',.DIFFERENCE.,#9005,#9009);\n");
}

// A plate on a disc, with a hole through both.
constexpr const char* kTree =
    "#9000=CSG_SOLID('',#9010);\n#9010=BOOLEAN_RESULT('',.DIFFERENCE.,#9011,#9012);\n"
    "#9011=BOOLEAN_RESULT('',.UNION.,#9013,#9014);\n"
    "#9012=RIGHT_CIRCULAR_CYLINDER('',#9003,9.,1.);\n"
    "#9013=BLOCK('',#9002,4.,4.,2.);\n#9014=RIGHT_CIRCULAR_CYLINDER('',#9003,2.,3.);\n";
constexpr double kTreeMm3 = 2 * (16 + 0.75 * kPi * 9 - kPi);

TEST(StepConstructive, TreesOfTreesAreRead) { expect_volume(kTreeMm3, kTree); }

TEST(StepConstructive, TheUnitOfTheFileHolds) {
  const std::string text = replaced(with_solid(kTree), R"(\.MILLI\.,\.METRE\.)", ".CENTI.,.METRE.");
  EXPECT_NEAR(read(text).volume_mm3, 1000 * kTreeMm3 + 999 * kBoxMm3, 1e-2 * 1000 * kTreeMm3);
}

// A triangle of 3 by 4 in the plane through #9002.
constexpr const char* kTriangle =
    "#9010=PLANE('',#9002);\n#9011=CARTESIAN_POINT('',(103.,0.,0.));\n"
    "#9012=CARTESIAN_POINT('',(103.,4.,0.));\n#9013=POLYLINE('',(#9001,#9011,#9012,#9001));\n"
    "#9014=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#9013);\n"
    "#9015=OUTER_BOUNDARY_CURVE('',(#9014),.F.);\n"
    "#9016=CURVE_BOUNDED_SURFACE('',#9010,(#9015),.F.);\n";

TEST(StepConstructive, SweptAreasAreRead) {
  expect_volume(6 * 5,
                std::string(kTriangle) + "#9000=EXTRUDED_AREA_SOLID('rib',#9016,#9004,5.);\n");
  // Around an axis at x = 90: the centroid of the triangle is 12 from it (Pappus).
  expect_volume(6 * 12 * kPi / 2,
                std::string(kTriangle) +
                    "#9017=CARTESIAN_POINT('',(90.,0.,0.));\n#9018=DIRECTION('',(0.,1.,0.));\n"
                    "#9019=AXIS1_PLACEMENT('',#9017,#9018);\n"
                    "#9000=REVOLVED_AREA_SOLID('ring',#9016,#9019,1.5707963267948966);\n");
}

#endif

}  // namespace
}  // namespace forcelayer
