#include "runtime/derive_parameters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "runtime/stability.h"

namespace forcelayer {
namespace {

constexpr double kApparentMassKg = 0.012;     // paper 5.1
constexpr double kComfortableLoad = 1.0 / 4;  // h sqrt(k_T / m): the spring alone loads h^2 k + 2 h
                                              // b < 4 to 27%, "comfortably consistent" (paper 5.1)
constexpr double kFieldMargin = 0.9;          // of the largest stable K_ff
constexpr double kAveragedPoints = 10;        // paper 5.2

constexpr ParameterInfo kTable[] = {
    {"mass_kg", "--mass", "apparent mass of the part, kg", &Parameters::mass_kg},
    {"coupling_n_per_m", "--coupling-stiffness", "coupling spring k_T, N/m",
     &Parameters::coupling_n_per_m},
    {"coupling_ns_per_m", "--coupling-damping", "coupling damper b_T, N s/m",
     &Parameters::coupling_ns_per_m},
    {"coupling_nm_per_rad", "--coupling-stiffness-rot", "coupling spring k_R, N m/rad",
     &Parameters::coupling_nm_per_rad},
    {"coupling_nms_per_rad", "--coupling-damping-rot", "coupling damper b_R, N m s/rad",
     &Parameters::coupling_nms_per_rad},
    {"coupling_force_limit_n", "--coupling-force-limit", "clamp of the coupling's force, N",
     &Parameters::coupling_force_limit_n},
    {"coupling_torque_limit_nm", "--coupling-torque-limit", "clamp of the coupling's torque, N m",
     &Parameters::coupling_torque_limit_nm},
    {"field_n_per_m", "--field-stiffness", "force field stiffness K_ff, N/m",
     &Parameters::field_n_per_m},
    {"max_force_n", "--max-force", "largest force at the device, N", &Parameters::max_force_n},
    {"max_torque_nm", "--max-torque", "largest torque at the device, N m",
     &Parameters::max_torque_nm},
};

std::string format(const char* pattern, double a, double b = 0, double c = 0) {
  char text[256];
  std::snprintf(text, sizeof text, pattern, a, b, c);
  return text;
}

// Takes the user's setting where there is one, else the default with its reason.
class Choice {
 public:
  Choice(const ParameterRequest& request, DerivedParameters& derived)
      : request_(request), derived_(derived) {}

  void set(std::string_view name, double value, std::string reason) {
    const auto* info = std::find_if(std::begin(kTable), std::end(kTable),
                                    [&](const ParameterInfo& i) { return i.name == name; });
    const auto setting = request_.settings.find(std::string(name));
    const bool chosen = setting != request_.settings.end();
    derived_.values.*(info->member) = chosen ? setting->second : value;
    derived_.reasons[std::string(name)] = chosen ? "set" : std::move(reason);
  }

