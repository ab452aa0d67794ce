// The coupling acts at the grip, and the motion scale is a transformer: whatever the arm, the scale
// and the hand, nothing swings, and slow closed loops give the hand no more than a sampled spring
// must.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "runtime/coupling/coupling_angle.h"
#include "runtime/coupling/virtual_coupling.h"
#include "tests/support/grip_map.h"
#include "tests/support/random_scenes.h"
#include "tests/support/sanitized.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005, kDt = 0.001;

// A part in the hand: its pose, the handle's, and the grip.
struct Hold {
  Pose part, handle;
  State state;
  coupling::CouplingHalf translation{1200, glm::dmat3(0), 15}, rotation{0.7, glm::dmat3(0), 0.1};

  explicit Hold(Random& random) {
    part = {random_direction(random), random_orientation(random)};
    const Pose grip{random_direction(random) * uniform(random, 0, 0.5), random_orientation(random)};
    state.handle_from_center = inverse(grip);
    handle = part * grip;
    // Within the clamps and beyond them.
    handle.position_m += random_direction(random) * uniform(random, 0, 0.03);
    handle.orientation = coupling::rotation_by(random_direction(random) * uniform(random, 0, 0.4)) *
                         handle.orientation;
  }

  coupling::GripTarget target() const {
    StepInput input;
    input.world_from_handle = handle;
    return coupling::grip_target(state, input);
  }
  glm::dvec3 angle() const {
    return coupling::continuous_angle(part.orientation, target().orientation, glm::dvec3(0));
  }
  double energy_j() const {
    return coupling::spring_energy_j(translation, coupling::grip_stretch_m(target(), part)) +
           coupling::spring_energy_j(rotation, angle());
  }
  glm::dvec3 force_n() const {
    return coupling::spring_force(translation, coupling::grip_stretch_m(target(), part));
  }
  glm::dvec3 torque_nm() const { return coupling::spring_force(rotation, angle()); }
};

Pose moved(const Pose& pose, int motion, double way) {
  Pose there = pose;
  glm::dvec3 axis(0);
  axis[motion % 3] = way;
  if (motion < 3) {
    there.position_m += axis;
  } else {
    there.orientation = coupling::rotation_by(axis) * there.orientation;
  }
  return there;
}

// For motions of the part and of the handle: the wrench on the part about its centroid and that on
// the hand about the handle's origin are the slopes of one energy.
TEST(Grip, ForceAndTorqueAreTheGradientOfAPotential) {
  constexpr double kWay = 1e-6;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Hold hold(random);
    const glm::dvec3 arm_m = coupling::grip_arm_m(hold.target(), hold.part);
    const glm::dvec3 on_part_nm = hold.torque_nm() + glm::cross(arm_m, hold.force_n());
    for (int motion = 0; motion < 6; ++motion) {
      const auto slope = [&](Pose Hold::*member) {
        Hold there = hold, back = hold;
        there.*member = moved(hold.*member, motion, kWay);
        back.*member = moved(hold.*member, motion, -kWay);
        return (there.energy_j() - back.energy_j()) / (2 * kWay);
      };
      // Rounding of the energies over the way, and the third derivative of a potential whose
      // slope turns within the stretch.
      const double tolerance = 1e-6 * (1 + glm::length(hold.force_n()));
      const double on_part = motion < 3 ? hold.force_n()[motion] : on_part_nm[motion - 3];
      const double on_hand = motion < 3 ? -hold.force_n()[motion] : -hold.torque_nm()[motion - 3];
      EXPECT_NEAR(-slope(&Hold::part), on_part, tolerance) << motion;
      EXPECT_NEAR(-slope(&Hold::handle), on_hand, tolerance) << motion;
    }
  }
}

