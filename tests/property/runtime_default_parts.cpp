// The parts of the default model, each against what it must be.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "runtime/contact_force.h"
#include "runtime/coupling_angle.h"
#include "runtime/handle_velocity.h"
#include "runtime/motion_allowance.h"
#include "runtime/passivity.h"
#include "runtime/principal_inertia.h"
#include "runtime/rigid_body.h"
#include "tests/support/motion_bench.h"

namespace forcelayer::test {
namespace {

glm::dmat3 random_inertia(std::mt19937_64& random) {
  PrincipalInertia inertia;
  inertia.axes = glm::mat3_cast(random_orientation(random));
  for (int axis = 0; axis < 3; ++axis) {
    inertia.moments[axis] = std::pow(10.0, uniform(random, -6, -3));
  }
  return tensor_of(inertia);
}

Vector6 random_vector(std::mt19937_64& random) {
  return vector6(random_direction(random), random_direction(random) * 20.0);
}

StepSystem random_system(std::mt19937_64& random) {
  StepSystem system;
  const glm::dmat3 inertia = random_inertia(random);
  for (int row = 0; row < 3; ++row) {
    system.inertia.lower[Symmetric6::at(row, row)] = 0.012;
    for (int column = 0; column <= row; ++column)
      system.inertia.lower[Symmetric6::at(3 + row, 3 + column)] = inertia[column][row];
  }
  system.momentum = system.inertia * random_vector(random);
  system.translation = {2000, glm::dmat3(8.0), 15};
  system.rotation = {0.5, glm::dmat3(1e-3), 0.1};
  system.displacement.displacement = random_direction(random) * uniform(random, 0, 0.02);
  system.angle.displacement = random_direction(random) * uniform(random, 0, 1);
  system.dt_s = 0.001;
  return system;
}

std::vector<ContactRow> random_rows(std::mt19937_64& random) {
  std::vector<ContactRow> rows(static_cast<std::size_t>(uniform(random, 0, 40)));
  for (ContactRow& row : rows) {
    const glm::dvec3 n = random_direction(random);
    row.j = vector6(n, glm::cross(random_direction(random) * 0.03, n));
    row.weight = std::pow(10.0, uniform(random, -4, 1));
    row.onset = uniform(random, -1, 1);
  }
  return rows;
}

ContactRows columns_of(const std::vector<ContactRow>& rows) {
  ContactRows columns;
  columns.reserve(rows.size());
  for (const ContactRow& row : rows) columns.add(row);
  return columns;
}

void use_vectors(std::int64_t targets) {  // 0: all
  hwy::SetSupportedTargetsForTest(targets);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

// Every vector width gives the bits of the narrowest, and these are what one row after the other
// gives, but for the order of the sums; a set of rows that push that comes again, or changes, is
// noticed.
TEST(ContactRows, AreSummedAsOneAfterTheOther) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const std::vector<ContactRow> rows = random_rows(random);
    const Vector6 velocities[] = {random_vector(random), random_vector(random)};
    std::vector<double> energies_j;  // of the first width, then of all others
    std::vector<ContactRowSum> sums;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      use_vectors(target);
      ContactRows columns = columns_of(rows);
      const bool first = energies_j.size() < 4;
      for (const int at : {0, 1, 2, 3}) {
        const int which = at == 1 || at == 2;
        const Vector6& v = velocities[which];
        double energy_j = 0;
        ContactRowSum sum;
        for (const ContactRow& row : rows) {
          const double short_of = row.onset - dot(row.j, v);
          if (!(short_of > 0)) continue;
          energy_j += 0.5 * row.weight * short_of * short_of;
          sum.matrix.add_outer(row.j, row.weight);
          for (int i = 0; i < 6; ++i) sum.impulse[i] += row.weight * row.onset * row.j[i];
        }
        const double found_j = columns.energy_j(v);
        const ContactRowSum& found = columns.pushing();
        EXPECT_NEAR(found_j, energy_j, 1e-14 * energy_j);
        const double scale = sum.matrix.lower[0] + sum.matrix.lower[2] + sum.matrix.lower[5];
        for (std::size_t i = 0; i < 21; ++i) {
          EXPECT_NEAR(found.matrix.lower[i], sum.matrix.lower[i], 1e-14 * scale) << i;
        }
        for (std::size_t i = 0; i < 6; ++i) {
          EXPECT_NEAR(found.impulse[i], sum.impulse[i], 1e-14 * scale) << i;
        }
        if (first) energies_j.push_back(found_j), sums.push_back(found);
        EXPECT_EQ(found_j, energies_j[at]);
        EXPECT_EQ(0, std::memcmp(&found, &sums[at], sizeof found));
      }
    }
    use_vectors(0);
  }
}