 private:
  const ParameterRequest& request_;
  DerivedParameters& derived_;
};

Status check_settings(const ParameterRequest& request) {
  for (const auto& [name, value] : request.settings) {
    const auto* info =
        std::find_if(std::begin(kTable), std::end(kTable),
                     [&, n = &name](const ParameterInfo& i) { return i.name == *n; });
    if (info == std::end(kTable)) {
      return Error{ErrorCode::kInternal, "", name, "is no parameter", ""};
    }
    if (!(value > 0)) {
      return Error{ErrorCode::kUsage, "", std::string(info->option), "must be above zero", ""};
    }
  }
  return {};
}

double stiffness_bound(double rated, double damping, double delay_s, double dt_s) {
  const double renderable = renderable_stiffness(damping, delay_s, dt_s);
  return rated > 0 ? std::min(rated, renderable) : renderable;
}

// Device limits: the user's, never above the ratings.
void choose_limits(const ParameterRequest& request, const DeviceCapabilities& device,
                   DerivedParameters& derived) {
  Choice choice(request, derived);
  Parameters& p = derived.values;
  choice.set("max_force_n", device.max_force_n, "rating of " + device.name);
  choice.set("max_torque_nm", device.max_torque_nm, "rating of " + device.name);
  if (p.max_force_n > device.max_force_n || p.max_torque_nm > device.max_torque_nm) {
    derived.warnings.push_back("--max-force and --max-torque end at the ratings of " + device.name +
                               format(": %g N, %g N m", device.max_force_n, device.max_torque_nm));
  }
  p.max_force_n = std::min(p.max_force_n, device.max_force_n);
  p.max_torque_nm = std::min(p.max_torque_nm, device.max_torque_nm);
}

// k_T, b_T, k_R, b_R of paper 5.1: high but comfortably stable, critically damped.
void choose_coupling(const ParameterRequest& request, const DeviceCapabilities& device,
                     DerivedParameters& derived) {
  Choice choice(request, derived);
  Parameters& p = derived.values;
  const double dt_s = 1 / p.rate_hz, inertia_kgm2 = p.inertia_kgm2[0][0];
  const double comfortable = kComfortableLoad * kComfortableLoad * p.mass_kg / (dt_s * dt_s);
  const double bound =
      stiffness_bound(device.max_stiffness_n_per_m, device.damping_ns_per_m, device.delay_s, dt_s) /
      request.motion_scale;
  choice.set("coupling_n_per_m", std::min(comfortable, bound),
             bound < comfortable
                 ? "the stiffness that " + device.name + " bears, over the motion scale"
                 : "(m / 16 dt^2): comfortably stable at this rate (paper 5.1)");
  choice.set("coupling_ns_per_m", 2 * std::sqrt(p.mass_kg * p.coupling_n_per_m),
             "2 sqrt(m k_T): critically damped (paper 5.1)");
  const double bound_rot = stiffness_bound(device.max_stiffness_nm_per_rad,
                                           device.damping_nms_per_rad, device.delay_s, dt_s);
  const double same_frequency = p.coupling_n_per_m * inertia_kgm2 / p.mass_kg;
  choice.set("coupling_nm_per_rad", std::min(same_frequency, bound_rot),
             bound_rot < same_frequency ? "the rotational stiffness that " + device.name + " bears"
                                        : "k_T I / m: the frequency of the translation");
  choice.set("coupling_nms_per_rad", 2 * std::sqrt(inertia_kgm2 * p.coupling_nm_per_rad),
             "2 sqrt(I k_R): critically damped (paper 5.1)");
  if (p.coupling_n_per_m > bound) {
    derived.warnings.push_back(
        format("--coupling-stiffness %g N/m is above the %g N/m", p.coupling_n_per_m, bound) +
        " that " + device.name +
        " can render stably: b / (delay + dt / 2), or its rating, over the "
        "motion scale");
  }
}

// K_ff of paper 5.2: the largest value consistent with stable operation, for up to 10 forces at
// once, each turning the part with at most the shell's largest arm. With mobility
// mu = 1 + m r^2 / I, symplectic Euler is stable while
//   h^2 (k_T + 10 mu K_ff) / m + 2 h b_T / m < 4.
void choose_field(const ParameterRequest& request, double arm_m, DerivedParameters& derived) {
  Choice choice(request, derived);
  Parameters& p = derived.values;
  const double dt_s = 1 / p.rate_hz, inertia_kgm2 = p.inertia_kgm2[0][0];
  const double mobility_1pkg = 1 / p.mass_kg + arm_m * arm_m / inertia_kgm2;
  const double stiffness =
      std::max(p.coupling_n_per_m / p.mass_kg, p.coupling_nm_per_rad / inertia_kgm2);
  const double damping =
      std::max(p.coupling_ns_per_m / p.mass_kg, p.coupling_nms_per_rad / inertia_kgm2);
  const double room = 1 - symplectic_euler_load(stiffness, damping, dt_s);
  const double largest = 4 * room / (dt_s * dt_s * kAveragedPoints * mobility_1pkg);
  choice.set("field_n_per_m", room > 0 ? kFieldMargin * largest : p.coupling_n_per_m,
             "0.9 of the largest stable at 10 intersections (paper 5.2): "
             "(4 - h^2 k_T/m - 2 h b_T/m) / (10 h^2 (1/m + r^2/I))");
  if (room <= 0) {
    derived.warnings.push_back(
        "the coupling alone is unstable at this rate: h^2 k/m + 2 h b/m reaches 4 (symplectic "
        "Euler); lower --coupling-stiffness or raise --mass or --rate");
  } else if (p.field_n_per_m > largest) {
    derived.warnings.push_back(
        format("--field-stiffness %g N/m is above the %g N/m", p.field_n_per_m, largest) +
        " that is stable for ten intersections at this rate (symplectic Euler)");
  }
}

void derive_paper(const ParameterRequest& request, const Pshell& shell,
                  const DeviceCapabilities& device, DerivedParameters& derived) {
  Choice choice(request, derived);
  Parameters& p = derived.values;
  choice.set("mass_kg", kApparentMassKg, "apparent mass of the paper (5.1)");
  p.inertia_kgm2 = glm::dmat3(0.4 * p.mass_kg * p.part_radius_m * p.part_radius_m);
  choose_coupling(request, device, derived);
  choice.set("coupling_force_limit_n", p.coupling_n_per_m * p.voxel_size_m / 2,
             "k_T s/2, the spring's force only (paper 5.2)");
  choice.set("coupling_torque_limit_nm", std::numeric_limits<double>::infinity(),
             "none (paper 5.2)");
  choose_field(request, largest_contact_arm_m(shell), derived);
}

}  // namespace

std::span<const ParameterInfo> parameter_table() { return kTable; }

double largest_contact_arm_m(const Pshell& shell) {
  const PshellView& v = shell.view();
  double largest2 = 0;
  for (std::uint64_t i = 0; i < v.point_count; ++i) {
    const double x = double{v.y[i]} * v.nz[i] - double{v.z[i]} * v.ny[i],
                 y = double{v.z[i]} * v.nx[i] - double{v.x[i]} * v.nz[i],
                 z = double{v.x[i]} * v.ny[i] - double{v.y[i]} * v.nx[i];
    largest2 = std::max(largest2, x * x + y * y + z * z);
  }
  return std::sqrt(largest2);
}

Result<DerivedParameters> derive_parameters(const ParameterRequest& request, const Voxmap& voxmap,
                                            const Pshell& shell, const DeviceCapabilities& device) {
  if (Status valid = check_settings(request); !valid) return valid.error();
  DerivedParameters derived;
  Parameters& p = derived.values;
  p.model = request.model;
  p.force = request.force;
  p.braking = request.braking;
  p.rate_hz = request.rate_hz;
  p.voxel_size_m = voxmap.voxel_size_m();
  // A part of one point has no radius; half a voxel keeps its inertia above zero.
  p.part_radius_m = std::max(shell.header().bounding_radius_m, p.voxel_size_m / 2);
  choose_limits(request, device, derived);
  switch (request.model) {
    case Model::kPaper:
      derive_paper(request, shell, device, derived);
      break;
  }
  return derived;
}

}  // namespace forcelayer
