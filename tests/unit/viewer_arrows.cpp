// Arrows of contacts: only so many, and only so long, that a reader can distinguish them.
#include <gtest/gtest.h>

#include "tests/support/dense_voxmap.h"
#include "tests/support/make_pshell.h"
#include "workbench/viewer/plan/arrows.h"

namespace forcelayer::testing {
namespace {

constexpr double kVoxel = 0.01, kRadius = 0.025;  // m

// A scene and a part, for their sizes alone.
struct Files {
  AlignedBytes map, part;
  viewer::ViewScene scene;

  Files()
      : map(dense_voxmap_bytes(DenseVoxels({0, 0, 0}, {8, 8, 8}, kVoxel), {})),
        part(pshell_bytes(TestShell({{0, 0, -kRadius}}, {{0, 0, 1}}, {}).content())) {
    auto voxmap = Voxmap::from_bytes(map.bytes(), "map", Verify::kStructureAndChecksums);
    auto shell = Pshell::from_bytes(part.bytes(), "part", Verify::kStructureAndChecksums);
    if (voxmap) scene.voxmap = std::move(*voxmap);
    if (shell) scene.shell = std::move(*shell);
  }
};

// As many contacts, the n-th n times `step_m` deep.
viewer::ContactView contacts_of(std::size_t count, double step_m) {
  viewer::ContactView view;
  for (std::size_t n = 1; n <= count; ++n) {
    view.points.push_back(
        {{0, 0, 0}, {0, 0, 1}, VoxelValue::kSurface, step_m * static_cast<double>(n), {0, 0, 1}});
  }
  return view;
}

TEST(Arrows, AreThoseOfTheDeepestContacts) {
  const Files files;
  ASSERT_TRUE(files.scene.voxmap && files.scene.shell);
  const viewer::Arrows arrows = arrows_of(files.scene, contacts_of(150, 1e-5));
  ASSERT_EQ(arrows.points.size(), viewer::kMaxArrows);
  EXPECT_EQ(arrows.points.front(), 149u);
  EXPECT_EQ(arrows.points.back(), 150 - viewer::kMaxArrows);
  EXPECT_EQ(arrows.left_out, 150 - viewer::kMaxArrows);
  EXPECT_EQ(arrows_of(files.scene, contacts_of(3, 1e-5)).left_out, 0u);
}

TEST(Arrows, AreNotLongerThanThePart) {
  const Files files;
  ASSERT_TRUE(files.scene.voxmap && files.scene.shell);
  // Half the radius for a tenth of a voxel, 12.5 times, rounded down; and so for most contacts.
  EXPECT_DOUBLE_EQ(arrows_of(files.scene, contacts_of(0, 0)).per_depth, 10);
  EXPECT_DOUBLE_EQ(arrows_of(files.scene, contacts_of(2, 0.001)).per_depth, 10);
  EXPECT_DOUBLE_EQ(arrows_of(files.scene, contacts_of(3, 0.001)).per_depth, 5);
  for (const double deepest_m : {0.003, 0.01, 0.04, 3.0}) {
    const double per_depth = arrows_of(files.scene, contacts_of(1, deepest_m)).per_depth;
    EXPECT_LE(per_depth * deepest_m, kRadius) << deepest_m;
    EXPECT_GE(per_depth * deepest_m, kRadius / 2.5) << deepest_m;
  }
}

TEST(Arrows, LeaveOutTheInterior) {
  const Files files;
  viewer::ContactView view = contacts_of(2, 0.001);
  view.points[1].value = VoxelValue::kInterior;
  view.points.push_back({{0, 0, 0}, {0, 0, 1}, VoxelValue::kSurface});  // no depth
  const viewer::Arrows arrows = arrows_of(files.scene, view);
  EXPECT_EQ(arrows.points, std::vector<std::size_t>{0});
  EXPECT_EQ(arrows.left_out, 0u);
}

}  // namespace
}  // namespace forcelayer::testing
