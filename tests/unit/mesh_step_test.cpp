// STEP assemblies, in a build with OpenCASCADE.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "formats/mesh/mesh_facts.h"
#include "tests/support/mesh_files.h"

namespace forcelayer {
namespace {

using namespace test;

#ifdef FORCELAYER_STEP

std::string model(const char* file) {
  return std::string(FORCELAYER_SOURCE_DIR) + "/../shared/models/cad/" + file;
}

class StepReader : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(model("as1-oc-214.stp"))) {
      GTEST_SKIP() << "the model collection is not there";
    }
  }
};

TEST_F(StepReader, KeepsTheAssemblysTreeAndInstances) {
  const auto assembly = read_assembly(model("as1-oc-214.stp"));
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  EXPECT_EQ(assembly->meshes.size(), 5u);  // nut, rod, bolt, bracket, plate
  EXPECT_EQ(assembly->instances.size(), 18u);
  EXPECT_EQ(assembly->instances[0].name, "as1/rod-assembly_1/nut_1");
  EXPECT_EQ(assembly->metres_per_unit, 1e-3);
  const auto rod = read_assembly(model("as1-oc-214.stp") + "#rod-assembly_1");
  ASSERT_TRUE(rod) << to_line(rod.error());
  EXPECT_EQ(rod->instances.size(), 3u);
  EXPECT_EQ(rod->instances[0].assembly_from_mesh.translation,
            assembly->instances[0].assembly_from_mesh.translation);
}

TEST_F(StepReader, GivesClosedSolidsThatFaceOutwards) {
  const auto assembly = read_assembly(model("as1-oc-214.stp"));
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  for (const Mesh& mesh : assembly->meshes) {
    const MeshFacts facts = mesh_facts(mesh);
    EXPECT_TRUE(facts.closed);
    EXPECT_TRUE(facts.consistently_oriented);
    EXPECT_GT(facts.signed_volume, 0);
  }
}

// The same part as an STL, whose unit is the inch.
TEST_F(StepReader, AgreesWithTheStlOfTheSamePart) {
  const auto step = read_assembly(model("featuretype.step"));
  const auto stl = read_assembly(model("featuretype.stl"));
  ASSERT_TRUE(step && stl);
  const MeshFacts a = mesh_facts(step->meshes[0]), b = mesh_facts(stl->meshes[0]);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(a.max[axis] - a.min[axis], 25.4 * (b.max[axis] - b.min[axis]), 0.1);
  }
  EXPECT_NEAR(a.signed_volume / (std::pow(25.4, 3) * b.signed_volume), 1, 1e-3);
}

TEST_F(StepReader, DeclaresItsDeflection) {
  const auto coarse = read_assembly(model("featuretype.step"), {.deflection_m = 1e-3});
  const auto fine = read_assembly(model("featuretype.step"), {.deflection_m = 1e-5});
  ASSERT_TRUE(coarse && fine);
  EXPECT_GT(fine->triangle_count(), coarse->triangle_count());
  EXPECT_GE(coarse->deviation_units, 1.0);
  EXPECT_GE(fine->deviation_units, 0.01);
  EXPECT_LT(fine->deviation_units, coarse->deviation_units);
}

TEST(StepReaderOfDamage, SaysWhatItCannotParse) {
  const ScratchFolder folder;
  const auto nothing = read_assembly(write_file(folder / "a.step", "no STEP file"));
  ASSERT_FALSE(nothing);
  EXPECT_EQ(exit_status(nothing.error().code), 3) << to_line(nothing.error());
}

#else

TEST(StepReader, IsLeftOutClearly) {
  for (const char* extension : {".step", ".stp", ".igs", ".IGES"}) {
    const auto assembly = read_bytes("ISO-10303-21;", extension);
    ASSERT_FALSE(assembly);
    EXPECT_EQ(assembly.error().code, ErrorCode::kMeshUnsupported);
    EXPECT_NE(to_line(assembly.error()).find("FORCELAYER_STEP"), std::string::npos);
  }
}

#endif

}  // namespace
}  // namespace forcelayer
