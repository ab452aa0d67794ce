#include "runtime/model/contact_force.h"

#include <algorithm>

// Compiles what follows once per instruction set.
#include "runtime/query/vector_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/model/contact_force.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Once, whatever the number of targets.
#ifndef FORCELAYER_CONTACT_FORCE_CONSTANTS
#define FORCELAYER_CONTACT_FORCE_CONSTANTS
namespace forcelayer::model {
namespace {

// Arguments of spring_row() beside the contact.
struct SpringStep {
  const field::ForceCurve& curve;
  double begin_m;  // the depth at which the curve begins
  double min_areas;
  double dt_s;
  double stiffness_n_per_m;  // of one point of mean area
  double damping_ns_per_m;   // of the same
  double min_depth_m;        // of contacts that get a row, from where the curve begins
};

// Sum over points that approach too fast of their rows times share, and of what is allowed.
struct BrakeSum {
  coupling::Vector6 rows{};
  double allowed = 0;
};

}  // namespace
}  // namespace forcelayer::model
#endif

HWY_BEFORE_NAMESPACE();
namespace forcelayer::model {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kColumns = 8;
using Doubles = hn::CappedTag<double, kColumns>;
using VD = hn::Vec<Doubles>;
constexpr Doubles kD;
constexpr std::size_t kLanes = HWY_MIN(HWY_LANES(double), kColumns);
static_assert(field::ContactSet::kPadding >= kColumns);

HWY_INLINE VD load(const std::vector<float>& values, std::size_t i) {
  const hn::Rebind<float, Doubles> floats;
  return hn::PromoteTo(kD, hn::LoadU(floats, values.data() + i));
}

HWY_INLINE double sum_of_columns(const double (&c)[kColumns]) {
  return ((c[0] + c[4]) + (c[2] + c[6])) + ((c[1] + c[5]) + (c[3] + c[7]));
}

// separation_row() of the contacts from i on.
HWY_INLINE void separation_rows(const field::ContactSet& set, std::size_t i, VD* j) {
  const VD r[3] = {load(set.rx, i), load(set.ry, i), load(set.rz, i)};
  j[0] = load(set.ux, i), j[1] = load(set.uy, i), j[2] = load(set.uz, i);
  j[3] = hn::Sub(hn::Mul(r[1], j[2]), hn::Mul(r[2], j[1]));
  j[4] = hn::Sub(hn::Mul(r[2], j[0]), hn::Mul(r[0], j[2]));
  j[5] = hn::Sub(hn::Mul(r[0], j[1]), hn::Mul(r[1], j[0]));
}

// `of` each lane, one after the other.
template <class F>
HWY_INLINE VD lane_by_lane(VD v, const F& of) {
  HWY_ALIGN double lanes[kLanes];
  hn::Store(v, kD, lanes);
  for (double& lane : lanes) lane = of(lane);
  return hn::Load(kD, lanes);
}

void totals_on_target(const field::ContactSet& set, double min_areas, double begin_m,
                      const field::ForceCurve& curve, ContactTotals& out) {
  HWY_ALIGN double energies[kColumns], deepest[kColumns];
  const VD zero = hn::Zero(kD), half = hn::Set(kD, 0.5), least = hn::Set(kD, min_areas),
           begin = hn::Set(kD, begin_m);
  std::size_t touching = 0;
  for (std::size_t first = 0; first < kColumns; first += kLanes) {
    VD sum = zero, largest = zero;
    for (std::size_t i = first; i < set.count; i += kColumns) {
      const VD signed_depth = hn::Sub(load(set.depth_m, i), begin);
      const auto touches = hn::And(hn::Gt(signed_depth, zero), hn::FirstN(kD, set.count - i));
      const VD depth = hn::IfThenElseZero(touches, signed_depth);
      const VD areas = hn::IfThenElseZero(touches, hn::Max(least, load(set.weight, i)));
      touching += hn::CountTrue(kD, touches);
      largest = hn::Max(largest, depth);
      VD energy = hn::Mul(depth, hn::Mul(half, depth));
      if (!curve.is_straight()) {
        energy = lane_by_lane(depth, [&](double depth_m) { return curve.energy_m2(depth_m); });
      }
      sum = hn::Add(sum, hn::Mul(areas, energy));
    }
    hn::Store(sum, kD, energies + first);
    hn::Store(largest, kD, deepest + first);
  }
  out.count = static_cast<std::uint32_t>(touching);
  out.depth_m = static_cast<float>(*std::max_element(deepest, deepest + kColumns));
  out.energy_m2 = sum_of_columns(energies);
}

// Writes the rows of the contacts [0, count) behind each other; how many.
std::size_t spring_rows_on_target(const field::ContactSet& set, std::size_t count,
                                  const SpringStep& step, const ContactRowColumns& out) {
  const VD zero = hn::Zero(kD), dt_s = hn::Set(kD, step.dt_s);
  std::size_t rows = 0;
  for (std::size_t i = 0; i < count; i += kLanes) {
    const VD depth = hn::Sub(load(set.depth_m, i), hn::Set(kD, step.begin_m));
    const auto kept =
        hn::AndNot(hn::Lt(depth, hn::Set(kD, step.min_depth_m)), hn::FirstN(kD, count - i));
    if (hn::AllFalse(kD, kept)) continue;
    VD column[8];
    separation_rows(set, i, column);
    const VD areas = hn::Max(hn::Set(kD, step.min_areas), load(set.weight, i));
    const VD per_step = hn::Mul(dt_s, hn::Mul(hn::Set(kD, step.stiffness_n_per_m), areas));
    VD force = depth, local = areas, yields = per_step, pushes = per_step;
    if (!step.curve.is_straight()) {
      force = lane_by_lane(depth, [&](double depth_m) { return step.curve.force_m(depth_m); });
      local = hn::Mul(
          areas, lane_by_lane(depth, [&](double depth_m) { return step.curve.slope(depth_m); }));
      yields = hn::Mul(dt_s, hn::Mul(hn::Set(kD, step.stiffness_n_per_m), local));
      pushes = hn::IfThenElse(hn::Gt(depth, zero), per_step, yields);
    }
    const VD damping =
        hn::IfThenElseZero(hn::Gt(force, zero), hn::Mul(hn::Set(kD, step.damping_ns_per_m), local));
    column[6] = hn::Mul(dt_s, hn::Add(yields, damping));
    column[7] = hn::Div(hn::Mul(pushes, force), column[6]);
    if (hn::AllTrue(kD, kept)) {
      for (std::size_t n = 0; n < 8; ++n) hn::StoreU(column[n], kD, out.at[n] + rows);
      rows += kLanes;
      continue;
    }
    HWY_ALIGN double lanes[8][kLanes];
    for (std::size_t n = 0; n < 8; ++n) hn::Store(column[n], kD, lanes[n]);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(kD, kept, bits);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      for (std::size_t n = 0; n < 8; ++n) out.at[n][rows] = lanes[n][lane];
      rows += bits[0] >> lane & 1;
    }
  }
  return rows;
}

