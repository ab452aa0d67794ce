// How stiff a sampled spring may be: bounds from the literature, used for defaults and warnings.
#pragma once

namespace forcelayer {

// A mass on springs and dampers, integrated by symplectic Euler, is stable while
//   h^2 k + 2 h b < 4   (k, b: stiffness and damping over mass; Jury's criterion on the 2x2 map).
// Returns the left side over the right: below 1 is stable.
double symplectic_euler_load(double stiffness_per_mass_1ps2, double damping_per_mass_1ps,
                             double dt_s);

// Largest stiffness that a device with physical damping b can render with one frame of sampling T
// and a delay t_d besides: K < b / (t_d + T / 2) (Colgate and Schenkel 1994, with delay). Infinite
// where no damping is declared (then nothing is known).
double renderable_stiffness(double damping, double delay_s, double dt_s);

// Largest stiffness whose energy from an encoder's steps D a Coulomb friction f dissipates:
// K < 2 f / D (Abbott and Okamura 2005). Infinite where one of the two is not declared.
double dissipated_stiffness(double friction, double encoder_step);

// Largest damping B that a loop with a frame of sampling T and a delay t_d can render on a handle
// of inertia M: B < M / (t_d + T / 2). The loop is an integrator with a delay, and crosses over at
// B / M; there the delay has taken at most one radian of its ninety degrees. Infinite where no
// inertia is declared.
double renderable_damping(double inertia, double delay_s, double dt_s);

}  // namespace forcelayer
