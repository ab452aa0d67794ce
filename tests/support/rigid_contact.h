// The truth of a part that a hand presses against a scene: no force layer, no spring of a contact.
// The pose with the least energy of the coupling among those that keep the exact distance of the
// meshes, and the coupling's wrench there. Slow, and checked by its own conditions: the distance is
// kept, and pushes along the contacts' normals balance the coupling.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "forcelayer/pose.h"
#include "runtime/coupling/coupling.h"
#include "runtime/coupling/spatial.h"

namespace forcelayer::test {

// A pair of features of the two surfaces, near each other.
struct Gap {
  double gap_m;          // their distance beyond the standoff
  glm::dvec3 normal;     // unit, from the scene to the part
  glm::dvec3 on_part_m;  // world
};
using GapsAt = std::function<std::vector<Gap>(const Pose& world_from_center)>;

// The spring between hand and part: up to a limit, then with the limit.
struct ClampedSpring {
  double stiffness, limit;

  glm::dvec3 pull(const glm::dvec3& stretch) const {
    const double force = stiffness * glm::length(stretch);
    return stiffness * stretch * (force > limit ? limit / force : 1);
  }
  double energy_j(const glm::dvec3& stretch) const {
    const double length = glm::length(stretch), longest = limit / stiffness;
    return length <= longest ? stiffness * length * length / 2 : limit * (length - longest / 2);
  }
  // Stiffness of the quadratic that touches the energy at this stretch and lies above it elsewhere.
  double secant(const glm::dvec3& stretch) const {
    const double length = glm::length(stretch);
    return length * stiffness > limit ? limit / length : stiffness;
  }
};

// A part in a hand.
struct HeldPart {
  ClampedSpring linear, angular;  // N and m, N m and rad
  glm::dvec3 hand_m;              // where the hand pulls the grip
  glm::dquat hand_turn;           // to which it turns the part
  glm::dvec3 grip_m;              // from the part's center, axes of the part
  double radius_m;                // of the part about its center

