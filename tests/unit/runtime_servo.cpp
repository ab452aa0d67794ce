// The servo with a device that misbehaves, the clutch, and the swap of part and scene.
#include "runtime/loop/servo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <glm/geometric.hpp>
#include <optional>
#include <stdexcept>

#include "forcelayer/run.h"
#include "runtime/coupling/coupling.h"
#include "runtime/loop/loop.h"
#include "runtime/machine/real_time.h"
#include "runtime/stream/recording.h"
#include "tests/support/both_models.h"
#include "tests/support/distance_scene.h"
#include "tests/support/puppet_device.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/shape_scene.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005;
constexpr double kDt = 0.001;

// A slab whose force layer begins at z = 15 mm, and a ball of 20 mm.
std::unique_ptr<model::Simulation> simulation(Model model, double ball_m = 0.02) {
  Voxmap voxmap =
      make_voxmap(offset_scene(kS, {0, 0, -2}, {48, 48, 8}, 2, [](Voxel v) { return v[2] <= 0; }));
  Pshell shell = make_pshell(sphere_part(ball_m, 300, kS));
  RunRequest request;
  request.model = model;
  request.device = puppet_capabilities();
  auto run = open_run(std::move(voxmap), std::move(shell), request);
  if (!run) throw std::runtime_error(to_line(run.error()));
  return run->release_simulation();
}

// A hand at the device, above the slab at first.
struct Bench {
  std::unique_ptr<model::Simulation> sim;
  PuppetDevice device;
  loop::DeviceInput input{device, {}};
  Pose hand{{0.1, 0.1, 0.05}, {1, 0, 0, 0}};
  loop::Servo servo{*sim, input, sim->registered(hand, hand), puppet_limits()};
  Frame frame;

  Pose last_hand = hand;
  Twist claim;  // beside the true velocity, where the device senses it

  explicit Bench(Model model = kDefaultModel, bool senses_velocity = false)
      : sim(simulation(model)) {
    device.senses_velocity(senses_velocity);
    device.sample.present = device.sample.fresh = true;
    device.sample.device_from_handle = hand;
  }
  Wrench tick() {
    device.sample.device_from_handle = hand;
    const glm::dquat turn = hand.orientation * glm::conjugate(last_hand.orientation);
    device.sample.velocity = {(hand.position_m - last_hand.position_m) / kDt + claim.linear_mps,
                              coupling::rotation_vector(turn) / kDt + claim.angular_radps};
    last_hand = hand;
    EXPECT_TRUE(servo.tick(frame));
    return device.felt;
  }
  void turn(double angle_rad) {
    hand.orientation = coupling::rotation_by({0, 0, angle_rad}) * hand.orientation;
    tick();
  }
  // Moves the hand to height z at 0.1 m/s and waits there.
  void go_to(double z, int wait = 300) {
    while (std::abs(hand.position_m.z - z) > 1e-9) {
      hand.position_m.z += std::clamp(z - hand.position_m.z, -1e-4, 1e-4);
      tick();
    }
    for (int i = 0; i < wait; ++i) tick();
  }
  double stretch_m() const {
    const Pose target = hand * servo.state().handle_from_center;
    return glm::length(target.position_m - servo.state().world_from_center.position_m);
  }
};

class ServoTest : public BothModels {};
INSTANTIATE_TEST_SUITE_P(Models, ServoTest, kBothModels, name_of_model);

TEST_P(ServoTest, PressesAndEveryFaultOfTheInputTakesTheForceToZeroInTheSameTick) {
  using Change = std::function<void(DeviceSample&)>;
  const double nan = std::nan("");
  const struct {
    const char* name;
    Change change;
    int late_ticks;  // until the output trips
    TripCause cause;
  } cases[] = {
      {"unplugged", [](auto& s) { s.present = false; }, 1, TripCause::kDeviceLost},
      {"not calibrated", [](auto& s) { s.calibrated = false; }, 1, TripCause::kNotCalibrated},
      {"frozen", [](auto& s) { s.fresh = false; }, 6, TripCause::kFrozen},
      {"not finite", [=](auto& s) { s.device_from_handle.position_m.x = nan; }, 6,
       TripCause::kInputNotFinite},
      {"no rotation",
       [](auto& s) {
         s.device_from_handle.orientation = {0, 0, 0, 0};
       },
       6, TripCause::kInputNotFinite},
      {"millimeters", [](auto& s) { s.device_from_handle.position_m *= 1000.0; }, 6,
       TripCause::kImplausible},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
    Bench bench(GetParam());
    bench.go_to(0.03);
    ASSERT_GT(bench.device.felt.force_n.z, 1);
    const Pose part = bench.servo.state().world_from_center;
    double last = bench.device.felt.force_n.z;
    int ticks = 0;
    while (bench.servo.output().state() == OutputState::kArmed && ticks < 20) {
      bench.device.sample.device_from_handle = bench.hand;
      c.change(bench.device.sample);
      bench.servo.tick(bench.frame);
      const double felt = bench.device.felt.force_n.z;
      EXPECT_LE(felt, last + 1e-9);
      last = felt;
      ++ticks;
      // A frozen device is known only after a while; until then the force fades.
      if (c.cause != TripCause::kFrozen || ticks == c.late_ticks) {
        EXPECT_EQ(felt, 0);
      }
    }
    EXPECT_EQ(ticks, c.late_ticks);
    EXPECT_EQ(bench.servo.output().last_trip(), c.cause);
    EXPECT_LT(glm::length(bench.servo.state().world_from_center.position_m - part.position_m),
              1e-3);
    // Sound again: still zero, until the clutch was pressed and released.
    bench.device.sample.present = bench.device.sample.fresh = bench.device.sample.calibrated = true;
    for (int i = 0; i < 400; ++i) EXPECT_EQ(bench.tick().force_n.z, 0);
    bench.servo.set_clutch(true);
    for (int i = 0; i < 10; ++i) EXPECT_EQ(bench.tick().force_n.z, 0);
    bench.servo.set_clutch(false);
    EXPECT_EQ(bench.servo.output().state(), OutputState::kArmed);
    bench.go_to(0.028);
    EXPECT_GT(bench.device.felt.force_n.z, 0.5);
  }
}

