#include "runtime/run/stability.h"

#include <limits>

namespace forcelayer {

double symplectic_euler_load(double stiffness_per_mass_1ps2, double damping_per_mass_1ps,
                             double dt_s) {
  return (dt_s * dt_s * stiffness_per_mass_1ps2 + 2 * dt_s * damping_per_mass_1ps) / 4;
}

double renderable_stiffness(double damping, double delay_s, double dt_s) {
  if (!(damping > 0)) return std::numeric_limits<double>::infinity();
  return damping / (delay_s + dt_s / 2);
}

double dissipated_stiffness(double friction, double encoder_step) {
  if (!(friction > 0) || !(encoder_step > 0)) return std::numeric_limits<double>::infinity();
  return 2 * friction / encoder_step;
}

double renderable_damping(double inertia, double delay_s, double dt_s) {
  if (!(inertia > 0)) return std::numeric_limits<double>::infinity();
  return inertia / (delay_s + dt_s / 2);
}

}  // namespace forcelayer