// At the solution the impulses balance: M (v - v0) = dt (coupling at v) + sum of contact impulses,
// with the clamp's secant at v itself.
TEST(ContactSolver, BalancesImpulsesAtTheEndOfTheStep) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const StepSystem system = random_system(random);
    const std::vector<ContactRow> rows = random_rows(random);
    ContactRows columns = columns_of(rows);
    const Vector6 v = solve_velocity(system, columns, random_vector(random));
    Symmetric6 matrix = system.inertia;
    Vector6 residual = system.momentum;
    add_implicit(system.translation, system.displacement, linear_part(v), system.dt_s, 0, matrix,
                 residual);
    add_implicit(system.rotation, system.angle, angular_part(v), system.dt_s, 3, matrix, residual);
    const Vector6 inner = matrix * v;
    double scale = 0, error = 0;
    for (const ContactRow& row : rows) {
      const double push = row.weight * std::max(0.0, row.onset - dot(row.j, v));
      for (int i = 0; i < 6; ++i) residual[i] += push * row.j[i];
    }
    for (int i = 0; i < 6; ++i) {
      const double unit = 1 / std::sqrt(system.inertia.lower[Symmetric6::at(i, i)]);
      error = std::max(error, std::abs(residual[i] - inner[i]) * unit);
      scale = std::max(scale, std::abs(inner[i]) * unit);
    }
    // The secant of the clamp converges linearly: the iterations leave a few hundred-thousandths.
    EXPECT_LT(error, 1e-4 * scale);
  }
}

// What the solver minimises, written out, for damping that is the same in all directions.
double energy_j(const StepSystem& system, const std::vector<ContactRow>& rows, const Vector6& v) {
  double sum = 0.5 * dot(v, system.inertia * v) - dot(v, system.momentum);
  const auto add_coupling = [&](const CouplingHalf& half, const HalfStretch& stretch,
                                const glm::dvec3& velocity) {
    const double slope = half.damping[0][0] + system.dt_s * half.stiffness;
    const double force = glm::length(half.stiffness * stretch.displacement +
                                     half.damping * stretch.target_velocity - slope * velocity);
    sum += system.dt_s / slope *
           (force <= half.limit ? 0.5 * force * force : half.limit * (force - 0.5 * half.limit));
  };
  add_coupling(system.translation, system.displacement, linear_part(v));
  add_coupling(system.rotation, system.angle, angular_part(v));
  for (const ContactRow& row : rows) {
    const double short_of = std::max(0.0, row.onset - dot(row.j, v));
    sum += 0.5 * row.weight * short_of * short_of;
  }
  return sum;
}

TEST(ContactSolver, IsNeverWorseThanItsGuess) {
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const StepSystem system = random_system(random);
    std::vector<ContactRow> rows = random_rows(random);
    ContactRows columns = columns_of(rows);
    // A guess beyond reason, and one that is the solution but for hard rows that come to it.
    Vector6 guess = random_vector(random);
    if (seed % 2 == 0) {
      guess = solve_velocity(system, columns, guess);
      for (int i = 0; i < 12; ++i) {
        ContactRow row;
        row.j = vector6(random_direction(random), random_direction(random) * 0.03);
        row.weight = std::pow(10.0, uniform(random, 0, 5));
        row.onset = dot(row.j, guess) - std::pow(10.0, uniform(random, -12, -2));
        rows.push_back(row);
      }
      columns = columns_of(rows);
    }
    const Vector6 v = solve_velocity(system, columns, guess);
    const double before_j = energy_j(system, rows, guess), after_j = energy_j(system, rows, v);
    EXPECT_TRUE(std::isfinite(after_j));
    // The sums' own rounding: terms of both signs, each a few times the larger one.
    EXPECT_LE(after_j, before_j + 1e-14 * (std::abs(before_j) + 1));
  }
}