// A hand that goes round and comes back got nothing from a part that stood still.
TEST(Grip, AClosedLoopOfTheHandleGivesNothing) {
  constexpr int kSteps = 4000;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Hold hold(random);
    const Pose start = hold.handle;
    const glm::dvec3 a = random_direction(random) * 0.02, b = random_direction(random) * 0.02,
                     c = random_direction(random) * 0.3, d = random_direction(random) * 0.3;
    double work_j = 0, either_way_j = 0;
    Hold last = hold;
    for (int i = 1; i <= kSteps; ++i) {
      const double t = 2 * M_PI * i / kSteps, sine = std::sin(t), cosine = 1 - std::cos(2 * t);
      hold.handle = {start.position_m + a * sine + b * cosine,
                     coupling::rotation_by(c * sine + d * cosine) * start.orientation};
      const glm::dvec3 way_m = hold.handle.position_m - last.handle.position_m;
      const glm::dvec3 turn_rad = coupling::rotation_vector(
          hold.handle.orientation * glm::conjugate(last.handle.orientation));
      const double step_j = -0.5 * (glm::dot(hold.force_n() + last.force_n(), way_m) +
                                    glm::dot(hold.torque_nm() + last.torque_nm(), turn_rad));
      work_j += step_j;
      either_way_j += std::abs(step_j);
      last = hold;
    }
    // The trapezoid errs by the square of a step.
    EXPECT_NEAR(work_j, 0, 1e-5 * either_way_j);
    EXPECT_GT(either_way_j, 1e-3);
  }
}

// Implicit rows of a force at an arm: J^T S J and J^T o, written out.
TEST(Grip, AForceAtAnArmEntersTheSystemWithItsJacobian) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const coupling::CouplingHalf half{2000, glm::dmat3(8.0), uniform(random, 1, 30)};
    const coupling::HalfStretch stretch{random_direction(random) * 0.01, random_direction(random)};
    const glm::dvec3 arm_m = random_direction(random) * 0.3;
    const coupling::Vector6 guess =
        coupling::vector6(random_direction(random), random_direction(random));
    coupling::Symmetric6 matrix;
    coupling::Vector6 impulse{};
    coupling::add_force(half, stretch, arm_m, guess, kDt, matrix, impulse);
    // Velocity of the grip for each of the six velocities.
    std::array<glm::dvec3, 6> j;
    for (int i = 0; i < 6; ++i) {
      glm::dvec3 axis(0);
      axis[i % 3] = 1;
      j[static_cast<std::size_t>(i)] = i < 3 ? axis : glm::cross(axis, arm_m);
    }
    const double slope = 8 + kDt * 2000;
    const glm::dvec3 offset = 2000.0 * stretch.displacement + 8.0 * stretch.target_velocity;
    glm::dvec3 grip_mps(0);
    for (std::size_t i = 0; i < 6; ++i) grip_mps += guess[i] * j[i];
    const double force = glm::length(offset - slope * grip_mps);
    const double secant = std::min(1.0, half.limit / force);
    for (int row = 0; row < 6; ++row) {
      const auto i = static_cast<std::size_t>(row);
      EXPECT_NEAR(impulse[i], kDt * secant * glm::dot(j[i], offset), 1e-14);
      for (int column = 0; column <= row; ++column) {
        EXPECT_NEAR(matrix.lower[coupling::Symmetric6::at(row, column)],
                    kDt * secant * slope * glm::dot(j[i], j[static_cast<std::size_t>(column)]),
                    1e-14);
      }
    }
  }
}

const std::vector<double> kScales = kSanitized ? std::vector{1.0} : std::vector{0.1, 1.0, 10.0};

TEST(Grip, AtRestInFreeSpaceTheHandFeelsExactlyNothing) {
  for (const double scale : kScales) {
    for (int axis = 0; axis < 6; ++axis) {
      SCOPED_TRACE(testing::Message() << "scale " << scale << ", axis " << axis);
      HeldPartOptions options = above_the_plane(0.3, axis, scale);
      options.start.position_m = plane_normal() * 30.0 * kS;
      HeldPart held(plane(), block(), options);
      for (int i = 0; i < 600; ++i) {
        held.servo().set_clutch(i >= 300 && i < 400);
        Pose handle = held.start_handle();
        if (i >= 350) handle.orientation = coupling::rotation_by({0.2, 0, 0}) * handle.orientation;
        const Frame& frame = held.tick(handle);
        ASSERT_EQ(frame.device_wrench.force_n, glm::dvec3(0)) << i;
        ASSERT_EQ(frame.device_wrench.torque_nm, glm::dvec3(0)) << i;
      }
      EXPECT_EQ(held.frame().output, OutputState::kArmed);
    }
  }
}

