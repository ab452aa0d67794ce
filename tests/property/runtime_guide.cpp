// The guide: a path that leads the hand. The nearest place on it against a slow twin; its law, its
// limits and its energy under hands, faults and buttons of all kinds; the servo with it.
#include "runtime/loop/guide.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "runtime/coupling/coupling.h"
#include "runtime/coupling/passivity.h"
#include "tests/support/random_scenes.h"

namespace forcelayer::test {
namespace {

constexpr double kDt = 0.001;

loop::GuideLimits limits_of(double force_n) {
  loop::GuideLimits limits;
  limits.force_n = force_n;
  limits.torque_nm = loop::kGuideLeverM * force_n;
  return limits;
}

// A path that winds: rows some centimeters and tenths of a radian apart.
std::vector<Pose> random_path(Random& random, int rows) {
  std::vector<Pose> path{{random_direction(random) * 0.1, random_orientation(random)}};
  for (int i = 1; i < rows; ++i) {
    Pose next = path.back();
    next.position_m += random_direction(random) * uniform(random, 0.001, 0.05);
    next.orientation = coupling::rotation_by(random_direction(random) * uniform(random, 0, 0.6)) *
                       next.orientation;
    path.push_back(next);
  }
  return path;
}

double distance_m(const Pose& a, const Pose& b, double scale) {
  const double chord = std::sqrt(
      std::max(0.0, 2 - 2 * std::min(1.0, std::abs(glm::dot(a.orientation, b.orientation)))));
  return std::hypot(glm::distance(a.position_m, b.position_m) / scale,
                    2 * loop::kGuideLeverM * chord);
}

// The slow twin: every row's motion by linear and spherical interpolation, in small steps.
double min_distance_m(const std::vector<Pose>& rows, const Pose& pose, double scale) {
  constexpr int kSteps = 400;
  double smallest = distance_m(rows.front(), pose, scale);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    for (int n = 1; n <= kSteps; ++n) {
      const double fraction = n / double{kSteps};
      const Pose there{glm::mix(rows[i - 1].position_m, rows[i].position_m, fraction),
                       glm::slerp(rows[i - 1].orientation, rows[i].orientation, fraction)};
      smallest = std::min(smallest, distance_m(there, pose, scale));
    }
  }
  return smallest;
}

Pose near(const Pose& pose, Random& random, double way_m, double turn_rad) {
  return {pose.position_m + random_direction(random) * way_m,
          coupling::rotation_by(random_direction(random) * turn_rad) * pose.orientation};
}

TEST(GuidePath, TheNearestPlaceIsAsNearAsThatOfASlowSearch) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const double scale = seed % 3 == 0 ? 4 : 1;
    const auto rows = random_path(random, 2 + static_cast<int>(seed % 9));
    const loop::GuidePath path(rows, limits_of(0.5), scale);
    const double step_m = path.length_m() / static_cast<double>(path.places() - 1);
    EXPECT_LE(step_m, loop::GuidePath::kStepM * 1.000001);
    for (int n = 0; n < 20; ++n) {
      const Pose pose = near(path.at(uniform(random, 0, path.length_m())), random,
                             uniform(random, 0, 0.03), uniform(random, 0, 2));
      const double s_m = path.nearest(pose);
      const double ours = distance_m(path.at(s_m), pose, scale);
      // Corners between rows are cut by half a step at most, and the twin's steps are of 0.3 mm.
      EXPECT_NEAR(ours, min_distance_m(rows, pose, scale), 0.5 * loop::GuidePath::kStepM);
      EXPECT_EQ(path.nearest(pose, s_m, s_m), s_m);
      EXPECT_EQ(path.nearest({pose.position_m, -pose.orientation}), s_m);
    }
  }
}

TEST(GuidePath, ItsEndsAndEvenDistances) {
  Random random(7);
  const auto rows = random_path(random, 5);
  const loop::GuidePath path(rows, limits_of(0.5), 1);
  for (const auto& [s_m, pose] :
       {std::pair{-1.0, rows.front()}, std::pair{0.0, rows.front()},
        std::pair{path.length_m(), rows.back()}, std::pair{path.length_m() + 1, rows.back()}}) {
    EXPECT_LT(distance_m(path.at(s_m), pose, 1), 1e-7);
  }
  // A single row, twice the same, and one longer than the places reach.
  const loop::GuidePath still(std::vector<Pose>{rows[0]}, limits_of(0.5), 1);
  EXPECT_EQ(still.length_m(), 0);
  EXPECT_EQ(still.nearest(rows[3]), 0);
  EXPECT_LT(distance_m(still.at(0.3), rows[0], 1), 1e-7);
  Pose far = rows[0];
  far.position_m.x += 100;
  const loop::GuidePath longest(std::vector<Pose>{rows[0], far}, limits_of(0.5), 1);
  EXPECT_EQ(longest.places(), loop::GuidePath::kMaxPlaces);
  EXPECT_NEAR(longest.nearest(far), 100, 1e-9);
}

