// The physical parameters of a step. Each is derived from the voxel size, the part, the rate and
// the device unless RunRequest::settings has it; Run::reasons() says by which rule.
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <optional>
#include <span>
#include <string_view>

#include "forcelayer/ranges.h"

namespace forcelayer {

// Which dynamic model moves the part. The numbers stand in recordings.
enum class Model : std::uint32_t {
  kPaper = 0,    // the method of 1999 to the letter: the yardstick, without a guard
  kDefault = 1,  // implicit, guarded, at rest when the hand rests
};

// Which field gives a point's depth and direction. The numbers stand in recordings.
enum class ForceKind : std::uint32_t {
  kTangentPlane = 0,  // the paper's (3); for every map, and the only one of the paper's model
  kLevel = 1,         // the two-bit values as a continuous field
  kDistance = 2,      // stored distances, interpolated; for maps that have them
};

inline constexpr Model kDefaultModel = Model::kDefault;

// Their names on command lines and in reports; none where there is no such thing.
std::string_view to_text(Model model);
std::string_view to_text(ForceKind force);
std::optional<Model> parse_model(std::string_view name);
std::optional<ForceKind> parse_force(std::string_view name);
bool is_known_model(std::uint32_t number);
bool is_known_force(std::uint32_t number);

// Those of an open run are complete and consistent: Run::parameters().
struct Parameters {
  Model model = kDefaultModel;
  ForceKind force = ForceKind::kTangentPlane;
  bool braking = true;  // pre-contact braking (paper 5.3)

  double rate_hz = 1000;      // 1 / dt
  double voxel_size_m = 0;    // s, of the map
  double part_radius_m = 0;   // R: of all shell points about the centroid
  double mass_kg = 0;         // apparent mass (paper 5.1: 12 g), in the scene
  glm::dmat3 inertia_kgm2{};  // apparent, part's axes: about the grip (paper: about the centroid,
                              // 2/5 m R^2, isotropic)

  double coupling_n_per_m = 0;        // k_T
  double coupling_ns_per_m = 0;       // b_T
  double coupling_nm_per_rad = 0;     // k_R
  double coupling_nms_per_rad = 0;    // b_R; default model: about the axis of the largest moment
  double coupling_force_limit_n = 0;  // clamp of the coupling's force (paper: spring only, k_T s/2)
  double coupling_torque_limit_nm = 0;  // clamp of its torque (paper: infinite)
  double field_n_per_m = 0;             // K_ff, of one contact point (default: of mean area)

  // The default model alone.
  // Damping of a contact over K_ff sqrt(m / K), with the larger of K_ff and k_T as K.
  double contact_damping_ratio = 0;
  double look_ups = 0;      // most motions in a frame, of at most s/2 each
  double recovery_mps = 0;  // at which a part that started inside is led out
  double allowance_j = 0;   // energy that a part may gain from the scene while the hand moves it
  double allowance_fade_s = 0;  // time constant with which that fades while the hand rests

  double passivity_damping_ns_per_m = 0;  // most that the passivity controller injects; 0: none

  double max_force_n = 0;    // of the wrench at the device
  double max_torque_nm = 0;  // of the wrench at the device
};

// One parameter that a user may set.
struct ParameterInfo {
  std::string_view name;  // of --set and in reports and recordings; its last part is the unit
  const char* what;       // its meaning, for --help
  double Parameters::*member;
  Range range;                   // of a setting
  bool may_be_infinite = false;  // a clamp: none
};

// All of them, in the order in which reports show them.
std::span<const ParameterInfo> parameter_table();

}  // namespace forcelayer
