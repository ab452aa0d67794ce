#include "runtime/model/motion_allowance.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "runtime/coupling/coupling.h"

namespace forcelayer::model {

namespace {

constexpr double kNothing = 1e-9;  // of the limit: below it the allowance is zero

}  // namespace

double handle_work_j(const Pose& before, const Pose& after, double force_n,
                     double torque_nm) noexcept {
  const glm::dvec3 path_m = after.position_m - before.position_m;
  const glm::dvec3 turn_rad =
      coupling::rotation_vector(after.orientation * glm::conjugate(before.orientation));
  return force_n * glm::length(path_m) + torque_nm * glm::length(turn_rad);
}

double faded_allowance_j(double allowance_j, double work_j, const AllowanceLaw& law,
                         double dt_s) noexcept {
  const double filled = std::min(law.limit_j, allowance_j + work_j);
  const double faded = filled * std::exp(-dt_s / law.fade_s);
  return faded > kNothing * law.limit_j ? faded : 0;
}

}  // namespace forcelayer::model
