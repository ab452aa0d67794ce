// `spacemouse`: 3Dconnexion's spring-centerd caps. They sense, and give no force.
#pragma once

#include <memory>

#include "runtime/devices/device.h"
#include "runtime/devices/hid/hid_link.h"
#include "runtime/devices/hid/spacemouse_layout.h"
#include "runtime/machine/latest_value.h"

namespace forcelayer::devices {

enum class SpaceMouseControl {
  kRate,      // the cap's deflection is the handle's velocity
  kPosition,  // it is the handle's place: released, the handle is back where it began
};

struct SpaceMouseOptions {
  SpaceMouseControl control = SpaceMouseControl::kRate;
  double dead_zone = 0.05;  // fraction of full deflection that is rest; the rest is stretched
  double speed_mps = 0.1;   // at full deflection, in rate control
  double turn_radps = 1;    // the same
  double reach_m = 0.05;    // at full deflection, in position control
  double reach_rad = 0.8;   // the same
};

// The handle as the cap moves it: a smooth path from readings that come some hundred times a
// second. Frame: x to the right, y away from the user, z up. A pure state machine.
class SpaceMouseMotion {
 public:
  static constexpr double kSmoothingS = 0.02;  // of a step in the readings: two or three of them
  static constexpr double kHoldS = 0.25;  // a deflected cap that is silent for longer was released

  explicit SpaceMouseMotion(const SpaceMouseOptions& options) : options_(options) {}

  // `dt_s` later, the cap being at `deflection`.
  void advance(const std::array<double, 6>& deflection, double dt_s) noexcept;

  const Pose& device_from_handle() const { return pose_; }
  const Twist& velocity() const { return velocity_; }  // of the handle's origin, device axes

 private:
  SpaceMouseOptions options_;
  std::array<double, 6> smooth_{};  // deflection, x y z rx ry rz in the frame above
  Pose pose_;
  Twist velocity_;
};

class SpaceMouse final : public Device, private HidLinkClient {
 public:
  SpaceMouse(std::unique_ptr<HidBus> bus, HidSelector selector, const SpaceMouseOptions& options);
  ~SpaceMouse() override { stop(); }

  const DeviceCapabilities& capabilities() const override { return capabilities_; }
  Status start() override { return link_.start(); }
  DeviceSample read(double time_s) noexcept override;
  void write(const Wrench&) noexcept override {}  // there are no motors
  void stop() noexcept override { link_.stop(); }

  DeviceTrouble trouble() const override { return link_.trouble(); }

 private:
  struct Report {
    SpaceMouseReading reading;
    long long moved_ns = 0;  // when the last report with axes came
  };

  Status attach(HidPort& port, const HidDeviceInfo& info) override;
  void take_report(std::span<const std::uint8_t> report, long long now_ns) noexcept override;
  HidLoss look(long long now_ns) noexcept override;
  void detach() noexcept override;
  void light(bool on) noexcept;

  std::unique_ptr<HidBus> bus_;
  DeviceCapabilities capabilities_;
  SpaceMouseLayout layout_;
  HidPort* port_ = nullptr;  // while attached
  Report received_;          // the link's thread's
  bool news_ = false;        // received_ has been changed since it was handed over
  machine::LatestValue<Report> handed_;
  Report held_;              // the loop's
  SpaceMouseMotion motion_;  // the loop's
  double time_s_ = 0;        // of the loop's last read()
  std::uint64_t sequence_ = 0;
  HidLink link_;
};

}  // namespace forcelayer::devices
