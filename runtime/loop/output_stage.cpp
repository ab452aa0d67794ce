#include "runtime/loop/output_stage.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "runtime/devices/output_watch.h"
#include "runtime/model/vectors.h"

namespace forcelayer {
namespace {

// The device's side reports late that it has let go of the motors again.
constexpr double kHeldGraceS = 0.05;

// `last` moved towards `wanted` by at most `step`; towards zero at once.
glm::dvec3 moved(const glm::dvec3& last, const glm::dvec3& wanted, double step) {
  if (glm::dot(wanted, wanted) == 0) return wanted;
  return last + clamped(wanted - last, step);
}

// Nothing that an output should wait out, where the rest passes: a late loop, a fast hand, motors
// that the device's own side holds at zero.
bool ends_the_wait(TripCause cause) {
  switch (cause) {
    case TripCause::kDeviceLost:
    case TripCause::kNotCalibrated:
    case TripCause::kFrozen:
    case TripCause::kInputNotFinite:
    case TripCause::kImplausible:
    case TripCause::kNotFinite:
    case TripCause::kMapLost:
      return true;
    case TripCause::kOverSpeed:
    case TripCause::kLoopLate:
    case TripCause::kOutputHeld:
    case TripCause::kNone:
      break;
  }
  return false;
}

}  // namespace

const char* to_text(TripCause cause) {
  switch (cause) {
    case TripCause::kDeviceLost:
      return "the device does not answer";
    case TripCause::kNotCalibrated:
      return "the device is not calibrated";
    case TripCause::kFrozen:
      return "no fresh reading from the device";
    case TripCause::kInputNotFinite:
      return "the device's pose is not finite";
    case TripCause::kImplausible:
      return "the device's pose cannot be: far outside its workspace, or a jump";
    case TripCause::kOverSpeed:
      return "the hand is too fast";
    case TripCause::kNotFinite:
      return "the motion or its wrench is not finite";
    case TripCause::kLoopLate:
      return "the loop was late";
    case TripCause::kOutputHeld:
      return "the device's side took the motors to zero by itself";
    case TripCause::kMapLost:
      return "a baked file was cut short or written to while it was in use";
    case TripCause::kNone:
      break;
  }
  return "none";
}

const char* how_to_mend(TripCause cause) {
  switch (cause) {
    case TripCause::kDeviceLost:
      return "look at plug and power";
    case TripCause::kNotCalibrated:
      return "calibrate it";
    case TripCause::kFrozen:
      return "look at the device and its driver";
    case TripCause::kInputNotFinite:
      return "look at the device's driver";
    case TripCause::kImplausible:
      return "look at the driver's units (metres) and at the encoders";
    case TripCause::kOverSpeed:
      return "was the device let go or overpowered?";
    case TripCause::kLoopLate:
    case TripCause::kOutputHeld:
      return "see voxrun doctor";
    case TripCause::kMapLost:
      return "bake it again, into a new file";
    case TripCause::kNotFinite:
      return "please report it, with a recording (--record)";
    case TripCause::kNone:
      break;
  }
  return "";
}

void OutputStage::trip(TripCause cause) noexcept {
  state_ = OutputState::kTripped;
  last_trip_ = cause;
  ++trips_;
}

bool OutputStage::may_arm(const OutputFrame& frame) const noexcept {
  if (frame.faulty || !is_finite(frame.wanted) || cause_to_trip(frame) != TripCause::kNone) {
    return false;
  }
  if (frame.health.clutch) return true;  // the part is gripped anew, without stretch
  if (state_ == OutputState::kTripped && !limits_.rearm_alone) return false;
  return frame.free_of_contact || frame.unstretched;
}

// Why an armed output may not go on, nor any be armed.
TripCause OutputStage::cause_to_trip(const OutputFrame& frame) const noexcept {
  const InputTrouble trouble = frame.health.trouble;
  if (frame.map_lost) return TripCause::kMapLost;
  if (trouble == InputTrouble::kDeviceLost) return TripCause::kDeviceLost;
  if (trouble == InputTrouble::kNotCalibrated) return TripCause::kNotCalibrated;
  if (trouble == InputTrouble::kFrozen) return TripCause::kFrozen;  // that took its time already
  if (!frame.faulty && !is_finite(frame.wanted)) return TripCause::kNotFinite;
  if (faulty_s_ > limits_.stale_s) {
    if (trouble == InputTrouble::kImplausible) return TripCause::kImplausible;
    if (trouble == InputTrouble::kNotFinite) return TripCause::kInputNotFinite;
    return frame.not_finite ? TripCause::kNotFinite : TripCause::kFrozen;
  }
  if (frame.health.loop_late) return TripCause::kLoopLate;
  if (frame.speed_mps > limits_.max_speed_mps) return TripCause::kOverSpeed;
  const bool settled = state_ == OutputState::kArmed && armed_s_ > kHeldGraceS;
  if (settled && frame.health.output_held) return TripCause::kOutputHeld;
  return TripCause::kNone;
}

bool OutputStage::trips_on(TripCause cause) const noexcept {
  return (state_ == OutputState::kArmed && cause != TripCause::kNone) ||
         (state_ == OutputState::kWaiting && ends_the_wait(cause));
}

Wrench OutputStage::limited(const Wrench& wanted, double gain) const noexcept {
  return {clamped(wanted.force_n, limits_.max_force_n) * gain,
          clamped(wanted.torque_nm, limits_.max_torque_nm) * gain};
}

Wrench OutputStage::slewed(const Wrench& wanted, double dt_s) const noexcept {
  const double share = dt_s / limits_.slew_s;
  return {moved(last_.force_n, wanted.force_n, limits_.max_force_n * share),
          moved(last_.torque_nm, wanted.torque_nm, limits_.max_torque_nm * share)};
}

Wrench OutputStage::pass(const OutputFrame& frame, double dt_s) noexcept {
  faulty_s_ = frame.faulty ? faulty_s_ + dt_s : 0;
  bool arming = false;
  if (const TripCause cause = cause_to_trip(frame); trips_on(cause)) {
    trip(cause);
  } else if (state_ != OutputState::kArmed && may_arm(frame)) {
    state_ = OutputState::kArmed;
    armed_s_ = 0;
    arming = true;
  }
  if (state_ != OutputState::kArmed || arming) gain_ = 0;
  if (state_ != OutputState::kArmed || frame.faulty || arming) {
    last_ = {};
    return last_;
  }
  armed_s_ += dt_s;
  if (armed_s_ + 0.5 * dt_s < limits_.zero_s) {
    last_ = {};
    return last_;
  }
  gain_ = frame.health.clutch || frame.health.swapping
              ? std::max(0.0, gain_ - dt_s / limits_.fade_s)
              : std::min(1.0, gain_ + dt_s / limits_.ramp_s);
  last_ = slewed(limited(frame.wanted, gain_ * late_gain(frame.health.age_share)), dt_s);
  return last_;
}

}  // namespace forcelayer
