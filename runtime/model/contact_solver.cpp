#include "runtime/model/contact_solver.h"

#include <algorithm>
#include <cmath>

namespace forcelayer::model {
namespace {

constexpr int kMaxIterations = 12;
// Rows that begin to push all at once can be a million times as hard as the part is heavy.
constexpr int kMaxHalvings = 32;
constexpr double kConverged = 1e-10;  // change of the velocity over its size: ends the iterations

// v A v / 2 - b v.
struct Quadratic {
  coupling::Symmetric6 matrix;
  coupling::Vector6 impulse{};

  bool operator==(const Quadratic&) const = default;
};

// All but the rows, at the secant that belongs to `guess`.
Quadratic smooth_part(const StepSystem& system, const coupling::Vector6& guess) {
  Quadratic q{system.inertia, system.momentum};
  coupling::add_force(system.translation, system.displacement, system.arm_m, guess, system.dt_s,
                      q.matrix, q.impulse);
  coupling::add_torque(system.rotation, system.angle, guess, system.dt_s, q.matrix, q.impulse);
  return q;
}

double energy_j(const Quadratic& q, const coupling::Vector6& v) {
  return 0.5 * coupling::dot(v, q.matrix * v) - coupling::dot(v, q.impulse);
}

Quadratic with_rows(Quadratic q, const ContactRowSum& rows) {
  for (std::size_t i = 0; i < q.matrix.lower.size(); ++i) q.matrix.lower[i] += rows.matrix.lower[i];
  for (std::size_t i = 0; i < 6; ++i) q.impulse[i] += rows.impulse[i];
  return q;
}

// Whether `q` is no larger at `to` than at `from`, by their difference: its terms are as small as
// the step, where those of the energies may be so large that they round it away.
bool descends(const Quadratic& q, const coupling::Vector6& from, const coupling::Vector6& to) {
  coupling::Vector6 step, slope = q.matrix * to;  // the latter at `to`
  for (int i = 0; i < 6; ++i) step[i] = to[i] - from[i];
  for (int i = 0; i < 6; ++i) slope[i] -= q.impulse[i];
  return coupling::dot(step, slope) - 0.5 * coupling::dot(step, q.matrix * step) <= 0;
}

coupling::Vector6 between(const coupling::Vector6& a, const coupling::Vector6& b, double fraction) {
  coupling::Vector6 v;
  for (int i = 0; i < 6; ++i) v[i] = a[i] + fraction * (b[i] - a[i]);
  return v;
}

}  // namespace

coupling::Vector6 solve_velocity(const StepSystem& system, ContactRows& rows,
                                 const coupling::Vector6& guess) noexcept {
  coupling::Vector6 v = guess;
  double rows_j = rows.energy_j(v);
  Quadratic smooth;
  bool minimal = false;  // `v` is the minimum of `smooth` and the rows that push at it
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const Quadratic last = smooth;
    smooth = smooth_part(system, v);
    if (minimal && smooth == last) break;
    const Quadratic q = with_rows(smooth, rows.pushing());
    coupling::Vector6 next = coupling::solve(q.matrix, q.impulse);
    double next_j = rows.energy_j(next);
    // Rows that push at both ends of the step push all along it, and no others do: there is nothing
    // but `q` to go down.
    minimal = rows.same_push() && descends(q, v, next);
    if (!minimal) {
      // It is convex and the step descends: halving leads to a better one. Where it does not within
      // reason, rounding has the last word, and `v` stays.
      const double before = energy_j(smooth, v) + rows_j;
      for (int halving = 0; halving < kMaxHalvings && !(energy_j(smooth, next) + next_j <= before);
           ++halving) {
        next = between(v, next, 0.5);
        next_j = rows.energy_j(next);
      }
      if (!(energy_j(smooth, next) + next_j <= before)) break;
    }
    rows_j = next_j;
    double change = 0, size = 0;
    for (int i = 0; i < 6; ++i) {
      const double mass = system.inertia.lower[coupling::Symmetric6::at(i, i)];
      change += mass * (next[i] - v[i]) * (next[i] - v[i]);
      size += mass * next[i] * next[i];
    }
    v = next;
    if (!(change > kConverged * kConverged * size)) break;
  }
  return v;
}

}  // namespace forcelayer::model
