// The default model under stress, in scenes of every kind of voxels, small in the normal run;
// FORCELAYER_LONG_TESTS=1 multiplies the trials by twenty. Every failure names the case and the
// seed.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <random>
#include <string>
#include <tuple>

#include "runtime/coupling/coupling.h"
#include "tests/stress/cases.h"
#include "tests/stress/exact_distance.h"
#include "tests/stress/shapes.h"

namespace forcelayer::stress {
namespace {

bool long_run() { return std::getenv("FORCELAYER_LONG_TESTS") != nullptr; }

std::uint64_t trials(std::uint64_t small) { return long_run() ? 20 * small : small; }

// Promises that every trial keeps: never inside, never beyond the limits, no value but finite ones,
// the exact meshes never nearer than the printed guarantee, and nothing that grows while the hand
// is held still.
void expect_safe(const Metrics& m, const std::string& what) {
  for (std::size_t i = 0; i < m.swing_last_voxels.size(); ++i) {
    // A thousandth of a voxel: far below what a hand feels, far above rounding.
    EXPECT_LE(m.swing_last_voxels[i], std::max(1e-3, m.swing_third_voxels[i])) << what;
  }
  EXPECT_EQ(m.penetration_frames, 0u) << what;
  EXPECT_EQ(m.non_finite, 0u) << what;
  EXPECT_EQ(m.over_limit, 0u) << what;
  if (m.distances_visited > 0) {
    EXPECT_GE(m.smallest_distance_m, m.guaranteed_m) << what;
    EXPECT_GT(m.guaranteed_m, 0) << what;
  }
}

// The judge itself: two faceted spheres against what the spheres would have, and a bound on the
// search changes nothing below it.
TEST(ExactDistance, IsThatOfTheMeshesWithAndWithoutABound) {
  const mesh::Mesh ball = sphere(0.02, 48);
  const ExactDistance exact(ball, ball);
  for (int i = 0; i < 40; ++i) {
    const double gap_m = 0.0005 * i;
    const Pose pose{coupling::rotation_by({0.1 * i, 0.2, 0.3}) * glm::dvec3(0, 0, 0.04 + gap_m),
                    coupling::rotation_by({0.3, 0.1 * i, 0})};
    const double distance_m = exact.at(pose);
    // Chords of 48 segments lie up to r (1 - cos(pi/48)) inside the sphere, on either side.
    EXPECT_GE(distance_m, gap_m - 1e-12);
    EXPECT_LE(distance_m, gap_m + 4 * 0.02 * (1 - std::cos(M_PI / 48)));
    for (const double bound_m : {0.001, 0.005, 0.02}) {
      EXPECT_DOUBLE_EQ(exact.at(pose, bound_m), std::min(distance_m, bound_m));
    }
  }
}

// The poses that the judge leaves out are not the smallest: along random paths, one by one with
// the smallest of all before as bound, it finds what measuring every pose to the end finds.
TEST(PathDistance, FindsTheSmallestOfAllPoses) {
  const mesh::Mesh scene = sphere(0.05, 16), part = box({0.02, 0.012, 0.006});
  const double radius_m = glm::length(glm::dvec3(0.02, 0.012, 0.006));
  const ExactDistance exact(scene, part);
  double smallest_m = 1e300, truth_m = 1e300;
  std::uint64_t measured = 0, visited = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    std::mt19937_64 random(seed);
    const auto uniform = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    const auto vector = [&](double size) {
      return glm::dvec3(uniform(-size, size), uniform(-size, size), uniform(-size, size));
    };
    PathDistance path(exact, radius_m, smallest_m);
    // Straight to a place nearer than all before and back, or a walk that is drawn to it, fast or
    // slow.
    const double step_m = std::pow(10, uniform(-5, -3));
    const glm::dvec3 goal = glm::normalize(vector(1)) * (0.1 - 0.002 * double(seed));
    const Pose start{goal * 1.5, coupling::rotation_by(vector(3))};
    Pose pose = start;
    for (int i = 0; i < 300; ++i) {
      if (seed % 2 == 0) {
        const double fraction = 1 - std::abs(i - 150) / 150.0;
        pose.position_m = start.position_m + fraction * (goal - start.position_m);
      } else {
        pose.position_m += 0.05 * (goal - pose.position_m) + vector(step_m);
        pose.orientation =
            glm::normalize(coupling::rotation_by(vector(10 * step_m)) * pose.orientation);
      }
      path.visit(pose, {0, 0, 0});
      truth_m = std::min(truth_m, exact.at(pose));
      ASSERT_DOUBLE_EQ(path.smallest_m(), truth_m) << "seed " << seed << " pose " << i;
    }
    smallest_m = path.smallest_m();
    measured += path.measured();
    visited += path.visited();
  }
  EXPECT_LT(measured, 3 * visited / 4);  // else it leaves nothing out
}

using KindAndCase = std::tuple<test::VoxelKind, Case>;
// Whether the part swung more at the end of a hold than before.
bool grew(const Metrics& m) {
  for (std::size_t i = 0; i < m.swing_last_voxels.size(); ++i) {
    if (m.swing_last_voxels[i] > std::max(1e-3, m.swing_third_voxels[i])) return true;
  }
  return false;
}

// Kilograms on next to no damping are on their way, or turn instead of moving, for longer than the
// three seconds of a hold where the field is so smooth that nothing else takes their energy. What
// is unstable goes on growing: it is held for sixteen times as long, and judged then.
Metrics run_extremes(Trial trial) {
  const Metrics m = run(trial, Model::kDefault);
  if (!grew(m) || trial.voxels == test::VoxelKind::kChebyshev) return m;
  trial.duration_s += 15 * (trial.duration_s - *trial.hold_from_s);
  return run(trial, Model::kDefault);
}

class EveryCase : public ::testing::TestWithParam<KindAndCase> {};

TEST_P(EveryCase, StaysOutsideWithinLimitsAndApart) {
  const auto& [kind, family] = GetParam();
  // The nut's threads are close to the bolt's all the way: thousands of exact distances in a trial;
  // and a trial of collisions is twenty seconds long.
  const bool dear = family.name == "nut-on-bolt" || family.name == "collisions";
  Metrics sum;
  for (std::uint64_t seed = 1; seed <= trials(dear ? 1 : 3); ++seed) {
    Trial trial = family.make(seed);
    trial.voxels = kind;
    const Metrics m = family.name == "extremes" ? run_extremes(trial) : run(trial, Model::kDefault);
    expect_safe(m, std::string(family.name) + " seed " + std::to_string(seed));
    sum.add(m);
  }
  // A trial that starts inside tells nothing, and neither does one without contact.
  EXPECT_LT(sum.starts_inside, sum.trials);
  EXPECT_GT(sum.force_layer_frames, 0u);
}

std::string test_name(const ::testing::TestParamInfo<KindAndCase>& info) {
  const auto& [kind, family] = info.param;
  std::string name = test::name_of(kind) + ("_" + std::string(family.name));
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
}
INSTANTIATE_TEST_SUITE_P(Stress, EveryCase,
                         ::testing::Combine(::testing::ValuesIn(test::kVoxelKinds),
                                            ::testing::ValuesIn(all_cases())),
                         test_name);

class EveryKind : public ::testing::TestWithParam<test::VoxelKind> {
 protected:
  // As the trial is, but for exact distances, in voxels of the kind.
  static Metrics run_here(Trial trial) {
    trial.voxels = GetParam();
    trial.exact_distance = false;
    return run(trial, Model::kDefault);
  }
};
INSTANTIATE_TEST_SUITE_P(Stress, EveryKind, ::testing::ValuesIn(test::kVoxelKinds),
                         [](const auto& kind) { return test::name_of(kind.param); });

// Hands of every temper through congested scenes: a hundred million frames in the long run.
TEST_P(EveryKind, RandomHandsNeverGetInside) {
  const std::uint64_t frames = long_run() ? 100'000'000 : 100'000;
  Metrics sum;
  for (std::uint64_t seed = 1000; sum.frames < frames; ++seed) {
    const Metrics m = run_here(case_named("random-hand").make(seed));
    expect_safe(m, "random hand seed " + std::to_string(seed));
    sum.frames += m.frames;
    sum.force_layer_frames += m.force_layer_frames;
  }
  std::printf("%llu frames, %llu in the force layer\n", static_cast<unsigned long long>(sum.frames),
              static_cast<unsigned long long>(sum.force_layer_frames));
}

// Position peak to peak below 1e-6 voxel and force below 1e-6 N, from every start.
// In a soft covering some come in slowly, where its foot is soft.
TEST_P(EveryKind, RestIsQuietInEveryTrial) {
  const bool covered = GetParam() == test::VoxelKind::kCovered;
  for (std::uint64_t seed = 1; seed <= trials(60); ++seed) {
    Trial trial = rest_trial(seed);
    if (covered) trial.duration_s += 3;
    const Metrics m = run_here(trial);
    expect_safe(m, "rest seed " + std::to_string(seed));
    for (const double cycle : m.cycle_voxels) EXPECT_LT(cycle, 1e-6) << "seed " << seed;
    for (const double force : m.cycle_force_n) EXPECT_LT(force, 1e-6) << "seed " << seed;
    for (const double settle : m.settle_s) EXPECT_LT(settle, covered ? 2.5 : 1) << "seed " << seed;
  }
}

TEST_P(EveryKind, SlidingKeepsUpWithTheHandAtOneAndEightVoxelsOfDepth) {
  for (const double depth : {1.0, 8.0}) {
    Metrics sum;
    for (std::uint64_t seed = 1; seed <= trials(20); ++seed) {
      sum.add(run_here(slide_trial(seed, depth)));
    }
    expect_safe(sum, "slide");
    EXPECT_GE(percentile(sum.progress, 50), depth < 2 ? 0.95 : 0.9) << depth;
    EXPECT_GE(percentile(sum.progress, 10), depth < 2 ? 0.95 : 0.9) << depth;
  }
}

TEST_P(EveryKind, APegGoesInFromHalfAVoxelOfClearance) {
  for (const double clearance : {0.5, 1.0, 2.0, 5.0, 10.0}) {
    Metrics sum;
    for (std::uint64_t seed = 1; seed <= trials(10); ++seed) {
      sum.add(run_here(peg_trial(seed, clearance)));
    }
    expect_safe(sum, "peg");
    EXPECT_GE(percentile(sum.progress, 10), 0.9) << clearance;
  }
}

// The clamp is what the device bears, not a multiple of the voxel: 15 N hold with 5, 2 and 1 mm.
TEST_P(EveryKind, APressHoldsFifteenNewtonsWithEveryVoxelSize) {
  for (const double s : {0.005, 0.002, 0.001}) {
    for (std::uint64_t seed = 1; seed <= trials(4); ++seed) {
      Trial trial = press_trial(seed, s);
      if (GetParam() == test::VoxelKind::kCovered) trial.duration_s += 12;  // one creeps for 5 s
      const Metrics m = run_here(trial);
      expect_safe(m, "press seed " + std::to_string(seed));
      ASSERT_EQ(m.rest_force_n.size(), 1u);
      EXPECT_NEAR(m.rest_force_n[0], 15, 1e-6) << s << " seed " << seed;
      EXPECT_LT(m.cycle_voxels[0], 1e-6) << s << " seed " << seed;
    }
  }
}

// A hand that moves slowly enough for the part to follow gets no energy from the scene. A soft
// covering begins farther out: 4 of 240 hands, which set off all at once, reach it while the part
// still catches up, and get 4 uJ to 0.35 mJ of its kinetic energy before anything touches.
TEST_P(EveryKind, ASlowHandIsGivenNothing) {
  const double max_j = GetParam() == test::VoxelKind::kCovered ? 1e-3 : 1e-6;
  for (const char* name : {"press-hold", "wedge", "sphere-in-cone"}) {
    for (std::uint64_t seed = 1; seed <= trials(4); ++seed) {
      EXPECT_LT(run_here(case_named(name).make(seed)).generated_j, max_j)
          << name << " seed " << seed;
    }
  }
}

// On request a controller takes back energy that the scene gave to the hand: less is generated with
// it than without, whatever the model, and the hand feels no more than the device's limit.
TEST(Passivity, TheControllerLowersWhatIsGenerated) {
  for (const Model model : {Model::kPaper, Model::kDefault}) {
    double without_j = 0, with_j = 0;
    for (std::uint64_t seed = 1; seed <= trials(2); ++seed) {
      Trial trial = case_named("shaking-hand").make(seed);
      trial.exact_distance = false;
      without_j += run(trial, model).generated_j;
      trial.settings["passivity_damping_ns_per_m"] = 2;
      const Metrics controlled = run(trial, model);
      with_j += controlled.generated_j;
      if (model == Model::kDefault) expect_safe(controlled, "controlled");
    }
    EXPECT_LT(with_j, without_j);
  }
}

}  // namespace
}  // namespace forcelayer::stress
