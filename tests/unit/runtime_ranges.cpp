// Numbers of a run that no device, part or scene has: each is refused by its name, with its range.
// The expected ranges are written out a second time here.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "forcelayer/forcelayer.h"
#include "forcelayer/run.h"
#include "tests/support/address_limit.h"
#include "tests/support/point_part.h"
#include "tests/support/random_scenes.h"
#include "tests/support/sanitized.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const double kNan = std::nan("");

// A value, and its text in the error.
struct Wrong {
  double value;
  const char* text;
};

struct Ranges : testing::Test {
  static VoxelScene slab() {
    return closed(
        offset_scene(0.005, {0, 0, -2}, {24, 24, 8}, 2, [](Voxel v) { return v[2] <= 0; }));
  }
  static PointPart ball() { return sphere_part(0.02, 200, 0.005); }
};

// A number, its range as the error says it, and values on both sides.
struct Number {
  const char* name;
  const char* range;
  std::vector<Wrong> wrong;  // beside NaN and the infinities
  std::vector<double> right;
  std::function<void(RunRequest&, double)> put;
};

std::function<void(RunRequest&, double)> rating(double DeviceCapabilities::*member) {
  return [member](RunRequest& request, double value) { request.device.*member = value; };
}
std::function<void(RunRequest&, double)> setting(const char* name) {
  return [name](RunRequest& request, double value) { request.settings[name] = value; };
}

std::vector<Number> numbers() {
  using D = DeviceCapabilities;
  const std::vector<Wrong> negative = {{-1, "-1"}, {1e9, "1e+09"}, {1e300, "1e+300"}};
  std::vector<Number> all = {
      {"rate_hz",
       "1 to 100000",
       {{0.001, "0.001"}, {0, "0"}, {1e9, "1e+09"}},
       {1, 1000, 1e5},
       [](RunRequest& r, double v) { r.rate_hz = v; }},
      {"motion_scale",
       "1e-06 to 1e+06",
       {{1e-9, "1e-09"}, {-1, "-1"}, {1e300, "1e+300"}},
       {0.1, 1, 10},
       [](RunRequest& r, double v) { r.placement.motion_scale = v; }},
      {"stale_s",
       "1e-06 to 10000",
       {{0, "0"}, {-1, "-1"}, {1e5, "100000"}},
       {0.005, 1000},
       [](RunRequest& r, double v) { r.stale_s = v; }},
      {"max_speed_mps",
       "0.001 to 10",
       {{0, "0"}, {10.5, "10.5"}},
       {0.001, 10},
       [](RunRequest& r, double v) { r.max_speed_mps = v, r.max_turn_radps = 1; }},
      {"max_turn_radps",
       "0.001 to 100",
       {{0, "0"}, {101, "101"}},
       {0.001, 100},
       [](RunRequest& r, double v) { r.max_turn_radps = v; }},
      {"max_force_n",
       "0 to 1000",
       {{-1, "-1"}, {1e5, "100000"}},
       {0, 15, 1000},
       rating(&D::max_force_n)},
      {"max_torque_nm",
       "0 to 100",
       {{-1, "-1"}, {1e5, "100000"}},
       {0, 0.1, 100},
       rating(&D::max_torque_nm)},
      {"max_stiffness_n_per_m",
       "0 to 1e+07",
       negative,
       {0, 3000},
       rating(&D::max_stiffness_n_per_m)},
      {"max_stiffness_nm_per_rad",
       "0 to 100000",
       negative,
       {0, 10},
       rating(&D::max_stiffness_nm_per_rad)},
      {"damping_ns_per_m", "0 to 100000", negative, {0, 2}, rating(&D::damping_ns_per_m)},
      {"damping_nms_per_rad", "0 to 10000", negative, {0, 0.005}, rating(&D::damping_nms_per_rad)},
      {"friction_n", "0 to 1000", negative, {0, 0.1}, rating(&D::friction_n)},
      {"friction_nm", "0 to 100", negative, {0, 0.001}, rating(&D::friction_nm)},
      {"encoder_step_m", "0 to 1", negative, {0, 1e-5}, rating(&D::encoder_step_m)},
      {"encoder_step_rad", "0 to 10", negative, {0, 1e-4}, rating(&D::encoder_step_rad)},
      {"apparent_mass_kg", "0 to 1000", negative, {0, 0.1}, rating(&D::apparent_mass_kg)},
      {"apparent_inertia_kgm2",
       "0 to 1000",
       negative,
       {0, 1e-4},
       rating(&D::apparent_inertia_kgm2)},
      {"delay_s",
       "0 to 1",
       {{-1, "-1"}, {-0.00049, "-0.00049"}, {2, "2"}},
       {0, 0.001},
       rating(&D::delay_s)},
      {"workspace_radius_m", "0 to 1000", negative, {0, 0.1}, rating(&D::workspace_radius_m)},
      {"rate_hz", "0 to 100000", negative, {0, 1000}, rating(&D::rate_hz)},
      {"watchdog_s", "0 to 1", negative, {0, 0.02}, rating(&D::watchdog_s)},
      {"mass_kg",
       "1e-06 to 1000",
       {{0, "0"}, {-1, "-1"}, {1e6, "1e+06"}},
       {0.012},
       setting("mass_kg")},
      {"coupling_n_per_m",
       "0.001 to 1e+07",
       {{1e-30, "1e-30"}, {1e8, "1e+08"}},
       {1000},
       setting("coupling_n_per_m")},
      {"look_ups", "1 to 10000", {{0.5, "0.5"}, {1e5, "100000"}}, {4}, setting("look_ups")},
      {"passivity_damping_ns_per_m",
       "0 to 100000",
       {{-1, "-1"}},
       {0, 1},
       setting("passivity_damping_ns_per_m")},
      {"max_force_n", "1e-06 to 1000", {{0, "0"}, {1e6, "1e+06"}}, {5}, setting("max_force_n")}};
  for (Number& number : all) {
    number.wrong.push_back({kNan, "nan"});
    number.wrong.push_back({kInfinity, "inf"});
    number.wrong.push_back({-kInfinity, "-inf"});
  }
  return all;
}