// A part in a box that leaves it no way: the handle that turns about its origin feels the
// rotational spring and nothing else, whatever the arm, and after a clutch that makes the arm
// another.
TEST(Grip, AHandleThatTurnsFeelsTheRotationalSpringAlone) {
  constexpr double kTurnRad = 0.03;  // within the clamp
  const glm::dvec3 half_m = glm::dvec3(8, 5, 4) * kS;
  // Its walls begin to push a little outside of the part's sides.
  const VoxelScene cavity = distance_scene(
      kS, {-20, -20, -20}, {40, 40, 40},
      [=](const glm::dvec3& p) {
        const glm::dvec3 left = half_m + 2.9 * kS - glm::abs(p);
        return std::min({left.x, left.y, left.z});
      },
      2, DistanceDefinition(2));
  for (const double scale : kScales) {
    for (const double arm_m : {0.0, 0.05, 0.2, 0.5}) {
      SCOPED_TRACE(testing::Message() << "scale " << scale << ", arm " << arm_m);
      HeldPartOptions options = above_the_plane(arm_m, 0, scale);
      options.start = {};
      HeldPart held(cavity, block(), options);
      Pose handle = held.start_handle();
      for (const glm::dvec3& away_m : {glm::dvec3(0), glm::dvec3(0.02, -0.1, 0.07)}) {
        // The clutch arms the output; the second time the hand comes back elsewhere, and turned.
        held.servo().set_clutch(true);
        for (int i = 0; i < 100; ++i) held.tick(handle);
        handle.position_m += away_m / scale;
        handle.orientation = coupling::rotation_by(5.0 * away_m) * handle.orientation;
        for (int i = 0; i < 100; ++i) held.tick(handle);
        held.servo().set_clutch(false);
        for (int i = 0; i < 400; ++i) held.tick(handle);
        const glm::dvec3 axis = glm::normalize(glm::dvec3(1, 2, -1));
        const glm::dquat from = handle.orientation;
        for (int i = 1; i <= 1000; ++i) {
          const double turn_rad = kTurnRad * std::min(1.0, i / 500.0);
          handle.orientation = coupling::rotation_by(axis * turn_rad) * from;
          held.tick(handle);
        }
        const Wrench& felt = held.frame().device_wrench;
        const glm::dvec3 angle_rad = coupling::rotation_vector(
            coupling::grip_target(held.servo().state(), held.frame().input).orientation *
            glm::conjugate(held.servo().state().world_from_center.orientation));
        const double spring_nm_per_rad = held.parameters().coupling_nm_per_rad;
        EXPECT_GT(glm::dot(angle_rad, axis), 0.5 * kTurnRad);  // the part gives way a little
        EXPECT_LT(glm::length(felt.torque_nm + spring_nm_per_rad * angle_rad),
                  0.02 * spring_nm_per_rad * kTurnRad);  // what the part settled by is not felt
        // The walls give way by a milliradian, which carries the grip along: at scale 10, where
        // they push with 2000 N/m, by half a millimeter at the longest arm.
        EXPECT_LT(glm::length(felt.force_n), 0.1);
      }
    }
  }
}

// The map of grips, thinned: a part pressed on a plane by a hand of every temper that then holds
// still or lets go. With the coupling at the centroid a loose hand swings by 3 degrees at 0.2 m.
// `stability_bench grips` has the whole map.
TEST(Grip, NoArmMakesAHandleSwing) {
  const char* const tempers[] = {"none", "loose", "firm"};
  constexpr double kStillSteps = 8;
  int cell = 0;
  for (const double scale : kScales) {
    for (int temper = 0; temper < 3; ++temper) {
      for (const double arm_m : {0.0, 0.2, 0.5}) {
        const int axis = cell++ % 6;
        SCOPED_TRACE(testing::Message() << "scale " << scale << ", hand " << tempers[temper]
                                        << ", arm " << arm_m << " along " << axis);
        const auto hand = temper == 2 ? devices::SimHandParameters{} : devices::loose_grip();
        HeldPartOptions options = above_the_plane(arm_m, axis, scale);
        options.hand = hand;
        HeldPart held(plane(), block(), options);
        EXPECT_TRUE(held.warnings().empty()) << held.warnings()[0];
        EXPECT_LT(swing_steps(held, hand, temper == 0), kStillSteps);
      }
    }
  }
}

