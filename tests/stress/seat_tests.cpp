// Parts that start installed rest, are held, come out and go back. `stability_bench seats` has the
// whole campaign: two hundred pairs, ten seconds each.
#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <vector>

#include "tests/stress/seat_trial.h"

namespace forcelayer::stress {
namespace {

TEST(Seat, InstalledPartsRestAreHeldAndComeOut) {
  std::vector<std::uint64_t> seeds(2 * kInstalledKinds);
  std::iota(seeds.begin(), seeds.end(), 0);
  // A pin with a gap of less than a step of the stored distances: it stayed in the mouth of its
  // bore where the force began at the seat's deepest reading.
  seeds.push_back(86);
  double deep = 0;
  for (const std::uint64_t seed : seeds) {
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
  // Today below 0.001. A force that begins at the surface makes it 0.04.
  EXPECT_LT(deep / static_cast<double>(seeds.size()), 0.02);
}

}  // namespace
}  // namespace forcelayer::stress