// A source that believes its own numbers, as a device's input does not.
TEST_P(ServoTest, NumbersThatAreNotFiniteAreNoFrozenDevice) {
  struct NotFinite final : loop::InputSource {
    bool next(double, double, StepInput& input) noexcept override {
      input.world_from_handle = {{std::nan(""), 0.1, 0.05}, {1, 0, 0, 0}};
      input.valid = kInputValid;
      return true;
    }
    void output(const Frame& frame) noexcept override { felt = frame.device_wrench; }
    void silence() noexcept override {}
    const DevicePlacement& placement() const override { return at_home; }
    DevicePlacement at_home;
    Wrench felt;
  } input;
  const auto sim = simulation(GetParam());
  const Pose hand{{0.1, 0.1, 0.05}, {1, 0, 0, 0}};
  loop::Servo servo(*sim, input, sim->registered(hand, hand), puppet_limits());
  Frame frame;
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(servo.output().trips(), 0u);
    ASSERT_TRUE(servo.tick(frame));
    EXPECT_EQ(input.felt.force_n, glm::dvec3(0));
  }
  EXPECT_EQ(servo.output().last_trip(), TripCause::kNotFinite);
}

TEST_P(ServoTest, ASingleLateReadingIsABlip) {
  Bench bench(GetParam());
  bench.go_to(0.03);
  const double before = bench.device.felt.force_n.z;
  constexpr double kCreepN = 1e-4;  // the part still settles
  for (const int missing : {1, 2}) {
    bench.device.sample.fresh = false;
    for (int i = 0; i < missing; ++i) EXPECT_NEAR(bench.tick().force_n.z, before, kCreepN);
    bench.device.sample.fresh = true;
    EXPECT_NEAR(bench.tick().force_n.z, before, kCreepN);
  }
  EXPECT_EQ(bench.servo.output().trips(), 0u);
}

TEST_P(ServoTest, AJumpOfTheReadingIsNotFollowed) {
  Bench bench(GetParam());
  bench.go_to(0.03);
  const Pose good = bench.hand;
  bench.hand.position_m.x += 0.05;
  EXPECT_EQ(bench.tick().force_n.z, 0);
  EXPECT_EQ(bench.frame.health.trouble, InputTrouble::kImplausible);
  bench.hand = good;
  for (int i = 0; i < 19; ++i) EXPECT_EQ(bench.tick().force_n.z, 0);
  EXPECT_GT(bench.tick().force_n.z, 0);  // one bad reading is a blip, and ramps in anew
  EXPECT_EQ(bench.servo.output().trips(), 0u);
}

TEST_P(ServoTest, AJumpOfTheRotationIsNotFollowed) {
  Bench bench(GetParam());
  bench.go_to(0.03);
  const Pose good = bench.hand;
  bench.hand.orientation = coupling::rotation_by({0, 0, 1});
  EXPECT_EQ(bench.tick().force_n.z, 0);
  EXPECT_EQ(bench.frame.health.trouble, InputTrouble::kImplausible);
  bench.hand = good;
  for (int i = 0; i < 300; ++i) bench.tick();
  EXPECT_GT(bench.device.felt.force_n.z, 1);
  EXPECT_EQ(bench.servo.output().trips(), 0u);
}

