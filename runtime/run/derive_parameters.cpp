#include "runtime/run/derive_parameters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "runtime/field/force_field.h"
#include "runtime/loop/handle_velocity.h"
#include "runtime/model/default_model.h"
#include "runtime/model/principal_inertia.h"
#include "runtime/run/stability.h"

namespace forcelayer {
namespace {

constexpr double kApparentMassKg = 0.012;     // paper 5.1
constexpr double kComfortableLoad = 1.0 / 4;  // h sqrt(k_T / m): the spring alone loads h^2 k + 2 h
                                              // b < 4 to 27%, "comfortably consistent" (paper 5.1)
constexpr double kFieldMargin = 0.9;          // of the largest stable K_ff
constexpr double kAveragedPoints = 10;        // paper 5.2

// Fraction of the stiffness that the device bears: a default lies inside the bound, not on it.
constexpr double kBoundFraction = 0.9;

// The default model's.
constexpr double kUnratedStiffness = 1000;  // N/m, for a device that says nothing of itself
// For a device without motors, or without those of an axis: the paper's (5).
constexpr double kUnratedForceN = 15, kUnratedTorqueNm = 0.1;
constexpr double kContactDampingRatio = 0.6;
constexpr double kThrowMps = 3;
constexpr double kRecoveryMps = 0.05;
constexpr double kAllowanceFadeS = 0.01;
constexpr double kMinMomentFraction = 1e-3;  // of the largest principal moment

constexpr ParameterInfo kTable[] = {
    {"mass_kg", "apparent mass of the part in the scene, kg", &Parameters::mass_kg, {1e-6, 1e3}},
    {"coupling_n_per_m", "coupling spring k_T, N/m", &Parameters::coupling_n_per_m, {1e-3, 1e7}},
    {"coupling_ns_per_m",
     "coupling damper b_T, N s/m",
     &Parameters::coupling_ns_per_m,
     {1e-6, 1e5}},
    {"coupling_nm_per_rad",
     "coupling spring k_R, N m/rad",
     &Parameters::coupling_nm_per_rad,
     {1e-6, 1e5}},
    {"coupling_nms_per_rad",
     "coupling damper b_R, N m s/rad",
     &Parameters::coupling_nms_per_rad,
     {1e-9, 1e4}},
    {"coupling_force_limit_n",
     "limit of the coupling's force, N",
     &Parameters::coupling_force_limit_n,
     {1e-6, 1e4},
     true},
    {"coupling_torque_limit_nm",
     "limit of the coupling's torque, N m",
     &Parameters::coupling_torque_limit_nm,
     {1e-6, 1e3},
     true},
    {"field_n_per_m", "force field stiffness K_ff, N/m", &Parameters::field_n_per_m, {1e-3, 1e8}},
    {"contact_damping_ratio",
     "damping of a contact divided by K_ff sqrt(m / K), where K is the larger of K_ff and k_T",
     &Parameters::contact_damping_ratio,
     {1e-3, 100}},
    {"look_ups",
     "largest number of motions in a frame, each of up to half a voxel",
     &Parameters::look_ups,
     {1, 10'000}},
    {"recovery_mps",
     "speed at which a part that starts inside the scene is moved out, m/s",
     &Parameters::recovery_mps,
     {1e-6, 10}},
    {"allowance_j",
     "energy that a part may gain from the scene while the hand moves the part, J",
     &Parameters::allowance_j,
     {1e-12, 100}},
    {"allowance_fade_s",
     "time in which allowance_j fades while the hand rests, s",
     &Parameters::allowance_fade_s,
     {1e-6, 3600}},
    {"passivity_damping_ns_per_m",
     "largest damping that the passivity controller may add at the device, N s/m",
     &Parameters::passivity_damping_ns_per_m,
     {0, 1e5}},
    {"max_force_n", "largest force at the device, N", &Parameters::max_force_n, {1e-6, 1000}},
    {"max_torque_nm", "largest torque at the device, N m", &Parameters::max_torque_nm, {1e-6, 100}},
};

std::string format(const char* pattern, double a, double b = 0, double c = 0) {
  char text[256];
  std::snprintf(text, sizeof text, pattern, a, b, c);
  return text;
}

// Takes the user's setting where there is one, else the default with its reason.
class Choice {
 public:
  Choice(const RunRequest& request, DerivedParameters& derived)
      : request_(request), derived_(derived) {}

  void set(std::string_view name, double value, std::string_view reason) {
    const auto* info = std::find_if(std::begin(kTable), std::end(kTable),
                                    [&](const ParameterInfo& i) { return i.name == name; });
    const auto setting = request_.settings.find(std::string(name));
    const bool chosen = setting != request_.settings.end();
    derived_.values.*(info->member) = chosen ? setting->second : value;
    derived_.reasons[std::string(name)] = chosen ? "set" : reason;
  }

 private:
  const RunRequest& request_;
  DerivedParameters& derived_;
};

Status check_settings(const RunRequest& request) {
  for (const auto& [name, value] : request.settings) {
    const auto* info =
        std::find_if(std::begin(kTable), std::end(kTable),
                     [&, n = &name](const ParameterInfo& i) { return i.name == *n; });
    if (info == std::end(kTable)) {
      std::string names = "known parameters:";
      for (const ParameterInfo& known : kTable) (names += ' ') += known.name;
      return Error{ErrorCode::kUsage, "", name, "is not a parameter", names};
    }
    if (info->may_be_infinite && std::isinf(value) && value > 0) continue;
    if (Status s = check_range(name, value, info->range); !s) return s;
  }
  return {};
}

// The largest value that the device loop bears, and why.
struct Bound {
  double value = std::numeric_limits<double>::infinity();
  std::string source;

  void lower_to(double other, const char* why) {
    if (!(other < value)) return;
    value = other;
    source = why;
  }
};

constexpr const char* kRated = "the maker's rating";
constexpr const char* kDamped =
    "b / (delay + dt / 2), with the device's own damping b (Colgate and Schenkel)";
constexpr const char* kQuantised =
    "2 f / D, with the device's friction f and encoder step D (Abbott and Okamura)";
constexpr const char* kInertial =
    "M / (delay + dt / 2 + lag of the velocity estimate), with the device's apparent inertia M: a "
    "phase margin of 33 degrees";

// The hand feels a stiffness, damping or mass of the scene times this (placement.h): the square of
// the motion scale. Moments, torques and their stiffness have no scale.
double felt_fraction(const RunRequest& request) {
  return request.placement.motion_scale * request.placement.motion_scale;
}

// The bound of a stiffness in the scene.
Bound stiffness_bound(const RunRequest& request, double dt_s) {
  const DeviceCapabilities& device = request.device;
  Bound bound;
  if (device.max_stiffness_n_per_m > 0) bound.lower_to(device.max_stiffness_n_per_m, kRated);
  bound.lower_to(renderable_stiffness(device.damping_ns_per_m, device.delay_s, dt_s), kDamped);
  bound.lower_to(dissipated_stiffness(device.friction_n, device.encoder_step_m), kQuantised);
  bound.value /= felt_fraction(request);
  return bound;
}

// Turning has no scale, and no arm: the coupling's force acts at the grip.
Bound rotation_bound(const DeviceCapabilities& device, double dt_s) {
  Bound bound;
  if (device.max_stiffness_nm_per_rad > 0) bound.lower_to(device.max_stiffness_nm_per_rad, kRated);
  bound.lower_to(renderable_stiffness(device.damping_nms_per_rad, device.delay_s, dt_s), kDamped);
  bound.lower_to(dissipated_stiffness(device.friction_nm, device.encoder_step_rad), kQuantised);
  return bound;
}

// The bound of a damping at the device, whose handle has this mass or moment.
Bound damping_bound(const DeviceCapabilities& device, double inertia, double dt_s) {
  Bound bound;
  const double lag_s = device.senses_velocity ? 0 : loop::HandleVelocity::kTimeConstantS;
  bound.lower_to(renderable_damping(inertia, device.delay_s + lag_s, dt_s), kInertial);
  return bound;
}

// The bound of a damping in the scene.
Bound linear_damping_bound(const RunRequest& request, double dt_s) {
  Bound bound = damping_bound(request.device, request.device.apparent_mass_kg, dt_s);
  bound.value /= felt_fraction(request);
  return bound;
}

Bound rotation_damping_bound(const RunRequest& request, double dt_s) {
  return damping_bound(request.device, request.device.apparent_inertia_kgm2, dt_s);
}

// Warns where a setting is beyond its bound.
void warn_beyond(const Bound& bound, const char* name, double value, const char* unit,
                 const DeviceCapabilities& device, DerivedParameters& derived) {
  if (!(value > bound.value * (1 + 1e-9))) return;
  char text[256];
  std::snprintf(text, sizeof text, "%s %g %s is above the %g %s that ", name, value, unit,
                bound.value, unit);
  derived.warnings.push_back(text + device.name + " can render stably: " + bound.source);
}

void warn_of_coupling(const RunRequest& request, DerivedParameters& derived) {
  const DeviceCapabilities& device = request.device;
  const Parameters& p = derived.values;
  const double dt_s = 1 / p.rate_hz;
  warn_beyond(stiffness_bound(request, dt_s), "coupling_n_per_m", p.coupling_n_per_m, "N/m", device,
              derived);
  warn_beyond(rotation_bound(device, dt_s), "coupling_nm_per_rad", p.coupling_nm_per_rad, "N m/rad",
              device, derived);
  warn_beyond(linear_damping_bound(request, dt_s), "coupling_ns_per_m", p.coupling_ns_per_m,
              "N s/m", device, derived);
  warn_beyond(rotation_damping_bound(request, dt_s), "coupling_nms_per_rad", p.coupling_nms_per_rad,
              "N m s/rad", device, derived);
}

std::string borne_reason(const char* what, const DeviceCapabilities& device, const Bound& bound) {
  return format("%g of the ", kBoundFraction) + what + " that " + device.name +
         " can render: " + bound.source;
}

constexpr const char* kLinear = "stiffness, divided by the squared motion scale,";
constexpr const char* kLinearDamping = "damping, divided by the squared motion scale,";

// A damping that is critical, or what the device bears of it.
void choose_damping(Choice& choice, const char* name, double critical, const char* why,
                    const char* what, const DeviceCapabilities& device, const Bound& bound) {
  const double borne = kBoundFraction * bound.value;
  choice.set(name, std::min(critical, borne),
             borne < critical ? borne_reason(what, device, bound) : why);
}

// Apparent mass: what the hand feels is the scene's times the square of the motion scale.
void choose_mass(const RunRequest& request, Choice& choice) {
  choice.set("mass_kg", kApparentMassKg / felt_fraction(request),
             request.placement.motion_scale == 1
                 ? "apparent mass of the paper (5.1)"
                 : "apparent mass of the paper (5.1), divided by the squared motion scale");
}

// Device limits: the user's, never above the ratings.
void choose_limits(const RunRequest& request, DerivedParameters& derived) {
  const DeviceCapabilities& device = request.device;
  Choice choice(request, derived);
  Parameters& p = derived.values;
  choice.set("max_force_n", device.max_force_n, "rating of " + device.name);
  choice.set("max_torque_nm", device.max_torque_nm, "rating of " + device.name);
  if (p.max_force_n > device.max_force_n || p.max_torque_nm > device.max_torque_nm) {
    derived.warnings.push_back("max_force_n and max_torque_nm are limited to the ratings of " +
                               device.name +
                               format(": %g N, %g N m", device.max_force_n, device.max_torque_nm));
  }
  p.max_force_n = std::min(p.max_force_n, device.max_force_n);
  p.max_torque_nm = std::min(p.max_torque_nm, device.max_torque_nm);
}

// k_T, b_T, k_R, b_R of paper 5.1: high but comfortably stable, critically damped.
void choose_coupling(const RunRequest& request, DerivedParameters& derived) {
  const DeviceCapabilities& device = request.device;
  Choice choice(request, derived);
  Parameters& p = derived.values;
  const double dt_s = 1 / p.rate_hz, inertia_kgm2 = p.inertia_kgm2[0][0];
  const double comfortable = kComfortableLoad * kComfortableLoad * p.mass_kg / (dt_s * dt_s);
  const Bound bound = stiffness_bound(request, dt_s);
  const double borne = kBoundFraction * bound.value;
  choice.set("coupling_n_per_m", std::min(comfortable, borne),
             borne < comfortable
                 ? borne_reason(kLinear, device, bound)
                 : "m / (16 dt^2): stable at this rate with a wide margin (paper 5.1)");
  choice.set("coupling_ns_per_m", 2 * std::sqrt(p.mass_kg * p.coupling_n_per_m),
             "2 sqrt(m k_T): critically damped (paper 5.1)");
  const Bound bound_rot = rotation_bound(device, dt_s);
  const double borne_rot = kBoundFraction * bound_rot.value;
  const double same_frequency = p.coupling_n_per_m * inertia_kgm2 / p.mass_kg;
  choice.set("coupling_nm_per_rad", std::min(same_frequency, borne_rot),
             borne_rot < same_frequency ? borne_reason("stiffness", device, bound_rot)
                                        : "k_T I / m: rotation gets the frequency of translation");
  choice.set("coupling_nms_per_rad", 2 * std::sqrt(inertia_kgm2 * p.coupling_nm_per_rad),
             "2 sqrt(I k_R): critically damped (paper 5.1)");
  warn_of_coupling(request, derived);
}

// K_ff of paper 5.2: the largest value consistent with stable operation, for up to 10 forces at
// once, each turning the part with at most the shell's largest arm. With mobility
// mu = 1 + m r^2 / I, symplectic Euler is stable while
//   h^2 (k_T + 10 mu K_ff) / m + 2 h b_T / m < 4.
void choose_field(const RunRequest& request, double arm_m, DerivedParameters& derived) {
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
             "0.9 of the largest stable stiffness at 10 contacts (paper 5.2): "
             "(4 - h^2 k_T/m - 2 h b_T/m) / (10 h^2 (1/m + r^2/I))");
  if (room <= 0) {
    derived.warnings.push_back(
        "the coupling alone is unstable at this rate: h^2 k/m + 2 h b/m reaches 4 (symplectic "
        "Euler); lower coupling_n_per_m, or raise mass_kg or the rate");
  } else if (p.field_n_per_m > largest) {
    derived.warnings.push_back(
        format("field_n_per_m %g N/m is above the %g N/m", p.field_n_per_m, largest) +
        " that is stable for ten contacts at this rate (symplectic Euler)");
  }
}

void derive_paper(const RunRequest& request, const Pshell& shell, DerivedParameters& derived) {
  Choice choice(request, derived);
  Parameters& p = derived.values;
  choose_mass(request, choice);
  p.inertia_kgm2 = glm::dmat3(0.4 * p.mass_kg * p.part_radius_m * p.part_radius_m);
  choose_coupling(request, derived);
  choice.set("coupling_force_limit_n", p.coupling_n_per_m * p.voxel_size_m / 2,
             "k_T s/2, for the force of the spring alone (paper 5.2)");
  choice.set("coupling_torque_limit_nm", std::numeric_limits<double>::infinity(),
             "none (paper 5.2)");
  choose_field(request, largest_contact_arm_m(shell), derived);
}

// The shell's inertia for `mass_kg`, its principal moments kept within what a part of this radius
// on this grid can have: a sheet, a wire or a soup without volume may have almost none.
glm::dmat3 shell_inertia_kgm2(const PshellHeader& shell, double mass_kg, double radius_m,
                              double voxel_size_m) {
  const auto& i = shell.inertia_m2;  // xx yy zz xy xz yz
  model::PrincipalInertia inertia =
      model::principal_inertia(glm::dmat3(i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2]));
  const double largest_m2 = std::max({inertia.moments.x, inertia.moments.y, inertia.moments.z});
  const double min_m2 = std::max(kMinMomentFraction * largest_m2, voxel_size_m * voxel_size_m / 4);
  for (int axis = 0; axis < 3; ++axis) {
    inertia.moments[axis] =
        mass_kg * std::max(min_m2, std::min(inertia.moments[axis], radius_m * radius_m));
  }
  return model::tensor_of(inertia);
}

double mean_moment(const glm::dmat3& inertia) {
  return (inertia[0][0] + inertia[1][1] + inertia[2][2]) / 3;
}

void choose_default_coupling(const RunRequest& request, DerivedParameters& derived) {
  const DeviceCapabilities& device = request.device;
  Choice choice(request, derived);
  Parameters& p = derived.values;
  const double dt_s = 1 / p.rate_hz;
  const Bound bound = stiffness_bound(request, dt_s);
  const bool bounded = std::isfinite(bound.value);
  choice.set("coupling_n_per_m",
             bounded ? kBoundFraction * bound.value : kUnratedStiffness / felt_fraction(request),
             bounded ? borne_reason(kLinear, device, bound)
                     : device.name + " states no stiffness and no damping");
  choose_damping(choice, "coupling_ns_per_m", 2 * std::sqrt(p.mass_kg * p.coupling_n_per_m),
                 "2 sqrt(m k_T): critically damped (paper 5.1)", kLinearDamping, device,
                 linear_damping_bound(request, dt_s));
  const Bound bound_rot = rotation_bound(device, dt_s);
  const double borne_rot = kBoundFraction * bound_rot.value;
  const double same_frequency = p.coupling_n_per_m * mean_moment(p.inertia_kgm2) / p.mass_kg;
  choice.set("coupling_nm_per_rad", std::min(same_frequency, borne_rot),
             borne_rot < same_frequency
                 ? borne_reason("stiffness", device, bound_rot)
                 : "k_T I / m (I: mean moment of inertia): same frequency as in translation");
  const model::PrincipalInertia inertia = model::principal_inertia(p.inertia_kgm2);
  const double largest = std::max({inertia.moments.x, inertia.moments.y, inertia.moments.z});
  choose_damping(
      choice, "coupling_nms_per_rad", 2 * std::sqrt(largest * p.coupling_nm_per_rad),
      "2 sqrt(I k_R) (I: largest moment of inertia): at least critically damped about every axis",
      "damping", device, rotation_damping_bound(request, dt_s));
  // A device that renders none still moves and turns the part: the output stage keeps it at zero.
  const bool forces = p.max_force_n > 0, torques = p.max_torque_nm > 0;
  choice.set("coupling_force_limit_n",
             (forces ? p.max_force_n : kUnratedForceN) / request.placement.motion_scale,
             forces ? "max_force_n divided by the motion scale" : "the device renders no force");
  choice.set("coupling_torque_limit_nm", torques ? p.max_torque_nm : kUnratedTorqueNm,
             torques ? "max_torque_nm" : "the device renders no torque");
  warn_of_coupling(request, derived);
}

// Parameters of the default model alone; derived for both, so that a report shows all.
void choose_guard(const RunRequest& request, DerivedParameters& derived) {
  Choice choice(request, derived);
  Parameters& p = derived.values;
  choice.set("contact_damping_ratio", kContactDampingRatio,
             "damps a single contact point within two frames");
  // At 3 m/s a hand throws; a look-up costs much, so there are at most eight in a millisecond.
  const double dt_s = 1 / p.rate_hz, throw_mps = kThrowMps * request.placement.motion_scale;
  choice.set("look_ups",
             std::clamp(std::ceil(2 * throw_mps * dt_s / p.voxel_size_m), 2.0,
                        std::max(2.0, std::ceil(8000 * dt_s))),
             "enough motions to follow a hand at 3 m/s, but at most 8 in a millisecond");
  choice.set("recovery_mps", kRecoveryMps, "leaves the user time to let go of the handle");
  choice.set(
      "allowance_j", p.coupling_force_limit_n * p.voxel_size_m,
      "force limit times voxel size: more energy than the part needs to climb a step of one voxel");
  choice.set("allowance_fade_s", kAllowanceFadeS, "the part comes to rest within a second");
}

// The passivity controller, for both models. A damper that the hand feels late may itself be active
// beyond the device's own damping: b > |B| (Colgate and Schenkel 1994, with K = 0).
void choose_control(const RunRequest& request, DerivedParameters& derived) {
  const DeviceCapabilities& device = request.device;
  Choice choice(request, derived);
  choice.set("passivity_damping_ns_per_m", 0, "off unless set");
  if (!(device.damping_ns_per_m > 0)) return;
  Bound bound;
  bound.lower_to(device.damping_ns_per_m,
                 "b > |B|, with the device's own damping b (Colgate and Schenkel)");
  warn_beyond(bound, "passivity_damping_ns_per_m", derived.values.passivity_damping_ns_per_m,
              "N s/m", device, derived);
}

void derive_default(const RunRequest& request, const Voxmap& voxmap, const Pshell& shell,
                    DerivedParameters& derived) {
  Choice choice(request, derived);
  Parameters& p = derived.values;
  choose_mass(request, choice);
  // The moment goes with the mass that the hand feels: with the scene's, k_R, which goes with the
  // moment, would be as many times softer at large motion scales as k_T is at the device stiffer
  // than in the scene.
  const double felt_kg = p.mass_kg * felt_fraction(request);
  p.inertia_kgm2 = shell_inertia_kgm2(shell.header(), felt_kg, p.part_radius_m, p.voxel_size_m);
  choose_default_coupling(request, derived);
  const double covering = steepest_pa_per_m(voxmap) * field::mean_point_area_m2(shell);
  if (covering > 0) {
    choice.set("field_n_per_m", covering,
               "the steepest slope of the scene's compliance times the mean area of a point");
    return;
  }
  const double rigid = model::rigid_stiffness_n_per_m(p);
  choice.set(
      "field_n_per_m", rigid,
      rigid > model::kRigidOverCoupling * p.coupling_n_per_m
          ? "one point at a depth of 0.15 voxel pushes with the coupling's force limit"
          : "150 k_T: behind the coupling, one contact point feels within 0.7% as stiff as many");
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

std::optional<std::string> arm_warning(const RunRequest& request, const Parameters& parameters,
                                       double arm_m) {
  if (parameters.model != Model::kPaper) return std::nullopt;
  const Bound bound = rotation_bound(request.device, 1 / parameters.rate_hz);
  const double felt = parameters.coupling_nm_per_rad + parameters.coupling_n_per_m * arm_m * arm_m;
  if (!(felt > bound.value)) return std::nullopt;
  return format(
             "the paper's coupling acts at the part's centroid, %.3g m from the handle. When the "
             "handle turns, the hand feels %.3g N m/rad, more than the %.3g N m/rad that ",
             arm_m, felt, bound.value) +
         request.device.name + " can render stably: " + bound.source +
         "; hold the part nearer to its centroid (--grip), or use --model default";
}

Result<DerivedParameters> derive_parameters(const RunRequest& request, const Voxmap& voxmap,
                                            const Pshell& shell) {
  if (Status valid = check_settings(request); !valid) return valid.error();
  DerivedParameters derived;
  Parameters& p = derived.values;
  p.model = request.model;
  p.force = request.force.value_or(field::usual_force(request.model, voxmap));
  p.braking = request.braking;
  p.rate_hz = request.rate_hz;
  p.voxel_size_m = voxmap.voxel_size_m();
  // A part of one point has no radius; half a voxel keeps its inertia above zero.
  p.part_radius_m = std::max(shell.header().bounding_radius_m, p.voxel_size_m / 2);
  choose_limits(request, derived);
  switch (request.model) {
    case Model::kPaper:
      derive_paper(request, shell, derived);
      if (!voxmap.compliance().empty()) {
        derived.warnings.push_back(
            "the paper's model ignores the scene's compliance: the stiffness is field_n_per_m at "
            "every depth");
      }
      break;
    case Model::kDefault:
      derive_default(request, voxmap, shell, derived);
      break;
  }
  choose_guard(request, derived);
  choose_control(request, derived);
  return derived;
}

}  // namespace forcelayer
