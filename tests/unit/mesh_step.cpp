// STEP assemblies, in a build with OpenCASCADE.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>

#include "formats/mesh/mesh_facts.h"
#include "tests/support/mesh_files.h"
#include "tests/support/models.h"
#include "tests/support/places.h"

namespace forcelayer {
namespace {

using namespace test;

#ifdef FORCELAYER_STEP

// The assembly of make_step_assembly.
class StepAssembly : public testing::Test {
 protected:
  void SetUp() override {
    const std::string command = test::command_path("make_step_assembly ") + path_;
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

// A product of make_step_assembly: how its box lies and what it holds, in the unit of the file.
struct MadePart {
  mesh::Vec3d min, max;
  double volume;
};

// Closed forms of the shapes in make_step_assembly.cpp.
MadePart made_part(const std::string& instance) {
  const double root3 = std::sqrt(3.0), pi = std::numbers::pi;
  const std::string name = instance.substr(instance.rfind('/') + 1);
  if (name.starts_with("nut")) {
    return {{-10, -5 * root3, 0}, {10, 5 * root3, 8}, 8 * (150 * root3 - 25 * pi)};
  }
  if (name.starts_with("rod")) return {{-5, -5, 0}, {5, 5, 200}, 200 * 25 * pi};
  if (name.starts_with("bolt")) {
    return {{-9, -4.5 * root3, -40}, {9, 4.5 * root3, 6}, 6 * 121.5 * root3 + 40 * 25 * pi};
  }
  if (name.starts_with("bracket")) return {{0, 0, 0}, {60, 100, 60}, 110000 - 4 * 10 * 25 * pi};
  return {{0, 0, 0}, {180, 150, 20}, 180 * 150 * 20};
}

// Names, places, boxes and volumes in every unit are those that the assembly was made with.
TEST(StepUnits, MillimeterInchAndMeter) {
  const ScratchFolder folder;
  for (const auto& [unit, unit_mm] : {std::pair{"MM", 1.0}, {"INCH", 25.4}, {"M", 1000.0}}) {
    const std::string path = folder / (std::string(unit) + ".step");
    const std::string command = test::command_path("make_step_assembly ") + path + " " + unit;
    ASSERT_EQ(std::system(command.c_str()), 0);
    const double deflection_mm = 1e-3 * unit_mm;
    const auto assembly = mesh::read_assembly(path, {.deflection_m = deflection_mm * 1e-3});
    ASSERT_TRUE(assembly) << to_line(assembly.error());
    EXPECT_EQ(assembly->meters_per_unit, 1e-3);
    ASSERT_EQ(assembly->instances.size(), 18u);
    for (const mesh::MeshInstance& instance : assembly->instances) {
      const MadePart made = made_part(instance.name);
      const mesh::MeshFacts facts = mesh::mesh_facts(assembly->meshes[instance.mesh]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(facts.min[axis], made.min[axis] * unit_mm, deflection_mm) << instance.name;
        EXPECT_NEAR(facts.max[axis], made.max[axis] * unit_mm, deflection_mm) << instance.name;
      }
      const double volume_mm3 = made.volume * std::pow(unit_mm, 3);
      EXPECT_NEAR(facts.signed_volume / volume_mm3, 1, 1e-3) << instance.name;
    }
    const auto place = [&](const char* name) {
      const auto found = std::find_if(assembly->instances.begin(), assembly->instances.end(),
                                      [&](const auto& each) { return each.name == name; });
      EXPECT_NE(found, assembly->instances.end()) << name;
      return found->assembly_from_mesh.translation;
    };
    const auto expect_at = [&, scale = unit_mm](const char* name, const mesh::Vec3d& made) {
      const mesh::Vec3d at = place(name);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(at[axis], made[axis] * scale, 1e-9 * scale) << name;
      }
    };
    expect_at("clamp/rod-assembly_1/rod_1", {90, 75, 20});
    expect_at("clamp/rod-assembly_1/nut_2", {90, 75, 202});
    expect_at("clamp/bracket-assembly_2/nut-bolt-assembly_1/bolt_1", {130, 105, 30});
    expect_at("clamp/plate_1", {0, 0, 0});
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
  EXPECT_GE(coarse->deviation_units(), 1.0);
  EXPECT_GE(fine->deviation_units(), 0.01);
  EXPECT_LT(fine->deviation_units(), coarse->deviation_units());
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
  EXPECT_LE(farthest, coarse->deviation_units() + fine->deviation_units());
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
