// The device's port: the one place where work passes between the loop and the hand. What the motors
// got and how far the handle went is all that counts here, whatever the scene, its scale and the
// limits made of it.
#pragma once

#include "runtime/coupling/passivity.h"

namespace forcelayer::loop {

class DevicePort {
 public:
  // The handle is here now (device axes): the wrench that it was left with was held until now. An
  // episode of contact ends where the part is free.
  void arrive(const Pose& device_from_handle, bool in_contact) noexcept;

  // Nobody knows where the handle is: the work of what it was left with is not known.
  void lose_handle() noexcept;

  // The wrench for the motors, about the handle's origin, device axes: held until the next call.
  void leave(const Wrench& device_wrench) noexcept { held_ = device_wrench; }

  // The damper of the passivity controller (passivity.h): at most `limit_ns_per_m`, and that times
  // `radius_m` squared against turning. Once a frame, after arrive().
  Wrench damping(const Twist& device_velocity, double radius_m, double limit_ns_per_m,
                 double dt_s) noexcept;

  double to_hand_j() const { return to_hand_j_; }  // since the call of arrive() before
  double generated_j() const { return coupling::total_generated_j(energy_); }

 private:
  coupling::EpisodeEnergy energy_;
  Pose handle_;
  Wrench held_;
  double to_hand_j_ = 0;
  bool known_ = false;  // where the handle was
};

}  // namespace forcelayer::loop
