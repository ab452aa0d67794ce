// Everything that evolves from frame to frame, shared by coupling and models. The frame `center` is
// that of forcelayer/step.h.
#pragma once

#include <cstdint>
#include <type_traits>

#include "forcelayer/pose.h"
#include "forcelayer/step.h"

namespace forcelayer {

// The seat of a part that starts installed (runtime/guard/seat.h). It closes when the part has
// entered it and left it again, and nothing opens it anew.
enum SeatUse : std::uint32_t {
  kSeatClosed = 0,   // or none
  kSeatOpen = 1,     // given, and the part was not yet there
  kSeatEntered = 2,  // the part is there, or was and may return
};

// Copy it to branch a simulation. Models keep their own memory here too: a step depends on nothing
// else.
struct State {
  Pose world_from_center;   // where the part is
  Twist velocity;           // of the centroid, world axes
  Pose handle_from_center;  // the grip: its orientation is the part's turn in the hand, its inverse
                            // has the point of the part that the hand holds

  // The hand in the frame before.
  Pose world_from_handle;
  Twist handle_velocity;         // of its origin, world axes
  std::uint32_t has_handle = 0;  // 0: no frame yet

  // Memory of the default model.
  std::uint32_t settled = 0;         // 1: the part rests until the handle moves
  std::uint64_t in_contact = 0;      // 1: a point was not in free space
  glm::dvec3 coupling_angle_rad{0};  // part to target, continuous past pi (coupling_angle.h)
  glm::dvec3 held_back_m{0};         // stretch of the grip that is not felt (passivity.h)
  glm::dvec3 held_back_rad{0};       // the same of the angle
  double allowance_j = 0;            // motion_allowance.h

  std::uint64_t frame = 0;  // steps done
  std::uint32_t seat = 0;   // SeatUse
  // The object that the guard kept the part out of in the last motion that it tried; 0: none.
  std::uint32_t stopped_by = 0;
};
static_assert(std::is_trivially_copyable_v<State>);

}  // namespace forcelayer
