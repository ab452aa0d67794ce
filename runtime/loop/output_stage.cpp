#include "runtime/loop/output_stage.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <iterator>

#include "runtime/devices/output_watch.h"
#include "runtime/model/vectors.h"

namespace forcelayer::loop {
namespace {

// The report of the device's side that it has let go of the motors again arrives late.
constexpr double kHeldGraceS = 0.05;

struct CauseRow {
  TripCause cause;
  const char* text;
  const char* mend;
  bool trips_waiting;  // an output that waits trips on it too, since it does not pass by itself
};

constexpr CauseRow kCauses[] = {
    {TripCause::kNone, "none", "", false},
    {TripCause::kDeviceLost, "the device does not answer", "look at plug and power", true},
    {TripCause::kNotCalibrated, "the device is not calibrated", "calibrate it", true},
    {TripCause::kFrozen, "no fresh reading from the device", "look at the device and its driver",
     true},
    {TripCause::kInputNotFinite, "the device's pose is not finite", "look at the device's driver",
     true},
    {TripCause::kImplausible, "the device's pose cannot be: far outside its workspace, or a jump",
     "look at the driver's units (meters) and at the encoders", true},
    {TripCause::kOverSpeed, "the hand is too fast", "was the device let go or overpowered?", false},
    {TripCause::kNotFinite, "the motion or its wrench is not finite",
     "please report it, with a recording (--record)", true},
    {TripCause::kLoopLate, "the loop was late", "see voxrun doctor", false},
    {TripCause::kOutputHeld, "the device's side took the motors to zero by itself",
     "see voxrun doctor", false},
    {TripCause::kMapLost, "a baked file was cut short or written to while it was in use",
     "bake it again, into a new file", true},
};

const CauseRow& row_of(TripCause cause) {
  const auto* const row = std::find_if(std::begin(kCauses), std::end(kCauses),
                                       [&](const CauseRow& r) { return r.cause == cause; });
  return row == std::end(kCauses) ? kCauses[0] : *row;
}

// `last` moved towards `wanted` by at most `step`. A zero `wanted` is reached at once: the slew
// limit must not delay letting go.
glm::dvec3 moved(const glm::dvec3& last, const glm::dvec3& wanted, double step) {
  if (glm::dot(wanted, wanted) == 0) return wanted;
  return last + model::clamped(wanted - last, step);
}

}  // namespace

void OutputStage::trip(TripCause cause) noexcept {
  state_ = OutputState::kTripped;
  last_trip_ = cause;
  ++trips_;
}

bool OutputStage::may_arm(const OutputFrame& frame) const noexcept {
  if (frame.faulty || !model::is_finite(frame.wanted) || cause_to_trip(frame) != TripCause::kNone) {
    return false;
  }
  if (frame.health.clutch) return true;  // the hand grips the part anew, without stretch
  if (state_ == OutputState::kTripped && !limits_.rearm_alone) return false;
  return frame.free_of_contact || frame.unstretched;
}

// The first cause that forbids output in this frame, the gravest first. Faults of one frame are no
// cause: they give zero in that frame, and trip once they last for stale_s.
TripCause OutputStage::cause_to_trip(const OutputFrame& frame) const noexcept {
  const InputTrouble trouble = frame.health.trouble;
  if (frame.map_lost) return TripCause::kMapLost;
  if (trouble == InputTrouble::kDeviceLost) return TripCause::kDeviceLost;
  if (trouble == InputTrouble::kNotCalibrated) return TripCause::kNotCalibrated;
  if (trouble == InputTrouble::kFrozen) return TripCause::kFrozen;  // stale already
  if (!frame.faulty && !model::is_finite(frame.wanted)) return TripCause::kNotFinite;
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
         (state_ == OutputState::kWaiting && row_of(cause).trips_waiting);
}

Wrench OutputStage::limited(const Wrench& wanted, double gain) const noexcept {
  return {model::clamped(wanted.force_n, limits_.max_force_n) * gain,
          model::clamped(wanted.torque_nm, limits_.max_torque_nm) * gain};
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
  last_ = slewed(limited(frame.wanted, gain_ * devices::late_gain(frame.health.age_share)), dt_s);
  return last_;
}

}  // namespace forcelayer::loop

namespace forcelayer {

const char* to_text(TripCause cause) { return loop::row_of(cause).text; }
const char* how_to_mend(TripCause cause) { return loop::row_of(cause).mend; }

}  // namespace forcelayer
