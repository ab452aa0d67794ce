// The condition of an input beside its numbers. It decides when the output fails; a recording keeps
// it, so that a replay fails in the same frames.
#pragma once

#include <cstdint>

namespace forcelayer {

// Why a reading is not used. The numbers are those of recordings.
enum class InputTrouble : std::uint32_t {
  kNone = 0,
  kDeviceLost = 1,     // it does not answer
  kNotCalibrated = 2,  // it answers, but its poses cannot be trusted
  kFrozen = 3,         // no fresh reading within the stale limit
  kNotFinite = 4,      // NaN, infinity, or no unit quaternion
  kImplausible = 5,    // far outside the workspace, a jump, or not what its velocity says
};
inline constexpr std::uint32_t kInputTroubles = 6;

inline constexpr float kFallSteps = 65535;

struct InputHealth {
  InputTrouble trouble = InputTrouble::kNone;  // else the input is invalid
  float age_fraction = 0;                      // age of the reading over its stale limit; 0: fresh
  bool clutch = false;                         // the user holds the clutch
  bool swapping = false;                       // part and scene wait to be replaced, at zero output
  bool output_held = false;                    // the device's own side keeps the motors at zero
  bool loop_late = false;                      // the frame began later than the stale limit allows
  float output_fall = 0;  // since the frame before, by the device's side, because the loop was
                          // late: 1 from full to zero, in steps of 1 / kFallSteps
};

}  // namespace forcelayer
