// Defaults and bounds of the parameters.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "runtime/field/force_field.h"
#include "runtime/run/derive_parameters.h"
#include "runtime/run/stability.h"
#include "tests/support/distance_scene.h"
#include "tests/support/point_part.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

DeviceCapabilities strong_device() {
  DeviceCapabilities device;
  device.name = "test device";
  device.max_force_n = 20;
  device.max_torque_nm = 1;
  return device;
}

class ParametersTest : public testing::Test {
 protected:
  DerivedParameters derive(RunRequest request, const DeviceCapabilities& device = strong_device()) {
    request.device = device;
    auto derived = derive_parameters(request, voxmap_, shell_);
    EXPECT_TRUE(derived);
    return *derived;
  }

  Voxmap voxmap_ = make_voxmap(
      offset_scene(0.005, {0, 0, 0}, {16, 16, 16}, 2, [](Voxel v) { return v[2] == 4; }));
  Pshell shell_ = make_pshell(sphere_part(0.03, 400, 0.005));
};

// |x| after 20000 frames, or where it passes 1e6.
double simulate_oscillator(double stiffness, double damping, double h) {
  double x = 1, v = 0;
  for (int i = 0; i < 20000 && std::abs(x) < 1e6; ++i) {
    v += h * (-stiffness * x - damping * v);
    x += h * v;
  }
  return std::abs(x);
}

TEST(Stability, LoadOfOneIsTheEdge) {
  for (const double damping : {0.0, 100.0, 800.0}) {
    const double h = 0.001;
    const double edge = (4 - 2 * h * damping) / (h * h);
    EXPECT_NEAR(symplectic_euler_load(edge, damping, h), 1, 1e-12);
    EXPECT_LE(simulate_oscillator(0.99 * edge, damping, h), 20);
    EXPECT_GE(simulate_oscillator(1.01 * edge, damping, h), 1e6);
  }
}

TEST_F(ParametersTest, FollowThePaper) {
  RunRequest request;
  request.model = Model::kPaper;
  const Parameters p = derive(request).values;
  EXPECT_DOUBLE_EQ(p.mass_kg, 0.012);
  const double radius_m = shell_.header().bounding_radius_m;
  EXPECT_DOUBLE_EQ(p.inertia_kgm2[1][1], 0.4 * 0.012 * radius_m * radius_m);
  EXPECT_EQ(p.inertia_kgm2[0][1], 0);
  EXPECT_DOUBLE_EQ(p.coupling_ns_per_m, 2 * std::sqrt(p.mass_kg * p.coupling_n_per_m));
  EXPECT_DOUBLE_EQ(p.coupling_nms_per_rad,
                   2 * std::sqrt(p.inertia_kgm2[0][0] * p.coupling_nm_per_rad));
  EXPECT_DOUBLE_EQ(p.coupling_force_limit_n, p.coupling_n_per_m * 0.0025);
  EXPECT_TRUE(std::isinf(p.coupling_torque_limit_nm));
  // One force at half a voxel must be able to hold the spring at its clamp (paper 5.2).
  EXPECT_GE(p.field_n_per_m, p.coupling_n_per_m);
}

TEST_F(ParametersTest, OfThePaperAreStableAtEveryRateAndMass) {
  for (const double rate_hz : {100.0, 1000.0, 10000.0}) {
    for (const double mass_kg : {0.001, 0.012, 1.0, 100.0}) {
      RunRequest request;
      request.model = Model::kPaper;
      request.rate_hz = rate_hz;
      request.settings["mass_kg"] = mass_kg;
      const DerivedParameters derived = derive(request);
      const Parameters& p = derived.values;
      const double arm_m = largest_contact_arm_m(shell_);
      const double mobility = 1 + mass_kg * arm_m * arm_m / p.inertia_kgm2[0][0];
      const double load =
          symplectic_euler_load((p.coupling_n_per_m + 10 * mobility * p.field_n_per_m) / mass_kg,
                                p.coupling_ns_per_m / mass_kg, 1 / rate_hz);
      EXPECT_LT(load, 1) << rate_hz << " Hz, " << mass_kg << " kg";
      EXPECT_GT(load, 0.5) << rate_hz << " Hz, " << mass_kg << " kg";
      EXPECT_TRUE(derived.warnings.empty());
    }
  }
}

