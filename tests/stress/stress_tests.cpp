// The default model under stress, small in the normal run; FORCELAYER_LONG_TESTS=1 multiplies the
// trials by twenty. Every failure names the case and the seed.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "tests/stress/cases.h"

namespace forcelayer::stress {
namespace {

std::uint64_t trials(std::uint64_t small) {
  return std::getenv("FORCELAYER_LONG_TESTS") != nullptr ? 20 * small : small;
}

// What no trial may break: never inside, never beyond the limits, never a value that is not finite,
// and the exact meshes never nearer than the printed guarantee.
void expect_safe(const Metrics& m, const std::string& what) {
  EXPECT_EQ(m.penetration_frames, 0u) << what;
  EXPECT_EQ(m.non_finite, 0u) << what;
  EXPECT_EQ(m.over_limit, 0u) << what;
  if (m.distances_visited > 0) {
    EXPECT_GE(m.smallest_distance_m, m.guaranteed_m) << what;
    EXPECT_GT(m.guaranteed_m, 0) << what;
  }
}

class EveryCase : public ::testing::TestWithParam<Case> {};

TEST_P(EveryCase, StaysOutsideWithinLimitsAndApart) {
  // The nut's threads are close to the bolt's all the way: thousands of exact distances in a trial.
  const std::uint64_t few = GetParam().name == "nut-on-bolt" ? 1 : 3;
  for (std::uint64_t seed = 1; seed <= trials(few); ++seed) {
    const std::string what = std::string(GetParam().name) + " seed " + std::to_string(seed);
    expect_safe(run(GetParam().make(seed), Model::kDefault), what);
  }
}

std::string test_name(const ::testing::TestParamInfo<Case>& info) {
  std::string name(info.param.name);
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
}
INSTANTIATE_TEST_SUITE_P(Stress, EveryCase, ::testing::ValuesIn(all_cases()), test_name);

// Position peak to peak below 1e-6 voxel and force below 1e-6 N, from every start.
TEST(Rest, IsQuietInEveryTrial) {
  for (std::uint64_t seed = 1; seed <= trials(60); ++seed) {
    Trial trial = rest_trial(seed);
    trial.exact_distance = false;
    const Metrics m = run(trial, Model::kDefault);
    expect_safe(m, "rest seed " + std::to_string(seed));
    for (const double cycle : m.cycle_voxels) EXPECT_LT(cycle, 1e-6) << "seed " << seed;
    for (const double force : m.cycle_force_n) EXPECT_LT(force, 1e-6) << "seed " << seed;
    for (const double settle : m.settle_s) EXPECT_LT(settle, 1) << "seed " << seed;
  }
}

TEST(Slide, KeepsUpWithTheHandAtOneAndEightVoxelsOfDepth) {
  for (const double depth : {1.0, 8.0}) {
    Metrics sum;
    for (std::uint64_t seed = 1; seed <= trials(20); ++seed) {
      Trial trial = slide_trial(seed, depth);
      trial.exact_distance = false;
      sum.add(run(trial, Model::kDefault));
    }
    expect_safe(sum, "slide");
    EXPECT_GE(percentile(sum.progress, 50), depth < 2 ? 0.95 : 0.9) << depth;
    EXPECT_GE(percentile(sum.progress, 10), depth < 2 ? 0.95 : 0.9) << depth;
  }
}

TEST(Peg, GoesInFromHalfAVoxelOfClearance) {
  for (const double clearance : {0.5, 1.0, 2.0, 5.0, 10.0}) {
    Metrics sum;
    for (std::uint64_t seed = 1; seed <= trials(10); ++seed) {
      Trial trial = peg_trial(seed, clearance);
      trial.exact_distance = false;
      sum.add(run(trial, Model::kDefault));
    }
    expect_safe(sum, "peg");
    EXPECT_GE(percentile(sum.progress, 10), 0.9) << clearance;
  }
}

// The clamp is what the device bears, not a multiple of the voxel: 15 N hold with 5, 2 and 1 mm.
TEST(Press, HoldsFifteenNewtonsWithEveryVoxelSize) {
  for (const double s : {0.005, 0.002, 0.001}) {
    for (std::uint64_t seed = 1; seed <= trials(4); ++seed) {
      Trial trial = press_trial(seed, s);
      trial.exact_distance = false;
      const Metrics m = run(trial, Model::kDefault);
      expect_safe(m, "press seed " + std::to_string(seed));
      ASSERT_EQ(m.rest_force_n.size(), 1u);
      EXPECT_NEAR(m.rest_force_n[0], 15, 1e-6) << s << " seed " << seed;
      EXPECT_LT(m.cycle_voxels[0], 1e-6) << s << " seed " << seed;
    }
  }
}

// A hand that moves slowly enough for the part to follow gets no energy from the scene.
TEST(Passivity, ASlowHandIsGivenNothing) {
  for (const char* name : {"press-hold", "wedge", "sphere-in-cone"}) {
    for (std::uint64_t seed = 1; seed <= trials(4); ++seed) {
      Trial trial = case_named(name).make(seed);
      trial.exact_distance = false;
      EXPECT_LT(run(trial, Model::kDefault).generated_j, 1e-6) << name << " seed " << seed;
    }
  }
}

}  // namespace
}  // namespace forcelayer::stress
