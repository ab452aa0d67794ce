// The words of one frame: what goes into a step and what comes out. Everything here is plain data
// that can be copied, recorded and compared bit for bit.
//
// The part's motion is described by the frame `center`: its origin is the part's centroid
// (PshellHeader::center_m in the part's frame), its axes are the part's. So a rotation about the
// centroid leaves the position alone, and the pose that was tested is the pose that is kept.
#pragma once

#include <cstdint>
#include <type_traits>

#include "forcelayer/pose.h"

namespace forcelayer {

// What an input is good for: StepInput::valid.
enum InputUse : std::uint32_t {
  kInputInvalid = 0,   // no pose: part frozen, wrench zero
  kInputValid = 1,     // fresh and meant
  kInputClutched = 2,  // moves nothing: part frozen and gripped anew where the handle is, without
                       // stretch; wrench zero
};

// What the device's side knows at one frame.
struct StepInput {
  Pose world_from_handle;
  Twist handle_velocity;      // of the handle's origin, world axes
  std::uint32_t buttons = 0;  // bit n: button n
  std::uint32_t valid = 0;    // InputUse
};
static_assert(std::is_trivially_copyable_v<StepInput> && sizeof(StepInput) == 112);

// Energy that the coupling gives to the hand, by contact episode (passivity.h), J.
struct EpisodeEnergy {
  double given_j = 0;           // since the episode began; negative: the hand paid
  double peak_j = 0;            // highest of that since then, at least 0
  double generated_j = 0;       // sum of the peaks of past episodes
  double damping_ns_per_m = 0;  // that the passivity controller injects now
};

// Everything that evolves from frame to frame. Copy it to branch a simulation. Models keep their
// own memory here too: a step depends on nothing else.
struct State {
  Pose world_from_center;   // where the part is
  Twist velocity;           // of the centroid, world axes
  Pose handle_from_center;  // the grip: the coupling pulls towards world_from_handle * this

  // What the hand saw in the frame before.
  Pose target;            // world_from_handle * handle_from_center
  Twist target_velocity;  // of the centroid there, world axes
  Wrench wrench;          // on the hand, held until the next frame
  EpisodeEnergy energy;
  std::uint32_t has_target = 0;  // 0: no frame yet

  // Memory of the default model.
  std::uint32_t settled = 0;         // 1: the part rests until the handle moves
  std::uint64_t in_contact = 0;      // 1: a point was not in free space
  glm::dvec3 coupling_angle_rad{0};  // part to target, continuous past pi (coupling_angle.h)
  glm::dvec3 held_back_m{0};         // stretch that is not felt (passivity.h)
  glm::dvec3 held_back_rad{0};       // the same of the angle
  double allowance_j = 0;            // motion_allowance.h

  std::uint64_t frame = 0;  // steps done
};
static_assert(std::is_trivially_copyable_v<State>);

// What went wrong in a frame; the output is defined all the same.
enum Fault : std::uint32_t {
  kFaultInvalidInput = 1,    // StepInput::valid was 0 or unknown: part frozen, wrench zero
  kFaultNonFiniteInput = 2,  // NaN, infinity or no unit quaternion: part frozen, wrench zero
  kFaultNonFiniteState = 4,  // the motion overflowed: part stopped where it was, wrench zero
  kFaultMapLost = 8,         // a mapped file was cut short (map_loss.h): nothing can be trusted
};

// What happened in a frame. Counts are those at `world_from_center`.
struct StepReport {
  Pose world_from_center;         // the pose that was tested
  std::uint32_t interior = 0;     // points in value 1; more than 0: a penetration frame
  std::uint32_t surface = 0;      // points in value 2: intersections, the paper's N
  std::uint32_t proximity = 0;    // points in value 3
  std::uint32_t contacts = 0;     // intersections with depth > 0
  std::uint32_t guard_cuts = 0;   // motions that the guard shortened in this frame
  std::uint32_t faults = 0;       // Fault bits
  std::uint32_t saturated = 0;    // 1: the coupling's clamp was at work
  std::uint32_t outside_map = 0;  // 1: a point lay beyond a cropped side: no guarantee
  double depth_m = 0;             // of the deepest contact
  double to_hand_j = 0;           // work of the wrench that was held until this frame, on the hand
  double generated_j = 0;  // sum over contact episodes of the peak of the energy given to the hand:
                           // what a passive scene, which stores none at first, could not give
};

struct StepResult {
  Wrench wrench;  // on the hand, about the part's centroid, world axes; before the device's limits
  StepReport report;
};

}  // namespace forcelayer