  glm::dvec3 stretch_m(const Pose& p) const {
    return hand_m - p.position_m - p.orientation * grip_m;
  }
  glm::dvec3 stretch_rad(const Pose& p) const {
    return coupling::rotation_vector(hand_turn * glm::conjugate(p.orientation));
  }
  double energy_j(const Pose& p) const {
    return linear.energy_j(stretch_m(p)) + angular.energy_j(stretch_rad(p));
  }
  Wrench on_hand(const Pose& p) const {
    return {-linear.pull(stretch_m(p)), -angular.pull(stretch_rad(p))};
  }
  coupling::Vector6 on_center(const Pose& p) const {
    const Wrench hand = on_hand(p);
    const glm::dvec3 arm_m = p.orientation * grip_m;
    return coupling::vector6(-hand.force_n, -hand.torque_nm - glm::cross(arm_m, hand.force_n));
  }
};

struct RigidContact {
  Pose world_from_center;
  Wrench on_hand;           // at the handle
  double too_near_m = 0;    // how far the standoff is violated
  double unbalanced_n = 0;  // of the coupling and the contacts' pushes; torque over the radius
};

namespace rigid_contact_detail {

inline coupling::Vector6 row_of(const Gap& gap, const Pose& pose) {
  return coupling::vector6(gap.normal, glm::cross(gap.on_part_m - pose.position_m, gap.normal));
}

inline double deepest(const std::vector<Gap>& gaps) {
  double most = 0;
  for (const Gap& gap : gaps) most = std::max(most, -gap.gap_m);
  return most;
}

inline Pose moved(const Pose& pose, const coupling::Vector6& by) {
  return {pose.position_m + coupling::linear_part(by),
          glm::normalize(coupling::rotation_by(coupling::angular_part(by)) * pose.orientation)};
}

// The x of a x = b, `a` positive definite, by elimination; what rounding makes singular stays zero.
inline std::vector<double> solved(std::vector<std::vector<double>> a, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    if (!(a[k][k] > 0)) a[k][k] = std::numeric_limits<double>::infinity();
    for (std::size_t i = k + 1; i < n; ++i) {
      const double by = a[i][k] / a[k][k];  // 0 where that is infinite
      for (std::size_t j = k; j < n; ++j) a[i][j] -= by * a[k][j];
      b[i] -= by * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  return b;
}

// The motion d with the least d A d / 2 - f d that closes no gap, the gaps linear in it. The gap
// that is violated most joins those that push; of these, the ones that would pull leave (Lawson and
// Hanson). `sum_n` is the sum of the pushes.
inline coupling::Vector6 least_motion(const coupling::Symmetric6& a, const coupling::Vector6& f,
                                      const std::vector<Gap>& gaps, const Pose& pose,
                                      double& sum_n) {
  constexpr double kKeptM = 1e-11;
  constexpr double kSoft = 1e-10;  // so that equal gaps make no singular system
  struct Push {
    std::size_t gap;
    coupling::Vector6 j, answer;  // A^-1 j
    double force_n;
  };
  std::vector<coupling::Vector6> rows;
  for (const Gap& gap : gaps) rows.push_back(row_of(gap, pose));
  const coupling::Vector6 free = coupling::solve(a, f);
  std::vector<Push> pushes;
  std::vector<bool> useless(gaps.size());  // left at once: rounding alone violates it
  coupling::Vector6 d = free;
  for (int round = 0; round < 200; ++round) {
    std::size_t worst = gaps.size();
    double worst_m = -kKeptM;
    for (std::size_t i = 0; i < gaps.size(); ++i) {
      const double left_m = gaps[i].gap_m + coupling::dot(rows[i], d);
      if (left_m >= worst_m || useless[i] ||
          std::ranges::find(pushes, i, &Push::gap) != pushes.end())
        continue;
      worst_m = left_m, worst = i;
    }
    if (worst == gaps.size()) break;
    pushes.push_back({worst, rows[worst], coupling::solve(a, rows[worst]), 0});
    for (;;) {
      std::vector<std::vector<double>> matrix(pushes.size());
      std::vector<double> short_m;
      for (std::size_t i = 0; i < pushes.size(); ++i) {
        for (const Push& other : pushes) {
          matrix[i].push_back(coupling::dot(pushes[i].j, other.answer));
        }
        matrix[i][i] *= 1 + kSoft;
        short_m.push_back(-gaps[pushes[i].gap].gap_m - coupling::dot(pushes[i].j, free));
      }
      const std::vector<double> wanted = solved(matrix, short_m);
      double fraction = 1;
      std::size_t leaves = pushes.size();
      for (std::size_t i = 0; i < pushes.size(); ++i) {
        if (wanted[i] > 0) continue;
        const double here = pushes[i].force_n / std::max(pushes[i].force_n - wanted[i], 1e-300);
        if (here < fraction || leaves == pushes.size()) fraction = here, leaves = i;
      }
      for (std::size_t i = 0; i < pushes.size(); ++i) {
        pushes[i].force_n += fraction * (wanted[i] - pushes[i].force_n);
      }
      if (leaves == pushes.size()) break;
      useless[worst] = useless[worst] || pushes[leaves].gap == worst;
      pushes.erase(pushes.begin() + static_cast<std::ptrdiff_t>(leaves));
    }
    d = free;
    sum_n = 0;
    for (const Push& push : pushes) {
      for (int n = 0; n < 6; ++n) d[n] += push.force_n * push.answer[n];
      sum_n += push.force_n;
    }
  }
  return d;
}

}  // namespace rigid_contact_detail

// Goes down from `start`, which must be near: where there are several such poses, it finds the one
// of that valley. Each step solves the linear problem, damped until energy and distance improve.
inline RigidContact rigid_contact(const HeldPart& held, const GapsAt& gaps_at, const Pose& start) {
  using namespace rigid_contact_detail;
  constexpr int kMaxSteps = 1000;
  constexpr double kStillM = 1e-8;
  constexpr double kMaxWayM = 0.0002;  // of a step, so that what it cannot see comes no nearer
  Pose pose = start;
  std::vector<Gap> gaps = gaps_at(pose);
  double damping = 1e-3, price_n = held.linear.limit;  // the latter of a violated distance
  for (int step = 0; step < kMaxSteps; ++step) {
    const glm::dvec3 arm_m = pose.orientation * held.grip_m;
    coupling::Symmetric6 a;
    coupling::add_at_arm(glm::dmat3(held.linear.secant(held.stretch_m(pose))), arm_m, a);
    coupling::add_block(glm::dmat3(held.angular.secant(held.stretch_rad(pose))), 3, a);
    const double extra = damping * held.linear.stiffness;
    coupling::add_block(glm::dmat3(extra), 0, a);
    coupling::add_block(glm::dmat3(extra * held.radius_m * held.radius_m), 3, a);
    // A part that is too near by more than a step can go comes out in several.
    std::vector<Gap> wanted = gaps;
    for (Gap& gap : wanted) gap.gap_m = std::max(gap.gap_m, -kMaxWayM / 4);
    double sum_n = 0;
    const coupling::Vector6 d = least_motion(a, held.on_center(pose), wanted, pose, sum_n);
    price_n = std::max(price_n, 2 * sum_n);
    const double way_m = glm::length(coupling::linear_part(d)) +
                         held.radius_m * glm::length(coupling::angular_part(d));
    if (way_m > kMaxWayM) {
      damping *= std::max(1.5, way_m / kMaxWayM);
      continue;
    }
    const Pose next = moved(pose, d);
    std::vector<Gap> there = gaps_at(next);
    const double better =
        held.energy_j(pose) - held.energy_j(next) + price_n * (deepest(gaps) - deepest(there));
    if (better < 0 && way_m > kStillM) {
      damping *= 4;
      continue;
    }
    damping = std::max(1e-6, damping / 3);
    pose = next, gaps = std::move(there);
    if (way_m <= kStillM) break;
  }
  // Its conditions, at the pose itself: the pushes that balance the coupling best there.
  RigidContact found{pose, held.on_hand(pose), deepest(gaps), 0};
  std::vector<Gap> touching;
  for (Gap gap : gaps) {
    if (gap.gap_m > 1e-7) continue;
    gap.gap_m = 0;
    touching.push_back(gap);
  }
  coupling::Symmetric6 unit;  // of a newton for a meter, and a radius
  coupling::add_block(glm::dmat3(1), 0, unit);
  coupling::add_block(glm::dmat3(held.radius_m * held.radius_m), 3, unit);
  double sum_n = 0;
  const coupling::Vector6 rest = least_motion(unit, held.on_center(pose), touching, pose, sum_n);
  found.unbalanced_n = glm::length(coupling::linear_part(rest)) +
                       held.radius_m * glm::length(coupling::angular_part(rest));
  return found;
}

}  // namespace forcelayer::test
