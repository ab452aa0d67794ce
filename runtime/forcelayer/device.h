// What a haptic device is to the loop: pose and velocity in, wrench out, limits stated in SI units.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/result.h"

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

// What a device declares of itself. Nothing it is asked for lies outside these ratings.
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
  bool output_held = false;    // its own side keeps the motors at zero: watchdog or OutputWatch
  std::uint64_t sequence = 0;  // counts readings; gaps are losses
};

struct DeviceCounter {
  const char* name;
  std::uint64_t value;
};

// Why a device was last absent, or took its motors to zero, and what to do about it: each a part of
// a sentence, empty where there was nothing.
struct DeviceTrouble {
  std::string what, mend;
};

// A device as the loop sees it. read() and write() are called from the loop's thread only: they
// never block, allocate or call out; slow I/O lives on a thread of the device's own, which passes
// every wrench through an OutputWatch (output_watch.h), so that a loop that stands still is not
// felt as its last force for ever.
class Device {
 public:
  virtual ~Device() = default;

  virtual const DeviceCapabilities& capabilities() const = 0;

  // Connects and starts whatever threads the device has. Errors: device codes (5xx).
  virtual Status start() = 0;

  // The newest reading at loop time `time_s`.
  virtual DeviceSample read(double time_s) noexcept = 0;

  // The wrench on the hand, about the handle's origin, device axes.
  virtual void write(const Wrench& device_wrench) noexcept = 0;

  // Takes the output to zero and disconnects. Safe to call twice.
  virtual void stop() noexcept = 0;

  // What its own side counted since start(), for the report.
  virtual std::vector<DeviceCounter> counters() const { return {}; }

  // For a message. Not for the loop's thread.
  virtual DeviceTrouble trouble() const { return {}; }
};

}  // namespace forcelayer