// One bad reading in a few is no row that lasts. It was a sawtooth of force for a whole contact.
TEST_P(ServoTest, BadReadingsAmongGoodOnesTripAndMakeNoSawtooth) {
  using Spoil = std::function<void(DeviceSample&)>;
  const std::pair<Spoil, TripCause> spoils[] = {
      {[](auto& s) { s.device_from_handle.position_m.x = std::nan(""); },
       TripCause::kInputNotFinite},
      {[](auto& s) { s.device_from_handle.position_m.x += 100; }, TripCause::kImplausible}};
  for (const auto& [spoil, cause] : spoils) {
    for (const int one_in : {2, 6, 25, 100}) {
      SCOPED_TRACE(one_in);
      Bench bench(GetParam());
      bench.go_to(0.03);
      const double before = bench.device.felt.force_n.z;
      double smallest = before, swing = 0;  // the largest rise of the force
      int frames = 0;
      for (; bench.servo.output().trips() == 0 && frames < 2000; ++frames) {
        bench.device.sample.device_from_handle = bench.hand;
        if (frames % one_in == 0) spoil(bench.device.sample);
        bench.servo.tick(bench.frame);
        smallest = std::min(smallest, bench.device.felt.force_n.z);
        swing = std::max(swing, bench.device.felt.force_n.z - smallest);
      }
      EXPECT_EQ(bench.servo.output().last_trip(), cause);
      EXPECT_LE(frames, 6 * one_in);
      EXPECT_LE(swing, std::max(0, one_in - 20) / 200.0 * 10);
    }
  }
}

// A handle that stands still and claims to move: its claim is not believed, and trips.
TEST_P(ServoTest, ClaimedVelocitiesAreHeldAgainstThePoses) {
  for (const double claim : {2.0, 1000.0, 1e300}) {
    for (const bool turns : {false, true}) {
      SCOPED_TRACE(testing::Message() << claim << (turns ? " rad/s" : " m/s"));
      Bench bench(GetParam(), true);
      bench.go_to(0.03);
      ASSERT_GT(bench.device.felt.force_n.z, 1);
      const Pose part = bench.servo.state().world_from_center;
      (turns ? bench.claim.angular_radps : bench.claim.linear_mps).y = claim;
      int frames = 0;
      while (bench.servo.output().trips() == 0 && frames < 100) {
        bench.tick();
        ++frames;
      }
      EXPECT_LT(frames, 60);
      EXPECT_EQ(bench.device.felt.force_n, glm::dvec3(0));
      EXPECT_EQ(bench.servo.output().last_trip(), TripCause::kImplausible);
      EXPECT_LT(glm::length(bench.servo.state().world_from_center.position_m - part.position_m),
                1e-3);
    }
  }
}

// The wrist turns as its poses and its sensor say.
TEST_P(ServoTest, AWristTooFastTrips) {
  for (const bool senses : {false, true}) {
    Bench bench(GetParam(), senses);
    for (int i = 0; i < 250; ++i) bench.tick();
    for (int i = 0; i < 40; ++i) bench.turn(30 * kDt);
    EXPECT_EQ(bench.servo.output().trips(), 0u);
    for (int i = 0; i < 40; ++i) bench.turn(60 * kDt);
    EXPECT_EQ(bench.servo.output().last_trip(), TripCause::kOverSpeed);
  }
}

TEST_P(ServoTest, AHandTooFastTrips) {
  Bench bench(GetParam());
  for (int i = 0; i < 250; ++i) bench.tick();
  for (int i = 0; i < 40; ++i) {
    bench.hand.position_m.y += 0.006;  // 6 m/s
    bench.tick();
  }
  EXPECT_EQ(bench.servo.output().last_trip(), TripCause::kOverSpeed);
  EXPECT_EQ(bench.device.felt.force_n, glm::dvec3(0));
}

// The estimate is of the hand: neither the device's rate nor the scene's size changes it.
TEST(DeviceInput, TheHandIsAsFastAsItIsForASlowDeviceAndALargeScale) {
  constexpr double kSpeedMps = 1.5;
  for (const int periods : {1, 2, 3, 4, 7}) {
    for (const double scale : {0.1, 1.0, 10.0}) {
      SCOPED_TRACE(testing::Message() << periods << " periods, scale " << scale);
      PuppetDevice device;
      device.rate(1000.0 / periods);
      device.sample.present = device.sample.calibrated = true;
      DevicePlacement placement;
      placement.motion_scale = scale;
      loop::DeviceInput input(device, placement);
      StepInput step;
      for (int i = 0; i < 150; ++i) {
        device.sample.fresh = i % periods == 0;
        if (device.sample.fresh) {
          device.sample.device_from_handle.position_m.y = kSpeedMps * kDt * (i - 75);
        }
        ASSERT_TRUE(input.next(i * kDt, kDt, step));
        ASSERT_EQ(step.valid, kInputValid);
      }
      // After twenty time constants what is left is rounding.
      EXPECT_NEAR(step.handle_velocity.linear_mps.y / scale, kSpeedMps, 1e-3);
    }
  }
}