// An empty request gets the default model, and the best field that the map can give.
TEST_F(ParametersTest, ModelAndFieldFollowFromTheMap) {
  EXPECT_EQ(derive({}).values.model, Model::kDefault);
  EXPECT_EQ(derive({}).values.force, field::usual_force(Model::kDefault, voxmap_));
  RunRequest request;
  request.model = Model::kPaper;
  EXPECT_EQ(derive(request).values.force, ForceKind::kTangentPlane);
  voxmap_ = make_voxmap(distance_scene(
      0.005, {0, 0, 0}, {16, 16, 16}, [](const glm::dvec3& p) { return p.z; }, 2,
      DistanceDefinition(2)));
  EXPECT_EQ(derive({}).values.force, ForceKind::kDistance);
  EXPECT_EQ(derive(request).values.force, ForceKind::kTangentPlane);
  request.model = Model::kDefault;
  request.force = ForceKind::kTangentPlane;
  EXPECT_EQ(derive(request).values.force, ForceKind::kTangentPlane);
}

TEST_F(ParametersTest, StayWithinWhatTheDeviceBears) {
  DeviceCapabilities device = strong_device();
  device.damping_ns_per_m = 0.6;
  device.delay_s = 0.001;
  RunRequest request;
  // Inside the bound, not on it.
  EXPECT_DOUBLE_EQ(derive(request, device).values.coupling_n_per_m, 0.9 * 0.6 / 0.0015);
  request.placement.motion_scale = 2;  // the hand feels four times the stiffness
  EXPECT_DOUBLE_EQ(derive(request, device).values.coupling_n_per_m, 0.9 * 0.15 / 0.0015);
  request.settings["coupling_n_per_m"] = 110;
  EXPECT_EQ(derive(request, device).warnings.size(), 1u);
}

// With any scale the hand feels the same: stiffness, damping and mass of the scene times its
// square, force times itself, and turning as it is.
TEST_F(ParametersTest, FeelTheSameAtEveryScale) {
  DeviceCapabilities device = strong_device();
  device.damping_ns_per_m = 2, device.damping_nms_per_rad = 0.005;
  device.apparent_mass_kg = 0.03, device.apparent_inertia_kgm2 = 2e-5;
  for (const Model model : {Model::kPaper, Model::kDefault}) {
    RunRequest request;
    request.model = model;
    const Parameters one = derive(request, device).values;
    for (const double c : {0.1, 0.5, 3.0, 10.0}) {
      SCOPED_TRACE(testing::Message() << to_text(model) << ", scale " << c);
      request.placement.motion_scale = c;
      const DerivedParameters derived = derive(request, device);
      const Parameters& p = derived.values;
      const auto expect_felt = [](double felt, double as_one) {
        EXPECT_NEAR(felt, as_one, 1e-12 * as_one);
      };
      expect_felt(p.mass_kg * c * c, one.mass_kg);
      expect_felt(p.coupling_n_per_m * c * c, one.coupling_n_per_m);
      expect_felt(p.coupling_ns_per_m * c * c, one.coupling_ns_per_m);
      if (model == Model::kPaper) continue;  // whose clamp is k_T s/2
      expect_felt(p.coupling_force_limit_n * c, one.coupling_force_limit_n);
      expect_felt(p.coupling_torque_limit_nm, one.coupling_torque_limit_nm);
      expect_felt(p.coupling_nm_per_rad, one.coupling_nm_per_rad);
      expect_felt(p.coupling_nms_per_rad, one.coupling_nms_per_rad);
      EXPECT_EQ(p.max_force_n, one.max_force_n);
      EXPECT_TRUE(derived.warnings.empty()) << derived.warnings[0];
    }
  }
}

