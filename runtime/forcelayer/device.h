// A haptic device in SI units: its ratings, and one of its readings.
#pragma once

#include <cstdint>
#include <string>

#include "forcelayer/pose.h"

namespace forcelayer {

// Axis bits of DeviceCapabilities: translations and rotations in the device's frame.
enum Axis : std::uint32_t {
  kAxisX = 1,
  kAxisY = 2,
  kAxisZ = 4,
  kAxisRotX = 8,
  kAxisRotY = 16,
  kAxisRotZ = 32,
  kAllAxes = 63,
};

// Declaration of a device. Nothing it is asked for lies outside these ratings.
struct DeviceCapabilities {
  std::string name;
  std::uint32_t sensed_axes = kAllAxes;
  std::uint32_t actuated_axes = kAllAxes;
  double max_force_n = 0;               // magnitude
  double max_torque_nm = 0;             // magnitude
  double max_stiffness_n_per_m = 0;     // rating of the maker, 0 where none is given
  double max_stiffness_nm_per_rad = 0;  // the same for rotation
  double damping_ns_per_m = 0;          // physical, that the loop may count on
  double damping_nms_per_rad = 0;       // the same for rotation
  double friction_n = 0;                // Coulomb, that the loop may count on; 0: not declared
  double friction_nm = 0;               // the same for rotation
  double encoder_step_m = 0;            // of the position; 0: not declared
  double encoder_step_rad = 0;          // the same for rotation
  double apparent_mass_kg = 0;          // of the handle without a hand; 0: not declared
  double apparent_inertia_kgm2 = 0;     // the same for rotation
  double delay_s = 0;                   // from sensing to force, beside the loop's own frame
  double workspace_radius_m = 0;        // about the device frame's origin; 0: unbounded
  double rate_hz = 0;                   // samples a second; 0: any
  bool senses_velocity = false;         // else the loop estimates it
  double watchdog_s = 0;  // its motors go to zero when the host is silent for so long; 0: never
  bool hardware = false;  // a hand holds it: runs in real time only, and a trip stays tripped
};

// One reading. Frames: `device_from_handle` in the device's base frame.
struct DeviceSample {
  Pose device_from_handle;
  Twist velocity;              // of the handle's origin, device axes; where sensed
  std::uint32_t buttons = 0;   // bit n: button n
  bool fresh = false;          // a new reading since the last read(); a device that is silent
                               // while nothing moves sets it as long as it is there
  bool present = false;        // the device answers
  bool calibrated = true;      // its poses can be trusted
  bool output_held = false;    // its own side keeps the motors at zero: a watchdog
  double output_falls = 0;     // falls of its output that its own side made since the start, since
                               // the loop was late: a sum, 1 from full to zero
  std::uint64_t sequence = 0;  // counts readings; gaps are losses
};

}  // namespace forcelayer
