// STEP assemblies, in a build with OpenCASCADE.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "formats/mesh/mesh_facts.h"
#include "tests/support/mesh_files.h"
#include "tests/support/models.h"

namespace forcelayer {
namespace {

using namespace test;

#ifdef FORCELAYER_STEP

// The assembly of make_step_assembly.
class StepAssembly : public testing::Test {
 protected:
  void SetUp() override {
    const std::string command = FORCELAYER_BIN_DIR "/make_step_assembly " + path_;
    ASSERT_EQ(std::system(command.c_str()), 0);
  }

  ScratchFolder folder_;
  std::string path_ = folder_ / "clamp.step";
};

TEST_F(StepAssembly, KeepsItsTreeAndInstances) {
  const auto assembly = mesh::read_assembly(path_);
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  EXPECT_EQ(assembly->meshes.size(), 5u);  // nut, rod, bolt, bracket, plate
  EXPECT_EQ(assembly->instances.size(), 18u);
  EXPECT_EQ(assembly->instances[0].name, "clamp/rod-assembly_1/nut_1");
  EXPECT_EQ(assembly->meters_per_unit, 1e-3);
  const auto rod = mesh::read_assembly(path_ + "#rod-assembly_1");
  ASSERT_TRUE(rod) << to_line(rod.error());
  EXPECT_EQ(rod->instances.size(), 3u);
  EXPECT_EQ(rod->instances[0].assembly_from_mesh.translation,
            assembly->instances[0].assembly_from_mesh.translation);
}

TEST_F(StepAssembly, GivesClosedSolidsThatFaceOutwards) {
  const auto assembly = mesh::read_assembly(path_);
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  for (const mesh::Mesh& mesh : assembly->meshes) {
    const mesh::MeshFacts facts = mesh::mesh_facts(mesh);
    EXPECT_TRUE(facts.closed);
    EXPECT_TRUE(facts.consistently_oriented);
    EXPECT_GT(facts.signed_volume, 0);
  }
}

// The same part as an STL, whose unit is the inch.
TEST(StepReader, AgreesWithTheStlOfTheSamePart) {
  const auto step = mesh::read_assembly(model_path("featuretype.step"));
  const auto stl = mesh::read_assembly(model_path("featuretype.stl"));
  ASSERT_TRUE(step && stl);
  const mesh::MeshFacts a = mesh::mesh_facts(step->meshes[0]), b = mesh::mesh_facts(stl->meshes[0]);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(a.max[axis] - a.min[axis], 25.4 * (b.max[axis] - b.min[axis]), 0.1);
  }
  EXPECT_NEAR(a.signed_volume / (std::pow(25.4, 3) * b.signed_volume), 1, 1e-3);
}

TEST(StepReader, DeclaresItsDeflection) {
  const auto coarse = mesh::read_assembly(model_path("featuretype.step"), {.deflection_m = 1e-3});
  const auto fine = mesh::read_assembly(model_path("featuretype.step"), {.deflection_m = 1e-5});
  ASSERT_TRUE(coarse && fine);
  EXPECT_GT(fine->triangle_count(), coarse->triangle_count());
  EXPECT_GE(coarse->deviation_units, 1.0);
  EXPECT_GE(fine->deviation_units, 0.01);
  EXPECT_LT(fine->deviation_units, coarse->deviation_units);
}

double dot(const mesh::Vec3d& a, const mesh::Vec3d& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
mesh::Vec3d minus(const mesh::Vec3d& a, const mesh::Vec3d& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double distance_to_segment(const mesh::Vec3d& p, const mesh::Vec3d& a, const mesh::Vec3d& b) {
  const mesh::Vec3d side = minus(b, a), to_p = minus(p, a);
  const double length2 = dot(side, side);
  const double t = length2 > 0 ? std::clamp(dot(to_p, side) / length2, 0.0, 1.0) : 0;
  const mesh::Vec3d off = {to_p[0] - t * side[0], to_p[1] - t * side[1], to_p[2] - t * side[2]};
  return std::sqrt(dot(off, off));
}

double distance_to_triangle(const mesh::Vec3d& p, const mesh::Vec3d& a, const mesh::Vec3d& b,
                            const mesh::Vec3d& c) {
  const double to_sides = std::min(
      {distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
  // Over the inside of the triangle it is the distance from the plane.
  const mesh::Vec3d u = minus(b, a), v = minus(c, a), w = minus(p, a);
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), wu = dot(w, u), wv = dot(w, v);
  const double area2 = uu * vv - uv * uv;
  if (!(area2 > 0)) return to_sides;
  const double s = (vv * wu - uv * wv) / area2, t = (uu * wv - uv * wu) / area2;
  if (s < 0 || t < 0 || s + t > 1) return to_sides;
  return std::sqrt(std::max(0.0, dot(w, w) - s * wu - t * wv));
}

// A tessellation a hundred times as fine stands for the true surface: the guarantee counts on no
// point of it being farther from the coarse triangles than the coarse reading declares, but for
// what the fine one deviates itself.
TEST(StepReader, StaysWithinTheDeviationThatItDeclares) {
  const auto coarse = mesh::read_assembly(model_path("featuretype.step"), {.deflection_m = 1e-3});
  const auto fine = mesh::read_assembly(model_path("featuretype.step"), {.deflection_m = 1e-5});
  ASSERT_TRUE(coarse && fine);
  const mesh::Mesh& triangles = coarse->meshes[0];
  double farthest = 0;
  for (std::size_t i = 0; i < fine->meshes[0].vertices.size(); i += 5) {
    const mesh::Vec3d& p = fine->meshes[0].vertices[i];
    double nearest = 1e300;
    for (const mesh::Triangle& t : triangles.triangles) {
      nearest = std::min(nearest,
                         distance_to_triangle(p, triangles.vertices[t[0]], triangles.vertices[t[1]],
                                              triangles.vertices[t[2]]));
    }
    farthest = std::max(farthest, nearest);
  }
  EXPECT_LE(farthest, coarse->deviation_units + fine->deviation_units);
  EXPECT_GT(farthest, 0.01);  // or the test has found nothing that curves
}

TEST(StepReaderOfDamage, SaysWhatItCannotParse) {
  const ScratchFolder folder;
  const auto nothing = mesh::read_assembly(write_file(folder / "a.step", "no STEP file"));
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
