#include "runtime/coupling/passivity.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "runtime/coupling/coupling.h"

namespace forcelayer::coupling {

double held_work_j(const Wrench& wrench, const Pose& from, const Pose& to) noexcept {
  return glm::dot(wrench.force_n, to.position_m - from.position_m) +
         glm::dot(wrench.torque_nm,
                  rotation_vector(to.orientation * glm::conjugate(from.orientation)));
}

void add_given(EpisodeEnergy& energy, double to_hand_j) noexcept {
  energy.given_j += to_hand_j;
  energy.peak_j = std::max(energy.peak_j, energy.given_j);
}

void end_episode(EpisodeEnergy& energy) noexcept {
  energy.generated_j += energy.peak_j;
  energy.given_j = energy.peak_j = energy.damping_ns_per_m = 0;
}

Wrench passivity_damping(EpisodeEnergy& energy, const Twist& handle_velocity, double radius_m,
                         double limit_ns_per_m, double dt_s) noexcept {
  const Twist& v = handle_velocity;
  const double speed2 = glm::dot(v.linear_mps, v.linear_mps) +
                        radius_m * radius_m * glm::dot(v.angular_radps, v.angular_radps);
  // The damping that takes all of it back in one frame at this speed, within the limit.
  const double takes_all = energy.given_j / (dt_s * speed2);
  const double wanted = energy.given_j > 0 ? std::min(limit_ns_per_m, takes_all) : 0;
  double& damping = energy.damping_ns_per_m;
  damping += (wanted - damping) * dt_s / (dt_s + kControlS);
  // Never more than there is to take, whatever it was a moment ago.
  const double now = std::min(damping, wanted);
  return {-now * v.linear_mps, -now * radius_m * radius_m * v.angular_radps};
}

glm::dvec3 felt_stretch(const glm::dvec3& stretch, glm::dvec3& held_back, double dt_s) noexcept {
  const double held = glm::length(held_back);
  if (!(held > 0)) return stretch;
  const glm::dvec3 direction = held_back / held;
  const double along = std::clamp(glm::dot(stretch, direction), 0.0, held);
  held_back = direction * (along * std::exp(-dt_s / kHeldBackFadeS));
  return stretch - direction * along;
}

}  // namespace forcelayer::coupling
