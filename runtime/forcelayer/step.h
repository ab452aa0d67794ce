// Input and outcome of one step: plain data that can be copied, recorded and compared bit for bit.
//
// The part's motion is described by the frame `center`: its origin is the part's centroid
// (PshellHeader::center_m in the part's frame), its axes are the part's. So a rotation about the
// centroid leaves the position alone, and the pose that was tested is the pose that is kept.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "forcelayer/pose.h"

namespace forcelayer {

// How an input is to be used: StepInput::valid.
enum InputUse : std::uint32_t {
  kInputInvalid = 0,   // no pose: part frozen, wrench zero
  kInputValid = 1,     // fresh and meant
  kInputClutched = 2,  // moves nothing: part frozen and gripped anew where the handle is, without
                       // stretch; wrench zero
};

// The handle at one frame.
struct StepInput {
  Pose world_from_handle;
  Twist handle_velocity;      // of the handle's origin, world axes
  std::uint32_t buttons = 0;  // bit n: button n
  std::uint32_t valid = 0;    // InputUse
};
static_assert(std::is_trivially_copyable_v<StepInput> && sizeof(StepInput) == 112);

// Faults of a frame. The output is defined all the same.
enum Fault : std::uint32_t {
  kFaultInvalidInput = 1,    // StepInput::valid was 0 or unknown: part frozen, wrench zero
  kFaultNonFiniteInput = 2,  // NaN, infinity or no unit quaternion: part frozen, wrench zero
  kFaultNonFiniteState = 4,  // the motion overflowed: part stopped where it was, wrench zero
};

// The kind of statement that a frame makes of its clearance, the distance between the exact
// surfaces of part and scene. The numbers stand in the pose stream.
enum class ClearanceKind : std::uint32_t {
  kNone,     // nothing: the scene stores no distances, or a premise of the proof fails
  kAtLeast,  // no shell point is near enough to the scene to be measured
  kProven,   // measured: at least so much, by the stored distances
};

// An object of the scene that the part pushes against.
struct TouchedObject {
  std::uint32_t object = 0;  // its number in the scene's file (Run::object_name); 0: none
  float force_n = 0;  // of the springs of its contacts, without their dampers; of an object that
                      // the guard keeps the part out of, with what they leave of the hand's pull
};

// Report of a frame. Counts are those at `world_from_center`.
struct StepReport {
  Pose world_from_center;           // the pose that was tested
  std::uint32_t interior = 0;       // points in value 1; more than 0: a penetration frame
  std::uint32_t surface = 0;        // points in value 2: intersections, the paper's N
  std::uint32_t proximity = 0;      // points in value 3
  std::uint32_t contacts = 0;       // intersections with depth > 0
  std::uint32_t guard_cuts = 0;     // motions that the guard shortened in this frame
  std::uint32_t faults = 0;         // Fault bits
  std::uint32_t saturated = 0;      // 1: the coupling's clamp was at work
  std::uint32_t outside_map = 0;    // 1: a point lay beyond a cropped side: no guarantee
  double depth_m = 0;               // of the deepest contact
  std::uint32_t seat_open = 0;      // 1: after this frame the seat is open, and what is guaranteed
                                    // between part and scene does not hold for the seat's objects
  std::uint32_t seated = 0;         // points nearer to an object of the open seat than is allowed
                                    // elsewhere; more than 0: no clearance is known
  std::uint32_t seat_contacts = 0;  // contacts with objects of the open seat
  std::uint32_t barred = 0;         // points nearer than the guard allows: its bound does not hold
  ClearanceKind clearance_kind = ClearanceKind::kNone;
  double clearance_m = 0;            // 0 where nothing is proven
  glm::dvec3 nearest_point_m{0};     // kProven: the shell point nearest to the scene, world
  std::uint32_t nearest_object = 0;  // kProven: the object nearest to that point; 0: not known
  // The objects that it pushes against, the one with the largest force first; of more than these,
  // the strongest. Only those that the scene's file names. Model `default` only.
  std::array<TouchedObject, 4> touched{};
};

// Wrenches on the hand, world axes, before the device's limits.
struct StepResult {
  Wrench wrench;     // about the part's centroid
  Wrench at_handle;  // the same about the handle's origin, where the hand feels it
  StepReport report;
};

}  // namespace forcelayer