// A guide and the hand that it leads.
struct Led {
  std::vector<Pose> rows;
  loop::GuideLimits limits;
  double scale;
  loop::GuidePath path;
  loop::Guide guide;
  loop::GuideFrame frame;
  Pose handle_from_center;

  Led(Random& random, double its_scale, double force_n)
      : rows(random_path(random, 6)),
        limits(limits_of(force_n)),
        scale(its_scale),
        path(rows, limits, its_scale),
        guide(path, limits, its_scale),
        handle_from_center{random_direction(random) * 0.05, random_orientation(random)} {
    frame.handle_from_center = handle_from_center;
    frame.max_force_n = 3;
    frame.max_torque_nm = 0.1;
    frame.sound = true;
    put(rows.front());
  }
  void put(const Pose& center) { frame.world_from_handle = center * inverse(handle_from_center); }
  Pose center() const { return frame.world_from_handle * handle_from_center; }
  Wrench tick(double gain = 1) {
    const Wrench pull = guide.pull(frame, kDt);
    guide.leave(gain);
    return pull;
  }
};

// A hand that gives way is led to the end: whatever path, grip and scale.
TEST(Guide, LeadsAHandThatGivesWayToTheEnd) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Led led(random, seed % 2 == 0 ? 3 : 1, 0.3);
    constexpr double kDamping = 4, kTurnDamping = 0.002;  // of the hand, N s/m and N m s
    for (int i = 0; i < 30'000; ++i) {
      const Wrench pull = led.tick();
      Pose& hand = led.frame.world_from_handle;
      hand.position_m += pull.force_n * (led.scale * kDt / kDamping);
      hand.orientation = glm::normalize(
          coupling::rotation_by(pull.torque_nm * (kDt / kTurnDamping)) * hand.orientation);
    }
    EXPECT_LT(distance_m(led.center(), led.rows.back(), led.scale), 1e-3);
    EXPECT_GT(led.guide.given_j(), 0);
    EXPECT_LE(led.guide.given_j(), led.guide.allowed_j());
  }
}

// A hand that stays: the anchor waits, and so does the pull.
TEST(Guide, AHandThatStaysIsPulledNoFartherAlong) {
  Random random(3);
  Led led(random, 1, 0.3);
  for (int i = 0; i < 5000; ++i) led.tick();
  const Wrench then = led.tick();
  for (int i = 0; i < 5000; ++i) led.tick();
  const Wrench now = led.tick();
  EXPECT_EQ(now.force_n, then.force_n);
  EXPECT_EQ(now.torque_nm, then.torque_nm);
  const Pose ahead =
      led.path.at(led.guide.at_m() + led.limits.reach_m) * inverse(led.handle_from_center);
  const glm::dvec3 gap_m = ahead.position_m - led.frame.world_from_handle.position_m;
  const double pull_n =
      std::min(led.limits.force_n, glm::length(gap_m) * led.limits.force_n / led.limits.reach_m);
  EXPECT_LT(glm::distance(now.force_n, glm::normalize(gap_m) * pull_n), 1e-9);
  EXPECT_EQ(led.guide.given_j(), 0);
}