// The paper's coupling acts at the centroid: a handle at an arm turns against k_R + k_T L^2. The
// default model's does not.
TEST_F(ParametersTest, WarnOfAnArmThatThePapersCouplingIsTooStiffFor) {
  DeviceCapabilities device = strong_device();
  device.damping_ns_per_m = 2, device.damping_nms_per_rad = 0.005;  // 10 N m/rad
  for (const Model model : {Model::kPaper, Model::kDefault}) {
    RunRequest request;
    request.model = model;
    request.device = device;
    Parameters p = derive(request, device).values;
    p.coupling_n_per_m = 1000, p.coupling_nm_per_rad = 1;
    EXPECT_FALSE(arm_warning(request, p, 0.0948));  // 9.99 N m/rad
    const auto warning = arm_warning(request, p, 0.095);
    ASSERT_EQ(warning.has_value(), model == Model::kPaper);
    if (!warning) continue;
    EXPECT_NE(warning->find("more than the 10 N m/rad that test device"), std::string::npos)
        << *warning;
    EXPECT_NE(warning->find("0.095 m"), std::string::npos) << *warning;
  }
}

// However heavy the part, what the damper asks of the handle stays within what it can render; a
// setting beyond draws a warning with the bound.
TEST_F(ParametersTest, DampingStaysWithinWhatTheHandleBears) {
  DeviceCapabilities device = strong_device();
  device.damping_ns_per_m = 2, device.damping_nms_per_rad = 0.005;
  device.apparent_mass_kg = 0.2, device.apparent_inertia_kgm2 = 2e-4;
  device.delay_s = 0.001;
  for (const double mass_kg : {0.001, 0.012, 1.0, 100.0}) {
    RunRequest request;
    request.settings["mass_kg"] = mass_kg;
    const DerivedParameters derived = derive(request, device);
    EXPECT_TRUE(derived.warnings.empty()) << derived.warnings[0];
    EXPECT_LE(derived.values.coupling_ns_per_m, 0.9 * 0.2 / 0.0065 * (1 + 1e-12)) << mass_kg;
    EXPECT_LE(derived.values.coupling_nms_per_rad, 0.9 * 2e-4 / 0.0065 * (1 + 1e-12)) << mass_kg;
  }
}

// Each bound of the device loop draws a warning of its own, with the number and where it is from.
TEST_F(ParametersTest, WarnOfEveryBoundOfTheDeviceLoop) {
  DeviceCapabilities device = strong_device();
  device.damping_ns_per_m = 2;                               // 4000 N/m without delay
  device.friction_n = 0.025, device.encoder_step_m = 25e-6;  // 2000 N/m
  device.damping_nms_per_rad = 0.005;                        // 10 N m/rad
  device.apparent_mass_kg = 0.2;                             // 0.2 kg / (5.5 ms) = 36.4 N s/m
  const struct {
    const char* name;
    double below, above;
    const char* says;
  } cases[] = {{"coupling_n_per_m", 1999, 2001, "above the 2000 N/m"},
               {"coupling_nm_per_rad", 9.9, 10.1, "above the 10 N m/rad"},
               {"coupling_ns_per_m", 36, 37, "above the 36.3636 N s/m"},
               {"passivity_damping_ns_per_m", 1.9, 2.1, "above the 2 N s/m"}};
  for (const auto& c : cases) {
    RunRequest request;
    request.model = Model::kDefault;
    request.settings[c.name] = c.below;
    EXPECT_TRUE(derive(request, device).warnings.empty()) << c.name;
    request.settings[c.name] = c.above;
    const auto warnings = derive(request, device).warnings;
    ASSERT_EQ(warnings.size(), 1u) << c.name;
    EXPECT_NE(warnings[0].find(c.says), std::string::npos) << warnings[0];
  }
}

// One contact point, however small the voxels: much stiffer than the coupling, so that the hand
// feels the coupling alone, and the force limit is reached before the guard stops the part.
TEST_F(ParametersTest, OneContactPointHoldsTheHand) {
  for (const double voxel_m : {0.02, 0.005, 0.001, 0.0002}) {
    voxmap_ = make_voxmap(
        offset_scene(voxel_m, {0, 0, 0}, {16, 16, 16}, 2, [](Voxel v) { return v[2] == 4; }));
    for (const double scale : {0.1, 1.0, 10.0}) {
      RunRequest request;
      request.placement.motion_scale = scale;
      const Parameters p = derive(request).values;
      EXPECT_GE(p.field_n_per_m, 149.999 * p.coupling_n_per_m) << voxel_m << " " << scale;
      EXPECT_GE(p.field_n_per_m * 0.1501 * voxel_m, p.coupling_force_limit_n)
          << voxel_m << " " << scale;
    }
  }
}

