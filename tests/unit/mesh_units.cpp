// Units of mesh files, and vertices that 32-bit floats make coarse.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "formats/mesh/units.h"

namespace forcelayer {
namespace {

mesh::Assembly triangle_at(double x) {
  mesh::Assembly assembly;
  assembly.meshes.push_back({{{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}}, {{0, 1, 2}}, true});
  assembly.instances.push_back({0, "triangle", {}});
  return assembly;
}

TEST(MeshUnits, AreRequiredWhereTheFormatHasNone) {
  std::vector<std::string> warnings;
  const auto unit = mesh::meters_per_unit(triangle_at(0), "a.stl", std::nullopt, warnings);
  ASSERT_FALSE(unit);
  EXPECT_EQ(unit.error().code, ErrorCode::kUsage);
  EXPECT_NE(to_line(unit.error()).find("--units"), std::string::npos);
}

TEST(MeshUnits, AreTheChosenOnesWithoutAWarningWhereTheFormatHasNone) {
  std::vector<std::string> warnings;
  EXPECT_EQ(*mesh::meters_per_unit(triangle_at(0), "a.stl", 0.001, warnings), 0.001);
  EXPECT_TRUE(warnings.empty());
}

TEST(MeshUnits, OfTheFormatAreOverriddenWithAWarning) {
  mesh::Assembly assembly = triangle_at(0);
  assembly.meters_per_unit = 1.0;
  std::vector<std::string> warnings;
  EXPECT_EQ(*mesh::meters_per_unit(assembly, "a.glb", std::nullopt, warnings), 1.0);
  EXPECT_EQ(*mesh::meters_per_unit(assembly, "a.glb", 1.0, warnings), 1.0);
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(*mesh::meters_per_unit(assembly, "a.glb", 0.001, warnings), 0.001);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0], "1 m of the file is read as 1 mm, as you asked");
}

TEST(FloatSpacing, IsTheDistanceToTheNextFloat) {
  for (const float value : {1.0f, 1.5f, -16.0f, 745.25f, 1e-30f, 3e-39f}) {
    const float magnitude = std::abs(value);
    const double step = static_cast<double>(std::nextafter(magnitude, 1e30f)) - magnitude;
    EXPECT_EQ(mesh::float_spacing(value), step) << value;
  }
  EXPECT_EQ(mesh::float_spacing(0), 0);
}

// Against the longest image of many directions, which can only be shorter.
TEST(LargestStretch, IsThatOfTheWorstDirection) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 200; ++trial) {
    mesh::Affine affine;
    const double scale = std::exp(10 * normal(random));
    for (double& x : affine.linear) x = scale * normal(random);
    if (trial % 4 == 0) affine.linear[4] = affine.linear[7] = affine.linear[1] = 0;  // of rank two
    double longest = 0;
    for (int n = 0; n < 4000; ++n) {
      const double x = normal(random), y = normal(random), z = normal(random);
      const mesh::Vec3d image = mesh::apply(affine, {x, y, z});
      longest = std::max(longest, std::hypot(image[0], image[1], image[2]) / std::hypot(x, y, z));
    }
    const double stretch = mesh::largest_stretch(affine);
    EXPECT_GE(stretch, longest);
    EXPECT_LE(stretch, 1.02 * longest);  // 4000 directions come within ten degrees of the worst
  }
}

TEST(LargestStretch, OfScaledAndOfTurnedFrames) {
  const double half = std::sqrt(0.5);
  const mesh::Affine turned_then_scaled{{10 * half, -10 * half, 0, half, half, 0, 0, 0, 1},
                                        {0, 0, 0}};
  EXPECT_NEAR(mesh::largest_stretch(turned_then_scaled), 10, 1e-9);
  EXPECT_NEAR(mesh::largest_stretch(mesh::Affine{}), 1, 1e-11);
  EXPECT_EQ(mesh::largest_stretch(mesh::Affine{{}, {0, 0, 0}}), 0);
  const mesh::Affine millimeters{{0, -1e-3, 0, 1e-3, 0, 0, 0, 0, 1e-3}, {5, 6, 7}};
  EXPECT_NEAR(mesh::largest_stretch(millimeters), 1e-3, 1e-14);
}

// Floats near 20 000 lie 2^-9 apart: 2 um where the unit is mm.
TEST(VertexSpacing, FollowsUnitAndPlacing) {
  mesh::Mesh mesh = triangle_at(20000).meshes[0];
  mesh::Affine meters_from_mm{{0.001, 0, 0, 0, 0.001, 0, 0, 0, 0.001}, {0, 0, 0}};
  EXPECT_DOUBLE_EQ(mesh::vertex_spacing_m(mesh::float_coordinate(mesh), meters_from_mm),
                   std::ldexp(0.001, -9));
  const mesh::Affine placing{{0, -3, 0, 2, 0, 0, 0, 0, 1}, {0, 0, 0}};
  EXPECT_DOUBLE_EQ(
      mesh::vertex_spacing_m(mesh::float_coordinate(mesh), mesh::compose(meters_from_mm, placing)),
      3 * std::ldexp(0.001, -9));
  mesh.single_precision = false;
  EXPECT_EQ(mesh::vertex_spacing_m(mesh::float_coordinate(mesh), meters_from_mm), 0);
}

TEST(VertexSpacing, DrawsAWarningBeyondAThousandthOfAVoxel) {
  EXPECT_FALSE(mesh::coarse_vertices_warning(2e-6, 2e-3));
  ASSERT_TRUE(mesh::coarse_vertices_warning(2e-6, 1.9e-3));
  EXPECT_NE(mesh::coarse_vertices_warning(2e-6, 1.9e-3)->find("thousandth"), std::string::npos);
}

TEST(SmallSize, IsWarnedOfBelowFourVoxels) {
  const auto warning = [](double x_m, double y_m) {
    return mesh::small_size_warning("the part", {{1, 1, 1}, {1 + x_m, 1 + y_m, 1}}, 0.001)
        .value_or("");
  };
  EXPECT_EQ(warning(0, 0.00025),
            "the part is 0.25 mm across, less than a voxel: check --units; if the unit is right, "
            "use a smaller --voxel-size");
  EXPECT_EQ(warning(0.0025, 0),
            "the part is 2.5 mm across, 2.5 voxels: check --units; if the unit is right, use a "
            "smaller --voxel-size");
  EXPECT_EQ(warning(0.001, 0.0041), "");
  EXPECT_EQ(warning(0, 0), "");
  EXPECT_FALSE(mesh::small_size_warning("the scene", mesh::empty_box(), 1));
}

}  // namespace
}  // namespace forcelayer
