// A block that a hand presses on a plane, held by a grip anywhere: how much the handle swings, and
// what closed loops give the hand. For the tests and for `stability_bench grips`.
#pragma once

#include "tests/support/held_part.h"

namespace forcelayer::test {

constexpr double kPlaneVoxelM = 0.005;

// A plane oblique to the grid, through the origin, with stored distances.
inline glm::dvec3 plane_normal() { return glm::normalize(glm::dvec3(0.2, -0.15, 1)); }

inline VoxelScene plane() {
  return distance_scene(
      kPlaneVoxelM, {-40, -40, -14}, {80, 80, 40},
      [n = plane_normal()](const glm::dvec3& p) { return glm::dot(p, n) - 0.3 * kPlaneVoxelM; }, 2,
      DistanceDefinition(2));
}

inline PointPart block() {
  return box_part(glm::dvec3(8, 5, 4) * kPlaneVoxelM, kPlaneVoxelM, kPlaneVoxelM);
}

inline HeldPartOptions above_the_plane(double arm_m, int axis, double scale) {
  HeldPartOptions options;
  options.motion_scale = scale;
  options.start = {plane_normal() * 14.0 * kPlaneVoxelM, coupling::rotation_by({0.3, 0.2, 0.5})};
  options.part_from_handle.position_m[axis % 3] = axis < 3 ? arm_m : -arm_m;
  options.part_from_handle.orientation = coupling::rotation_by({0.4, -0.2, 0.1});
  return options;
}

// The block lies flat on the plane, but for a few degrees.
inline HeldPartOptions flat_above_the_plane(double arm_m, int axis, double scale) {
  HeldPartOptions options = above_the_plane(arm_m, axis, scale);
  const glm::dvec3 n = plane_normal();
  options.start.orientation =
      coupling::rotation_by(glm::cross({0, 0, 1}, n)) * coupling::rotation_by({0.02, 0.03, 0.5});
  return options;
}

// The block is installed there: it lies flat on the plane, and touches it.
inline HeldPartOptions seated_on_the_plane(double arm_m, int axis, double scale) {
  HeldPartOptions options = above_the_plane(arm_m, axis, scale);
  const glm::dvec3 n = plane_normal(), axis_rad = glm::cross({0, 0, 1}, n);
  const glm::dvec3 tilt = glm::normalize(axis_rad) * std::atan2(glm::length(axis_rad), n.z);
  options.start = {n * 4.3 * kPlaneVoxelM,
                   coupling::rotation_by(tilt) * coupling::rotation_by({0, 0, 0.5})};
  options.seated = true;
  return options;
}

// Goes down until something touches, then a little farther, and waits for the ramp.
inline Pose press(HeldPart& held, double beyond_m) {
  const double step_m = std::min(5e-4, 5e-5 / held.placement().motion_scale);
  Pose handle = held.start_handle();
  for (int i = 0; i < 20000 && held.frame().result.report.contacts == 0; ++i) {
    handle.position_m -= plane_normal() * step_m;
    held.tick(handle);
  }
  if (held.frame().result.report.contacts == 0) throw std::runtime_error("nothing was touched");
  for (double way_m = 0; way_m < beyond_m; way_m += 2e-5) {
    handle.position_m -= plane_normal() * 2e-5;
    held.tick(handle);
  }
  for (int i = 0; i < 500; ++i) held.tick(handle);
  return handle;
}

// Peak to peak of the handle in the last second of twenty, in steps of its encoder: the larger of
// place and angle. The hand goes down until the block touches and 10 mm farther, and then holds
// still; it may let go at 8 s, and take a new grip at 5 s, in contact, to press anew.
inline double swing_steps(HeldPart& held, const devices::SimHandParameters& hand, bool let_go,
                          bool clutch = false) {
  const glm::dvec3 n = plane_normal();
  const double step_m = std::min(5e-4, 5e-5 / held.placement().motion_scale);
  Pose wanted = held.start_handle(), first;
  double beyond_m = 0;
  bool touched = false;
  glm::dvec3 low_m(1e300), high_m(-1e300), low_rad(1e300), high_rad(-1e300);
  for (int i = 0; i < 20000; ++i) {
    if (!touched) {
      wanted.position_m -= n * step_m;
    } else if (beyond_m < 0.01) {
      wanted.position_m -= n * 5e-5;
      beyond_m += 5e-5;
    }
    if (clutch && (i == 5000 || i == 5300)) {
      held.servo().set_clutch(i == 5000);
      beyond_m = 0;
    }
    if (let_go && i == 8000) held.device().let_go();
    if (held.tick(wanted).result.report.contacts > 0 && !touched) {
      touched = true;
      held.work() = {};  // counted from the first touch on
    }
    if (i < 19000) continue;
    const Pose& handle = held.device().pose();
    if (i == 19000) first = handle;
    const glm::dvec3 turn =
        coupling::rotation_vector(handle.orientation * glm::conjugate(first.orientation));
    low_m = glm::min(low_m, handle.position_m), high_m = glm::max(high_m, handle.position_m);
    low_rad = glm::min(low_rad, turn), high_rad = glm::max(high_rad, turn);
  }
  if (!touched) throw std::runtime_error("nothing was touched");
  return std::max(glm::length(high_m - low_m) / hand.encoder_step_m,
                  glm::length(high_rad - low_rad) / hand.encoder_step_rad);
}

// The way of a handle that nobody holds, from now until it has not moved for a second.
struct Creep {
  double rest_s = 0;                // until then; infinite where it takes more than ten minutes
  double way_rad = 0, net_rad = 0;  // along the way, and from its beginning to its end
  double min_nm = INFINITY, max_nm = 0;  // of the motors' torque while it moves
};

inline Creep creep(HeldPart& held) {
  Creep out;
  const Pose first = held.device().pose();
  glm::dquat last = first.orientation;
  int still = 0, frame = 0;
  constexpr int kStill = 1000, kMax = 600'000;
  for (; frame < kMax && still < kStill; ++frame) {
    const double torque_nm = glm::length(held.tick().device_wrench.torque_nm);
    const glm::dquat now = held.device().pose().orientation;
    const double turned_rad = glm::length(coupling::rotation_vector(now * glm::conjugate(last)));
    last = now;
    out.way_rad += turned_rad;
    still = turned_rad > 1e-12 ? 0 : still + 1;
    if (still > 0) continue;
    out.min_nm = std::min(out.min_nm, torque_nm), out.max_nm = std::max(out.max_nm, torque_nm);
  }
  out.rest_s = still < kStill ? INFINITY : (frame - kStill) * held.servo().dt_s();
  out.net_rad = glm::length(coupling::rotation_vector(last * glm::conjugate(first.orientation)));
  return out;
}

// One closed loop of the handle in contact, made of the same way at every scale.
struct HandleLoop {
  const char* name;
  double size;       // m or rad
  double per_speed;  // of that in a second, over the speed in m/s
  Pose (*at)(const Pose& from, double size, double angle);
};

inline const HandleLoop kHandleLoops[] = {
    {"press and slide", 0.002, 1,
     [](const Pose& from, double size, double a) {
       const glm::dvec3 n = plane_normal(), t = glm::normalize(glm::cross(n, {0, 1, 0}));
       return Pose{from.position_m + size * (t * std::sin(a) + n * (0.9 * (1 - std::cos(a)))),
                   from.orientation};
     }},
    {"slide aslant", 0.002, 1,
     [](const Pose& from, double size, double a) {
       const glm::dvec3 n = plane_normal(), t = glm::normalize(glm::cross(n, {0, 1, 0}));
       const glm::dvec3 aslant = glm::normalize(t + n), across = glm::cross(n, t);
       return Pose{from.position_m + size * (aslant * std::sin(a) + across * (1 - std::cos(a))),
                   from.orientation};
     }},
    {"turn", 0.05, 20,
     [](const Pose& from, double size, double a) {
       const glm::dvec3 n = plane_normal(), t = glm::normalize(glm::cross(n, {0, 1, 0}));
       const glm::dvec3 turn = size * (t * std::sin(a) + glm::cross(n, t) * (1 - std::cos(a)));
       return Pose{from.position_m, coupling::rotation_by(turn) * from.orientation};
     }},
    {"turn and press", 0.05, 10,
     [](const Pose& from, double size, double a) {
       const glm::dvec3 n = plane_normal(), t = glm::normalize(glm::cross(n, {0, 1, 0}));
       return Pose{from.position_m + 0.0015 * (1 - std::cos(a)) * n,
                   coupling::rotation_by(size * std::sin(a) * t) * from.orientation};
     }},
};

// The least that the sampled springs of the work so far must give, J: k T / 2 times the integral of
// v^2 (Colgate and Schenkel 1994).
inline double sampled_j(HeldPart& held) {
  const Parameters& p = held.parameters();
  const double c = held.placement().motion_scale;
  return 0.5 * held.servo().dt_s() *
         (p.coupling_n_per_m * c * c * held.work().speed2_s +
          p.coupling_nm_per_rad * held.work().turning2_s);
}

// The energy, J, that the second of two such loops gave the hand, and sampled_j() of it.
// The first loop carries the part to its steady way round.
struct LoopWork {
  double given_j = 0, sampled_j = 0, reported_j = 0;
  double moved_j = 0;  // either way
};

inline LoopWork loop_work(HeldPart& held, const HandleLoop& loop, double speed_mps, bool back) {
  constexpr double kPressM = 0.005;
  // The output of a part in contact arms while nobody pulls it.
  for (int i = 0; i < 10; ++i) held.tick(held.start_handle());
  const Pose from = press(held, kPressM);
  const double dt_s = held.servo().dt_s(), way = back ? -1 : 1;
  const int period = static_cast<int>(2 * M_PI * loop.size / (speed_mps * loop.per_speed * dt_s));
  LoopWork out;
  for (int i = 0; i <= 2 * period; ++i) {
    if (i == period) held.work() = {};
    const Frame& frame = held.tick(loop.at(from, loop.size, way * 2 * M_PI * i / period));
    if (i > period) out.reported_j += frame.to_hand_j;
  }
  out.given_j = held.work().given_j;
  out.moved_j = held.work().moved_j;
  out.sampled_j = sampled_j(held);
  return out;
}

}  // namespace forcelayer::test
