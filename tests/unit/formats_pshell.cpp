// A .pshell that is written and read again has the same content.
#include <gtest/gtest.h>

#include "tests/support/make_pshell.h"

namespace forcelayer::testing {
namespace {

TEST(Pshell, KeepsPointsNormalsAndFacts) {
  std::vector<Vec3> points, normals;
  for (int i = 0; i < 130; ++i) {
    points.push_back({0.01 * i, 0.02, -0.03 * i});
    normals.push_back({0, 0, i % 2 ? 2.0 : -1.0});
  }
  TestShellOptions options;
  options.center_m = {0.5, 0, -1};
  options.cones = true;
  options.provenance = R"({"made":"by hand"})";
  const BuiltPshell built(points, normals, options);
  const PshellView& view = built.pshell().view();
  ASSERT_EQ(view.point_count, 130u);
  EXPECT_EQ(view.block_count, 3u);
  EXPECT_EQ(view.super_block_count, 1u);
  for (std::size_t i = 0; i < 130; ++i) {
    EXPECT_EQ(view.x[i], static_cast<float>(points[i][0] - 0.5));
    EXPECT_EQ(view.z[i], static_cast<float>(points[i][2] + 1));
    EXPECT_EQ(view.nz[i], i % 2 ? 1.0f : -1.0f);
    EXPECT_EQ(view.weight_m2[i], 2.5e-5f);
    EXPECT_EQ(view.cone_cos[i], 1.0f);
  }
  for (std::size_t i = 130; i < 192; ++i) {
    EXPECT_EQ(view.x[i], view.x[129]);
    EXPECT_EQ(view.weight_m2[i], 0.0f);
  }
  EXPECT_EQ(built.pshell().header().center_m, options.center_m);
  EXPECT_EQ(built.pshell().provenance(), options.provenance);
}

}  // namespace
}  // namespace forcelayer::testing
