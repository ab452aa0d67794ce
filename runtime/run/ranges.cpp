#include "forcelayer/ranges.h"

#include <cmath>
#include <cstdio>
#include <string>

#include "forcelayer/run.h"
#include "runtime/run/limits.h"

namespace forcelayer {
namespace {

constexpr Range kStaleS{1e-6, 1e4};
constexpr double kDerived = 1e30;  // far above what any range of the others leads to

struct Rating {
  const char* name;
  double DeviceCapabilities::*member;
  double largest;  // the least is 0: none, or not known
};
constexpr Rating kRatings[] = {
    {"max_force_n", &DeviceCapabilities::max_force_n, 1000},
    {"max_torque_nm", &DeviceCapabilities::max_torque_nm, 100},
    {"max_stiffness_n_per_m", &DeviceCapabilities::max_stiffness_n_per_m, 1e7},
    {"max_stiffness_nm_per_rad", &DeviceCapabilities::max_stiffness_nm_per_rad, 1e5},
    {"damping_ns_per_m", &DeviceCapabilities::damping_ns_per_m, 1e5},
    {"damping_nms_per_rad", &DeviceCapabilities::damping_nms_per_rad, 1e4},
    {"friction_n", &DeviceCapabilities::friction_n, 1000},
    {"friction_nm", &DeviceCapabilities::friction_nm, 100},
    {"encoder_step_m", &DeviceCapabilities::encoder_step_m, 1},
    {"encoder_step_rad", &DeviceCapabilities::encoder_step_rad, 10},
    {"apparent_mass_kg", &DeviceCapabilities::apparent_mass_kg, 1000},
    {"apparent_inertia_kgm2", &DeviceCapabilities::apparent_inertia_kgm2, 1000},
    {"delay_s", &DeviceCapabilities::delay_s, 1},
    {"workspace_radius_m", &DeviceCapabilities::workspace_radius_m, 1000},
    {"rate_hz", &DeviceCapabilities::rate_hz, kRatesHz.largest},
    {"watchdog_s", &DeviceCapabilities::watchdog_s, 1}};

}  // namespace

Status check_range(std::string_view name, double value, const Range& range) {
  if (value >= range.smallest && value <= range.largest) return {};  // neither for NaN
  char text[100];
  std::snprintf(text, sizeof text, "%.6g is outside the range %.6g to %.6g", value, range.smallest,
                range.largest);
  return Error{ErrorCode::kUsage, "", name, text, ""};
}

Status check_ratings(const DeviceCapabilities& device) {
  for (const Rating& rating : kRatings) {
    if (Status s = check_range(rating.name, device.*rating.member, {0, rating.largest}); !s)
      return s;
  }
  return {};
}

Status check_numbers(const RunRequest& request) {
  const struct {
    const char* name;
    double value;
    Range range;
  } numbers[] = {{"rate_hz", request.rate_hz, kRatesHz},
                 {"motion_scale", request.placement.motion_scale, kMotionScales},
                 {"stale_s", request.stale_s, kStaleS},
                 {"max_speed_mps", request.max_speed_mps, kMaxSpeedsMps},
                 {"max_turn_radps", max_turn_radps(request), kMaxTurnsRadps},
                 {"threads", static_cast<double>(request.threads), kThreads}};
  for (const auto& number : numbers) {
    if (Status s = check_range(number.name, number.value, number.range); !s) return s;
  }
  if (Status s = check_ratings(request.device); !s) return s;
  return request.recorded ? check_recorded(*request.recorded) : Status{};
}

// A device without motors has limits of 0, and what was derived from a motion scale may be beyond
// the range of a setting.
Status check_recorded(const Parameters& p) {
  if (Status s = check_range("rate_hz", p.rate_hz, kRatesHz); !s) return s;
  for (const ParameterInfo& info : parameter_table()) {
    const double value = p.*(info.member);
    const bool at_device =
        info.member == &Parameters::max_force_n || info.member == &Parameters::max_torque_nm;
    const double largest = at_device ? info.range.largest : kDerived;
    if (info.may_be_infinite && std::isinf(value) && value > 0) continue;
    if (Status s = check_range(info.name, value, {0, largest}); !s) return s;
  }
  return {};
}

}  // namespace forcelayer
