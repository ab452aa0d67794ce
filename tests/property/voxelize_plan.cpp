// Promises of --plan: figures that follow from the definitions, and estimates against real bakes.
#include <gtest/gtest.h>

#include "formats/mesh/scene.h"
#include "tests/support/baked_scene.h"
#include "tests/support/models.h"
#include "tests/support/places.h"
#include "tests/support/reference_bake.h"
#include "tests/support/sanitized.h"
#include "tests/support/soups.h"
#include "voxelize/plan.h"

namespace forcelayer {
namespace {

using reference::BakedScene;
using reference::objects_of;
using reference::Random;
using reference::real;

// The estimated file size holds within this factor, either way: two coarse bakes cannot know which
// bricks of a fine one will be equal. Bakes of models and bays came to 0.9 to 1.6 of
// the true size.
constexpr double kSizeFactor = 2;

void expect_size_is_estimated(const std::vector<voxelize::SceneObject>& objects,
                              double voxel_size_m) {
  voxelize::BakeOptions options;
  options.voxel_size_m = voxel_size_m;
  const auto plan = voxelize::plan_bakes(objects, options);
  ASSERT_TRUE(plan) << to_line(plan.error());
  for (const voxelize::PlannedSize& size : plan->sizes) {
    options.voxel_size_m = size.voxel_size_m;
    const auto baked = voxelize::bake(objects, options);
    ASSERT_TRUE(baked) << to_line(baked.error());
    const auto bytes = static_cast<double>(voxmap_bytes(baked->content({})).size());
    EXPECT_LT(size.file_bytes, bytes * kSizeFactor) << size.voxel_size_m;
    EXPECT_GT(size.file_bytes, bytes / kSizeFactor) << size.voxel_size_m;
    EXPECT_GT(size.bake_s, 0);
    EXPECT_TRUE(size.fits);
  }
}

TEST(Plan, FileSizeOfTheSampleSceneIsEstimated) {
  const std::string path = test::source_path("sample_data/bay.json");
  const auto scene = mesh::read_scene(std::span(&path, 1), std::nullopt);
  ASSERT_TRUE(scene) << to_line(scene.error());
  expect_size_is_estimated(objects_of(*scene), 0.01);
}

TEST(Plan, FileSizesOfModelsAreEstimated) {
  const std::pair<const char*, double> files[] = {
      {"bunny.drc", 0.1557 / 100}, {"dragon.drc", 2.0 / 100}, {"counter.drc", 304.8 / 100}};
  for (const auto& [file, voxel_size_m] : std::span(files).first(test::kSanitized ? 1 : 3)) {
    SCOPED_TRACE(file);
    const std::string path = test::model_path(file);
    const auto scene = mesh::read_scene(std::span(&path, 1), 1.0);
    ASSERT_TRUE(scene) << to_line(scene.error());
    expect_size_is_estimated(objects_of(*scene), voxel_size_m);
  }
}

TEST(Plan, TooLargeSizesAreMarked) {
  Random random(1);
  const mesh::Mesh mesh = reference::random_object(random, {0, 0, 0}, 1e6);
  voxelize::BakeOptions options;
  options.voxel_size_m = 0.001;
  const auto plan = voxelize::plan_bakes(
      std::vector<voxelize::SceneObject>{{"big", &mesh, mesh::Affine{}, {}, 0}}, options);
  ASSERT_TRUE(plan) << to_line(plan.error());
  EXPECT_FALSE(plan->sizes[0].fits);
  EXPECT_GT(plan->probe_sizes_m[1], 100);  // coarse, whatever was asked for
}

// A plate on each side of a gap along x, in voxels of 1 m.
mesh::Mesh plates(double first_end, double gap) {
  const auto box = [](mesh::Mesh& mesh, double x0, double x1) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const double x : {x0, x1}) {
      for (const double y : {0.0, 20.0}) {
        for (const double z : {0.0, 20.0}) mesh.vertices.push_back({x, y, z});
      }
    }
    constexpr std::array<mesh::Triangle, 12> kFaces = {{{0, 1, 3},
                                                        {0, 3, 2},
                                                        {4, 6, 7},
                                                        {4, 7, 5},
                                                        {0, 4, 5},
                                                        {0, 5, 1},
                                                        {2, 3, 7},
                                                        {2, 7, 6},
                                                        {0, 2, 6},
                                                        {0, 6, 4},
                                                        {1, 5, 7},
                                                        {1, 7, 3}}};
    for (const mesh::Triangle& t : kFaces) {
      mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
  };
  mesh::Mesh mesh;
  box(mesh, first_end - 3, first_end);
  box(mesh, first_end + gap, first_end + gap + 3);
  return mesh;
}

// Voxels of neither the force layer nor the interior between the plates.
int passable_voxels(const mesh::Mesh& mesh, const voxelize::BakeOptions& options, double first_end,
                    double gap) {
  const BakedScene baked({{"plates", &mesh, mesh::Affine{}, {}, 0}}, options);
  int passable = 0;
  for (double x = std::floor(first_end); x <= first_end + gap; ++x) {
    const VoxelValue value = baked.map().value(static_cast<std::int64_t>(x), 10, 10);
    passable += value == VoxelValue::kFree || value == VoxelValue::kProximity ? 1 : 0;
  }
  return passable;
}

void expect_narrowest_gap(const voxelize::BakeOptions& options, double gap) {
  SCOPED_TRACE(::testing::Message() << options.layers << " layers");
  const mesh::Mesh some = plates(3, 5);
  const auto plan = voxelize::plan_bakes(
      std::vector<voxelize::SceneObject>{{"p", &some, mesh::Affine{}, {}, 0}}, options);
  ASSERT_TRUE(plan) << to_line(plan.error());
  ASSERT_EQ(plan->sizes[0].narrowest_gap_m, gap);
  bool narrower_is_closed = false;
  for (int step = 0; step < 16; ++step) {
    const double end = 5 + step / 16.0;
    EXPECT_GT(passable_voxels(plates(end, gap), options, end, gap), 0) << end;
    const double narrower = gap - 1.0 / 16;
    narrower_is_closed |= passable_voxels(plates(end, narrower), options, end, narrower) == 0;
  }
  EXPECT_TRUE(narrower_is_closed);
}

TEST(Plan, TheNarrowestGapIsPassableWhereverItLiesAndNoNarrowerOneIs) {
  voxelize::BakeOptions options;
  options.voxel_size_m = 1;
  options.distances = false;
  options.metric = Metric::kChebyshev;
  for (options.layers = 0; options.layers <= 3; ++options.layers) {
    expect_narrowest_gap(options, 2 * options.layers + 2);
  }
  options.metric = Metric::kEuclidean;
  for (options.layers = 1; options.layers <= 3; ++options.layers) {
    expect_narrowest_gap(options, 2 * (options.layers - 1 + 888.0 / 1024) + 3);
  }
}

}  // namespace
}  // namespace forcelayer