// Nothing shows the velocity of a first reading, so it is not believed, whatever it is.
TEST(DeviceInput, TheFirstClaimOfAVelocityIsNotUsed) {
  for (const double claim : {1.0, 1000.0, 1e300}) {
    PuppetDevice device;
    device.senses_velocity(true);
    device.sample.present = device.sample.calibrated = device.sample.fresh = true;
    device.sample.velocity = {{claim, 0, 0}, {0, claim, 0}};
    loop::DeviceInput input(device, {});
    StepInput step;
    ASSERT_TRUE(input.next(0, kDt, step));
    EXPECT_EQ(step.valid, kInputValid);
    EXPECT_EQ(step.handle_velocity.linear_mps, glm::dvec3(0));
    EXPECT_EQ(step.handle_velocity.angular_radps, glm::dvec3(0));
  }
}

// A jump is counted from the last reading, however long ago; one that was lost may return anywhere.
TEST(DeviceInput, AHandMovesOnWhileTheDeviceIsSilentOrLost) {
  PuppetDevice device;
  device.senses_velocity(true);
  device.sample.present = device.sample.calibrated = true;
  loop::DeviceInput input(device, {});
  StepInput step;
  for (int i = 0; i < 50; ++i) {
    device.sample.fresh = i % 4 == 0;
    device.sample.velocity.linear_mps.y = 6;
    if (device.sample.fresh) device.sample.device_from_handle.position_m.y = 6 * kDt * (i - 25);
    ASSERT_TRUE(input.next(i * kDt, kDt, step));
    ASSERT_EQ(step.valid, kInputValid) << i;
  }
  device.sample.present = false;
  input.next(0.05, kDt, step);
  ASSERT_EQ(step.valid, kInputInvalid);
  device.sample.present = device.sample.fresh = true;
  device.sample.device_from_handle.position_m = {0.3, 0, 0};
  device.sample.velocity.linear_mps = {0, 100, 0};
  input.next(0.051, kDt, step);
  EXPECT_EQ(step.valid, kInputValid);
  EXPECT_EQ(step.handle_velocity.linear_mps, glm::dvec3(0));
}

// Whatever rate it declares: a force does not outlive its reading by more than the ceiling.
TEST(DeviceInput, NoSlownessOfADeviceRaisesTheStaleLimitBeyondItsCeiling) {
  for (const double rate_hz : {1e-3, 1.0, 20.0, 49.0}) {
    SCOPED_TRACE(rate_hz);
    PuppetDevice device;
    device.rate(rate_hz);
    device.sample.present = device.sample.calibrated = device.sample.fresh = true;
    loop::DeviceInput input(device, {});
    StepInput step;
    ASSERT_TRUE(input.next(0, kDt, step));
    ASSERT_EQ(step.valid, kInputValid);
    device.sample.fresh = false;
    for (int i = 1; i * kDt <= kStaleCeilingS + kDt; ++i) input.next(i * kDt, kDt, step);
    EXPECT_EQ(step.valid, kInputInvalid);
    EXPECT_EQ(input.health().trouble, InputTrouble::kFrozen);
    EXPECT_EQ(input.health().age_fraction, 1);
  }
}

TEST_P(ServoTest, ALateLoopTrips) {
  Bench bench(GetParam());
  bench.go_to(0.03);
  bench.servo.note_late();
  EXPECT_EQ(bench.tick().force_n.z, 0);
  EXPECT_EQ(bench.servo.output().last_trip(), TripCause::kLoopLate);
}

TEST_P(ServoTest, TheClutchFreezesThePartInContactAndRegripsWithoutStretch) {
  Bench bench(GetParam());
  bench.go_to(0.03);
  double last = bench.device.felt.force_n.z;
  ASSERT_GT(last, 1);
  bench.servo.set_clutch(true);
  for (int i = 0; i < 50; ++i) {
    const double felt = bench.tick().force_n.z;
    EXPECT_LE(felt, last);
    last = felt;
  }
  EXPECT_EQ(last, 0);
  bench.tick();
  const Pose part = bench.servo.state().world_from_center;
  bench.go_to(0.06);
  bench.hand.orientation = coupling::rotation_by({0, 0, 0.3});
  bench.go_to(0.05);
  const Pose held = bench.servo.state().world_from_center;
  EXPECT_EQ(held.position_m, part.position_m);
  EXPECT_EQ(held.orientation, part.orientation);
  EXPECT_EQ(bench.device.felt.force_n, glm::dvec3(0));
  bench.servo.set_clutch(false);
  EXPECT_LT(bench.stretch_m(), 1e-12);
  // In contact still: what pushes the part out is felt, and ramps in.
  double largest = 0;
  for (int i = 1; i <= 100; ++i) {
    const double felt = glm::length(bench.tick().force_n);
    EXPECT_LE(felt, 10 * i / 200.0 + 1e-9);
    largest = std::max(largest, felt);
  }
  EXPECT_LT(largest, 2.5);  // no blow: less than what pressed before the clutch
  bench.go_to(0.045);
  EXPECT_GT(bench.device.felt.force_n.z, 1);
}

