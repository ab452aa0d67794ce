// Parts that start installed rest, are held, come out and go back. `stability_bench seats` has the
// whole campaign: two hundred pairs, ten seconds each.
#include <gtest/gtest.h>

#include "tests/stress/seat_trial.h"

namespace forcelayer::stress {
namespace {

TEST(Seat, InstalledPartsRestAreHeldAndComeOut) {
  constexpr std::uint64_t kPairs = 2 * kInstalledKinds;
  double deep = 0;
  for (std::uint64_t seed = 0; seed < kPairs; ++seed) {
    const InstalledPair pair = installed_pair(seed);
    SCOPED_TRACE(::testing::Message()
                 << "seed " << seed << ", " << pair.kind << ", voxels of "
                 << pair.voxel_size_m * 1000 << " mm, gap " << pair.gap_m * 1000 << " mm");
    const SeatOutcome outcome = try_seat(pair, seed, 2);
    EXPECT_EQ(outcome.refused, "");
    EXPECT_LT(outcome.drift, 0.2);
    EXPECT_LT(outcome.depth, 0.6);
    EXPECT_LT(outcome.edge_depth, 0.6);
    EXPECT_LT(outcome.pushed_depth, 0.4);
    deep += outcome.deep;
    EXPECT_TRUE(outcome.came_out);
    EXPECT_TRUE(outcome.went_back || !outcome.tried_back) << outcome.held;
  }
  // Today 0.18, most of it beside edges of the scene and on sheets. A force that begins a tenth of
  // a voxel later makes it 0.71.
  EXPECT_LT(deep / kPairs, 0.2);
}

}  // namespace
}  // namespace forcelayer::stress