TEST_F(Ranges, EveryNumberOfARequestIsRefusedByNameWithItsRange) {
  const auto open = [](const RunRequest& request) {
    return open_run(make_voxmap(slab()), make_pshell(ball()), request);
  };
  for (const Number& number : numbers()) {
    for (const Wrong& wrong : number.wrong) {
      SCOPED_TRACE(std::string(number.name) + " " + wrong.text);
      RunRequest request;
      number.put(request, wrong.value);
      const auto run = open(request);
      ASSERT_FALSE(run);
      EXPECT_EQ(run.error().code, ErrorCode::kUsage);
      EXPECT_EQ(run.error().where, number.name);
      EXPECT_EQ(run.error().what,
                std::string(wrong.text) + " is outside the range " + number.range);
    }
    for (const double right : number.right) {
      RunRequest request;
      number.put(request, right);
      EXPECT_TRUE(open(request)) << number.name << " " << right;
    }
  }
}

TEST_F(Ranges, ThreadsAreBoundedAndPlacesAreNear) {
  RunRequest request;
  for (const unsigned threads : {0u, 257u, 100000u}) {
    request.threads = threads;
    const auto run = open_run(make_voxmap(slab()), make_pshell(ball()), request);
    ASSERT_FALSE(run) << threads;
    EXPECT_EQ(to_line(run.error()),
              "threads: " + std::to_string(threads) + " is outside the range 1 to 256");
  }
  request = {};
  for (const double far_m : {1e300, 2e9, -2e9, kNan, kInfinity}) {
    request.placement.world_from_device.position_m = {far_m, 0, 0};
    const auto run = open_run(make_voxmap(slab()), make_pshell(ball()), request);
    ASSERT_FALSE(run) << far_m;
    EXPECT_EQ(run.error().where, "world_from_device");
  }
}

// As many threads as are allowed, in a process that has no room for them: an error, and no thread
// is left behind (each would have ended the process).
TEST_F(Ranges, ThreadsThatCannotBeStartedAreAnError) {
  if (kSanitized) return;  // it holds terabytes of addresses: no limit holds there
  Voxmap voxmap = make_voxmap(slab());
  Pshell shell = make_pshell(ball());
  RunRequest request;
  request.threads = 256;  // of 8 MiB of stack each
  const AddressLimit limit(std::uint64_t{256} << 20);
  const auto run = open_run(std::move(voxmap), std::move(shell), request);
  ASSERT_FALSE(run);
  EXPECT_EQ(run.error().code, ErrorCode::kOutOfMemory);
  EXPECT_EQ(to_line(run.error()).find("threads: 256 cannot be started: "), 0u)
      << to_line(run.error());
}

