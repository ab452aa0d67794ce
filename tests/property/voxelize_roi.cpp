// A region of interest: what lies inside equals the full bake's, and nothing is said about the
// rest.
#include <gtest/gtest.h>

#include <cmath>

#include "formats/audit/voxmap_audit.h"
#include "tests/support/baked_scene.h"
#include "tests/support/sanitized.h"
#include "tests/support/soups.h"

namespace forcelayer {
namespace {

using reference::BakedScene;
using reference::Random;
using reference::real;
using reference::whole;

// Meshes in voxels of 1 m.
struct RoiScene {
  std::vector<mesh::Mesh> meshes;
  std::vector<voxelize::SceneObject> objects() const {
    std::vector<voxelize::SceneObject> list;
    for (const mesh::Mesh& mesh : meshes) list.push_back({"object", &mesh, mesh::Affine{}, {}, 0});
    return list;
  }
};

using Roi = std::array<double, 6>;

voxelize::BakeOptions options_with(std::uint32_t layers, std::optional<Roi> roi = {},
                                   Metric metric = Metric::kChebyshev) {
  voxelize::BakeOptions options;
  options.voxel_size_m = 1;
  options.layers = layers;
  options.metric = metric;
  options.threads = 2;
  options.roi_m = roi;
  return options;
}

bool inside_valid_box(const VoxmapHeader& header, const lattice::VoxelIndex& v) {
  for (std::size_t d = 0; d < 3; ++d) {
    if (v[d] < header.valid_min_voxel[d] || v[d] >= header.valid_max_voxel[d]) return false;
  }
  return true;
}

// Every voxel of the region and around it, counts, tight box, cropped sides, clearance.
void expect_region_of(const Voxmap& part, const Voxmap& full, const Roi& roi) {
  const VoxmapHeader &cut = part.header(), &all = full.header();
  const Status audited = audit_voxmap(part, "region");
  ASSERT_TRUE(audited) << to_line(audited.error());
  lattice::VoxelIndex low, high;
  // Sides across which something lies; and across which something might for all that is known
  // before the bake: Euclidean distances reach three voxels beyond the layers, and whether layers
  // end a voxel further out hangs on where a surface lies in its voxel.
  std::uint32_t cropped = 0, maybe_cropped = 0;
  const std::int64_t slack = all.metric == static_cast<std::uint32_t>(Metric::kEuclidean) ? 4 : 0;
  for (std::size_t d = 0; d < 3; ++d) {
    low[d] = static_cast<std::int64_t>(std::floor(roi[d]));
    high[d] = static_cast<std::int64_t>(std::ceil(roi[d + 3])) - 1;
    const std::int64_t last =
        all.origin_voxel[d] + static_cast<std::int64_t>(all.dims_voxels[d]) - 1;
    if (all.origin_voxel[d] < low[d]) cropped |= 1u << (2 * d);
    if (last > high[d]) cropped |= 2u << (2 * d);
    if (all.origin_voxel[d] - slack < low[d]) maybe_cropped |= 1u << (2 * d);
    if (last + slack > high[d]) maybe_cropped |= 2u << (2 * d);
  }
  ASSERT_EQ(cut.cropped_sides & cropped, cropped);
  ASSERT_EQ(cut.cropped_sides | maybe_cropped, maybe_cropped);
  std::uint64_t wrong = 0;
  reference::DenseGrid({low[0] - 3, low[1] - 3, low[2] - 3},
                       {high[0] + 3, high[1] + 3, high[2] + 3})
      .for_each([&](const lattice::VoxelIndex& v) {
        bool in_region = true;
        for (std::size_t d = 0; d < 3; ++d) in_region &= v[d] >= low[d] && v[d] <= high[d];
        const VoxelValue expected = in_region ? full.value(v[0], v[1], v[2]) : VoxelValue::kFree;
        wrong += part.value(v[0], v[1], v[2]) != expected;
        // A voxel of the region that is not free lies in the valid box.
        if (expected != VoxelValue::kFree) wrong += !inside_valid_box(cut, v);
      });
  ASSERT_EQ(wrong, 0u);
}

TEST(BakeRoi, InsideEqualsTheFullBake) {
  int held = 0;
  for (std::uint64_t seed = 1; seed <= 60; seed += test::seed_step(7)) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    RoiScene scene;
    mesh::Vec3d place;
    for (double& x : place) x = static_cast<double>(whole(random, -2, 2) * 512);
    for (std::int64_t n = whole(random, 1, 4); n > 0; --n) {
      mesh::Vec3d center = place;
      for (double& x : center) x += real(random, -20, 20);
      scene.meshes.push_back(reference::random_object(random, center, real(random, 1, 60)));
    }
    const auto layers = static_cast<std::uint32_t>(whole(random, 0, 3));
    const Metric metric = layers > 0 && seed % 3 == 0 ? Metric::kEuclidean : Metric::kChebyshev;
    const BakedScene full(scene.objects(), options_with(layers, {}, metric));
    for (int round = 0; round < 4; ++round) {
      Roi roi;
      for (std::size_t d = 0; d < 3; ++d) {
        const double a = place[d] + real(random, -45, 45), b = place[d] + real(random, -45, 45);
        roi[d] = std::min(a, b);
        roi[d + 3] = std::max(a, b) + 0.01;
        if (round == 0) roi[d] = std::round(roi[d]);  // on voxel faces
        if (round == 0) roi[d + 3] = std::round(roi[d + 3]) + 1;
      }
      const BakedScene part(scene.objects(), options_with(layers, roi, metric));
      expect_region_of(part.map(), full.map(), roi);
      if (HasFatalFailure()) return;
      held += part.map().header().dims_voxels[0] > 0;
    }
  }
  EXPECT_GT(held, static_cast<int>(100 / test::seed_step(7))) << "the regions have lost the scene";
}

// Whole nodes and blocks of a solid, cut anywhere.
TEST(BakeRoi, DeepInsideOneSolid) {
  RoiScene scene;
  reference::add_box(scene.meshes.emplace_back(), {-777, -777, -777}, {901.5, 901.5, 901.5});
  const BakedScene full(scene.objects(), options_with(2));
  Random random(1);
  const Roi rois[] = {{10, 20, 30, 50, 70, 90},       // inside one node
                      {0, 0, 0, 64, 64, 64},          // one node
                      {-512, -512, -512, 0, 0, 0},    // one block
                      {-64, -70, -1, 130, 128, 190},  // several nodes
                      {-300, -300, -300, -250.5, 400, -200},
                      {880, 880, 880, 2000, 2000, 2000},  // a corner
                      {-600, 800, 100, -520, 1000, 140},
                      {200, 300, 905, 260, 340, 930}};  // outside, next to a face
  for (const Roi& roi : rois) {
    SCOPED_TRACE(::testing::Message() << "from " << roi[0] << ' ' << roi[1] << ' ' << roi[2]);
    const BakedScene part(scene.objects(), options_with(2, roi));
    const VoxmapHeader& header = part.map().header();
    const Status audited = audit_voxmap(part.map(), "region");
    ASSERT_TRUE(audited) << to_line(audited.error());
    for (int n = 0; n < 20000; ++n) {
      lattice::VoxelIndex v;
      bool inside = true;
      for (std::size_t d = 0; d < 3; ++d) {
        const auto low = static_cast<std::int64_t>(std::floor(roi[d])),
                   high = static_cast<std::int64_t>(std::ceil(roi[d + 3])) - 1;
        v[d] = n % 3 == 0                 ? whole(random, low - 70, high + 70)
               : whole(random, 0, 1) == 0 ? low + whole(random, -3, 3)
                                          : high + whole(random, -3, 3);
        inside &= v[d] >= low && v[d] <= high;
      }
      ASSERT_EQ(part.map().value(v[0], v[1], v[2]),
                inside ? full.map().value(v[0], v[1], v[2]) : VoxelValue::kFree)
          << v[0] << ' ' << v[1] << ' ' << v[2];
    }
    EXPECT_NE(header.cropped_sides, 0u);
  }
  const BakedScene deep(scene.objects(), options_with(2, rois[3]));
  EXPECT_EQ(deep.map().header().interior_voxels, 194u * 198 * 191);
  EXPECT_EQ(deep.map().header().cropped_sides, 63u);
}

TEST(BakeRoi, ObjectsThatCannotTouchItAreSkipped) {
  RoiScene scene;
  for (int i = 0; i < 3; ++i) {
    const double x = 100 * i;
    reference::add_box(scene.meshes.emplace_back(), {x, 0, 0}, {x + 10, 10, 10});
  }
  const auto result =
      voxelize::bake(scene.objects(), options_with(2, Roi{90, -20, -20, 130, 30, 30}));
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->objects[0].skipped);
  EXPECT_FALSE(result->objects[1].skipped);
  EXPECT_TRUE(result->objects[2].skipped);
  EXPECT_EQ(result->header.triangles, 36u);
  // The last object that may still reach the region is not skipped.
  for (const auto& [low_x, skipped] : {std::pair{115.0, true}, std::pair{114.0, false}}) {
    const auto beside =
        voxelize::bake(scene.objects(), options_with(2, Roi{low_x, 0, 0, 150, 10, 10}));
    ASSERT_TRUE(beside);
    EXPECT_EQ(beside->objects[1].skipped, skipped) << low_x;
  }
}