TEST(RigidBody, KeepsAngularMomentumAndItsEnergyInBounds) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    PrincipalInertia inertia{glm::mat3_cast(random_orientation(random)), {}};
    for (int axis = 0; axis < 3; ++axis) inertia.moments[axis] = uniform(random, 1e-5, 4e-5);
    RigidMass mass{0.012, tensor_of(inertia), {}};
    mass.inverse_inertia_1pkgm2 = glm::inverse(mass.inertia_kgm2);
    Pose pose{{0, 0, 0}, random_orientation(random)};
    Twist velocity{{0, 0, 0}, random_direction(random) * 20.0};
    const glm::dvec3 momentum =
        turned(mass.inertia_kgm2, pose.orientation) * velocity.angular_radps;
    const double energy_j = kinetic_energy_j(mass, pose.orientation, velocity);
    double lowest = energy_j, highest = energy_j;
    for (int step = 0; step < 100000; ++step) {
      pose = advance(mass, pose, velocity, 1e-3);
      const double now = kinetic_energy_j(mass, pose.orientation, velocity);
      lowest = std::min(lowest, now);
      highest = std::max(highest, now);
    }
    const glm::dvec3 after = turned(mass.inertia_kgm2, pose.orientation) * velocity.angular_radps;
    // Rounding of 1e5 turns of the momentum into the body and back.
    EXPECT_LT(glm::length(after - momentum), 1e-9 * glm::length(momentum));
    // The midpoint rule swings by about the square of the angle per step (0.02), without drift.
    EXPECT_GT(lowest, 0.999 * energy_j);
    EXPECT_LT(highest, 1.001 * energy_j);
  }
}

// The guard's promise is about the rotation that is made: whatever the body's shape, it turns by no
// more than it may, and gains no energy by being held.
TEST(RigidBody, TurnsByNoMoreThanItMay) {
  int held = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    RigidMass mass{0.012, random_inertia(random), {}};
    mass.inverse_inertia_1pkgm2 = glm::inverse(mass.inertia_kgm2);
    const Pose pose{{0, 0, 0}, random_orientation(random)};
    const double asked_rad = std::pow(10.0, uniform(random, -3, 0));
    Twist velocity{{0, 0, 0}, random_direction(random) * (asked_rad / 1e-3)};
    const double energy_before_j = kinetic_energy_j(mass, pose.orientation, velocity);
    Twist free = velocity;
    const auto turned_rad = [&](const Pose& to) {
      return glm::length(rotation_vector(to.orientation * glm::conjugate(pose.orientation)));
    };
    const Pose unbounded = advance(mass, pose, free, 1e-3);
    const Pose bounded = advance(mass, pose, velocity, 1e-3, asked_rad);
    EXPECT_LE(turned_rad(bounded), asked_rad * (1 + 1e-9));
    if (bounded.orientation != unbounded.orientation) {
      ++held;
      EXPECT_GE(turned_rad(bounded), asked_rad * (1 - 1e-9));
      EXPECT_LE(kinetic_energy_j(mass, bounded.orientation, velocity),
                energy_before_j * (1 + 1e-9));
    } else {
      EXPECT_LE(turned_rad(unbounded), asked_rad * (1 + 1e-9));
    }
  }
  EXPECT_GT(held, 300);
}

// A needle spun far too fast for the step: momentum may be lost, energy is not gained.
TEST(RigidBody, ARotationTooFastForTheStepGainsNoEnergy) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    RigidMass mass{0.012, random_inertia(random), {}};
    mass.inverse_inertia_1pkgm2 = glm::inverse(mass.inertia_kgm2);
    Pose pose{{0, 0, 0}, random_orientation(random)};
    Twist velocity{{0, 0, 0}, random_direction(random) * std::pow(10.0, uniform(random, 1, 4))};
    const double energy_j = kinetic_energy_j(mass, pose.orientation, velocity);
    for (int step = 0; step < 5000; ++step) {
      pose = advance(mass, pose, velocity, 1e-3);
      ASSERT_LT(kinetic_energy_j(mass, pose.orientation, velocity), 1.5 * energy_j) << step;
    }
  }
}

