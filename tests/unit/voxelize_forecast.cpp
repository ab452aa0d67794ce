// The forecast of a bake before it begins.
#include <gtest/gtest.h>

#include <cmath>

#include "formats/mesh/units.h"
#include "tests/support/mesh_files.h"
#include "voxelize/forecast.h"
#include "voxelize/warnings.h"

namespace forcelayer {
namespace {

using voxelize::Forecast;

// A cube of `side_units`, in a unit of `unit_m`.
struct CubeScene {
  CubeScene(double side_units, double unit_m) {
    mesh::Mesh cube = test::cube();
    const mesh::Box unit = mesh::box_of(cube, {});
    const double side = unit.high[0] - unit.low[0];
    for (mesh::Vec3d& vertex : cube.vertices) {
      for (double& coordinate : vertex) coordinate *= side_units / side;
    }
    mesh::MeshObject& object = scene.objects.emplace_back();
    for (std::size_t i = 0; i < 9; i += 4) object.world_from_mesh.linear[i] = unit_m;
    object.box_m = mesh::box_of(cube, object.world_from_mesh);
    outlines.push_back(cache::outline_of(cube));
  }
  mesh::Scene scene;
  std::vector<cache::MeshOutline> outlines;
};

voxelize::BakeOptions options_for(double voxel_size_m) {
  voxelize::BakeOptions options;
  options.voxel_size_m = voxel_size_m;
  options.threads = 2;
  return options;
}

TEST(Forecast, CountsTheFacesOfTheSurface) {
  const CubeScene cube(100, 1e-3);
  const Forecast forecast = voxelize::forecast_of(cube.scene, cube.outlines, options_for(1e-3));
  EXPECT_NEAR(forecast.surface_voxels, 6e4, 1e-4);
  EXPECT_NEAR(forecast.box_m.high[0] - forecast.box_m.low[0], 0.1, 1e-12);
  EXPECT_TRUE(voxelize::check_forecast(forecast, options_for(1e-3), 1e9));
  EXPECT_FALSE(voxelize::forecast_warning(forecast, options_for(1e-3)));
}

TEST(Forecast, LeavesOutWhatLiesOutsideTheRegion) {
  const CubeScene cube(100, 1e-3);
  voxelize::BakeOptions options = options_for(1e-3);
  options.roi_m = {1, 1, 1, 2, 2, 2};
  EXPECT_EQ(voxelize::forecast_of(cube.scene, cube.outlines, options).surface_voxels, 0);
  options.roi_m = {0, 0, 0, 2, 2, 2};
  EXPECT_GT(voxelize::forecast_of(cube.scene, cube.outlines, options).surface_voxels, 0);
}

// An engine in millimeters that is called meters.
TEST(Forecast, RefusesWhatCannotFitAndNamesTheLikeliestMistake) {
  const CubeScene cube(745, 1);
  const auto options = options_for(1e-3);
  const Forecast forecast = voxelize::forecast_of(cube.scene, cube.outlines, options);
  const Status fits = voxelize::check_forecast(forecast, options, 16e9);
  ASSERT_FALSE(fits);
  EXPECT_EQ(fits.error().code, ErrorCode::kBakeTooLarge);
  EXPECT_TRUE(fits.error().what.starts_with("at 1 mm the scene takes at least "))
      << fits.error().what;
  EXPECT_TRUE(fits.error().what.ends_with("this process can have 16 GB")) << fits.error().what;
  EXPECT_TRUE(
      fits.error().mend.starts_with("the scene is 745 m across; if the unit of the files is the "
                                    "millimeter, add --units mm; otherwise use --voxel-size "))
      << fits.error().mend;
}

TEST(Forecast, AsksAboutMetersOnlyWhereTheyMayBeMillimeters) {
  const auto asks = [](double side_m, double unit_m) {
    const mesh::Box box{{0, 0, 0}, {1, side_m, 1}};
    return voxelize::unit_question("it", box, unit_m);
  };
  EXPECT_EQ(asks(743, 1),
            "it is 743 m across; if the unit of the files is the millimeter, add --units mm");
  EXPECT_TRUE(asks(50, 0.9));
  EXPECT_FALSE(asks(std::nextafter(50, 0), 1));
  EXPECT_FALSE(asks(743, std::nextafter(0.9, 0)));
  EXPECT_FALSE(voxelize::unit_question("it", mesh::empty_box(), 1));
}

// A rod of 1200 x 1 x 1 that a manifest makes a cube of 120 mm.
TEST(Forecast, KnowsTheAreaUnderAnUnevenScale) {
  CubeScene rod(1, 1);
  mesh::MeshObject& object = rod.scene.objects[0];
  object.world_from_mesh.linear = {1e-4, 0, 0, 0, 0.12, 0, 0, 0, 0.12};
  object.box_m = {{0, 0, 0}, {0.12, 0.12, 0.12}};
  rod.outlines[0].area = 2 + 4 * 1200;
  const auto options = options_for(1e-3);
  const Forecast forecast = voxelize::forecast_of(rod.scene, rod.outlines, options);
  const double bytes = 6 * 0.12 * 0.12 / 1e-6 * 6;  // 6 for each face of a voxel
  EXPECT_LE(forecast.min_memory_bytes, bytes);
  EXPECT_GT(forecast.min_memory_bytes, 0);
  EXPECT_TRUE(voxelize::check_forecast(forecast, options, bytes));
  // Evenly scaled and turned, both factors are the square of the scale.
  mesh::Affine turned;
  turned.linear = {1.8, -2.4, 0, 2.4, 1.8, 0, 0, 0, 3};
  EXPECT_NEAR(mesh::area_factors(turned).smallest, 9, 1e-9);
  EXPECT_NEAR(mesh::area_factors(turned).mean, 9, 1e-9);
  EXPECT_EQ(mesh::area_factors({{}, {0, 0, 0}}).mean, 0);
}

TEST(Forecast, WarnsOfAMinuteOrAGigabyte) {
  const voxelize::BakeOptions options = options_for(1e-3);
  Forecast own;
  const auto warns = [&](double seconds, double bytes) {
    own.bake_s = seconds, own.memory_bytes = bytes;
    return voxelize::forecast_warning(own, options).has_value();
  };
  EXPECT_FALSE(warns(59, 0.9e9));
  EXPECT_TRUE(warns(61, 0.1e9));
  EXPECT_TRUE(warns(1, 1.1e9));
}

TEST(Forecast, NamesALargerVoxelSize) {
  const CubeScene cube(20, 1);
  const auto options = options_for(1e-3);
  const auto warning = voxelize::forecast_warning(
      voxelize::forecast_of(cube.scene, cube.outlines, options), options);
  ASSERT_TRUE(warning);
  EXPECT_TRUE(warning->starts_with("this bake may take ")) << *warning;
  EXPECT_NE(warning->find("GB of memory: the scene is 20 m across; use --voxel-size "),
            std::string::npos)
      << *warning;  // an airliner may be as large: no word of units
}

TEST(Warnings, OfCoarseVerticesAreOneForAllFiles) {
  CubeScene cubes(100, 1);
  cubes.scene.objects[0].file = "a.stl#0";
  for (int n = 1; n < 66; ++n) {
    cubes.scene.objects.push_back(cubes.scene.objects[0]);
    cubes.outlines.push_back(cubes.outlines[0]);
    cubes.scene.objects.back().file = "part" + std::to_string(n) + ".stl";
  }
  cubes.outlines[5].float_coordinate = 1e5;  // the coarsest
  for (auto& outline : cubes.outlines) outline.float_coordinate += 1e4;
  const auto warnings = voxelize::all_warnings(cubes.scene, cubes.outlines, options_for(1e-3));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_TRUE(warnings[0].starts_with("part5.stl: the 32-bit coordinates are rounded to steps of "))
      << warnings[0];
  EXPECT_TRUE(warnings[0].ends_with("(this also applies to 65 other files)")) << warnings[0];
}

}  // namespace
}  // namespace forcelayer
