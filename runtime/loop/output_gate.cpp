#include "runtime/loop/output_gate.h"

#include <algorithm>

namespace forcelayer::loop {
namespace {

constexpr double kFall = 1 / OutputGate::kEpisodes;  // of the bucket, for one from full to zero
constexpr double kRounding = 1e-9;                   // of a bucket that is filled frame by frame

}  // namespace

void OutputGate::trip(TripCause cause) noexcept {
  state_ = GateState::kTripped;
  last_trip_ = cause;
  ++trips_;
  gain_ = 0;
}

// Charges and drains the bucket. It keeps no more than it holds, so that a long fault is forgotten
// like a short one.
bool OutputGate::overflows(const GateInput& input, double dt_s) noexcept {
  const bool bad = input.fault != TripCause::kNone;
  if (bad) {
    level_ += std::max(dt_s / limits_.stale_s, was_bad_ ? 0 : kFall);
  } else {
    level_ = std::max(0.0, level_ - kFall * dt_s / kForgetS);
    level_ += kFall * std::max(0.0, gain_ - input.late_gain);
  }
  level_ += kFall * gain_ * input.device_fall;
  was_bad_ = bad;
  const bool over = level_ > 1 + kRounding;
  level_ = std::min(level_, 1.0);
  return over;
}

bool OutputGate::trips_on(const GateInput& input) const noexcept {
  if (input.cause == TripCause::kNone) return false;
  return armed() || (state_ == GateState::kWaiting && input.lasting);
}

bool OutputGate::arms_on(const GateInput& input) const noexcept {
  if (armed() || input.cause != TripCause::kNone || input.fault != TripCause::kNone) return false;
  if (input.clutch) return true;  // the hand grips the part anew, without stretch
  if (state_ == GateState::kTripped && !limits_.rearm_alone) return false;
  return input.ready;
}

// The gain of an armed output in a frame without a cause to trip.
double OutputGate::carry(const GateInput& input, double dt_s) noexcept {
  const bool bad = input.fault != TripCause::kNone;
  if (!bad) armed_s_ += dt_s;
  const bool late = input.late_gain < 1 && input.late_gain <= gain_;
  if (bad || late) {
    gain_ = bad ? 0 : input.late_gain;
    state_ = GateState::kHeld;
    held_s_ = 0;
    return gain_;
  }
  held_s_ += dt_s;
  const bool holds = state_ == GateState::kHeld && held_s_ + 0.5 * dt_s < limits_.zero_s;
  if (input.clutch || input.swapping) {
    gain_ = std::max(0.0, gain_ - dt_s / limits_.fade_s);
  } else if (!holds) {
    gain_ = std::min(input.late_gain, gain_ + dt_s / limits_.ramp_s);
  }
  state_ = holds ? GateState::kHeld : gain_ < 1 ? GateState::kRamping : GateState::kFull;
  return gain_;
}

double OutputGate::pass(const GateInput& frame, double dt_s) noexcept {
  GateInput input = frame;
  if (overflows(input, dt_s) && !input.lasting) {
    input.cause = input.fault != TripCause::kNone ? input.fault
                  : input.device_fall > 0         ? TripCause::kLoopLate
                                                  : TripCause::kFrozen;
    input.lasting = true;
  }
  if (trips_on(input)) trip(input.cause);
  if (arms_on(input)) {
    state_ = GateState::kHeld;
    gain_ = armed_s_ = held_s_ = 0;
    return 0;
  }
  return armed() ? carry(input, dt_s) : 0;
}

}  // namespace forcelayer::loop