void brake_sum_on_target(const field::ContactSet& set, const coupling::Vector6& velocity,
                         double stop_s, BrakeSum& out) {
  constexpr std::size_t kSums = 7;
  HWY_ALIGN double columns[kSums][kColumns];
  const VD zero = hn::Zero(kD);
  for (std::size_t first = 0; first < kColumns; first += kLanes) {
    VD sums[kSums];
    for (VD& sum : sums) sum = zero;
    for (std::size_t i = first; i < set.count; i += kColumns) {
      const VD depth = load(set.depth_m, i);
      if (hn::AllFalse(kD, hn::Lt(depth, zero))) continue;
      VD j[6];
      separation_rows(set, i, j);
      VD speed = hn::Mul(j[0], hn::Set(kD, velocity[0]));
      for (std::size_t n = 1; n < 6; ++n) {
        speed = hn::Add(speed, hn::Mul(j[n], hn::Set(kD, velocity[n])));
      }
      const VD allowed_mps = hn::Div(hn::Neg(depth), hn::Set(kD, stop_s));
      const VD excess_mps = hn::Sub(hn::Neg(speed), allowed_mps);
      const auto counted = hn::And(hn::And(hn::Lt(depth, zero), hn::Gt(excess_mps, zero)),
                                   hn::FirstN(kD, set.count - i));
      const VD fraction = hn::IfThenElseZero(counted, hn::Mul(load(set.weight, i), excess_mps));
      for (std::size_t n = 0; n < 6; ++n) sums[n] = hn::Add(sums[n], hn::Mul(fraction, j[n]));
      sums[6] = hn::Add(sums[6], hn::Mul(fraction, allowed_mps));
    }
    for (std::size_t n = 0; n < kSums; ++n) hn::Store(sums[n], kD, columns[n] + first);
  }
  for (std::size_t n = 0; n < 6; ++n) out.rows[n] = sum_of_columns(columns[n]);
  out.allowed = sum_of_columns(columns[6]);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace forcelayer::model
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::model {

HWY_EXPORT(totals_on_target);
HWY_EXPORT(spring_rows_on_target);
HWY_EXPORT(brake_sum_on_target);

ContactTotals contact_totals(const field::ContactSet& set, const ContactLaw& law) noexcept {
  ContactTotals totals;
  HWY_DYNAMIC_DISPATCH(totals_on_target)(set, law.min_areas, law.begin_m, law.curve, totals);
  return totals;
}

double contact_energy_j(const ContactTotals& totals, const ContactLaw& law) noexcept {
  return law.stiffness_n_per_m * totals.energy_m2;
}

ContactRow spring_row(const field::Contact& contact, double force_m, const ContactLaw& law,
                      double dt_s) noexcept {
  const double areas = law.areas_of(contact), local = areas * law.slope(contact);
  const double yields = dt_s * (law.stiffness_n_per_m * local);
  const double damping = force_m > 0 ? law.damping_ns_per_m * local : 0;
  const double per_step = law.is_pressed(contact) ? dt_s * (law.stiffness_n_per_m * areas) : yields;
  ContactRow row;
  row.j = separation_row(contact);
  row.weight = dt_s * (yields + damping);
  row.onset = per_step * force_m / row.weight;
  return row;
}

void add_contact_rows(const field::ContactSet& set, const ContactLaw& law, double dt_s,
                      double reach_m, ContactRows& rows) noexcept {
  const SpringStep step{law.curve, law.begin_m,           law.min_areas,
                        dt_s,      law.stiffness_n_per_m, law.damping_ns_per_m,
                        -reach_m};
  const std::size_t count = std::min<std::size_t>(set.count, rows.room());
  rows.added(HWY_DYNAMIC_DISPATCH(spring_rows_on_target)(set, count, step, rows.next()));
}

bool braking_row(const field::ContactSet& set, const coupling::Symmetric6& inertia,
                 const coupling::Vector6& velocity, double dt_s, ContactRow& row) noexcept {
  BrakeSum sum;
  HWY_DYNAMIC_DISPATCH(brake_sum_on_target)(set, velocity, kBrakeFrames * dt_s, sum);
  if (sum.rows == coupling::Vector6{}) return false;
  const double mobility =
      coupling::dot(sum.rows, coupling::solve(inertia, sum.rows));  // one over the mass along S
  if (!(mobility > 0)) return false;
  row = {sum.rows, 0.5 / mobility, -sum.allowed};
  return true;
}

}  // namespace forcelayer::model
#endif
