// The gate decides over time when the output may carry force, and how much of it. It is a state
// machine that knows no device, wrench or step; the output stage reports each frame to it.
//
// | state   | gain            | leaves to                                                         |
// |---------|-----------------|-------------------------------------------------------------------|
// | waiting | 0               | held: sound, and ready or clutched. Tripped: lasting cause        |
// | held    | does not rise   | ramping after zero_s without a fault. Tripped: cause              |
// | ramping | rises in ramp_s | full at gain 1. Held: bad or late. Tripped: cause                 |
// | full    | 1               | ramping: clutch or swap. Held: bad or late. Tripped: cause        |
// | tripped | 0               | held: sound and clutched; with rearm_alone as waiting             |
//
// | input of a frame | effect                                                                   |
// |------------------|--------------------------------------------------------------------------|
// | sound            | drains the bucket; the gain rises                                        |
// | late             | the gain falls to what the reading's age allows; charges the fall        |
// | faded            | the device's side faded the output of a late loop, and ramps it in      |
// |                  | itself: charges that fall                                                |
// | bad              | gain 0 in this frame; charges the bucket; one that is full is a lasting  |
// |                  | cause                                                                    |
// | passing cause    | gain 0; trips held, ramping and full: a late loop, a fast hand           |
// | lasting cause    | the same, and trips waiting: the device, its numbers                     |
// | clutch, swap     | sound, and the gain falls to 0 in fade_s                                 |
//
// The bucket bounds what comes and goes. Full, it holds kEpisodes falls of the gain from 1 to 0; it
// drains one in kForgetS. A late frame charges its fall, and so does
// a faded one. A bad frame charges its length over
// stale_s, and the first of a row at least a whole fall. So before it trips, the falls by faults in
// any T seconds add up to at most kEpisodes + T / kForgetS, and so do the rises that follow them.
#pragma once

#include <cstdint>

#include "forcelayer/frame.h"
#include "forcelayer/stale_limit.h"

namespace forcelayer::loop {

enum class GateState : std::uint32_t { kWaiting, kHeld, kRamping, kFull, kTripped };

struct GateLimits {
  double zero_s = 0.02;  // the gain stays at zero so long after arming and after a fault:
                         // OutputWatch lets a force through only once it has seen a zero from the
                         // loop, and a write can take 14 ms
  double ramp_s = 0.2;   // from zero to full gain
  double fade_s = 0.05;  // from full gain to zero when the clutch is pressed
  double stale_s = kStaleLimitS;  // longest run of bad frames without a trip
  bool rearm_alone = false;       // arms again by itself once a trip's cause is gone: for simulated
                                  // hands, never with a motor
};

// One frame as the gate sees it. The default is a sound frame that may not arm.
struct GateInput {
  TripCause cause = TripCause::kNone;  // forbids output at once
  bool lasting = false;                // that cause does not pass by itself
  TripCause fault = TripCause::kNone;  // of a bad frame: the cause of the trip if such frames last
  double late_gain = 1;                // the most that the age of the reading allows
  double device_fall = 0;              // of the output by the device's side, 1 from full to zero
  bool ready = false;     // to arm: the part is free of contact, or held without stretch
  bool clutch = false;    // pressed: the output goes to zero; the clutch arms
  bool swapping = false;  // the output goes to zero, but nothing arms: no hand has said it is ready
};

class OutputGate {
 public:
  static constexpr double kEpisodes = 5;
  static constexpr double kForgetS = 1;

  explicit OutputGate(const GateLimits& limits) : limits_(limits) {}

  // The gain for the output of this frame of `dt_s`, 0 to 1.
  double pass(const GateInput& input, double dt_s) noexcept;

  // To zero at once.
  void trip(TripCause cause) noexcept;

  GateState state() const { return state_; }
  bool armed() const { return state_ != GateState::kWaiting && state_ != GateState::kTripped; }
  double armed_s() const { return armed_s_; }  // sound frames since arming
  double gain() const { return gain_; }
  double level() const { return level_; }  // of the bucket; full at 1
  TripCause last_trip() const { return last_trip_; }
  std::uint64_t trips() const { return trips_; }

 private:
  bool overflows(const GateInput& input, double dt_s) noexcept;
  bool trips_on(const GateInput& input) const noexcept;
  bool arms_on(const GateInput& input) const noexcept;
  double carry(const GateInput& input, double dt_s) noexcept;

  GateLimits limits_;
  GateState state_ = GateState::kWaiting;
  TripCause last_trip_ = TripCause::kNone;
  std::uint64_t trips_ = 0;
  double gain_ = 0;
  double level_ = 0;
  bool was_bad_ = false;
  double armed_s_ = 0;
  double held_s_ = 0;  // since the last fault, or arming
};

}  // namespace forcelayer::loop
