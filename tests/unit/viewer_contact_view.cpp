// The picture of a moment, on a scene that can be checked by hand.
#include <gtest/gtest.h>

#include "tests/support/dense_voxmap.h"
#include "tests/support/make_pshell.h"
#include "workbench/viewer/plan/camera.h"
#include "workbench/viewer/run/contact_view.h"

namespace forcelayer::testing {
namespace {

constexpr double kVoxel = 0.01;  // m

// Half space below z = 0: interior, a force layer [0, s), proximity [s, 2 s).
DenseVoxels half_space() {
  DenseVoxels voxels({-8, -8, -6}, {16, 16, 8}, kVoxel);
  voxels.fill({-8, -8, -6}, {8, 8, 0}, VoxelValue::kInterior);
  voxels.fill({-8, -8, 0}, {8, 8, 1}, VoxelValue::kSurface);
  voxels.fill({-8, -8, 1}, {8, 8, 2}, VoxelValue::kProximity);
  return voxels;
}

// One point below the part's frame by 20 mm, its inward normal upwards.
BuiltPshell foot() {
  TestShellOptions options;
  options.center_m = {0.001, 0.002, 0.003};
  return BuiltPshell({{0, 0, -0.02}}, {{0, 0, 1}}, options);
}

viewer::ContactView view_at(double height_m) {
  const BuiltVoxmap scene(half_space());
  const BuiltPshell part = foot();
  auto field = field::make_force_field(Model::kPaper, ForceKind::kTangentPlane, scene.voxmap());
  viewer::ContactViewSource source(scene.voxmap(), part.pshell(), Model::kPaper, std::move(*field));
  return source.at({{0.004, 0.004, height_m}, {1, 0, 0, 0}});
}

TEST(ContactView, NamesEachKindOfFrame) {
  EXPECT_EQ(view_at(0.050).kind(), viewer::FrameKind::kFree);
  EXPECT_EQ(view_at(0.034).kind(), viewer::FrameKind::kProximity);
  EXPECT_EQ(view_at(0.027).kind(), viewer::FrameKind::kForceLayer);  // above the tangent plane
  EXPECT_EQ(view_at(0.022).kind(), viewer::FrameKind::kContact);
  EXPECT_EQ(view_at(0.018).kind(), viewer::FrameKind::kPenetration);
}

TEST(ContactView, PlacesTheContactWhereItIs) {
  const viewer::ContactView view = view_at(0.022);
  ASSERT_EQ(view.points.size(), 1u);
  const viewer::ViewPoint& point = view.points.front();
  // The query's float arithmetic is good to some 1e-7 of the part's 20 mm.
  EXPECT_NEAR(point.position_m.x, 0.004, 1e-8);
  EXPECT_NEAR(point.position_m.z, 0.002, 1e-8);
  EXPECT_NEAR(point.depth_m, 0.003, 1e-8);  // the voxel's center is at 5 mm
  EXPECT_EQ(point.direction, glm::dvec3(0, 0, 1));
  EXPECT_EQ(view.contacts, 1u);
  EXPECT_EQ(view.surface, 1u);
  EXPECT_EQ(view.deepest_m, point.depth_m);
}

TEST(Camera, LooksThroughTheOpenSide) {
  DenseVoxels voxels({0, 0, 0}, {40, 40, 40}, kVoxel);
  voxels.fill({0, 0, 0}, {40, 40, 40}, VoxelValue::kInterior);
  voxels.fill({5, 5, 5}, {35, 40, 35}, VoxelValue::kFree);  // open towards +y
  const BuiltVoxmap scene(voxels);
  const glm::dvec3 direction =
      viewer::clearest_direction(scene.voxmap(), {{0.2, 0.2, 0.2}}, {}, 1.0);
  EXPECT_GT(direction.y, 0.7);
}

TEST(Camera, FramesTheWholeBox) {
  viewer::WorldBox box;
  box.add({-1, -1, -1});
  box.add({3, 1, 0});
  const viewer::CameraView wide = viewer::frame_box(box, {0, -1, 0}, 2.0);
  EXPECT_EQ(wide.target_m, glm::dvec3(1, 0, -0.5));
  EXPECT_EQ(wide.up, glm::dvec3(0, 0, 1));
  EXPECT_NEAR(wide.half_height_m, 1.08 * 1.0, 1e-12);  // 4 m wide at twice the height
  EXPECT_EQ(viewer::frame_box(box, {0, 0, 1}, 1.0).up, glm::dvec3(0, 1, 0));
}

}  // namespace
}  // namespace forcelayer::testing
