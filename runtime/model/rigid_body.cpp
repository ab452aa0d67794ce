#include "runtime/model/rigid_body.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "runtime/coupling/coupling.h"

namespace forcelayer::model {

namespace {

// Fixed-point iterations of the midpoint rule. The guard keeps a step's rotation small, and each
// iteration gains a factor of about that rotation.
constexpr int kMidpointIterations = 3;

// A last iteration that changes the rotation by more than this fraction has not converged: the
// rotation is too fast for the step, and the rule does not bound its energy.
constexpr double kConverged = 1e-4;

}  // namespace

glm::dmat3 turned(const glm::dmat3& body, const glm::dquat& orientation) noexcept {
  const glm::dmat3 rotation = glm::mat3_cast(orientation);
  return rotation * body * glm::transpose(rotation);
}

double kinetic_energy_j(const RigidMass& mass, const glm::dquat& orientation,
                        const Twist& velocity) noexcept {
  const glm::dvec3 body_radps = glm::conjugate(orientation) * velocity.angular_radps;
  return 0.5 * mass.mass_kg * glm::dot(velocity.linear_mps, velocity.linear_mps) +
         0.5 * glm::dot(body_radps, mass.inertia_kgm2 * body_radps);
}

Pose advance(const RigidMass& mass, const Pose& world_from_center, Twist& velocity, double dt_s,
             double max_turn_rad) noexcept {
  Pose moved = world_from_center;
  moved.position_m += velocity.linear_mps * dt_s;
  if (velocity.angular_radps == glm::dvec3(0)) return moved;

  const glm::dquat& start = world_from_center.orientation;
  const glm::dvec3 momentum = turned(mass.inertia_kgm2, start) * velocity.angular_radps;
  const auto angular_at = [&](const glm::dquat& orientation) {
    return orientation * (mass.inverse_inertia_1pkgm2 * (glm::conjugate(orientation) * momentum));
  };
  glm::dvec3 middle_radps = velocity.angular_radps;
  glm::dvec3 last_radps = middle_radps;
  for (int i = 0; i < kMidpointIterations; ++i) {
    last_radps = middle_radps;
    middle_radps = angular_at(coupling::rotation_by(middle_radps * (0.5 * dt_s)) * start);
  }
  const bool resolved =
      glm::length(middle_radps - last_radps) <= kConverged * glm::length(middle_radps);
  glm::dvec3 turn_rad = middle_radps * dt_s;
  const double angle_rad = glm::length(turn_rad);
  const bool held = angle_rad > max_turn_rad;
  if (held) turn_rad *= max_turn_rad / angle_rad;
  moved.orientation = glm::normalize(coupling::rotation_by(turn_rad) * start);
  const double before = glm::dot(momentum, velocity.angular_radps);  // twice the energy
  velocity.angular_radps = angular_at(moved.orientation);
  const double after = glm::dot(momentum, velocity.angular_radps);
  // A rotation that was held ends where the rule would not: it bounds no energy there.
  if ((held || !resolved) && after > before) velocity.angular_radps *= std::sqrt(before / after);
  return moved;
}

}  // namespace forcelayer::model
