// The contact forces of the default model: springs of the force layer, each by the area for which
// its point stands, and pre-contact braking, as rows of the implicit solve. No contact knows of any
// other: what is squeezed in one place changes nothing in another.
#pragma once

#include <algorithm>
#include <glm/geometric.hpp>

#include "runtime/field/contact_set.h"
#include "runtime/field/force_curve.h"
#include "runtime/model/contact_solver.h"

namespace forcelayer::model {

struct ContactLaw {
  double stiffness_n_per_m = 0;  // of one point of mean area, where the curve is steepest
  double damping_ns_per_m = 0;   // of the same
  // A point counts by its area over the mean. On a hard scene it counts at least as one of mean
  // area, so that an edge or a corner holds the part off as a face does; on a soft one a covering
  // of twice the area is twice as stiff.
  double min_areas = 1;
  field::ForceCurve curve;
  double begin_m = 0;  // the depth at which the curve begins: that of a core under a covering

  // Force over the stiffness of a point of mean area, m; the gap to where it begins, below zero.
  double force_m(const field::Contact& contact) const noexcept {
    return curve.force_m(double{contact.depth_m} - begin_m);
  }
  // The curve's slope at the contact, over that where it is steepest. The implicit step takes this
  // one: a soft foot gives way as fast as it is soft, however steep the covering is deeper down.
  double slope(const field::Contact& contact) const noexcept {
    return curve.slope(double{contact.depth_m} - begin_m);
  }
  bool is_pressed(const field::Contact& contact) const noexcept {
    return double{contact.depth_m} > begin_m;
  }
  double areas_of(const field::Contact& contact) const noexcept {
    return std::max(min_areas, double{contact.weight});
  }
};

// Totals over the contacts of a set, those deeper than where the law begins. Sums run in eight
// columns and are then added in one order: the same bits for any vector width.
struct ContactTotals {
  std::uint32_t count = 0;
  float depth_m = 0;     // of the deepest, from where the law begins
  double energy_m2 = 0;  // of their springs, over K_ff
};

ContactTotals contact_totals(const field::ContactSet& set, const ContactLaw& law) noexcept;

// Energy stored in the contact springs, J.
double contact_energy_j(const ContactTotals& totals, const ContactLaw& law) noexcept;

// Separation speed of a contact per velocity of the part: [u; r x u].
inline coupling::Vector6 separation_row(const field::Contact& contact) noexcept {
  const glm::dvec3 push(contact.direction);
  return coupling::vector6(push, glm::cross(glm::dvec3(contact.arm_m), push));
}

// One contact over a step of `dt_s`, with the force (over the stiffness, m) that it would have
// after no motion, or its gap below zero. Touching ones are springs with dampers; the others stop
// the part where their gap ends.
ContactRow spring_row(const field::Contact& contact, double force_m, const ContactLaw& law,
                      double dt_s) noexcept;

// Adds a row for every contact of `set` that a motion of at most `reach_m` could bring to touch, as
// spring_row() makes them.
void add_contact_rows(const field::ContactSet& set, const ContactLaw& law, double dt_s,
                      double reach_m, ContactRows& rows) noexcept;

// Pre-contact braking (paper 5.3) of force and torque in one: S is the sum, over the points in
// value 3, of their rows times the speed by which they approach too fast to stop within
// kBrakeFrames frames. The impulse along S takes half of the momentum of that excess (the paper's
// half of the kinetic energy over dt), with the mass that the part shows along S, rotation
// included. It acts on the velocity after it, so it never reverses one; below that speed it does
// nothing, so it neither creeps nor drags. Returns false where no point approaches too fast.
bool braking_row(const field::ContactSet& set, const coupling::Symmetric6& inertia,
                 const coupling::Vector6& velocity, double dt_s, ContactRow& row) noexcept;

inline constexpr double kBrakeFrames = 4;

}  // namespace forcelayer::model