// The steepest slope of a soft covering is the field's stiffness, unless the user scales it; the
// paper's model says that it leaves the covering out.
TEST_F(ParametersTest, FollowASoftCovering) {
  const DistanceDefinition definition(2);
  VoxelScene scene = distance_scene(
      0.005, {0, 0, 0}, {16, 16, 16}, [](const glm::dvec3& p) { return p.z; }, 2, definition);
  scene.distances.compliance = {0, 0.25f, 2, 2.5f};
  voxmap_ = make_voxmap(scene);
  RunRequest request;
  request.model = Model::kDefault;
  request.force = ForceKind::kDistance;
  const DerivedParameters derived = derive(request);
  EXPECT_DOUBLE_EQ(derived.values.field_n_per_m,
                   1.75 / (0.005 * definition.quantum) * field::mean_point_area_m2(shell_));
  EXPECT_NE(derived.reasons.at("field_n_per_m").find("the scene's compliance"), std::string::npos);
  request.settings["field_n_per_m"] = 5000;
  EXPECT_EQ(derive(request).values.field_n_per_m, 5000);
  request = {};
  request.model = Model::kPaper;
  const auto warnings = derive(request).warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("ignores the scene's compliance"), std::string::npos) << warnings[0];
}

TEST_F(ParametersTest, TakeSettingsAndWarnBeyondABound) {
  RunRequest request;
  request.model = Model::kPaper;  // whose field stiffness has a bound
  request.settings["field_n_per_m"] = 1e6;
  request.settings["max_force_n"] = 500;
  const DerivedParameters derived = derive(request);
  EXPECT_EQ(derived.values.field_n_per_m, 1e6);
  EXPECT_EQ(derived.reasons.at("field_n_per_m"), "set");
  EXPECT_EQ(derived.values.max_force_n, 20);  // never above the rating
  EXPECT_EQ(derived.warnings.size(), 2u);
  for (const double wrong : {-1.0, 0.0, kInfinity, std::nan("")}) {
    request.settings["mass_kg"] = wrong;
    const auto refused = derive_parameters(request, voxmap_, shell_);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
  }
  request.settings.erase("mass_kg");
  request.settings["coupling_force_limit_n"] = kInfinity;
  request.settings["passivity_damping_ns_per_m"] = 0;
  EXPECT_EQ(derive(request).values.coupling_force_limit_n, kInfinity);
}

// The part turns with the wrist all the same; what the hand feels is the output stage's affair.
TEST_F(ParametersTest, ADeviceWithoutMotorsStillMovesAndTurnsThePart) {
  DeviceCapabilities device = strong_device();
  device.max_torque_nm = 0;
  RunRequest request;
  request.model = Model::kDefault;
  Parameters p = derive(request, device).values;
  EXPECT_EQ(p.max_torque_nm, 0);
  EXPECT_GT(p.coupling_torque_limit_nm, 0.01);
  EXPECT_GT(p.coupling_nm_per_rad, 0);
  EXPECT_EQ(p.coupling_force_limit_n, device.max_force_n);
  device.max_force_n = 0;
  p = derive(request, device).values;
  EXPECT_EQ(p.max_force_n, 0);
  EXPECT_GT(p.coupling_force_limit_n, 1);
  EXPECT_GT(p.coupling_n_per_m, 0);
}

TEST_F(ParametersTest, EveryParameterHasAReason) {
  for (const Model model : {Model::kPaper, Model::kDefault}) {
    RunRequest request;
    request.model = model;
    const DerivedParameters derived = derive(request);
    for (const ParameterInfo& info : parameter_table()) {
      EXPECT_TRUE(derived.reasons.contains(std::string(info.name))) << info.name;
      const bool may_be_off = info.name == "passivity_damping_ns_per_m";
      EXPECT_TRUE(derived.values.*(info.member) > 0 || may_be_off) << info.name;
    }
  }
}

}  // namespace
}  // namespace forcelayer::test
