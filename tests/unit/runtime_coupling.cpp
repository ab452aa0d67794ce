// Rotation vectors and the virtual coupling's target.
#include "runtime/coupling/coupling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "tests/support/random_scenes.h"

namespace forcelayer::test {
namespace {

TEST(Coupling, RotationVectorsGoThereAndBack) {
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    Random random(seed);
    // Angles from 1e-12 to pi, both signs of the quaternion.
    const double angle = std::min(std::exp(uniform(random, -27.6, 1.15)), 3.141592);
    const glm::dvec3 axis = random_direction(random);
    const glm::dquat q = coupling::rotation_by(axis * angle) * (random() % 2 ? 1.0 : -1.0);
    const glm::dvec3 back = coupling::rotation_vector(q);
    // Near pi the cosine is flat: an error of 1e-16 in it is 1e-10 in the angle at most here.
    EXPECT_NEAR(glm::length(back - axis * angle), 0, 1e-9 * angle) << "seed " << seed;
    EXPECT_NEAR(glm::length(q), 1, 4e-16) << "seed " << seed;
  }
  EXPECT_EQ(coupling::rotation_vector({1, 0, 0, 0}), glm::dvec3(0));
  EXPECT_EQ(coupling::rotation_vector({-1, 0, 0, 0}), glm::dvec3(0));
}

TEST(Coupling, TargetMovesLikeARigidExtensionOfTheHandle) {
  State state;
  state.handle_from_center.position_m = {0.1, 0, 0};
  StepInput input;
  input.world_from_handle.position_m = {1, 2, 3};
  input.world_from_handle.orientation = coupling::rotation_by({0, 0, M_PI / 2});
  input.handle_velocity.linear_mps = {0.5, 0, 0};
  input.handle_velocity.angular_radps = {0, 0, 2};
  const coupling::CouplingTarget target = coupling::coupling_target(state, input);
  const glm::dvec3 expected_m(1, 2.1, 3), expected_mps(0.5 - 2 * 0.1, 0, 0);
  EXPECT_LT(glm::length(target.world_from_center.position_m - expected_m), 1e-15);
  EXPECT_LT(glm::length(target.velocity.linear_mps - expected_mps), 1e-15);
}

TEST(Coupling, StretchTurnsThePartToTheTarget) {
  State state;
  state.world_from_center.orientation = coupling::rotation_by({0.3, 0, 0});
  coupling::CouplingTarget target;
  target.world_from_center.orientation =
      coupling::rotation_by({0, 0.2, 0}) * coupling::rotation_by({0.3, 0, 0});
  const coupling::CouplingStretch stretch = coupling::coupling_stretch(state, target);
  EXPECT_LT(glm::length(stretch.rotation_rad - glm::dvec3(0, 0.2, 0)), 1e-15);
}

}  // namespace
}  // namespace forcelayer::test
