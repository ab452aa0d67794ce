#include "runtime/contact_force.h"

namespace forcelayer {
namespace {

constexpr double kAveragingStart = 10;      // contacts from which forces are averaged (paper 5.2)
constexpr double kFullDepthVoxels = 0.125;  // depth from which a contact counts fully

}  // namespace

LoadSharing::LoadSharing(const ContactSet& set, double voxel_size_m) noexcept {
  const double full_m = kFullDepthVoxels * voxel_size_m;
  double contacts = 0;
  for (std::uint32_t i = 0; i < set.count; ++i) {
    const Contact& c = set.contacts[i];
    contacts += c.weight * std::clamp(c.depth_m / full_m, 0.0, 1.0);
  }
  average_ = kAveragingStart / std::max(kAveragingStart, contacts);
  by_area_ = std::clamp((contacts - 1) / (kAveragingStart - 1), 0.0, 1.0);
}

double contact_energy_j(const ContactSet& set, const LoadSharing& load,
                        const ContactLaw& law) noexcept {
  const bool straight = law.curve.is_straight();
  double sum = 0;
  for (std::uint32_t i = 0; i < set.count; ++i) {
    const Contact& c = set.contacts[i];
    if (!(c.depth_m > 0)) continue;
    sum += straight ? load.share(c) * c.depth_m * c.depth_m
                    : 2 * load.share(c) * law.curve.energy_m2(c.depth_m);
  }
  return 0.5 * law.stiffness_n_per_m * sum;
}

ContactRow spring_row(const Contact& contact, double force_m, const LoadSharing& load,
                      const ContactLaw& law, double dt_s) noexcept {
  const double share = load.share(contact);
  const double stiffness = law.stiffness_n_per_m * share;
  const double damping = force_m > 0 ? law.damping_ns_per_m * share : 0;
  ContactRow row;
  row.j = separation_row(contact);
  row.weight = dt_s * (dt_s * stiffness + damping);
  row.onset = dt_s * stiffness * force_m / row.weight;
  return row;
}

void add_contact_rows(const ContactSet& set, const LoadSharing& load, const ContactLaw& law,
                      double dt_s, double reach_m, ContactRows& rows) noexcept {
  for (std::uint32_t i = 0; i < set.count; ++i) {
    const Contact& c = set.contacts[i];
    if (-c.depth_m > reach_m) continue;
    rows.add(spring_row(c, law.curve.force_m(c.depth_m), load, law, dt_s));
  }
}

bool braking_row(const ContactSet& set, const Symmetric6& inertia, const Vector6& velocity,
                 double dt_s, ContactRow& row) noexcept {
  Vector6 sum{};
  double allowed = 0;  // approach along S that still stops in time
  for (std::uint32_t i = 0; i < set.count; ++i) {
    const Contact& c = set.contacts[i];
    if (c.depth_m >= 0) continue;
    const Vector6 j = separation_row(c);
    const double allowed_mps = -c.depth_m / (kBrakeFrames * dt_s);
    const double excess_mps = -dot(j, velocity) - allowed_mps;
    if (!(excess_mps > 0)) continue;
    const double share = c.weight * excess_mps;
    for (int k = 0; k < 6; ++k) sum[k] += share * j[k];
    allowed += share * allowed_mps;
  }
  const double mobility = dot(sum, solve(inertia, sum));  // one over the mass along S
  if (!(mobility > 0)) return false;
  row = {sum, 0.5 / mobility, -allowed};
  return true;
}

}  // namespace forcelayer
