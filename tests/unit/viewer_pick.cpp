// The voxel that a ray through a voxmap meets first.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/golden_bytes.h"
#include "workbench/viewer/surface/pick.h"

namespace forcelayer::viewer {
namespace {

using Voxel = std::array<std::int64_t, 3>;

// Two objects: `left` in voxel (3, 3, 3) of 1 mm, `right` in (4, 4, 4).
class Pick : public ::testing::Test {
 protected:
  Pick() : map_(Voxmap::open(testing::golden_path("v2_distances.vox")).value()) {}

  // The object that the ray meets; empty where there is none.
  std::string_view object_on(const Ray& ray, const HiddenObjects& hidden = {}) const {
    const auto voxel = interior_on(map_, ray, {}, hidden);
    return voxel ? object_of(map_, *voxel) : std::string_view();
  }

  Voxmap map_;
};

TEST_F(Pick, MeetsTheFirstInteriorVoxelOfItsSide) {
  const Ray up{{0.0035, 0.0035, -1}, {0, 0, 2}}, down{{0.0035, 0.0035, 1}, {0, 0, -1}};
  EXPECT_EQ(interior_on(map_, up, {}), (Voxel{3, 3, 2}));
  EXPECT_EQ(interior_on(map_, down, {}), (Voxel{3, 3, 5}));
  EXPECT_EQ(object_on(up), "left");
  EXPECT_EQ(object_on(down), "right");
}

TEST_F(Pick, MeetsNothingBesideTheScene) {
  EXPECT_EQ(interior_on(map_, {{0.0035, 0.0095, -1}, {0, 0, 1}}, {}), std::nullopt);
  EXPECT_EQ(interior_on(map_, {{0.0005, 0.0005, -1}, {0, 0, 1}}, {}), std::nullopt);
  EXPECT_EQ(interior_on(map_, {{0.0035, 0.0035, 1}, {0, 0, 1}}, {}), std::nullopt) << "behind";
  EXPECT_EQ(object_on({{0.0005, 0.0005, -1}, {0, 0, 1}}), "");
}

TEST_F(Pick, GoesThroughHiddenObjects) {
  const Ray up{{0.0035, 0.0035, -1}, {0, 0, 2}};
  EXPECT_EQ(object_on(up, {1, 1, 0}), "right");
  EXPECT_EQ(object_on(up, {1, 0, 1}), "left");
  EXPECT_EQ(object_on(up, {1, 1, 1}), "");
}

TEST_F(Pick, BeginsAtACut) {
  const Ray up{{0.0035, 0.0035, -1}, {0, 0, 1}}, down{{0.0035, 0.0035, 1}, {0, 0, -1}};
  EXPECT_EQ(interior_on(map_, up, Cut{2, 0.004, false}), (Voxel{3, 3, 4}));
  EXPECT_EQ(interior_on(map_, down, Cut{2, 0.004, true}), (Voxel{3, 3, 3}));
  EXPECT_EQ(interior_on(map_, up, Cut{2, 0.002, true}), std::nullopt);
  EXPECT_EQ(interior_on(map_, up, Cut{0, 0.0045, false}), std::nullopt);
}

// Every voxel in front of the one that is met holds no interior, by points on the ray.
TEST_F(Pick, ObliqueRaysMissNothing) {
  int met = 0;
  for (int n = 0; n < 400; ++n) {
    const glm::dvec3 from{-0.02, 0.0007 * (n % 20) - 0.002, 0.0007 * (n / 20) - 0.002};
    const glm::dvec3 along{1, 0.3 - 0.03 * (n % 20), 0.35 - 0.035 * (n / 20)};
    std::optional<Voxel> expected;
    for (double t = 0; t < 0.05 && !expected; t += 1e-6) {
      Voxel v;
      for (int axis = 0; axis < 3; ++axis) {
        v[static_cast<std::size_t>(axis)] =
            static_cast<std::int64_t>(std::floor((from[axis] + t * along[axis]) / 0.001));
      }
      if (map_.value(v[0], v[1], v[2]) == VoxelValue::kInterior) expected = v;
    }
    EXPECT_EQ(interior_on(map_, {from, along}, {}), expected) << "ray " << n;
    met += expected.has_value();
  }
  EXPECT_GT(met, 20);
}

}  // namespace
}  // namespace forcelayer::viewer