TEST_P(ServoTest, AButtonOfTheDeviceIsTheClutch) {
  Bench bench(GetParam());
  bench.servo.set_clutch_buttons(4);
  bench.go_to(0.03);
  bench.device.sample.buttons = 3;
  EXPECT_GT(bench.tick().force_n.z, 1);
  bench.device.sample.buttons = 6;
  for (int i = 0; i < 60; ++i) bench.tick();
  EXPECT_EQ(bench.frame.input.valid, kInputClutched);
}

TEST_P(ServoTest, ThePartIsSwappedWithoutARestart) {
  Bench bench(GetParam());
  bench.go_to(0.03);
  const auto larger = simulation(GetParam(), 0.03);
  auto parameters = larger->parameters();
  parameters.rate_hz = 500;
  Voxmap slab =
      make_voxmap(offset_scene(kS, {0, 0, -2}, {8, 8, 8}, 2, [](Voxel v) { return v[2] <= 0; }));
  auto slower = model::Simulation::create(std::move(slab), make_pshell(sphere_part(0.02, 50, kS)),
                                          parameters);
  ASSERT_TRUE(slower);
  const Pose above{{0.1, 0.1, 0.08}, {1, 0, 0, 0}};
  EXPECT_FALSE(bench.servo.request_swap(**slower, {above, {}}));
  ASSERT_TRUE(bench.servo.request_swap(*larger, {above, {}}));
  EXPECT_FALSE(bench.servo.request_swap(*larger, {above, {}}));
  double last = bench.device.felt.force_n.z;
  int ticks = 0;
  while (bench.servo.swapping()) {
    const double felt = bench.tick().force_n.z;
    EXPECT_LE(felt, last);
    last = felt;
    ASSERT_LT(++ticks, 100);
  }
  bench.sim.reset();  // the old one is free
  EXPECT_EQ(&bench.servo.simulation(), larger.get());
  EXPECT_LT(bench.stretch_m(), 1e-12);
  EXPECT_LT(glm::length(bench.servo.state().world_from_center.position_m - above.position_m),
            1e-12);
  for (int i = 0; i < 300; ++i) EXPECT_EQ(bench.tick().force_n.z, 0);  // nothing touches
  bench.go_to(bench.hand.position_m.z - 0.05);
  EXPECT_GT(bench.device.felt.force_n.z, 1);
  EXPECT_EQ(bench.servo.output().trips(), 0u);
}

// A hold fades as the clutch does, arms nothing, and keeps the part where it is while the scene is
// changed: the part goes on from there, without stretch, though the hand moved on.
TEST_P(ServoTest, AHeldPartStaysWhereItIsWhileTheSceneIsChanged) {
  Bench bench(GetParam());
  bench.servo.set_hold(true);
  for (int i = 0; i < 60; ++i) bench.tick();
  EXPECT_EQ(bench.servo.output().state(), OutputState::kWaiting);
  bench.servo.set_hold(false);
  bench.go_to(0.03);
  double last = bench.device.felt.force_n.z;
  ASSERT_GT(last, 1);
  bench.servo.set_hold(true);
  for (int i = 0; i < 60; ++i) {
    bench.hand.position_m.x += 1e-5;
    const double felt = bench.tick().force_n.z;
    EXPECT_LE(felt, last + 1e-9);
    last = felt;
  }
  EXPECT_EQ(last, 0);
  ASSERT_EQ(bench.frame.input.valid, kInputClutched);
  EXPECT_TRUE(bench.frame.health.swapping);
  const Pose held = bench.frame.result.report.world_from_center;
  const auto next = simulation(GetParam());
  PartStart start;
  start.world_from_part = next->world_from_part(held);
  EXPECT_EQ(bench.frame.scene, 0u);
  ASSERT_TRUE(bench.servo.request_swap(*next, start));
  bench.servo.set_hold(false);
  bench.tick();
  EXPECT_EQ(bench.frame.scene, 1u);
  EXPECT_FALSE(bench.servo.swapping());
  EXPECT_LT(glm::length(bench.servo.state().world_from_center.position_m - held.position_m), 1e-12);
  EXPECT_LT(bench.stretch_m(), 1e-12);
  const double z = held.position_m.z;
  for (int i = 0; i < 300; ++i) {
    bench.tick();
    // The force layer, without the hand against it, moves the part out by less than its depth.
    EXPECT_NEAR(bench.servo.state().world_from_center.position_m.z, z, kS / 4);
  }
  bench.go_to(bench.hand.position_m.z - 0.005);
  EXPECT_GT(bench.device.felt.force_n.z, 1);
  EXPECT_EQ(bench.servo.output().trips(), 0u);
}