// Slow loops at the port: what the hand gets beyond what a sampled spring must give is nothing, at
// any scale, and the report is what the motors did.
TEST(Grip, ClosedLoopsInContactGiveTheHandNothing) {
  constexpr double kFreeJ = 2e-5;
  const VoxelScene scene = plane();
  const PointPart part = block();
  int cell = 0, worked = 0;
  const std::vector scales = kSanitized ? kScales : std::vector{0.1, 0.3, 1.0, 5.0, 10.0};
  for (const double scale : scales) {
    for (const HandleLoop& loop : kHandleLoops) {
      for (const bool back : {false, true}) {
        const double speed_mps = std::array{0.001, 0.02, 0.005}[static_cast<std::size_t>(cell) % 3];
        const double arm_m = std::array{0.0, 0.03, 0.1}[static_cast<std::size_t>(cell) % 3];
        const int axis = cell++ % 3 == 1 ? 0 : 2;  // over the block's foot, or high above it
        SCOPED_TRACE(testing::Message() << loop.name << (back ? " back" : "") << ", scale " << scale
                                        << ", " << speed_mps << " m/s, arm " << arm_m);
        HeldPart held(scene, part, flat_above_the_plane(arm_m, axis, scale));
        const LoopWork work = loop_work(held, loop, speed_mps, back);
        EXPECT_LE(work.given_j, work.sampled_j + kFreeJ);
        EXPECT_NEAR(work.reported_j, work.given_j, 1e-9);
        worked += work.moved_j > 1e-3;
        EXPECT_EQ(held.servo().output().trips(), 0u);
      }
    }
  }
  EXPECT_GT(worked, cell / 2);
}

// The same of a block that is installed on the plane, while its seat is open and once it has left
// it.
TEST(Grip, ClosedLoopsWithAnOpenSeatGiveTheHandNothing) {
  constexpr double kFreeJ = 2e-5;
  const VoxelScene scene = plane();
  const PointPart part = block();
  int cell = 0, worked = 0;
  for (const double scale : kScales) {
    for (const HandleLoop& loop : kHandleLoops) {
      const double speed_mps = cell % 2 == 0 ? 0.005 : 0.02;
      const double arm_m = std::array{0.0, 0.03, 0.1}[static_cast<std::size_t>(cell) % 3];
      const bool back = cell++ % 4 > 1;
      SCOPED_TRACE(testing::Message() << loop.name << (back ? " back" : "") << ", scale " << scale
                                      << ", " << speed_mps << " m/s, arm " << arm_m);
      HeldPart held(scene, part, seated_on_the_plane(arm_m, 2, scale));
      ASSERT_NE(held.servo().state().seat, kSeatClosed);
      const LoopWork work = loop_work(held, loop, speed_mps, back);
      EXPECT_LE(work.given_j, work.sampled_j + kFreeJ);
      EXPECT_NEAR(work.reported_j, work.given_j, 1e-9);
      worked += work.moved_j > 1e-3;
    }
  }
  EXPECT_GE(worked, static_cast<int>(kScales.size()));
  EXPECT_EQ(cell, 4 * static_cast<int>(kScales.size()));
}

// The push of a seat is that of a potential: a slow loop along metal costs the same both ways
// round. A push along the field's slope, some degrees aside of its gradient, gave the hand 47 uJ on
// one way round here, and took 89 on the other.
TEST(Grip, SlidingAlongASeatCostsTheSameBothWaysRound) {
  constexpr double kFreeJ = 2e-5;
  const HandleLoop& aslant = kHandleLoops[1];
  LoopWork work[2];
  for (const bool back : {false, true}) {
    HeldPart held(plane(), block(), seated_on_the_plane(0.03, 0, 0.1));
    work[back ? 1 : 0] = loop_work(held, aslant, 0.001, back);
    EXPECT_NE(held.servo().state().seat, kSeatClosed);
  }
  for (const LoopWork& one : work) EXPECT_LE(one.given_j, one.sampled_j + kFreeJ);
  EXPECT_NEAR(work[0].given_j, work[1].given_j, kFreeJ);
}

