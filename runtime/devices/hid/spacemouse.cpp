#include "runtime/devices/hid/spacemouse.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "runtime/coupling/coupling.h"
#include "runtime/devices/sim_device.h"
#include "runtime/machine/real_time.h"

namespace forcelayer::devices {
namespace {

constexpr std::array<std::uint16_t, 2> kVendors = {0x256f, 0x046d};  // 3Dconnexion; Logitech before
constexpr double kMaxStepS = 0.1;  // a loop that slept does not jump
constexpr double kAtRest = 1e-6;   // of full deflection

// The device has no motors whose ratings could bound the coupling. It takes the simulated device's.
DeviceCapabilities spacemouse_capabilities() {
  DeviceCapabilities device = sim_capabilities();
  device.name = "spacemouse";
  device.actuated_axes = 0;
  device.rate_hz = 100;
  device.watchdog_s = 0;
  device.hardware = true;
  return device;
}

// From the cap's axes (x right, y towards the user, z down) to x right, y away, z up: half a turn
// about x.
constexpr std::array<double, 6> kSigns = {1, -1, -1, 1, -1, -1};

double beyond_dead_zone(double deflection, double dead_zone) {
  const double beyond = (std::abs(deflection) - dead_zone) / (1 - dead_zone);
  return beyond > 0 ? std::copysign(beyond, deflection) : 0;
}

}  // namespace

void SpaceMouseMotion::advance(const std::array<double, 6>& deflection, double dt_s) noexcept {
  const double fraction = 1 - std::exp(-dt_s / kSmoothingS);
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const double wanted = kSigns[axis] * beyond_dead_zone(deflection[axis], options_.dead_zone);
    smooth_[axis] += fraction * (wanted - smooth_[axis]);
    if (wanted == 0 && std::abs(smooth_[axis]) < kAtRest) smooth_[axis] = 0;
  }
  const glm::dvec3 move(smooth_[0], smooth_[1], smooth_[2]),
      turn(smooth_[3], smooth_[4], smooth_[5]);
  if (!(dt_s > 0)) return;
  if (options_.control == SpaceMouseControl::kRate) {
    velocity_ = {options_.speed_mps * move, options_.turn_radps * turn};
    pose_.position_m += velocity_.linear_mps * dt_s;
    pose_.orientation =
        glm::normalize(coupling::rotation_by(velocity_.angular_radps * dt_s) * pose_.orientation);
    return;
  }
  const Pose now{options_.reach_m * move, coupling::rotation_by(options_.reach_rad * turn)};
  velocity_ = {
      (now.position_m - pose_.position_m) / dt_s,
      coupling::rotation_vector(now.orientation * glm::conjugate(pose_.orientation)) / dt_s};
  pose_ = now;
}

SpaceMouse::SpaceMouse(std::unique_ptr<HidBus> bus, HidSelector selector,
                       const SpaceMouseOptions& options)
    : bus_(std::move(bus)),
      capabilities_(spacemouse_capabilities()),
      motion_(options),
      link_(*bus_, {"SpaceMouse", kVendors, kMultiAxisUsage}, std::move(selector), *this) {}

DeviceSample SpaceMouse::read(double time_s) noexcept {
  handed_.take(held_);
  const bool present = link_.connected();
  const double silent_s = static_cast<double>(machine::monotonic_ns() - held_.moved_ns) * 1e-9;
  const bool moved = present && silent_s <= SpaceMouseMotion::kHoldS;
  motion_.advance(moved ? held_.reading.deflection : std::array<double, 6>{},
                  std::clamp(time_s - time_s_, 0.0, kMaxStepS));
  time_s_ = time_s;
  DeviceSample sample;
  sample.device_from_handle = motion_.device_from_handle();
  sample.velocity = motion_.velocity();
  sample.buttons = present ? held_.reading.buttons : 0;
  sample.present = sample.fresh = present;  // it is silent while the cap is at rest
  sample.sequence = ++sequence_;
  return sample;
}

Status SpaceMouse::attach(HidPort& port, const HidDeviceInfo& info) {
  const auto descriptor = parse_hid_report_descriptor(port.report_descriptor());
  const auto layout = descriptor ? SpaceMouseLayout::from(*descriptor) : descriptor.error();
  if (!layout) {
    Error error = layout.error();
    error.file = to_text(info);
    return error;
  }
  layout_ = *layout;
  port_ = &port;
  received_ = {};
  news_ = true;
  light(true);
  return {};
}

void SpaceMouse::light(bool on) noexcept {
  const std::vector<std::uint8_t> report = layout_.led_report(on);
  if (!report.empty()) (void)port_->write(report);
}

void SpaceMouse::take_report(std::span<const std::uint8_t> report, long long now_ns) noexcept {
  if (layout_.take(report, received_.reading)) received_.moved_ns = now_ns;
  news_ = true;
}

HidLoss SpaceMouse::look(long long) noexcept {
  if (news_) handed_.put(received_);
  news_ = false;
  return {};
}

void SpaceMouse::detach() noexcept {
  light(false);
  port_ = nullptr;
}

}  // namespace forcelayer::devices
