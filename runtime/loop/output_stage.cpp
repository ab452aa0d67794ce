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
constexpr double kRounding = 1e-12;  // of a wrench's length, relative

struct CauseRow {
  TripCause cause;
  const char* text;
  const char* mend;
  bool lasting;  // it does not pass by itself: an output that waits trips on it too
};

constexpr CauseRow kCauses[] = {
    {TripCause::kNone, "none", "", false},
    {TripCause::kDeviceLost, "the device does not answer", "check plug and power", true},
    {TripCause::kNotCalibrated, "the device is not calibrated", "calibrate it", true},
    {TripCause::kFrozen, "no fresh reading from the device", "check the device and its driver",
     true},
    {TripCause::kInputNotFinite, "the device's pose is not finite", "check the device's driver",
     true},
    {TripCause::kImplausible,
     "the device's pose is impossible: it is far outside the workspace, jumps, or contradicts the "
     "velocity",
     "check the driver's units (meters, radians) and the encoders", true},
    {TripCause::kOverSpeed, "the hand is too fast",
     "check whether the handle slipped out of the hand, or the motors were too strong", false},
    {TripCause::kNotFinite, "the motion or the wrench is not finite",
     "report this error with a recording (--record)", true},
    {TripCause::kLoopLate, "the loop was late", "see voxrun doctor", false},
    {TripCause::kOutputHeld, "the device or its driver set the motors to zero by itself",
     "see voxrun doctor", false},
};

const CauseRow& row_of(TripCause cause) {
  const auto* const row = std::find_if(std::begin(kCauses), std::end(kCauses),
                                       [&](const CauseRow& r) { return r.cause == cause; });
  return row == std::end(kCauses) ? kCauses[0] : *row;
}

// A limit of zero lets nothing through, not even what is so small that its square is zero.
glm::dvec3 clamped(const glm::dvec3& v, double limit) {
  return limit == 0 ? glm::dvec3(0) : model::clamped(v, limit);
}

// `last` moved towards `wanted` by at most `step`. A zero `wanted` is reached at once: the slew
// limit must not delay letting go.
glm::dvec3 moved(const glm::dvec3& last, const glm::dvec3& wanted, double step) {
  if (glm::dot(wanted, wanted) == 0) return wanted;
  return last + model::clamped(wanted - last, step);
}

// The cause to trip with if this frame's fault lasts.
TripCause fault_of(const OutputFrame& frame) {
  if (!frame.faulty) return TripCause::kNone;
  switch (frame.health.trouble) {
    case InputTrouble::kImplausible:
      return TripCause::kImplausible;
    case InputTrouble::kNotFinite:
      return TripCause::kInputNotFinite;
    default:
      return frame.not_finite ? TripCause::kNotFinite : TripCause::kFrozen;
  }
}

}  // namespace

// The first cause that forbids output in this frame, the gravest first. Faults of one frame are no
// cause: they give zero in that frame.
TripCause OutputStage::cause_to_trip(const OutputFrame& frame) const noexcept {
  const InputTrouble trouble = frame.health.trouble;
  if (trouble == InputTrouble::kDeviceLost) return TripCause::kDeviceLost;
  if (trouble == InputTrouble::kNotCalibrated) return TripCause::kNotCalibrated;
  if (trouble == InputTrouble::kFrozen) return TripCause::kFrozen;  // stale already
  if (!frame.faulty && !model::is_finite(frame.wanted)) return TripCause::kNotFinite;
  if (frame.health.loop_late) return TripCause::kLoopLate;
  const bool fast =
      frame.speed_mps > limits_.max_speed_mps || frame.turn_radps > limits_.max_turn_radps;
  if (fast) return TripCause::kOverSpeed;
  const bool settled = gate_.armed() && gate_.armed_s() > kHeldGraceS;
  if (settled && frame.health.output_held) return TripCause::kOutputHeld;
  return TripCause::kNone;
}

Wrench OutputStage::limited(const Wrench& wanted, double gain) const noexcept {
  return {clamped(wanted.force_n, limits_.max_force_n) * gain,
          clamped(wanted.torque_nm, limits_.max_torque_nm) * gain};
}

Wrench OutputStage::slewed(const Wrench& wanted, double dt_s) const noexcept {
  const double fraction = dt_s / limits_.slew_s;
  return {moved(last_.force_n, wanted.force_n, limits_.max_force_n * fraction),
          moved(last_.torque_nm, wanted.torque_nm, limits_.max_torque_nm * fraction)};
}

// Whether the wrench may go out, whatever came before.
bool OutputStage::allowed(const Wrench& wrench) const noexcept {
  return glm::length(wrench.force_n) <= limits_.max_force_n * (1 + kRounding) &&
         glm::length(wrench.torque_nm) <= limits_.max_torque_nm * (1 + kRounding);
}

Wrench OutputStage::pass(const OutputFrame& frame, double dt_s) noexcept {
  GateInput input;
  input.cause = cause_to_trip(frame);
  input.lasting = row_of(input.cause).lasting;
  input.fault = fault_of(frame);
  input.late_gain = devices::late_gain(frame.health.age_fraction);
  input.device_fall = frame.health.output_fall;
  // A part that is held for a swap is looked at nowhere, and gripped anew in each frame.
  input.ready = !frame.health.swapping && (frame.free_of_contact || frame.unstretched);
  input.clutch = frame.health.clutch;
  input.swapping = frame.health.swapping;
  const double gain = gate_.pass(input, dt_s);
  last_ = gain > 0 ? slewed(limited(frame.wanted, gain), dt_s) : Wrench{};
  if (allowed(last_)) return last_;
  gate_.trip(TripCause::kNotFinite);
  last_ = {};
  return last_;
}

OutputState OutputStage::state() const {
  if (gate_.armed()) return OutputState::kArmed;
  return gate_.state() == GateState::kWaiting ? OutputState::kWaiting : OutputState::kTripped;
}

}  // namespace forcelayer::loop

namespace forcelayer {

const char* to_text(TripCause cause) { return loop::row_of(cause).text; }
const char* how_to_mend(TripCause cause) { return loop::row_of(cause).mend; }

}  // namespace forcelayer
