// Measuring: what is picked of the scene and of the part, the distance; and the turntable's ways.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "tests/support/golden_bytes.h"
#include "tests/support/random_numbers.h"
#include "workbench/viewer/plan/camera.h"
#include "workbench/viewer/plan/measurement.h"
#include "workbench/viewer/plan/mesh_pick.h"

namespace forcelayer::viewer {
namespace {

TEST(Measurement, TellsTheDistanceOfTwoPlaces) {
  Measurement measurement;
  EXPECT_EQ(measurement.words({}), "");
  measurement.pick({"bay/floor/beam", {0.1, 0.2, 0.3}});
  EXPECT_EQ(
      measurement.words({}),
      "first point: beam at x 100.000, y 200.000, z 300.000 mm    key m: second point, at the "
      "pointer");
  measurement.pick({"skin", {0.1, 0.23, 0.34}});
  EXPECT_EQ(measurement.words({}),
            "measured: 50.000 mm from beam to skin    x 0.000, y 30.000, z 40.000 mm");
  measurement.pick({"skin", {0, 0, 0}});
  EXPECT_EQ(measurement.places_m({}).size(), 1u) << "a third begins anew";
  measurement.clear();
  EXPECT_TRUE(measurement.empty());
}

TEST(Measurement, APlaceOfThePartGoesWithIt) {
  Measurement measurement;
  measurement.pick({"the part", {0.01, 0, 0}, true});
  measurement.pick({"wall", {1, 0, 0}});
  const Pose quarter{{0, 0, 0.5}, glm::angleAxis(std::numbers::pi / 2, glm::dvec3(0, 0, 1))};
  const auto places = measurement.places_m(quarter);
  EXPECT_NEAR(glm::distance(places[0], glm::dvec3(0, 0.01, 0.5)), 0, 1e-15);
  EXPECT_EQ(places[1], glm::dvec3(1, 0, 0));
}

// A ray meets a part that was moved where it meets the resting part, moved.
TEST(PartOn, MeetsAMovedPartWhereItIs) {
  ViewScene scene;
  scene.part = ViewMesh{"part", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const Ray down{{0.25, 0.25, 2}, {0, 0, -4}};
  EXPECT_EQ(part_on(scene, true, {}, down), 0.5);
  EXPECT_EQ(part_on(scene, true, {}, {{0.75, 0.75, 2}, {0, 0, -1}}), std::nullopt);
  EXPECT_EQ(part_on(scene, false, {}, down), std::nullopt) << "no shell";
  const Pose pose{{3, -1, 2}, glm::normalize(glm::dquat(0.3, 0.5, -0.7, 0.2))};
  const Ray moved{pose.orientation * down.from_m + pose.position_m, pose.orientation * down.along};
  const auto along = part_on(scene, true, pose, moved);
  ASSERT_TRUE(along);
  EXPECT_NEAR(*along, 0.5, 1e-12);
}

// A ray to a shell point, against its normal, meets the disc at the point, or one before it.
TEST(PartOn, MeetsTheDiscsOfAShell) {
  ViewScene scene;
  scene.shell.emplace(Pshell::open(testing::golden_path("v2.pshell")).value());
  const PshellView& view = scene.shell->view();
  const auto& center = scene.shell->header().center_m;
  for (std::uint64_t n = 0; n < view.point_count; ++n) {
    const glm::dvec3 inward(view.nx[n], view.ny[n], view.nz[n]);
    const glm::dvec3 point(center[0] + double{view.x[n]}, center[1] + double{view.y[n]},
                           center[2] + double{view.z[n]});
    const auto along = part_on(scene, false, {}, {point - 0.01 * inward, inward});
    ASSERT_TRUE(along);
    EXPECT_LE(*along, 0.01 + 1e-9);
  }
  EXPECT_EQ(part_on(scene, false, {}, {{9, 9, 9}, {1, 0, 0}}), std::nullopt);
}

TEST(Turned, KeepsTheHorizonLevelAndZUp) {
  test::Random random(31);
  Orbit orbit{{0, 0, 1}, {0, 1, 0}};  // from above
  for (int n = 0; n < 1000; ++n) {
    orbit = turned(orbit, test::uniform(random, -1, 1), test::uniform(random, -1, 1));
    EXPECT_NEAR(glm::length(orbit.to_eye), 1, 1e-12);
    EXPECT_NEAR(glm::length(orbit.up), 1, 1e-12);
    EXPECT_NEAR(glm::dot(orbit.up, orbit.to_eye), 0, 1e-12);
    EXPECT_NEAR(glm::cross(orbit.up, orbit.to_eye).z, 0, 1e-12) << "the horizon tilts";
    EXPECT_GE(orbit.up.z, -1e-12);
  }
}

TEST(Turned, GoesRoundAndBackAndStopsAtThePoles) {
  const CameraView start = camera_along({0, -1, 0.5});
  const Orbit once = turned({start.to_eye, start.up}, std::numbers::pi / 2, 0);
  EXPECT_NEAR(glm::distance(once.to_eye, glm::normalize(glm::dvec3(1, 0, 0.5))), 0, 1e-12);
  const Orbit back = turned(once, -std::numbers::pi / 2, 0);
  EXPECT_NEAR(glm::distance(back.to_eye, start.to_eye), 0, 1e-12);
  EXPECT_NEAR(glm::distance(back.up, start.up), 0, 1e-12);
  const Orbit above = turned({start.to_eye, start.up}, 0, 9);
  EXPECT_NEAR(glm::distance(above.to_eye, glm::dvec3(0, 0, 1)), 0, 1e-12);
  EXPECT_NEAR(glm::distance(above.up, glm::dvec3(0, 1, 0)), 0, 1e-12);
}

}  // namespace
}  // namespace forcelayer::viewer
