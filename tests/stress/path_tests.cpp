// The proofs of voxcheck along paths against the exact distance of the meshes, which FCL measures.
// FORCELAYER_LONG_TESTS=1 multiplies the moments by thirty; clearance_bench paths has 100,000.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "tests/stress/clearance_campaign.h"
#include "tests/stress/path_campaign.h"

namespace forcelayer::stress {
namespace {

TEST(Path, ClearanceIsNeverAboveTheExactDistanceAndEveryPlantedViolationIsFound) {
  const std::uint64_t scenes = std::getenv("FORCELAYER_LONG_TESTS") != nullptr ? 600 : 20;
  std::vector<double> along, alone;
  std::uint64_t planted = 0, found = 0;
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const ClearanceScene scene = generated_clearance_scene(seed);
    const JudgedPaths judged = judge_paths(scene, seed, 60);
    for (const JudgedMoment& m : judged.moments) {
      ASSERT_FALSE(m.too_much()) << "exact " << m.exact << ", along the path " << m.along
                                 << ", alone " << m.alone;
      if (scene.roi_m || m.exact < 1.2) continue;
      if (m.alone >= 0 && m.exact < 14) alone.push_back(m.exact - m.alone);
    }
    EXPECT_EQ(judged.found, judged.planted);
    planted += judged.planted;
    found += judged.found;
  }
  ASSERT_GT(alone.size(), 50u);
  EXPECT_GT(planted, 20u);
  const Spread spread = spread_of(alone);
  std::printf(
      "%zu poses: slack median %.2f, 99%% %.2f, most %.2f voxels; %llu of %llu planted found\n",
      alone.size(), spread.median, spread.high, spread.largest,
      static_cast<unsigned long long>(found), static_cast<unsigned long long>(planted));
  EXPECT_LT(spread.median, 0.6);
  EXPECT_LT(spread.largest, 1.5);
}

}  // namespace
}  // namespace forcelayer::stress
