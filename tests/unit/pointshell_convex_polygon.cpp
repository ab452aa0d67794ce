// Cutting convex polygons by planes.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pointshell/certificate/convex_polygon.h"

namespace forcelayer {
namespace {

certificate::ConvexPolygon regular_polygon(int corners) {
  std::vector<part::Vec3> places;
  for (int n = 0; n < corners; ++n) {
    const double angle = 2 * M_PI * (n + 0.5) / corners;
    places.push_back({std::cos(angle), std::sin(angle), 0});
  }
  return certificate::ConvexPolygon(places);
}

TEST(ConvexPolygon, IsSplitIntoTwo) {
  for (const int corners : {3, 4, 31}) {
    certificate::ConvexPolygon kept = regular_polygon(corners), rest;
    EXPECT_TRUE(kept.split({1, 0, 0}, 0.1, rest)) << corners;
    for (const part::Vec3& corner : kept.corners()) EXPECT_LE(corner.x, 0.1 + 1e-15);
    for (const part::Vec3& corner : rest.corners()) EXPECT_GE(corner.x, 0.1 - 1e-15);
    EXPECT_FALSE(kept.empty());
    EXPECT_FALSE(rest.empty());
  }
}

TEST(ConvexPolygon, WhollyOnOneSideIsSplitFromNothing) {
  certificate::ConvexPolygon kept = regular_polygon(5), rest;
  EXPECT_TRUE(kept.split({1, 0, 0}, 2, rest));
  EXPECT_EQ(kept.corners().size(), 5u);
  EXPECT_TRUE(rest.empty());
}

TEST(ConvexPolygon, SaysThatItHasTooManyCornersToBeCut) {
  certificate::ConvexPolygon kept = regular_polygon(32), rest;
  EXPECT_FALSE(kept.split({1, 0, 0}, 0, rest));
  EXPECT_EQ(kept.corners().size(), 32u);
  EXPECT_EQ(rest.corners().size(), 32u);
}

}  // namespace
}  // namespace forcelayer