// The generated energy in the report is the peak of the work at the port in an episode, through
// ramp, clamp and slew, whatever the scale.
TEST(Grip, TheReportedEnergyIsThatOfThePort) {
  for (const double scale : {0.2, 1.0, 5.0}) {
    SCOPED_TRACE(scale);
    HeldPartOptions options = flat_above_the_plane(0.03, 0, scale);
    options.settings["coupling_ns_per_m"] = 0.01 / (scale * scale);  // a sampled spring gives
    HeldPart held(plane(), block(), options);
    const Pose from = press(held, 0.0005);
    const double before_j = held.frame().generated_j;  // by the press, in the same episode
    Random random(7);
    double peak_j = 0;
    Pose handle = from;
    for (int i = 0; i < 3000; ++i) {
      // A hand that jerks is given much, but stays in contact.
      if (i % 3 == 0) {
        handle.position_m = from.position_m + random_direction(random) * 0.001;
        handle.orientation =
            coupling::rotation_by(random_direction(random) * 0.05) * from.orientation;
      }
      const Frame& frame = held.tick(handle);
      const StepReport& report = frame.result.report;
      ASSERT_GT(report.surface + report.proximity, 0u);
      peak_j = std::max({before_j, peak_j, held.work().given_j});
      ASSERT_NEAR(frame.generated_j, peak_j, 1e-9) << i;
    }
    EXPECT_GT(peak_j, 1e-4);
  }
}

// A block that is thrown about a corner by hands of every speed: whatever the arm, no point gets
// into the interior, and when the hand rests the part comes to rest, or is where the hand has it.
TEST(Grip, ALongArmNeitherLeaksNorSwings) {
  const auto slab = [](const glm::dvec3& p, const glm::dvec3& center_m, const glm::dvec3& half_m) {
    const glm::dquat turned = coupling::rotation_by({0.15, 0.2, 0});
    const glm::dvec3 out_m = glm::abs(glm::conjugate(turned) * (p - center_m)) - half_m;
    return glm::length(glm::max(out_m, glm::dvec3(0))) +
           std::min(0.0, std::max({out_m.x, out_m.y, out_m.z}));
  };
  const VoxelScene corner = distance_scene(
      kS, {-40, -40, -24}, {80, 80, 60},
      [&](const glm::dvec3& p) {
        return std::min(slab(p, glm::dvec3(0, 0, -4) * kS, glm::dvec3(24, 24, 3) * kS),
                        slab(p, glm::dvec3(20, 0, 10) * kS, glm::dvec3(3, 24, 14) * kS));
      },
      2, DistanceDefinition(2));
  int touching = 0;
  for (const double arm_m : {0.0, 0.1, 0.3, 0.5}) {
    for (std::uint64_t seed = 1; seed <= (kSanitized ? 1 : 4); ++seed) {
      SCOPED_TRACE(testing::Message() << "arm " << arm_m << ", seed " << seed);
      Random random(seed);
      HeldPartOptions options;
      options.start = {glm::dvec3(-2.4, 0, 24) * kS, random_orientation(random)};
      options.part_from_handle = {random_direction(random) * arm_m, random_orientation(random)};
      HeldPart held(corner, block(), options);
      const Pose& grip = options.part_from_handle;
      Pose from = options.start, to = from, last;
      for (int i = 0; i < 12000; ++i) {
        if (i % 500 == 0 && i < 9000) {
          from = to;
          to.position_m =
              options.start.position_m * 0.6 + random_direction(random) * uniform(random, 0, 0.08);
          to.orientation = coupling::rotation_by(random_direction(random) * uniform(random, 0, 1)) *
                           options.start.orientation;
        }
        const double fraction = std::min(1.0, i % 500 / (seed % 2 == 1 ? 100.0 : 400.0));
        const Pose wanted{from.position_m + fraction * (to.position_m - from.position_m),
                          glm::normalize(glm::slerp(from.orientation, to.orientation, fraction))};
        const Pose handle = (i < 9000 ? wanted : to) * grip;
        const StepReport& report =
            held.tick(held.placement().device_from_handle(handle)).result.report;
        ASSERT_EQ(report.interior, 0u) << i;
        touching += report.contacts > 0;
        if (i >= 10500 && report.contacts > 0) {
          ASSERT_EQ(report.world_from_center.position_m, last.position_m) << i;
          ASSERT_EQ(report.world_from_center.orientation, last.orientation) << i;
        }
        last = report.world_from_center;
      }
      if (held.frame().result.report.contacts > 0) continue;
      const auto target = coupling::grip_target(held.servo().state(), held.frame().input);
      EXPECT_LT(glm::length(coupling::grip_stretch_m(target, last)), 1e-4);
      EXPECT_LT(glm::length(coupling::rotation_vector(target.orientation *
                                                      glm::conjugate(last.orientation))),
                1e-3);
    }
  }
  EXPECT_GT(touching, 10000);
}

}  // namespace
}  // namespace forcelayer::test