// The parameters of a recording that a program hands over, and a setting of no parameter.
TEST_F(Ranges, RecordedParametersAndNamesAreChecked) {
  RunRequest request;
  const auto sound = open_run(make_voxmap(slab()), make_pshell(ball()), request);
  ASSERT_TRUE(sound);
  request.recorded = sound->parameters();
  ASSERT_TRUE(open_run(make_voxmap(slab()), make_pshell(ball()), request));
  request.recorded->max_force_n = 1e300;
  const auto strong = open_run(make_voxmap(slab()), make_pshell(ball()), request);
  ASSERT_FALSE(strong);
  EXPECT_EQ(to_line(strong.error()), "max_force_n: 1e+300 is outside the range 0 to 1000");
  request = {};
  request.settings["nope"] = 1;
  const auto unknown = open_run(make_voxmap(slab()), make_pshell(ball()), request);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kUsage);
  EXPECT_EQ(unknown.error().where, "nope");
  for (const ParameterInfo& info : parameter_table()) {
    EXPECT_NE(unknown.error().mend.find(info.name), std::string::npos) << info.name;
  }
}

// A limit that may be infinite limits nothing.
TEST_F(Ranges, ACouplingMayBeWithoutAClamp) {
  for (const char* name : {"coupling_force_limit_n", "coupling_torque_limit_nm"}) {
    RunRequest request;
    request.settings[name] = kInfinity;
    EXPECT_TRUE(open_run(make_voxmap(slab()), make_pshell(ball()), request)) << name;
    for (const double wrong : {-kInfinity, kNan, 0.0, 1e5}) {
      request.settings[name] = wrong;
      EXPECT_FALSE(open_run(make_voxmap(slab()), make_pshell(ball()), request)) << name << wrong;
    }
  }
}

// Every number that the C header has.
TEST_F(Ranges, EveryOptionOfTheCInterfaceIsChecked) {
  const ScratchFolder folder;
  save_voxmap(folder / "slab.vox", slab());
  save_pshell(folder / "ball.pshell", ball());
  using O = forcelayer_options;
  const struct {
    const char* name;
    double O::*member;
    std::vector<double> wrong;
  } cases[] = {{"rate_hz", &O::rate_hz, {1e9, 0.001, 0, -1}},
               {"max_force_n", &O::max_force_n, {-1, 1e5}},
               {"max_torque_nm", &O::max_torque_nm, {-1, 1e5}},
               {"max_stiffness_n_per_m", &O::max_stiffness_n_per_m, {-1, 1e9}},
               {"max_stiffness_nm_per_rad", &O::max_stiffness_nm_per_rad, {-1, 1e9}},
               {"damping_ns_per_m", &O::damping_ns_per_m, {-1, 1e9}},
               {"damping_nms_per_rad", &O::damping_nms_per_rad, {-1, 1e9}},
               {"delay_s", &O::delay_s, {-1, -0.00049, 2}},
               {"workspace_radius_m", &O::workspace_radius_m, {-1, 1e9}},
               {"motion_scale", &O::motion_scale, {0, 1e-9, 1e300}},
               {"stale_s", &O::stale_s, {0, -1, 1e9}},
               {"max_speed_mps", &O::max_speed_mps, {0, -1, 11}},
               {"max_turn_radps", &O::max_turn_radps, {0, -1, 101}}};
  const auto refusal = [&](const O& options) -> std::string {
    char error[256] = "";
    forcelayer_runtime* const runtime =
        forcelayer_open((folder / "slab.vox").c_str(), (folder / "ball.pshell").c_str(), &options,
                        error, sizeof error);
    EXPECT_EQ(runtime == nullptr, error[0] != 0);
    forcelayer_close(runtime);
    return error;
  };
  O options;
  forcelayer_default_options(&options);
  EXPECT_EQ(refusal(options), "");
  for (const auto& c : cases) {
    for (const double wrong : {kNan, kInfinity, -kInfinity}) {
      forcelayer_default_options(&options);
      options.*c.member = wrong;
      EXPECT_EQ(refusal(options).find(std::string(c.name) + ": "), 0u) << c.name << wrong;
    }
    for (const double wrong : c.wrong) {
      forcelayer_default_options(&options);
      options.*c.member = wrong;
      const std::string said = refusal(options);
      EXPECT_EQ(said.find(std::string(c.name) + ": "), 0u) << c.name << wrong << said;
      EXPECT_NE(said.find(" is outside the range "), std::string::npos) << said;
    }
  }
  for (int n = 0; n < 7; ++n) {
    for (const double wrong : {kNan, kInfinity, 1e300}) {
      if (n >= 3 && wrong == 1e300) continue;  // a quaternion of any finite length is made unit
      forcelayer_default_options(&options);
      options.world_from_device[n] = wrong;
      EXPECT_EQ(refusal(options).find("world_from_device: "), 0u) << n << wrong;
    }
  }
}

}  // namespace
}  // namespace forcelayer::test