// A quarter of the step, a sixteenth of the error: second order.
TEST(RigidBody, AsymmetricRotationIsOfSecondOrder) {
  RigidMass mass{0.012, glm::dmat3(0), {}};
  mass.inertia_kgm2[0][0] = 1e-5, mass.inertia_kgm2[1][1] = 2e-5, mass.inertia_kgm2[2][2] = 3e-5;
  mass.inverse_inertia_1pkgm2 = glm::inverse(mass.inertia_kgm2);
  const auto end = [&](int steps) {
    Pose pose;
    Twist velocity{{0, 0, 0}, {3, 10, 1}};
    for (int i = 0; i < steps; ++i) pose = advance(mass, pose, velocity, 0.5 / steps);
    return pose.orientation;
  };
  const glm::dquat truth = end(500000);
  const auto error = [&](int steps) {
    return glm::length(rotation_vector(end(steps) * glm::conjugate(truth)));
  };
  EXPECT_NEAR(std::log2(error(500) / error(2000)) / 2, 2, 0.1);
}

TEST(PrincipalInertia, TakesTensorsApartAndTogether) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    std::mt19937_64 random(seed);
    const glm::dmat3 tensor = random_inertia(random);
    const glm::dmat3 again = tensor_of(principal_inertia(tensor));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        EXPECT_NEAR(again[i][j], tensor[i][j], 1e-14 * 1e-3) << "seed " << seed;
  }
}

// Braking takes energy and never turns a velocity round, for any motion and any points.
TEST(Braking, OnlyRemovesEnergyAndNeverReverses) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    StepSystem system = random_system(random);
    system.translation = {1, glm::dmat3(0), 0};
    system.rotation = {1, glm::dmat3(0), 0};  // no coupling
    const Vector6 before = solve(system.inertia, system.momentum);
    ContactSet set;
    set.reserve(30);
    for (set.count = 0; set.count < 30; ++set.count) {
      Contact& c = set.contacts[set.count];
      c.arm_m = glm::vec3(random_direction(random) * 0.03);
      c.direction = glm::vec3(random_direction(random));
      c.depth_m = static_cast<float>(-uniform(random, 0, 0.005));
    }
    ContactRow row;
    if (!braking_row(set, system.inertia, before, system.dt_s, row)) continue;
    ContactRows rows = columns_of({row});
    const Vector6 after = solve_velocity(system, rows, before);
    EXPECT_LE(dot(after, system.inertia * after),
              dot(before, system.inertia * before) * (1 + 1e-12));
    const double approach_before = -dot(row.j, before), approach_after = -dot(row.j, after);
    EXPECT_LE(approach_after, approach_before * (1 + 1e-12));
    EXPECT_GE(approach_after, -1e-9 * approach_before);
  }
}

TEST(CouplingAngle, GoesOnPastHalfATurnAndFadesBeforeAWholeOne) {
  glm::dvec3 last(0);
  for (double angle = 0; angle < 1.99 * M_PI; angle += 0.01) {
    const Pose target{{0, 0, 0}, rotation_by({0, 0, angle})};
    last = continuous_angle({}, target, last);
    EXPECT_NEAR(last.z, angle, 1e-9);
  }
  EXPECT_EQ(torque_share(M_PI), 1);
  EXPECT_EQ(torque_share(2 * M_PI), 0);
  EXPECT_NEAR(faded_angle_rad(2 * M_PI), M_PI / 4, 1e-12);  // half of the last quarter turn
}

TEST(Allowance, EndsAtZeroWhenTheHandRests) {
  const AllowanceLaw law{0.05, 0.01};
  double allowance_j = 0.05;
  int frames = 0;
  for (; allowance_j > 0 && frames < 10000; ++frames)
    allowance_j = faded_allowance_j(allowance_j, 0, law, 0.001);
  EXPECT_LT(frames, 300);  // ln(1e9) = 21 time constants
  EXPECT_LE(faded_allowance_j(0, 1e9, law, 0.001), law.limit_j);
}

