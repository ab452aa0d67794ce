// The loop for programs and SDKs that own the servo thread (push mode). They call it once a period
// with the device's reading and give the returned wrench to the motors. The paper's own
// arrangement.
#pragma once

#include <memory>

#include "runtime/loop/loop_statistics.h"
#include "runtime/loop/servo.h"

namespace forcelayer {

// The limits of the output that the parameters set.
OutputLimits output_limits(const Parameters& parameters);

class CallbackServo {
 public:
  // The part begins at rest where `start` puts it, with the handle at the reading `first`.
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
  class HostDevice;  // the device that the calling program reads and writes itself

  double stale_s_;
  std::unique_ptr<HostDevice> device_;
  std::unique_ptr<DeviceInput> input_;
  std::unique_ptr<Servo> servo_;
  std::unique_ptr<LoopStatistics> statistics_;
  Frame frame_;
  long long last_ns_ = 0;
};

}  // namespace forcelayer