// Also where the scene's box ends inside the region, or the region lies beside the scene.
TEST(BakeRoi, BesideTheScene) {
  RoiScene scene;
  reference::add_box(scene.meshes.emplace_back(), {0, 0, 0}, {10, 10, 10});
  for (const Roi& roi : {Roi{1000, 1000, 1000, 1e9, 1e9, 1e9}, Roi{-50, -50, -50, -20, 100, 100},
                         Roi{14, 0, 0, 15, 5, 5}}) {
    const BakedScene part(scene.objects(), options_with(2, roi));
    const VoxmapHeader& header = part.map().header();
    EXPECT_EQ(header.dims_voxels, (std::array<std::uint64_t, 3>{}));
    EXPECT_NE(header.cropped_sides, 0u);
    EXPECT_TRUE(audit_voxmap(part.map(), "region"));
  }
  const BakedScene full(scene.objects(), options_with(2));
  const BakedScene around(scene.objects(), options_with(2, Roi{-100, -100, -100, 100, 100, 100}));
  EXPECT_EQ(around.bytes(), full.bytes()) << "a region that holds the scene crops nothing";
}

// A seed outside the region opens what reaches into it.
TEST(BakeRoi, SeedsOutsideCount) {
  RoiScene scene;
  reference::add_box(scene.meshes.emplace_back(), {0, 0, 0}, {100, 100, 100});
  voxelize::BakeOptions options = options_with(2, Roi{40, 40, 40, 60, 60, 60});
  options.free_seeds_m = {{10, 10, 10}};
  EXPECT_EQ(BakedScene(scene.objects(), options).map().header().interior_voxels, 0u);
}

}  // namespace
}  // namespace forcelayer
