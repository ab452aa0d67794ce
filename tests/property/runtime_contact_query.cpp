// The contact query against its slow twins.
#include <gtest/gtest.h>

#include "runtime/query/contact_query.h"
#include "tests/support/random_scenes.h"
#include "tests/support/reference_query.h"

namespace forcelayer::test {
namespace {

constexpr int kScenes = 60;
constexpr int kPosesPerScene = 20;

void expect_same_points(const query::CollectedPoints& found, const std::vector<TwinPoint>& twin,
                        const Voxmap& voxmap) {
  ASSERT_EQ(found.count, twin.size());
  std::uint32_t counts[4] = {};
  for (std::uint32_t i = 0; i < found.count; ++i) {
    const TwinPoint& t = twin[i];
    const auto& origin = voxmap.header().directory_origin;
    ASSERT_EQ(found.index[i], t.index);
    ASSERT_EQ(found.value[i], static_cast<std::uint8_t>(t.value));
    ASSERT_EQ(found.vx[i] + origin[0], t.voxel[0]);
    ASSERT_EQ(found.vy[i] + origin[1], t.voxel[1]);
    ASSERT_EQ(found.vz[i] + origin[2], t.voxel[2]);
    ASSERT_EQ((std::array{found.fx[i], found.fy[i], found.fz[i]}), t.fraction);
    ASSERT_EQ((std::array{found.rx[i], found.ry[i], found.rz[i]}), t.offset_m);
    ASSERT_EQ((std::array{found.nx[i], found.ny[i], found.nz[i]}), t.normal);
    ++counts[found.value[i]];
  }
  EXPECT_EQ(found.interior_count, counts[1]);
  EXPECT_EQ(found.surface_count, counts[2]);
  EXPECT_EQ(found.proximity_count, counts[3]);
}

// Bit for bit, near the origin and far from it.
TEST(ContactQueryProperty, FindsWhatTestingEveryPointFinds) {
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const VoxelScene scene = random_scene(random, seed % 3 == 0 ? 50'000'000 : 0);
    const PointPart part = random_part(random, scene.voxel_size_m);
    const Voxmap voxmap = make_voxmap(scene);
    const Pshell shell = make_pshell(part);
    query::ContactQuery query(voxmap, shell);
    query::CollectedPoints found;
    found.reserve(part.points.size());
    for (int i = 0; i < kPosesPerScene; ++i) {
      const Pose pose = random_pose(random, scene);
      query.run(pose, found);
      expect_same_points(found, float_twin(scene, part, pose), voxmap);
      if (HasFatalFailure()) return;
    }
  }
}

// In double precision, except for points nearer to a voxel face than the rounding bound.
TEST(ContactQueryProperty, MisplacesNoPointByMoreThanItsRoundingBound) {
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const VoxelScene scene = random_scene(random, seed % 3 == 0 ? 50'000'000 : 0);
    const PointPart part = random_part(random, scene.voxel_size_m);
    const Voxmap voxmap = make_voxmap(scene);
    const Pshell shell = make_pshell(part);
    const query::ContactQuery query(voxmap, shell);
    // Beside the query's own rounding, the reference places the center with another product:
    // 2^-51 of the largest index.
    const double bound_voxels = query.rounding_bound_m() / scene.voxel_size_m + 5.1e7 * 0x1p-51;
    for (int i = 0; i < kPosesPerScene; ++i) {
      const Pose pose = random_pose(random, scene);
      const auto exact = double_twin(scene, part, pose);
      const query::VoxelPose v = query.voxel_pose(pose);
      if (!v.within_reach) continue;
      for (const TwinPoint& t : exact) {
        const auto& p = part.points[t.index];
        for (int axis = 0; axis < 3; ++axis) {
          const float position = v.turn[axis][0] * p[0] + v.turn[axis][1] * p[1] +
                                 v.turn[axis][2] * p[2] + v.fraction[axis];
          const double error =
              static_cast<double>(v.whole[axis] + voxmap.header().directory_origin[axis] -
                                  t.voxel[axis]) +
              double{position} - t.exact_fraction[axis];
          ASSERT_LE(std::abs(error), bound_voxels);
        }
      }
    }
  }
}

}  // namespace
}  // namespace forcelayer::test
