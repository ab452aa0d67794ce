#include "pointshell/part/part.h"

#include <gtest/gtest.h>

#include "pointshell/bake.h"
#include "pointshell/sample/stored_position.h"
#include "tests/support/part_support.h"

namespace forcelayer {
namespace {

using namespace testing;

TEST(Part, IsTheSameForAnyOrderOfTriangles) {
  const mesh::Mesh mesh = torus_mesh(1, 0.3, 12);
  const part::Part part = part_of(mesh);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const part::Part other = part_of(shuffled(mesh, seed));
    EXPECT_EQ(part.vertices, other.vertices);
    EXPECT_EQ(part.triangles, other.triangles);
  }
}

TEST(Part, DropsDuplicatesWithinABodyAndCountsThem) {
  mesh::Mesh mesh = box_mesh(1, 1, 1);
  mesh.triangles.push_back({3, 0, 2});  // the first, from another corner
  mesh.triangles.push_back({0, 3, 2});  // the first, turned round
  const part::Part part = part_of(mesh);
  EXPECT_EQ(part.input_triangles, 14u);
  EXPECT_EQ(part.duplicate_triangles, 2u);
  EXPECT_EQ(part.triangles, part_of(box_mesh(1, 1, 1)).triangles);
}

// Bodies that are alike but for one triangle are two.
TEST(Part, DropsABodyThatIsAnotherAgain) {
  const mesh::Mesh box = box_mesh(1, 1, 1);
  mesh::Mesh open = box;
  open.triangles.pop_back();
  EXPECT_EQ(part_of({box, box, box}).triangles.size(), 12u);
  EXPECT_EQ(part_of({box, open, box, open}).triangles.size(), 12u + 11u);
}

TEST(Part, WeldsEqualVerticesWhateverTheSignOfZero) {
  mesh::Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, -0.0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {3, 1, 4}};
  EXPECT_EQ(part_of(mesh).vertices.size(), 4u);
}

TEST(Part, AMirroredPlacingStillFacesOutwards) {
  mesh::Assembly assembly = assembly_of({box_mesh(1, 1, 1)});
  assembly.instances[0].assembly_from_mesh.linear = {-1, 0, 0, 0, 1, 0, 0, 0, 1};
  const part::PartInput input{&assembly, 1};
  const part::Part part = std::move(part::assemble_part({&input, 1})).value();
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    EXPECT_GT(part::dot(part::doubled_area_normal(part, t), part.vertices[part.triangles[t][0]]),
              0);
  }
}

// The deviation that a STEP reader states reaches the shell's e_part, added to the user's own.
TEST(Part, DeviationOfTheFilesCounts) {
  mesh::Assembly exact = assembly_of({box_mesh(1, 1, 1)}), tessellated = exact;
  tessellated.instances.front().deviation_units = 0.1;
  const part::PartInput inputs[] = {{&exact, 1}, {&tessellated, 1e-3}};
  const part::Part part = std::move(part::assemble_part(inputs)).value();
  EXPECT_DOUBLE_EQ(part.deviation_m, 1e-4);
  pointshell::ShellOptions options;
  options.voxel_size_m = 0.2;
  options.mesh_deviation_m = 2e-5;
  const auto shell = pointshell::bake_shell(part, options, [](const std::string&, double) {});
  EXPECT_DOUBLE_EQ(shell.value().header.part_deviation_m, 1.2e-4);
}

TEST(Part, WithoutAreaIsAnError) {
  mesh::Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
  mesh.triangles = {{0, 1, 2}};
  const mesh::Assembly assembly = assembly_of({mesh});
  const part::PartInput input{&assembly, 1};
  const auto part = part::assemble_part({&input, 1});
  ASSERT_FALSE(part.ok());
  EXPECT_EQ(part.error().code, ErrorCode::kMeshEmpty);
}

// Coordinates that overflow where the transform takes them are NaN or infinite, and have no order.
TEST(Part, BeyondTheRangeOfDoublesIsAnError) {
  mesh::Assembly assembly = assembly_of({box_mesh(1, 1, 1)});
  assembly.instances[0].assembly_from_mesh.linear = {1e308, 1e308, -1e308, 0, 1, 0, 0, 0, 1};
  const part::PartInput input{&assembly, 1e3};
  const auto part = part::assemble_part({&input, 1});
  ASSERT_FALSE(part.ok());
  EXPECT_EQ(part.error().code, ErrorCode::kMeshUnsupported);
}

// The proof of the covering loses 2^-44 of the largest coordinate: at 1e11 m more than the radius
// of 4.3 mm, which no number of points makes up for.
TEST(Part, TooFarForItsProofIsAnErrorOfTheBake) {
  for (const double far_m : {1e6, 1e9, 1e11, 1e200}) {
    mesh::Assembly assembly = assembly_of({box_mesh(0.1, 0.1, 0.1)});
    assembly.instances[0].assembly_from_mesh.translation = {far_m, 0, 0};
    const part::PartInput input{&assembly, 1};
    pointshell::ShellOptions options;
    options.voxel_size_m = 0.005;
    options.effort = sample::Effort::kFast;
    const auto shell = pointshell::bake_shell(part::assemble_part({&input, 1}).value(), options,
                                              [](const std::string&, double) {});
    EXPECT_EQ(shell.ok(), far_m < 1e10) << far_m;
    if (shell.ok()) continue;
    EXPECT_EQ(shell.error().code, ErrorCode::kBakeTooLarge) << far_m;
  }
}

// A mesh far from the origin that its transform brings back has rounded as if it were there.
TEST(Part, RoundingOfMeshBroughtBackCounts) {
  mesh::Assembly assembly = assembly_of({box_mesh(0.1, 0.1, 0.1)});
  for (mesh::Vec3d& vertex : assembly.meshes[0].vertices) vertex[0] += 1e7;
  assembly.instances[0].assembly_from_mesh.translation = {-1e7, 0, 0};
  const part::PartInput input{&assembly, 1};
  const part::Part part = part::assemble_part({&input, 1}).value();
  EXPECT_GE(part.largest_coordinate, 2e7);
  EXPECT_LT(part.largest_coordinate, 2.1e7);
}

// gcc 12 drops this rounding unless it is kept from vectorizing straight-line code.
TEST(StoredPosition, HasFloatsAsCoordinates) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int n = 0; n < 1000; ++n) {
    const part::Vec3 given{unit(random), unit(random), unit(random)};
    const part::Vec3 stored = sample::as_stored(given);
    const volatile float x = static_cast<float>(given.x), y = static_cast<float>(given.y),
                         z = static_cast<float>(given.z);
    EXPECT_EQ(stored.x, x);
    EXPECT_EQ(stored.y, y);
    EXPECT_EQ(stored.z, z);
  }
}

}  // namespace
}  // namespace forcelayer
