// The contact forces of the default model: springs of the force layer, averaged by area, and
// pre-contact braking, as rows of the implicit solve.
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
  double voxel_size_m = 0;
  field::ForceCurve curve;
};

// Totals over the contacts of a set, those with depth > 0. Sums run in eight columns and are then
// added in one order: the same bits for any vector width.
struct ContactTotals {
  std::uint32_t count = 0;
  float depth_m = 0;  // of the deepest
  // Contacts that share the load: by area, each in full from an eighth of a voxel of depth on.
  double sharing = 0;
  // Sum of the energies over K_ff of contacts that count as max(1, weight), and what is to be added
  // to it where they count by their weight.
  double alone_m2 = 0, rest_m2 = 0;
};

ContactTotals contact_totals(const field::ContactSet& set, const ContactLaw& law) noexcept;

// How many contacts share the load, and so how stiff each is (the place of the paper's N/10, 5.2).
// Contacts are counted by area, and by depth up to an eighth of a voxel, so that the count is
// continuous: a point enters with nothing. Few points each hold with the full stiffness, however
// little area they stand for; of many, each holds by its area; from ten on they share what ten
// have.
class LoadSharing {
 public:
  LoadSharing() = default;  // one contact
  explicit LoadSharing(const ContactTotals& totals) noexcept;
  // Factor on the stiffness of a contact.
  double fraction(const field::Contact& contact) const noexcept {
    const double alone = std::max(1.0f, contact.weight);
    return average_ * (alone + by_area_ * (contact.weight - alone));
  }

  double average() const noexcept { return average_; }
  double by_area() const noexcept { return by_area_; }

 private:
  double average_ = 1;  // 1 up to ten contacts, then ten over their number
  double by_area_ = 0;  // 0 for one contact, 1 from ten on
};

// Energy stored in the contact springs, J.
double contact_energy_j(const ContactTotals& totals, const LoadSharing& load,
                        const ContactLaw& law) noexcept;

// Separation speed of a contact per velocity of the part: [u; r x u].
inline coupling::Vector6 separation_row(const field::Contact& contact) noexcept {
  const glm::dvec3 push(contact.direction);
  return coupling::vector6(push, glm::cross(glm::dvec3(contact.arm_m), push));
}

// One contact over a step of `dt_s`, with the force (over the stiffness, m) that it would have
// after no motion, or its gap below zero. Touching ones are springs with dampers; the others stop
// the part where their gap ends.
ContactRow spring_row(const field::Contact& contact, double force_m, const LoadSharing& load,
                      const ContactLaw& law, double dt_s) noexcept;

// Adds a row for every contact of `set` that a motion of at most `reach_m` could bring to touch, as
// spring_row() makes them.
void add_contact_rows(const field::ContactSet& set, const LoadSharing& load, const ContactLaw& law,
                      double dt_s, double reach_m, ContactRows& rows) noexcept;

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