// With the limits of the run, a replay gives the device's wrench again, faults and clutch included.
TEST_P(ServoTest, AReplayGivesTheDevicesWrenchAgain) {
  const ScratchFolder folder;
  std::vector<Wrench> felt;
  {
    Bench bench(GetParam());
    auto writer = stream::RecordingWriter::create(folder / "run.flr");
    ASSERT_TRUE(writer);
    writer->begin(stream::describe_run(*bench.sim, bench.servo.state(), DevicePlacement{}));
    const auto tick = [&] {
      felt.push_back(bench.tick());
      ASSERT_TRUE(writer->add(bench.frame));
    };
    for (int i = 0; i < 1500; ++i) {
      if (i >= 250 && i < 450) bench.hand.position_m.z -= 1e-4;
      bench.device.sample.fresh = i % 7 != 0 && (i < 600 || i > 603);
      bench.device.sample.present = i < 1200 || i > 1203;
      bench.servo.set_clutch((i > 700 && i < 800) || (i > 1300 && i < 1310));
      if (i == 1000) bench.servo.note_late();
      if (i >= 1410 && i < 1440) bench.device.sample.output_falls += 0.3;  // trips
      if (i == 1100) bench.servo.set_clutch(true);
      tick();
    }
    ASSERT_TRUE(writer->finish(0));
    EXPECT_GE(bench.servo.output().trips(), 2u);
  }
  const auto recording = stream::Recording::open(folder / "run.flr");
  ASSERT_TRUE(recording);
  const auto sim = simulation(GetParam());
  stream::ReplayInput input(*recording);
  loop::Servo servo(*sim, input, recording->run().start, puppet_limits());
  Frame frame;
  for (std::size_t i = 0; i < felt.size(); ++i) {
    ASSERT_TRUE(servo.tick(frame));
    ASSERT_EQ(frame.device_wrench.force_n, felt[i].force_n) << i;
    ASSERT_EQ(frame.device_wrench.torque_nm, felt[i].torque_nm) << i;
  }
  EXPECT_FALSE(servo.tick(frame));
  EXPECT_EQ(input.differing_frames(), 0u);
}

// A block that is installed in a pocket without play, held at a motion scale by a handle that was
// moved, in device axes, between registration and the first tick.
struct SeatedBench {
  std::unique_ptr<model::Simulation> sim;
  PuppetDevice device;
  DevicePlacement placement;
  Pose home;  // of the handle at the device
  std::optional<loop::DeviceInput> input;
  std::optional<loop::Servo> servo;
  Frame frame;

  SeatedBench(double scale, const glm::dvec3& moved_m, const glm::dvec3& turned_rad) {
    const glm::dvec3 half_m{0.015, 0.012, 0.01};
    const VoxelScene pocket = distance_scene(
        kS, {-8, -8, -8}, {16, 16, 16},
        [=](const glm::dvec3& p) {
          const glm::dvec3 left_m = half_m - glm::abs(p);
          return std::min({left_m.x, left_m.y, left_m.z});
        },
        2, DistanceDefinition(2));
    placement.motion_scale = scale;
    RunRequest request;
    request.device = puppet_capabilities();
    request.placement = placement;
    request.without_guarantee = true;  // any part will do
    auto run = open_run(make_voxmap(pocket), make_pshell(box_part(half_m, 0.8 * kS, kS)), request);
    if (!run) throw std::runtime_error(to_line(run.error()));
    sim = run->release_simulation();
    PartStart start;
    start.world_from_part = Pose{};
    const auto begun = sim->begin(start, {});
    if (!begun) throw std::runtime_error(to_line(begun.error()));
    device.sample.present = device.sample.fresh = true;
    input.emplace(device, placement);
    servo.emplace(*sim, *input, *begun, puppet_limits());
    home = {moved_m, coupling::rotation_by(turned_rad)};
    tick_to = home;
  }
  Pose tick_to;
  Wrench tick() {
    device.sample.device_from_handle = tick_to;
    EXPECT_TRUE(servo->tick(frame));
    return device.felt;
  }
  bool armed() const { return servo->output().state() == OutputState::kArmed; }
};

// Both sides of the tolerance, 0.1 mm and 1 mrad at the device whatever the scale. The part gives
// way a fifth of what the hand pulls at most.
const struct {
  const char* name;
  glm::dvec3 moved_m, turned_rad;
  bool arms;
} kHandsAtTheStart[] = {
    {"at rest", {0, 0, 0}, {0, 0, 0}, true},
    {"moved within", {6e-5, -5e-5, 6e-5}, {0, 0, 0}, true},
    {"moved beyond", {8e-5, -7e-5, 8e-5}, {0, 0, 0}, false},
    {"pressed within", {0, 0, -9.9e-5}, {0, 0, 0}, true},
    {"pressed beyond", {0, 0, -1.3e-4}, {0, 0, 0}, false},
    {"far away", {0, 0, 0.01}, {0, 0, 0}, false},
    {"turned within", {0, 0, 0}, {6e-4, 5e-4, -6e-4}, true},
    {"turned beyond", {0, 0, 0}, {8e-4, 7e-4, -8e-4}, false},
    {"both within", {0, 9e-5, 0}, {0, 9e-4, 0}, true},
    {"moved within, turned beyond", {0, 9e-5, 0}, {0, 1.3e-3, 0}, false},
    {"a whole turn but little", {0, 0, 0}, {0, 0, 2 * M_PI - 5e-4}, true},
    {"upside down", {0, 0, 0}, {0, M_PI, 0}, false},
};