// What the coupling had stretched unseen is not felt when contact begins, and never comes back.
TEST(Passivity, EntryIsContinuousAndWhatIsHeldBackOnlyShrinks) {
  glm::dvec3 held(0.01, 0, 0);
  EXPECT_EQ(glm::length(felt_stretch({0.01, 0, 0}, held, 0.001)), 0);
  EXPECT_NEAR(felt_stretch({0.03, 0, 0}, held, 0.001).x, 0.02, 1e-5);
  EXPECT_NEAR(felt_stretch({0.004, 0, 0}, held, 0.001).x, 0, 1e-12);
  EXPECT_LE(held.x, 0.004);
  EXPECT_NEAR(felt_stretch({0.01, 0, 0}, held, 0.001).x, 0.006, 1e-5);
  EXPECT_NEAR(felt_stretch({-0.01, 0, 0}, held, 0.001).x, -0.01, 1e-12);
  EXPECT_EQ(held.x, 0);
}

// The controller's damper takes no more than what was given, never drives, keeps within its limit,
// and follows the need within its time constant.
TEST(Passivity, TheControllerTakesBackWhatWasGivenAndNoMore) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const double limit = uniform(random, 0.1, 5), radius_m = uniform(random, 0.01, 0.1);
    EpisodeEnergy energy;
    Twist v{random_direction(random) * uniform(random, 0, 1),
            random_direction(random) * uniform(random, 0, 10)};
    double last = 0;
    for (int frame = 0; frame < 200; ++frame) {
      if (frame % 50 == 0) add_given(energy, uniform(random, -1e-3, 1e-3));
      const double before_j = energy.given_j;
      const Wrench damper = passivity_damping(energy, v, radius_m, limit, 0.001);
      const double power_w =
          glm::dot(damper.force_n, v.linear_mps) + glm::dot(damper.torque_nm, v.angular_radps);
      EXPECT_LE(power_w, 0);
      EXPECT_LE(-power_w * 0.001, std::max(0.0, before_j) * (1 + 1e-12));
      EXPECT_LE(glm::length(damper.force_n), limit * glm::length(v.linear_mps) * (1 + 1e-12));
      EXPECT_LE(std::abs(energy.damping_ns_per_m - last), limit * 0.001 / 0.006 * (1 + 1e-12));
      last = energy.damping_ns_per_m;
      add_given(energy, power_w * 0.001);
    }
    EXPECT_LE(energy.given_j, 1e-3);
  }
}

// With the hand at rest, or before any energy was given, it does nothing.
TEST(Passivity, TheControllerRestsWithTheHand) {
  EpisodeEnergy energy;
  add_given(energy, -1);
  const Wrench none = passivity_damping(energy, {{1, 0, 0}, {0, 0, 0}}, 0.1, 2, 0.001);
  EXPECT_EQ(none.force_n, glm::dvec3(0));
  add_given(energy, 2);
  const Wrench still = passivity_damping(energy, {}, 0.1, 2, 0.001);
  EXPECT_EQ(still.force_n, glm::dvec3(0));
  EXPECT_EQ(still.torque_nm, glm::dvec3(0));
}

TEST(HandleVelocityEstimate, DoesNotSeeAJumpAndEndsAtZero) {
  HandleVelocity estimate;
  Pose pose;
  for (int i = 0; i < 10; ++i) estimate.update(pose, 0.001);
  pose.position_m.x = 0.01;  // a centimetre in one tick
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(estimate.update(pose, 0.001).linear_mps, glm::dvec3(0)) << i;
  }
  for (int i = 0; i < 100; ++i) {
    pose.position_m.x += 1e-4;
    estimate.update(pose, 0.001);
  }
  Twist v;
  for (int i = 0; i < 200; ++i) v = estimate.update(pose, 0.001);
  EXPECT_EQ(v.linear_mps, glm::dvec3(0));
}

}  // namespace
}  // namespace forcelayer::test
