// The loop for programs and SDKs that own the servo thread (push mode): call it once a period with
// the device's reading, and give the wrench that it returns to the motors. The paper's own
// arrangement.
#pragma once

#include <memory>

#include "runtime/loop/loop_statistics.h"
#include "runtime/loop/servo.h"

namespace forcelayer {

// Limits of the output as the parameters have them.
OutputLimits output_limits(const Parameters& parameters);

class CallbackServo {
 public:
  // The part begins as `start` has it, at rest, the handle being where `first` has it.
  // `simulation` must outlive this, and runs at its parameters' rate.
  CallbackServo(Simulation& simulation, const DeviceCapabilities& device,
                const DevicePlacement& placement, const PartStart& start, const DeviceSample& first,
                const OutputLimits& limits, const InputLimits& input_limits = {});

  ~CallbackServo();

  // One period: the wrench on the hand, about the handle's origin, device axes. Never blocks,
  // allocates, locks or logs. A call that comes later than limits.stale_s trips the output.
  Wrench call(const DeviceSample& reading) noexcept;

  // Clutch, swap and state; servo().tick() is not for the caller.
  Servo& servo() { return *servo_; }
  const Frame& frame() const { return frame_; }  // of the last call
  const LoopStatistics& statistics() const { return *statistics_; }

 private:
  class Supplied;  // a device whose readings are handed over

  double stale_s_;
  std::unique_ptr<Supplied> device_;
  std::unique_ptr<DeviceInput> input_;
  std::unique_ptr<Servo> servo_;
  std::unique_ptr<LoopStatistics> statistics_;
  Frame frame_;
  long long last_ns_ = 0;
};

}  // namespace forcelayer
