// Parts of a STEP or IGES file that OpenCASCADE leaves out are errors that name them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>

#include "formats/mesh/mesh_facts.h"
#include "tests/support/models.h"
#include "tests/support/step_files.h"

namespace forcelayer {
namespace {

using namespace test;

#ifdef FORCELAYER_STEP

// The error of reading `text`; "" where it is read.
std::string error_of(const std::string& text, const std::string& extension) {
  const ScratchFolder folder;
  const auto assembly = mesh::read_assembly(write_file(folder / ("a" + extension), text));
  if (assembly) return "";
  EXPECT_EQ(assembly.error().code, ErrorCode::kMeshIncomplete) << to_line(assembly.error());
  return to_line(assembly.error());
}

std::string step_error(const std::string& text) { return error_of(text, ".step"); }
std::string iges_error(const std::string& text) { return error_of(text, ".igs"); }

void expect_in(const std::string& part, const std::string& text) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

// ", `item`" at the end of the items of the box's shape.
std::string with_item(const std::string& text, const std::string& item) {
  return replaced(text, R"((ADVANCED_BREP_SHAPE_REPRESENTATION\('',\([^)]*)\))",
                  "$1," + item + ")");
}

constexpr const char* kFrame =
    "#9002=AXIS2_PLACEMENT_3D('',#9003,$,$);\n#9003=CARTESIAN_POINT('',(100.,0.,0.));\n";

TEST(StepLosses, OfASoundFileThereAreNone) {
  EXPECT_EQ(step_error(step_box()), "");
  EXPECT_EQ(iges_error(iges_box(false)), "");
  EXPECT_EQ(iges_error(iges_box(true)), "");
}

TEST(StepLosses, AConstructiveSolid) {
  const std::string cone =
      with_entities(with_item(step_box(), "#9004"),
                    std::string(kFrame) +
                        "#9005=DIRECTION('',(0.,0.,1.));\n#9006=AXIS1_PLACEMENT('',#9003,#9005);\n"
                        "#9001=RIGHT_CIRCULAR_CONE('tip',#9006,5.,1.,0.5);\n"
                        "#9004=CSG_SOLID('lid',#9001);\n");
  expect_in("1 solid: #9004 CSG_SOLID 'lid'", step_error(cone));
  // Only the root of a tree is named.
  const std::string tree = with_entities(
      with_item(step_box(), "#9004"),
      std::string(kFrame) +
          "#9001=BLOCK('',#9002,5.,5.,5.);\n#9005=PLANE('',#9002);\n"
          "#9007=HALF_SPACE_SOLID('',#9005,.T.);\n"
          "#9006=BOOLEAN_RESULT('',.UNION.,#9001,#9007);\n#9004=CSG_SOLID('lid',#9006);\n");
  expect_in("1 solid: #9004 CSG_SOLID 'lid' (", step_error(tree));
  // A solid that no shape lists.
  const std::string alone =
      with_entities(step_box(), std::string(kFrame) + "#9001=BLOCK('block',#9002,5.,5.,5.);\n");
  expect_in("1 solid: #9001 BLOCK 'block'", step_error(alone));
}

// Triangles of AP242 in place of a solid are lost, those beside the exact solid are not.
TEST(StepLosses, ATessellatedSolid) {
  const auto with_triangles = [](const std::string& link) {
    return with_entities(
        step_box(),
        "#9001=COORDINATES_LIST('',4,((0.,0.,0.),(9.,0.,0.),(0.,9.,0.),(0.,0.,9.)));\n"
        "#9002=TRIANGULATED_FACE('',#9001,4,(),$,(),((1,3,2),(1,2,4),(2,3,4),(1,4,3)));\n"
        "#9003=TESSELLATED_SOLID('lid',(#9002)," +
            link + ");\n#9004=TESSELLATED_SHAPE_REPRESENTATION('',(#9003),#345);\n");
  };
  expect_in("1 solid: #9003 TESSELLATED_SOLID 'lid'", step_error(with_triangles("$")));
  EXPECT_EQ(step_error(with_triangles("#15")), "");
}

TEST(StepLosses, ASurfaceThatStandsAlone) {
  const std::string text =
      with_entities(with_item(step_box(), "#9005"),
                    std::string(kFrame) +
                        "#9001=PLANE('',#9002);\n"
                        "#9005=RECTANGULAR_TRIMMED_SURFACE('lid',#9001,0.,5.,0.,5.,.T.,.T.);\n");
  expect_in("1 solid: #9005 RECTANGULAR_TRIMMED_SURFACE 'lid'", step_error(text));
  const std::string in_a_set =
      with_entities(replaced(text, R"(,#9005\))", ",#9006)"), "#9006=GEOMETRIC_SET('',(#9005));\n");
  EXPECT_EQ(step_error(in_a_set), "");
}

TEST(StepLosses, ASolidOfANewerSchema) {
  const std::string text =
      with_entities(with_item(step_box(), "#9001"),
                    std::string(kFrame) +
                        "#9001=EXTRUDED_AREA_SOLID_TAPERED('rib',#9002,#9003,1.,#9002);\n"
                        "#9005=ELLIPSOID('egg',#9002,1.,2.,3.);\n");
  expect_in("2 solids: #9001 EXTRUDED_AREA_SOLID_TAPERED 'rib', #9005 ELLIPSOID 'egg'",
            step_error(text));
}

TEST(StepLosses, DamagedEntitiesAreNamed) {
  const std::string box = step_box();
  const std::string damaged = "OpenCASCADE could not read 1 damaged entity: ";
  for (const auto& [pattern, by, entity] :
       {std::tuple{" = PLANE\\(", " = PLANX(", "#17 ADVANCED_FACE"},
        {" = ADVANCED_FACE", " = ADVANCED_FACX", "#16 CLOSED_SHELL"},
        {"#17 = ADVANCED_FACE[^;]*;", "", "#16 CLOSED_SHELL"},
        {R"( = VECTOR\('',#\d+)", " = VECTOR('',#9999", "#"},
        {R"(_REPRESENTATION\(#4,#10\))", "_REPRESENTATION(#9999,#10)",
         "#3 SHAPE_DEFINITION_REPRESENTATION"},
        {R"( = LINE\('',#\d+)", " = LINE('',$", "#"},
        {R"(#17 = ADVANCED_FACE\('',\(#\d+\))", "#17 = ADVANCED_FACE('',(#9999)",
         "#17 ADVANCED_FACE"},
        // OpenCASCADE would take it for 0.
        {R"(\('',\(10.,20.,30.\)\))", "('',(10.,20.,'x'))", "#196 CARTESIAN_POINT"},
        // OpenCASCADE would take it for true.
        {R"((#17 = ADVANCED_FACE\('',\(#18\),#32,).F.\))", "$017)", "#17 ADVANCED_FACE"}}) {
    expect_in(damaged + entity, step_error(replaced(box, pattern, by)));
  }
  expect_in(damaged + "#10 ADVANCED_BREP_SHAPE_REPRESENTATION",
            step_error(with_item(box, "#9999")));
  // A face that its shell does not list.
  expect_in("1 of 6 faces: #17 ADVANCED_FACE",
            step_error(replaced(box, R"(CLOSED_SHELL\('',\(#17,)", "CLOSED_SHELL('',(")));
  expect_in("6 of 6 faces: #17 ADVANCED_FACE",
            step_error(replaced(box, "MANIFOLD_SOLID_BREP", "MANIFOLD_SOLID_BREX")));
}

// The warnings of reading `text`.
std::vector<std::string> warnings_of(const std::string& text, const std::string& extension) {
  const ScratchFolder folder;
  const auto assembly = mesh::read_assembly(write_file(folder / ("a" + extension), text));
  EXPECT_TRUE(assembly) << to_line(assembly.error());
  return assembly ? assembly->warnings : std::vector<std::string>{};
}

TEST(StepLosses, NoUnitOfLengthIsTold) {
  const std::string box = step_box();
  for (const std::string& text :
       {replaced(box, R"(SI_UNIT\(.MILLI.,.METRE.\))", "SI_UNITS(.MILLI.,.METRE.)"),
        replaced(box, R"(GLOBAL_UNIT_ASSIGNED_CONTEXT\s*\(\([^)]*\)\))", "")}) {
    const auto warnings = warnings_of(text, ".step");
    ASSERT_EQ(warnings.size(), 1u);
    expect_in("#10 ADVANCED_BREP_SHAPE_REPRESENTATION has no known unit of length", warnings[0]);
  }
  EXPECT_TRUE(warnings_of(box, ".step").empty());
}

// OpenCASCADE takes each of them for a meter.
TEST(StepLosses, AnOddUnitIsTold) {
  const std::string box = step_box();
  for (const char* unit : {"SI_UNIT(.MILLI.,.SECOND.)", "SI_UNIT(.MILLI.)",
                           "SI_UNIT(.METRE.,.MILLI.)", "SI_UNIT(.SECOND.,.METRE.)"}) {
    const auto warnings =
        warnings_of(replaced(box, R"(SI_UNIT\(.MILLI.,.METRE.\))", unit), ".step");
    ASSERT_EQ(warnings.size(), 1u) << unit;
    expect_in(" is not a plausible unit of length: check the model's size", warnings[0]);
  }
  const auto angle = warnings_of(replaced(box, ".RADIAN.", ".SECOND."), ".step");
  ASSERT_EQ(angle.size(), 1u);
  expect_in(" is not a plausible unit of angle", angle[0]);
  for (const char* unit : {"SI_UNIT($,.METRE.)", "SI_UNIT(.CENTI.,.METRE.)"}) {
    EXPECT_TRUE(warnings_of(replaced(box, R"(SI_UNIT\(.MILLI.,.METRE.\))", unit), ".step").empty());
  }
}

TEST(IgesLosses, UnitsThatContradictAndAScaleAreTold) {
  const std::string box = iges_box(true);
  EXPECT_TRUE(warnings_of(box, ".igs").empty());
  const auto named = warnings_of(replaced(box, "1\\.,2,2HMM,", "1.,2,2HIN,"), ".igs");
  ASSERT_EQ(named.size(), 1u);
  expect_in("the file's unit name 'IN' and unit code 2 contradict each other", named[0]);
  const auto scaled = warnings_of(replaced(box, "1\\.,2,2HMM,", "2.,2,2HMM,"), ".igs");
  ASSERT_EQ(scaled.size(), 1u);
  expect_in("drawn to a scale of 2", scaled[0]);
}

// The losses of the plate of the assembly, and the faces that are missing then.
struct LossOfPlate {
  const char *pattern, *by;
  std::size_t pieces, triangles;  // of the plate's 12
};

TEST(StepLosses, LeaveAWayOutByNodeAndByNumber) {
  const ScratchFolder folder;
  run_in(folder.path(), "make_step_assembly clamp.step");
  const std::string clamp = read_text(folder / "clamp.step");
  const std::size_t plate = clamp.find("PRODUCT('plate'");
  constexpr std::size_t kInstances = 18, kTriangles = 3720;
  for (const auto& [pattern, by, pieces, triangles] :
       {LossOfPlate{R"((CLOSED_SHELL\('',\()#\d+,)", "$1", 1, 10},
        {"MANIFOLD_SOLID_BREP", "MANIFOLD_SOLID_BREX", 6, 0}}) {
    const std::string path = write_file(
        folder / "a.step", clamp.substr(0, plate) + replaced(clamp.substr(plate), pattern, by));
    const auto refused = mesh::read_assembly(path);
    ASSERT_FALSE(refused) << pattern;
    if (pieces > 1) expect_in("clamp/plate_1", to_line(refused.error()));
    expect_in("--missing-faces " + std::to_string(pieces), to_line(refused.error()));
    EXPECT_FALSE(mesh::read_assembly(path, {.missing_faces = pieces - 1})) << pattern;
    const auto accepted = mesh::read_assembly(path, {.missing_faces = pieces});
    ASSERT_TRUE(accepted) << to_line(accepted.error());
    EXPECT_EQ(accepted->missing_faces.size(), pieces) << pattern;
    EXPECT_EQ(accepted->triangle_count(), kTriangles - 12 + triangles) << pattern;
    for (const mesh::MissingFace& face : accepted->missing_faces) {
      EXPECT_EQ(face.node, pieces > 1 ? "clamp/plate_1" : "");  // no solid lists the other one
    }
    const auto without = mesh::read_assembly(path, {.without = {"plate_1"}});
    if (!accepted->missing_faces.back().node.empty()) {
      ASSERT_TRUE(without) << to_line(without.error());
      EXPECT_EQ(without->instances.size(), kInstances - 1);
      EXPECT_TRUE(without->missing_faces.empty());
    }
  }
}

// The box placed twice by mapped items, which AP203 assemblies use; `target` places the second.
std::string twice_mapped(const std::string& target) {
  return with_entities(
      replaced(step_box(), R"(SHAPE_DEFINITION_REPRESENTATION\((#\d+),#10\))",
               "SHAPE_DEFINITION_REPRESENTATION($1,#9200)"),
      "#9200=SHAPE_REPRESENTATION('',(#9202,#9203,#9204),#345);\n"
      "#9201=REPRESENTATION_MAP(#9204,#10);\n"
      "#9202=MAPPED_ITEM('one',#9201,#9205);\n#9203=MAPPED_ITEM('two',#9201,#9207);\n"
      "#9204=AXIS2_PLACEMENT_3D('',#9208,$,$);\n#9205=AXIS2_PLACEMENT_3D('',#9206,$,$);\n"
      "#9206=CARTESIAN_POINT('',(100.,0.,0.));\n#9207=" +
          target +
          "\n#9208=CARTESIAN_POINT('',(0.,0.,0.));\n#9209=CARTESIAN_POINT('',(200.,0.,0.));\n"
          "#9210=DIRECTION('',(-1.,0.,0.));\n#9211=DIRECTION('',(0.,1.,0.));\n"
          "#9212=DIRECTION('',(0.,0.,1.));\n");
}

TEST(StepLosses, MappedItemsAreReadOrNamed) {
  const ScratchFolder folder;
  const auto placed = mesh::read_assembly(
      write_file(folder / "a.step", twice_mapped("AXIS2_PLACEMENT_3D('',#9209,$,$);")));
  ASSERT_TRUE(placed) << to_line(placed.error());
  ASSERT_EQ(placed->instances.size(), 2u);
  EXPECT_EQ(placed->instances[0].assembly_from_mesh.translation, (mesh::Vec3d{100, 0, 0}));
  EXPECT_EQ(placed->instances[1].assembly_from_mesh.translation, (mesh::Vec3d{200, 0, 0}));
  const std::string lost = "1 placing: #9203 MAPPED_ITEM 'two'";
  for (const char* target :
       {"CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',$,$,#9209,2.,$);",              // scaled
        "CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',#9210,#9211,#9209,1.,#9212);",  // mirrored
        "CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',#9210,$,#9209,1.,$);",  // axes left out
        "NO_SUCH_PLACEMENT('',#9209);"}) {
    expect_in(lost, step_error(twice_mapped(target)));
  }
}

// OpenCASCADE crashes on it where it reads properties.
TEST(StepLosses, ADamagedPropertyLosesNoShape) {
  const ScratchFolder folder;
  const auto box = mesh::read_assembly(write_file(
      folder / "a.step",
      with_entities(step_box(),
                    "#9001=PROPERTY_DEFINITION('geometric validation property','area "
                    "measure',#4);\n#9002=PROPERTY_DEFINITION_REPRESENTATION(#9001,$);\n")));
  ASSERT_TRUE(box) << to_line(box.error());
  EXPECT_EQ(box->triangle_count(), 12u);
  EXPECT_TRUE(box->warnings.empty());
}

TEST(StepLosses, OccurrencesWithoutAPlacing) {
  const ScratchFolder folder;
  run_in(folder.path(), "make_step_assembly clamp.step");
  const std::string clamp = read_text(folder / "clamp.step");
  expect_in("1 placing: #", step_error(replaced(clamp, "ITEM_DEFINED_TRANSFORMATION",
                                                "FREELY_DEFINED_TRANSFORMATION")));
  // Without the entity that ties the occurrence to its placing the part stands nowhere.
  expect_in(
      "NEXT_ASSEMBLY_USAGE_OCCURRENCE",
      step_error(replaced(clamp, R"(#\d+ = CONTEXT_DEPENDENT_SHAPE_REPRESENTATION[^;]*;)", "")));
  // Nor where the occurrence is not there, and its placing is of nothing.
  expect_in(
      " CONTEXT_DEPENDENT_SHAPE_REPRESENTATION",
      step_error(replaced(
          clamp, R"(#\d+ = NEXT_ASSEMBLY_USAGE_OCCURRENCE\([^;]*'bracket-assembly_2'[^;]*;)", "")));
  // Nor where the occurrence is of nothing, or in nothing.
  for (const char* by : {"$1$$,#70,$3", "$1#1931,$$,$3", "$1#99999,#70,$3"}) {
    expect_in(
        "1 damaged entity: #2559 NEXT_ASSEMBLY_USAGE_OCCURRENCE",
        step_error(replaced(
            clamp, R"((#2559 = NEXT_ASSEMBLY_USAGE_OCCURRENCE\([^#]*)(#1931,#70,)(\$))", by)));
  }
}

// Properties by which receivers check volumes have a shape of their own, of no product, which lists
// the solid of a product once more.
TEST(StepLosses, AShapeThatOnlyRepeatsASolidLosesNothing) {
  const ScratchFolder folder;
  run_in(folder.path(), "make_step_assembly clamp.step");
  const std::string clamp = read_text(folder / "clamp.step");
  const std::string repeating = with_entities(
      replaced(clamp, R"(#75 = ADVANCED_BREP_SHAPE_REPRESENTATION\('',\((#\d+),(#\d+)\),(#\d+)\);)",
               "$&\n#9001=SHAPE_REPRESENTATION('',($2),$3);\n"
               "#9002=SHAPE_DEFINITION_REPRESENTATION(#9003,#9001);"),
      "#9003=PROPERTY_DEFINITION('','solid data',#9004);\n"
      "#9004=SHAPE_ASPECT('','solid data',#69,.F.);\n");
  const auto assembly = mesh::read_assembly(write_file(folder / "a.step", repeating));
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  const auto whole = mesh::read_assembly(folder / "clamp.step");
  ASSERT_TRUE(whole) << to_line(whole.error());
  EXPECT_EQ(assembly->instances.size(), whole->instances.size());
  EXPECT_EQ(assembly->triangle_count(), whole->triangle_count());
}

TEST(IgesLosses, ADamagedEntityIsNamed) {
  const std::string loose = iges_box(false), solid = iges_box(true);
  const std::string damaged = "OpenCASCADE could not read 1 damaged entity: ";
  for (const auto& [entry, parameters] :
       {std::pair{21, "108,x,y,z;"}, {19, "144,0,1,0,23;"}, {19, "144,21,0,0;"}}) {
    expect_in(damaged + "D" + std::to_string(entry),
              iges_error(with_parameters(loose, entry, parameters)));
  }
  for (const auto& [entry, parameters] : {std::pair{45, "510,0,1,1,0;"},
                                          {45, "510,0,1,1,55;"},
                                          {15, "508,1,0,47,1,1,0;"},
                                          {15, "508,8,0,17,1,0,0,0,17,2,1,0;"},
                                          {3, "514,1,17,1;"},
                                          {47, "190,0,0;"}}) {
    expect_in(damaged + "D" + std::to_string(entry),
              iges_error(with_parameters(solid, entry, parameters)));
  }
}

TEST(IgesLosses, LeaveAWayOut) {
  const ScratchFolder folder;
  const std::string loose = iges_box(false);
  const std::string lost = "1 of 6 faces: D19 (type 144)";
  for (const char* parameters : {"108,0.,0.,0.,0.,0,0.,0.,0.,0.;", ""}) {
    const std::string text = *parameters != 0 ? with_parameters(loose, 21, parameters)
                                              : with_parameters(loose, 19, "144,27,1,0,23;");
    expect_in(lost, iges_error(text));
    const auto accepted =
        mesh::read_assembly(write_file(folder / "a.igs", text), {.missing_faces = 1});
    ASSERT_TRUE(accepted) << to_line(accepted.error());
    EXPECT_EQ(accepted->triangle_count(), 10u);
    ASSERT_EQ(accepted->missing_faces.size(), 1u);
    EXPECT_NEAR(accepted->missing_faces[0].size, std::sqrt(1400), 0.1);  // the node's 10 x 20 x 30
  }
  // The boundary tells of a face that is not a face any more.
  expect_in("1 faceless boundary: D23 (type 142)", iges_error(with_type(loose, 19, "999")));
}

TEST(IgesLosses, AnExternalReference) {
  const std::string text =
      with_type(with_parameters(iges_box(false), 19, "416,8Hbolt.igs;"), 19, "416");
  expect_in("1 external reference: D19 (type 416)", iges_error(text));
}

TEST(IgesLosses, AConstructiveSolid) {
  // The group's first face becomes a block of its own.
  const std::string text =
      with_type(with_parameters(iges_box(false), 19, "150,5.,5.,5.;"), 19, "150");
  expect_in("1 solid: D19 (type 150)", iges_error(text));
}

// OpenCASCADE bends such an edge, and gives a face half of its triangles. The deviation covers it.
TEST(IgesLosses, AnEdgeThatLeavesItsFacesIsTold) {
  const ScratchFolder folder;
  const std::string text = with_parameters(iges_box(true), 33, "110,9999.,20.,0.,10.,20.,30.;");
  const auto box = mesh::read_assembly(write_file(folder / "a.igs", text));
  ASSERT_TRUE(box) << to_line(box.error());
  ASSERT_EQ(box->warnings.size(), 1u);
  expect_in("an edge lies up to 10 mm from its faces", box->warnings[0]);
  EXPECT_GE(box->deviation_units(), 10);
  // A listing takes the size of the shape from its triangles: the box of the edge is 40 m large.
  mesh::ReadOptions listing;
  listing.deflection_m = mesh::kDeflectionBySize;
  const auto listed = mesh::read_assembly((folder / "a.igs").string(), listing);
  ASSERT_TRUE(listed) << to_line(listed.error());
  EXPECT_EQ(listed->warnings, box->warnings);
}

// The edge begins at another corner: OpenCASCADE gives its corner a tolerance of 10 mm, leaves a
// triangle out and finds no deflection.
TEST(IgesLosses, AnEdgeThatOnlyItsToleranceTiesIsTold) {
  const ScratchFolder folder;
  const std::string text = replaced(iges_box(true), "110,10\\.,20\\.,0\\.,10\\.,20\\.,30\\.; ",
                                    "110,0.,20.,0.,10.,20.,30.;  ");
  const auto box = mesh::read_assembly(write_file(folder / "a.igs", text));
  ASSERT_TRUE(box) << to_line(box.error());
  ASSERT_EQ(box->warnings.size(), 1u);
  expect_in("an edge lies up to 10 mm from its faces", box->warnings[0]);
  EXPECT_GE(box->deviation_units(), 10);
}

// OpenCASCADE leaves a triangle of twelve out, and takes the edge for 3.33 mm off.
TEST(IgesLosses, AHoleBesideADamagedEdgeIsTold) {
  const ScratchFolder folder;
  const std::string text = with_parameters(iges_box(true), 39, "110,0.,0.,30.,10.,0.,15.;");
  const auto box = mesh::read_assembly(write_file(folder / "a.igs", text));
  ASSERT_TRUE(box) << to_line(box.error());
  EXPECT_EQ(box->triangle_count(), 11u);
  ASSERT_EQ(box->warnings.size(), 1u);
  expect_in("an edge lies up to 4.74 mm from its faces", box->warnings[0]);
  EXPECT_GE(box->deviation_units(), 4.74);
}

// The line ends 0.9 mm beside the corner, and the reader bends it.
TEST(IgesLosses, ASewnEdgeThatLeavesItsFacesIsTold) {
  const ScratchFolder folder;
  const std::string text = with_parameters(iges_box(false), 11, "110,0.,20.,0.,0.,0.,0.9;");
  mesh::ReadOptions options;
  options.deflection_m = 5e-5;
  const auto box = mesh::read_assembly(write_file(folder / "a.igs", text), options);
  ASSERT_TRUE(box) << to_line(box.error());
  ASSERT_GE(box->warnings.size(), 1u);
  expect_in(
      "6 loose faces are joined at edges within 0.05 mm of each other. These edges lie up to 0.473 "
      "mm from their faces, so the guaranteed distance is 0.473 mm smaller. 3 other edges are not "
      "joined; check whether an edge is damaged",
      box->warnings[0]);
  EXPECT_GE(box->deviation_units(), 0.472);
}

// A plane in the group, in place of the face that it carries.
TEST(IgesLosses, AFaceWithoutEdgesIsSomewhereInItsNode) {
  const std::string text = with_parameters(iges_box(false), 1, "402,6,5,19,35,51,67,83;");
  expect_in("a face without edges, somewhere in the region at (5, 10, 15) mm, 37.4 mm across",
            iges_error(text));
}

// One of two damaged faces has no shape, and one gets no triangles.
TEST(IgesLosses, AllAreToldAtOnce) {
  const ScratchFolder folder;
  const std::string text = with_parameters(
      with_parameters(iges_box(false), 15, "110,0.,0.,40.,0.,20.,30.;"), 19, "144,27,1,0,23;");
  expect_in("could not read 1 of 6 faces: D19 (type 144), and could not tessellate 1 face (",
            iges_error(text));
  expect_in("--missing-faces 2", iges_error(text));
  const auto rest = mesh::read_assembly(write_file(folder / "a.igs", text), {.missing_faces = 2});
  ASSERT_TRUE(rest) << to_line(rest.error());
  EXPECT_EQ(count_patches(*rest), 4u);
}

// Nothing is lost where only the boundary's own word for its surface is missing.
TEST(IgesLosses, ABoundaryThatNamesNoSurfaceLiesOnItsFaces) {
  const ScratchFolder folder;
  for (const std::string surface : {"0", "", "99999", "x"}) {
    const auto box = mesh::read_assembly(write_file(
        folder / "a.igs", with_parameters(iges_box(false), 23, "142,0," + surface + ",0,25,2;")));
    ASSERT_TRUE(box) << to_line(box.error());
    ASSERT_EQ(box->meshes.size(), 1u);
    EXPECT_EQ(box->triangle_count(), 12u);
    EXPECT_TRUE(mesh::mesh_facts(box->meshes[0]).closed);
  }
}

TEST(IgesLosses, LooseFacesAreSewnIntoAClosedSurface) {
  const ScratchFolder folder;
  run_in(folder.path(), "make_box_file rod.igs cylinder");
  const auto rod = mesh::read_assembly((folder / "rod.igs").string());
  ASSERT_TRUE(rod) << to_line(rod.error());
  ASSERT_EQ(rod->meshes.size(), 1u);
  const mesh::MeshFacts facts = mesh::mesh_facts(rod->meshes[0]);
  EXPECT_TRUE(facts.closed);
  EXPECT_NEAR(std::abs(facts.signed_volume), std::numbers::pi * 10 * 10 * 30, 100);
  ASSERT_EQ(rod->warnings.size(), 1u);
  EXPECT_NE(rod->warnings[0].find("3 loose faces are joined at edges within 0.1 mm of each other. "
                                  "These edges lie up to 0.001 mm from their faces"),
            std::string::npos)
      << rod->warnings[0];
  EXPECT_EQ(rod->warnings[0].find("damaged"), std::string::npos);
  EXPECT_LT(rod->deviation_units(), 0.11);  // a deflection, and gaps of next to nothing
}

// The group (type 402) of the six faces lists five, none, one twice, or is no group any more.
TEST(IgesLosses, ABodyThatIsInSeveralNodesIsReadAsOne) {
  const ScratchFolder folder;
  const std::string box = iges_box(false);
  for (const auto& [text, others] :
       {std::pair{with_parameters(box, 1, "402,5,3,19,35,51,67,83;"), "1 other node (FACE)"},
        {with_parameters(box, 1, "402,6,3,3,35,51,67,83;"), "1 other node (FACE)"},
        {with_parameters(box, 1, "402,3,3,19,35;"), "3 other nodes (FACE, ...)"},
        {with_parameters(box, 1, "402,x,3,19,35,51,67,83;"), "5 other nodes (FACE[2], ...)"},
        {with_type(box, 1, "999"), "5 other nodes (FACE[2], ...)"}}) {
    const auto body = mesh::read_assembly(write_file(folder / "a.igs", text));
    ASSERT_TRUE(body) << to_line(body.error());
    ASSERT_EQ(body->instances.size(), 1u);
    EXPECT_EQ(body->triangle_count(), 12u);
    const mesh::MeshFacts facts = mesh::mesh_facts(body->meshes[0]);
    EXPECT_TRUE(facts.closed);
    EXPECT_NEAR(std::abs(facts.signed_volume), 6000, 1e-6);
    expect_in(others + std::string(" are read as one body, because their faces meet at open edges"),
              body->warnings.at(0));
  }
  // Its nodes stay: each can be read alone, and left out.
  const std::string path = (folder / "a.igs").string();
  EXPECT_EQ(mesh::read_assembly(path + "#FACE[2]")->triangle_count(), 2u);
  EXPECT_EQ(mesh::read_assembly(path, {.without = {"FACE[2]"}})->triangle_count(), 10u);
}

TEST(IgesLosses, ClosedBodiesThatTouchStayNodes) {
  const ScratchFolder folder;
  run_in(folder.path(), "make_box_file two.igs two");
  const auto two = mesh::read_assembly((folder / "two.igs").string());
  ASSERT_TRUE(two) << to_line(two.error());
  ASSERT_EQ(two->instances.size(), 2u);
  for (const mesh::Mesh& mesh : two->meshes) EXPECT_TRUE(mesh::mesh_facts(mesh).closed);
  // Without their groups (entries 1 and 99) all twelve faces are nodes, and meet.
  const std::string text = read_text((folder / "two.igs").string());
  const auto bare = mesh::read_assembly(
      write_file(folder / "a.igs", with_type(with_type(text, 1, "999"), 99, "999")));
  ASSERT_TRUE(bare) << to_line(bare.error());
  EXPECT_EQ(bare->triangle_count(), 24u);
}

// No way out is offered that leaves nothing: neither where all is lost, nor the only node.
TEST(StepLosses, NoWayOutLeadsToNothing) {
  const std::string box = step_box();
  const std::string all = replaced(box, "MANIFOLD_SOLID_BREP", "MANIFOLD_SOLID_BREX");
  const std::string none = step_error(all),
                    one = step_error(
                        replaced(box, R"(CLOSED_SHELL\('',\(#17,)", "CLOSED_SHELL('',("));
  expect_in("could not read 6 of 6 faces", none);
  expect_in("the file has no other face", none);
  EXPECT_EQ(none.find("--missing-faces"), std::string::npos) << none;
  expect_in("or accept the holes with --missing-faces 1", one);
  EXPECT_EQ(one.find("--without"), std::string::npos) << one;
  const ScratchFolder folder;
  const auto accepted =
      mesh::read_assembly(write_file(folder / "a.step", all), {.missing_faces = 40});
  ASSERT_FALSE(accepted);
  expect_in("no face of this file can be read", to_line(accepted.error()));
}

// A loss of one of several nodes belongs to that node, and goes with it.
TEST(IgesLosses, BelongToTheirNodes) {
  const ScratchFolder folder;
  run_in(folder.path(), "make_box_file two.igs two");
  const std::string two = read_text((folder / "two.igs").string());
  for (const auto& [entry, parameters, node, alone] :
       {std::tuple{19, "144,27,1,0,23;", "COMPOUND", "COMPOUND[1]"},
        {117, "144,125,1,0,121;", "COMPOUND[2]", "COMPOUND[2]"}}) {
    const std::string path = write_file(folder / "a.igs", with_parameters(two, entry, parameters));
    const auto refused = mesh::read_assembly(path);
    ASSERT_FALSE(refused);
    expect_in(node + std::string(": OpenCASCADE could not read 1 of 12 faces"),
              to_line(refused.error()));
    const auto rest = mesh::read_assembly(path, {.without = {alone}});
    ASSERT_TRUE(rest) << to_line(rest.error());
    EXPECT_EQ(rest->triangle_count(), 12u);
  }
}

// A bore whose loop lists an edge of elsewhere gets no triangles: 76 of 620 are missing.
TEST(StepLosses, AHoleInASolidThatDoesNotCloseCounts) {
  const ScratchFolder folder;
  run_in(folder.path(), "make_step_assembly clamp.step");
  const std::string clamp = read_text(folder / "clamp.step");
  const auto bracket = mesh::read_assembly(write_file(
      folder / "a.step", replaced(clamp, R"((#1750 = EDGE_LOOP\('',\()#1751)", "$1#81")));
  ASSERT_TRUE(bracket) << to_line(bracket.error());
  ASSERT_EQ(bracket->warnings.size(), 2u);
  expect_in("#822 MANIFOLD_SOLID_BREP is not closed: 2 edges belong to only one face",
            bracket->warnings[0]);
  expect_in("bracket_1: an edge lies up to 5 mm from its faces", bracket->warnings[1]);
  EXPECT_GE(bracket->deviation_units(), 5);
}

// A face is not there at all, and its shell does not list it. Half of its width counts at least,
// where the shell should close, whether OpenCASCADE makes a solid or a shell of the rest.
TEST(StepLosses, AHoleInAShellThatShouldCloseCounts) {
  const ScratchFolder folder;
  const std::string box = replaced(replaced(step_box(), R"(#17 = ADVANCED_FACE\([^;]*;)", ""),
                                   R"(CLOSED_SHELL\('',\(#17,)", "CLOSED_SHELL('',(");
  const std::string shell =
      replaced(box, R"(MANIFOLD_SOLID_BREP\('',#16\))", "SHELL_BASED_SURFACE_MODEL('',(#16))");
  for (const std::string& text : {box, shell}) {
    const auto rest = mesh::read_assembly(write_file(folder / "a.step", text));
    ASSERT_TRUE(rest) << to_line(rest.error());
    EXPECT_EQ(rest->triangle_count(), 10u);
    ASSERT_EQ(rest->warnings.size(), 2u);
    expect_in("is not closed: 4 edges", rest->warnings[0]);
    EXPECT_GE(rest->deviation_units(), 10);  // of 20 x 30
  }
  const auto sheet = mesh::read_assembly(
      write_file(folder / "a.step", replaced(shell, "CLOSED_SHELL", "OPEN_SHELL")));
  ASSERT_TRUE(sheet) << to_line(sheet.error());
  EXPECT_TRUE(sheet->warnings.empty());
  EXPECT_DOUBLE_EQ(sheet->deviation_units(), 0.1);
}

// The rims of a hole are two rows of nearly the same points: no hole as wide as that.
TEST(IgesLosses, RimsThatMeetAreNoHole) {
  const ScratchFolder folder;
  run_in(folder.path(), "make_box_file plate.igs plate");
  const auto plate = mesh::read_assembly((folder / "plate.igs").string());
  ASSERT_TRUE(plate) << to_line(plate.error());
  EXPECT_EQ(plate->warnings.size(), 1u);  // of the sewing
  EXPECT_LT(plate->deviation_units(), 0.11);
}

TEST(IgesLosses, ASolidThatDoesNotCloseIsTold) {
  const ScratchFolder folder;
  const std::string path =
      write_file(folder / "a.igs",
                 with_parameters(iges_box(true), 15, "508,3,0,17,1,0,0,0,17,2,1,0,0,17,3,1,0;"));
  const auto box = mesh::read_assembly(path);
  ASSERT_TRUE(box) << to_line(box.error());
  EXPECT_EQ(box->triangle_count(), 12u);
  ASSERT_EQ(box->warnings.size(), 1u);
  expect_in("D1 (type 186) is not closed: 1 edge belongs to only one face", box->warnings[0]);
}

TEST(StepLosses, AFileThatCannotBeParsedSaysWhy) {
  const ScratchFolder folder;
  const std::string text = replaced(step_box(), "DATA;", "DATA");
  const auto assembly = mesh::read_assembly(write_file(folder / "a.step", text));
  ASSERT_FALSE(assembly);
  EXPECT_EQ(assembly.error().code, ErrorCode::kMeshUnreadable);
  expect_in("OpenCASCADE cannot parse this file: ERR StepFile", to_line(assembly.error()));
  expect_in("expecting DATA", to_line(assembly.error()));
}

// The independent count: the faces of a text, by a pattern, are those of the meshes.
TEST(StepLosses, NoFaceOfTheTextIsMissing) {
  const ScratchFolder folder;
  run_in(folder.path(), "make_step_assembly clamp.step");
  const std::string clamp = read_text(folder / "clamp.step"), box = step_box();
  const std::string feature = read_text(model_path("featuretype.step"));
  EXPECT_EQ(count_step_faces(box), 6u);
  for (const std::string& text : {box, clamp, feature}) {
    const auto assembly = mesh::read_assembly(write_file(folder / "a.step", text));
    ASSERT_TRUE(assembly) << to_line(assembly.error());
    EXPECT_EQ(count_patches(*assembly), count_step_faces(text));
  }
  for (const std::string& text : {iges_box(false), iges_box(true)}) {
    EXPECT_EQ(count_iges_faces(text), 6u);
    const auto assembly = mesh::read_assembly(write_file(folder / "a.igs", text));
    ASSERT_TRUE(assembly) << to_line(assembly.error());
    EXPECT_EQ(count_patches(*assembly), 6u);
  }
}

#endif

}  // namespace
}  // namespace forcelayer
