#include "runtime/output_stage.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace forcelayer {
namespace {

// v, or v shortened to `limit`.
glm::dvec3 at_most(const glm::dvec3& v, double limit) {
  const double length = glm::length(v);
  return length > limit ? v * (limit / length) : v;
}

// `last` moved towards `wanted` by at most `step`; towards zero at once.
glm::dvec3 moved(const glm::dvec3& last, const glm::dvec3& wanted, double step) {
  if (glm::dot(wanted, wanted) == 0) return wanted;
  return last + at_most(wanted - last, step);
}

bool finite(const Wrench& wrench) {
  const double sum =
      glm::dot(wrench.force_n, glm::dvec3(1)) + glm::dot(wrench.torque_nm, glm::dvec3(1));
  return std::isfinite(sum);
}

}  // namespace

const char* to_text(TripCause cause) {
  switch (cause) {
    case TripCause::kStaleInput:
      return "no valid input";
    case TripCause::kOverSpeed:
      return "hand too fast";
    case TripCause::kNotFinite:
      return "wrench not finite";
    case TripCause::kNone:
      break;
  }
  return "none";
}

void OutputStage::trip(TripCause cause) noexcept {
  state_ = OutputState::kTripped;
  last_trip_ = cause;
  ++trips_;
}

bool OutputStage::may_arm(const OutputFrame& frame) const noexcept {
  if (state_ == OutputState::kTripped && !limits_.rearm_alone) return false;
  return frame.speed_mps <= limits_.max_speed_mps && (frame.free_of_contact || frame.unstretched);
}

Wrench OutputStage::limited(const Wrench& wanted, double gain) const noexcept {
  return {at_most(wanted.force_n, limits_.max_force_n) * gain,
          at_most(wanted.torque_nm, limits_.max_torque_nm) * gain};
}

Wrench OutputStage::slewed(const Wrench& wanted, double dt_s) const noexcept {
  const double share = dt_s / limits_.slew_s;
  return {moved(last_.force_n, wanted.force_n, limits_.max_force_n * share),
          moved(last_.torque_nm, wanted.torque_nm, limits_.max_torque_nm * share)};
}

Wrench OutputStage::pass(const OutputFrame& frame, double dt_s) noexcept {
  faulty_s_ = frame.faulty ? faulty_s_ + dt_s : 0;
  if (state_ == OutputState::kArmed) {
    if (!finite(frame.wanted)) {
      trip(TripCause::kNotFinite);
    } else if (faulty_s_ > limits_.stale_s) {
      trip(TripCause::kStaleInput);
    } else if (frame.speed_mps > limits_.max_speed_mps) {
      trip(TripCause::kOverSpeed);
    }
  } else if (!frame.faulty && finite(frame.wanted) && may_arm(frame)) {
    state_ = OutputState::kArmed;
    armed_s_ = 0;
  }
  if (state_ != OutputState::kArmed || frame.faulty) {
    last_ = {};
    return last_;
  }
  armed_s_ += dt_s;
  const double gain = std::min(1.0, armed_s_ / limits_.ramp_s);
  last_ = slewed(limited(frame.wanted, gain), dt_s);
  return last_;
}

}  // namespace forcelayer