// Hands that go anywhere and shake, contacts, faults, buttons, gains and clutches: the pull is
// within its limits and what the contact leaves, and the work within its budget.
TEST(Guide, LimitsAndEnergyUnderEverything) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const double scale = seed % 4 == 0 ? 5 : 1;
    Led led(random, scale, uniform(random, 0.05, 1));
    const double max_force_n = seed % 3 == 0 ? 0.4 : 3;
    led.frame.max_force_n = max_force_n;
    double sum_j = 0, work_j = 0;
    Wrench left;
    Pose last = led.frame.world_from_handle;
    glm::dvec3 drift = random_direction(random), spin = random_direction(random);
    for (int i = 0; i < 20'000; ++i) {
      if (uniform(random, 0, 1) < 0.003) {
        drift = random_direction(random) * uniform(random, 0, 1.5);
        spin = random_direction(random) * uniform(random, 0, 10);
      }
      if (uniform(random, 0, 1) < 0.001) led.frame.wanted = !led.frame.wanted;
      // A hand that takes what it can: it goes where it is pulled, but returns the long way round.
      Pose& hand = led.frame.world_from_handle;
      const glm::dvec3 greedy = seed % 2 == 0 ? led.guide.left().force_n : glm::dvec3(0);
      hand.position_m += (drift + greedy * 2.0) * (scale * kDt);
      const glm::dvec3 home = led.rows[2].position_m - hand.position_m;
      if (glm::length(home) > 0.2 * scale) drift = glm::normalize(home);
      hand.orientation = glm::normalize(coupling::rotation_by(spin * kDt) * hand.orientation);
      led.frame.sound = uniform(random, 0, 1) > 0.0005;
      led.frame.placed = led.frame.sound || uniform(random, 0, 1) < 0.5;
      const bool touches = i / 500 % 3 == 0;
      led.frame.contact = {};
      if (touches) {
        led.frame.contact = {random_direction(random) * uniform(random, 0, 4),
                             random_direction(random) * uniform(random, 0, 0.15)};
      }
      const bool placed = led.frame.placed;
      const double step_j =
          placed ? coupling::held_work_j({left.force_n / scale, left.torque_nm}, last, hand) : 0;
      const double before_j = led.guide.given_j();
      const double gain = uniform(random, 0, 1);
      const Wrench pull = led.tick(gain);
      EXPECT_EQ(led.guide.left().force_n, pull.force_n * gain);
      EXPECT_EQ(led.guide.left().torque_nm, pull.torque_nm * gain);
      sum_j += step_j;
      work_j += led.guide.work_j();
      EXPECT_LE(led.guide.given_j() - before_j, std::max(0.0, step_j) + 1e-12);
      if (placed) last = hand;
      left = led.guide.left();
      if (!led.frame.sound) {
        EXPECT_EQ(pull.force_n, glm::dvec3(0));
        EXPECT_EQ(left.torque_nm, glm::dvec3(0));
      }
      const double force_n = glm::length(pull.force_n),
                   contact_n = glm::length(led.frame.contact.force_n);
      ASSERT_LE(force_n, led.limits.force_n * (1 + 1e-12));
      ASSERT_LE(glm::length(pull.torque_nm), led.limits.torque_nm * (1 + 1e-12));
      ASSERT_LE(force_n, std::max(0.0, max_force_n - contact_n) + 1e-12);
      const double contact_nm = glm::length(led.frame.contact.torque_nm);
      ASSERT_LE(glm::length(pull.torque_nm),
                std::max(0.0, led.frame.max_torque_nm - contact_nm) + 1e-12);
      if (contact_n >= led.limits.force_n) {
        ASSERT_GE(glm::dot(pull.force_n, led.frame.contact.force_n), -1e-12);
      }
      ASSERT_LE(led.guide.given_j(), led.guide.allowed_j());
    }
    EXPECT_NEAR(sum_j, work_j, 1e-12 + 1e-9 * std::abs(work_j));
  }
}

// The budget is what holds: a hand that goes along with the pull and comes back where the guide
// does not follow, again and again, takes no more out than the path's length allows.
TEST(Guide, ALoopOfTheHandTakesNoMoreThanThePathIsLong) {
  const std::vector<Pose> there_and_back = {{{0, 0, 0}, {1, 0, 0, 0}},
                                            {{0.2, 0, 0}, {1, 0, 0, 0}},
                                            {{0.2, 0.01, 0}, {1, 0, 0, 0}},
                                            {{0, 0.01, 0}, {1, 0, 0, 0}}};
  const loop::GuideLimits limits = limits_of(0.5);
  loop::Guide guide(loop::GuidePath(there_and_back, limits, 1), limits, 1);
  loop::GuideFrame frame;
  frame.max_force_n = 3;
  frame.max_torque_nm = 0.1;
  frame.sound = true;
  const double max_j = limits.force_n * (limits.reach_m + guide.length_m());
  double sum_j = 0;
  for (int round = 0; round < 40; ++round) {
    for (int i = 0; i < 10'000; ++i) {  // along both legs at 0.04 m/s, and across at the beginning
      const double x = 4e-5 * (i < 5000 ? i : 10'000 - i);
      frame.world_from_handle.position_m = {x, i < 5000 ? 0 : 0.01, 0};
      guide.pull(frame, kDt);
      guide.leave(1);
      sum_j += guide.work_j();
    }
    ASSERT_LE(guide.given_j(), max_j);
  }
  EXPECT_GT(guide.given_j(), 0.5 * limits.force_n * 0.2);
  EXPECT_LE(sum_j, max_j);
}

// Off at the button within fade_s, and on again over ramp_s; off at once in the frame of a fault.
TEST(Guide, TheButtonFadesItAndAFaultEndsItAtOnce) {
  Random random(5);
  Led led(random, 1, 0.5);
  for (int i = 0; i < 1500; ++i) led.tick();
  const double full_n = glm::length(led.tick().force_n);
  ASSERT_GT(full_n, 0.1);
  led.frame.wanted = false;
  double last_n = full_n;
  for (int i = 0; i < 50; ++i) {
    const double now_n = glm::length(led.tick().force_n);
    EXPECT_LT(now_n, last_n + 1e-9);
    last_n = now_n;
  }
  for (int i = 0; i < 100; ++i) EXPECT_EQ(glm::length(led.tick().force_n), 0);
  led.frame.wanted = true;
  for (int i = 0; i < 100; ++i) led.tick();
  EXPECT_LT(glm::length(led.tick().force_n), 0.15 * full_n);
  for (int i = 0; i < 1500; ++i) led.tick();
  EXPECT_NEAR(glm::length(led.tick().force_n), full_n, 1e-9);
  led.frame.sound = false;
  EXPECT_EQ(led.tick().force_n, glm::dvec3(0));
  led.frame.sound = true;
  EXPECT_LT(glm::length(led.tick().force_n), 0.01 * full_n);
}

}  // namespace
}  // namespace forcelayer::test