TEST(SeatedServo, ArmsWhileAHandHoldsItStillAtEveryScale) {
  for (const double scale : {0.1, 1.0, 10.0}) {
    for (const auto& hand : kHandsAtTheStart) {
      SCOPED_TRACE(testing::Message() << hand.name << ", scale " << scale);
      SeatedBench bench(scale, hand.moved_m, hand.turned_rad);
      for (int i = 0; i < 100; ++i) {
        const Wrench felt = bench.tick();
        ASSERT_EQ(bench.armed(), hand.arms) << i;
        if (hand.arms) continue;
        ASSERT_EQ(felt.force_n, glm::dvec3(0)) << i;
        ASSERT_EQ(felt.torque_nm, glm::dvec3(0)) << i;
      }
      EXPECT_GT(bench.frame.result.report.seated, 0u);
      EXPECT_EQ(bench.servo->output().trips(), 0u);
    }
  }
}

// The hand arms the output at the edge of the tolerance and presses at once: it feels nothing for
// 20 ms, and then no more than the ramp lets in.
TEST(SeatedServo, WhateverTheHandDoesAfterArmingTheForceIsARampFromZero) {
  constexpr int kZeroTicks = 20, kRampTicks = 200;
  for (const double scale : {0.1, 1.0, 10.0}) {
    for (const glm::dvec3& way : {glm::dvec3(0, 0, -1), glm::dvec3(0.6, 0, -0.8)}) {
      SCOPED_TRACE(testing::Message() << "scale " << scale << ", way " << way.x);
      SeatedBench bench(scale, 9.9e-5 * way, 9.9e-4 * glm::dvec3(way.z, 0, way.x));
      double max_n = 0, max_nm = 0;
      for (int i = 0; i < 400; ++i) {
        const double fraction = std::min(i, 100) / 100.0;  // 10 mm at 0.1 m/s, and 0.2 rad
        bench.tick_to = {bench.home.position_m + fraction * 0.01 * way,
                         coupling::rotation_by({0, 0.2 * fraction, 0}) * bench.home.orientation};
        const Wrench felt = bench.tick();
        ASSERT_TRUE(bench.armed());
        const double gain = std::clamp((i + 1 - kZeroTicks) / double{kRampTicks}, 0.0, 1.0);
        ASSERT_LE(glm::length(felt.force_n), puppet_limits().max_force_n * gain + 1e-9) << i;
        ASSERT_LE(glm::length(felt.torque_nm), puppet_limits().max_torque_nm * gain + 1e-9) << i;
        max_n = std::max(max_n, glm::length(felt.force_n));
        max_nm = std::max(max_nm, glm::length(felt.torque_nm));
      }
      EXPECT_GT(max_n, 5);  // it does push back
      EXPECT_GT(max_nm, 1e-4);
    }
  }
}

// A hand that stays where it armed the output feels the springs at the tolerance's edge at most:
// the same at every scale, and below what a hand tells from nothing.
TEST(SeatedServo, AHandThatStaysWhereItArmedFeelsTheSpringsOfThatStretchAtMost) {
  for (const double scale : {0.1, 1.0, 10.0}) {
    for (const auto& hand : kHandsAtTheStart) {
      if (!hand.arms) continue;
      SCOPED_TRACE(testing::Message() << hand.name << ", scale " << scale);
      SeatedBench bench(scale, hand.moved_m, hand.turned_rad);
      const Parameters& p = bench.sim->parameters();
      const double max_n = p.coupling_n_per_m * scale * scale * 1e-4;
      const double max_nm = p.coupling_nm_per_rad * 1e-3;
      EXPECT_LT(max_n, 0.05 * puppet_limits().max_force_n);
      EXPECT_LT(max_nm, 0.05 * puppet_limits().max_torque_nm);
      for (int i = 0; i < 500; ++i) {
        const Wrench felt = bench.tick();
        ASSERT_LE(glm::length(felt.force_n), max_n) << i;
        ASSERT_LE(glm::length(felt.torque_nm), max_nm) << i;
      }
    }
  }
}

TEST(SeatedServo, NumbersThatAreNotFiniteAndAFastHandArmNothing) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double value : {std::nan(""), double{INFINITY}}) {
      for (const bool turned : {false, true}) {
        SCOPED_TRACE(testing::Message() << value << ", axis " << axis << ", turned " << turned);
        SeatedBench bench(1, {0, 0, 0}, {0, 0, 0});
        (turned ? bench.tick_to.orientation[axis] : bench.tick_to.position_m[axis]) = value;
        const Wrench felt = bench.tick();
        EXPECT_FALSE(bench.armed());
        EXPECT_EQ(felt.force_n, glm::dvec3(0));
        EXPECT_EQ(felt.torque_nm, glm::dvec3(0));
        bench.tick_to = bench.home;
        bench.tick();
        EXPECT_TRUE(bench.armed());
      }
    }
  }
  // A hand that passes where it would arm, at 6 m/s: faster than it may.
  SeatedBench bench(1, {0, 0, 0}, {0, 0, 0});
  for (int i = -30; i <= 30; ++i) {
    bench.tick_to.position_m.z = 0.006 * i;
    const Wrench felt = bench.tick();
    ASSERT_FALSE(bench.armed()) << i;
    ASSERT_EQ(felt.force_n, glm::dvec3(0)) << i;
  }
}

// The fake device stands still in the loop's clock: a pause of the loop is noticed by the loop.
TEST(Loop, APauseTripsAndEveryMissHasACause) {
  class PausingInput final : public loop::InputSource {
   public:
    explicit PausingInput(loop::InputSource& inner) : inner_(inner) {}
    bool next(double t, double dt, StepInput& input) noexcept override {
      if (++frames_ == 300) machine::sleep_until_ns(machine::monotonic_ns() + 60'000'000);
      return inner_.next(t, dt, input);
    }
    InputHealth health() const noexcept override { return inner_.health(); }
    void output(const Frame& frame) noexcept override { inner_.output(frame); }
    void silence() noexcept override { inner_.silence(); }
    const DevicePlacement& placement() const override { return inner_.placement(); }

   private:
    loop::InputSource& inner_;
    int frames_ = 0;
  };
  // A machine that is itself too late before the pause ends the run there: then once more.
  for (int attempt = 0;; ++attempt) {
    Bench bench;
    PausingInput input(bench.input);
    loop::Servo servo(*bench.sim, input, bench.servo.state(), puppet_limits());
    loop::LoopOptions options;
    options.frames = 400;
    options.stale_s = 0.05;  // a busy machine alone shall not reach it
    options.end_on_trip = true;
    const auto statistics = std::make_unique<loop::LoopStatistics>();
    loop::run_loop(servo, options, nullptr, *statistics);
    if (statistics->frames < 300 && attempt < 20) continue;
    EXPECT_EQ(servo.output().last_trip(), TripCause::kLoopLate);
    EXPECT_GE(statistics->deadline_misses, 1u);
    std::uint64_t sum = 0;
    for (const std::uint64_t n : statistics->misses_by_cause) sum += n;
    EXPECT_EQ(sum, statistics->deadline_misses);
    bool found = false;
    for (std::size_t i = 0; i < statistics->worst.size(); ++i) {
      found |= statistics->worst[i].frame == 299 &&
               statistics->worst[i].cause == loop::MissCause::kBlocked;
    }
    EXPECT_TRUE(found);
    break;
  }
}

TEST(Loop, TheCauseOfAMissIsTheFirstThatApplies) {
  loop::TickCost cost;
  cost.woke_late_ns = 2'000'000;
  cost.tick_ns = cost.cpu_ns = 100'000;
  EXPECT_EQ(loop::cause_of(cost), loop::MissCause::kWokeLate);
  cost.woke_late_ns = 0;
  cost.tick_ns = 5'000'000;
  cost.cpu_ns = 5'000'000;
  EXPECT_EQ(loop::cause_of(cost), loop::MissCause::kLongTick);
  cost.minor_faults = 3;
  EXPECT_EQ(loop::cause_of(cost), loop::MissCause::kMinorFault);
  cost.cpu_ns = 100'000;
  EXPECT_EQ(loop::cause_of(cost), loop::MissCause::kStoodStill);
  cost.voluntary_switches = 1;
  EXPECT_EQ(loop::cause_of(cost), loop::MissCause::kBlocked);
  cost.involuntary_switches = 1;
  EXPECT_EQ(loop::cause_of(cost), loop::MissCause::kPreempted);
  cost.major_faults = 1;
  EXPECT_EQ(loop::cause_of(cost), loop::MissCause::kMajorFault);
}

TEST(Loop, TheWorstFramesAreKept) {
  loop::WorstFrames worst;
  for (int i = 0; i < 1000; ++i) {
    loop::MissedFrame frame;
    frame.late_ns = (i * 7919) % 1000;
    worst.add(frame);
  }
  ASSERT_EQ(worst.size(), loop::WorstFrames::kKept);
  for (std::size_t i = 0; i < worst.size(); ++i) EXPECT_GE(worst[i].late_ns, 984);
}

}  // namespace
}  // namespace forcelayer::test
