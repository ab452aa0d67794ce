// The benchmarks' order statistics.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>

#include "tests/bench/spread.h"

namespace forcelayer::bench {
namespace {

// Counts all outcomes of n draws that lie below the median or above it.
TEST(Spread, MedianLiesBetweenTwoValuesInNinetyFivePercentOfAllOutcomes) {
  for (unsigned n = 1; n <= 16; ++n) {
    const auto missed = [&](unsigned beyond) {  // how often fewer than so many and one are below
      std::uint64_t outcomes = 0;
      for (std::uint64_t below = 0; below < std::uint64_t{1} << n; ++below) {
        outcomes += static_cast<unsigned>(std::popcount(below)) <= beyond;
      }
      return static_cast<double>(outcomes) / std::pow(2.0, n);
    };
    const std::size_t beyond = values_beyond_median(n);
    if (beyond == SIZE_MAX) {
      EXPECT_GT(missed(0), 0.025) << n;
      continue;
    }
    EXPECT_LE(missed(static_cast<unsigned>(beyond)), 0.025) << n;
    EXPECT_GT(missed(static_cast<unsigned>(beyond) + 1), 0.025) << n;
  }
}

// Tables of the sign test: 6 draws, the first and the last; 20, the 6th and the 15th; 100, the 40th
// and the 61st.
TEST(Spread, MedianIntervalIsThatOfTheTables) {
  EXPECT_EQ(values_beyond_median(0), SIZE_MAX);
  EXPECT_EQ(values_beyond_median(5), SIZE_MAX);
  EXPECT_EQ(values_beyond_median(6), 0u);
  EXPECT_EQ(values_beyond_median(20), 5u);
  EXPECT_EQ(values_beyond_median(100), 39u);
  EXPECT_GT(values_beyond_median(100000), 49000u);
  EXPECT_LT(values_beyond_median(100000), 50000u);
}

TEST(Spread, QuantilesAreInterpolatedAndIgnoreOrderAndWhatIsNotFinite) {
  const Spread s = spread({5, NAN, 1, 4, INFINITY, 2, 3});
  EXPECT_EQ(s.n, 5u);
  EXPECT_DOUBLE_EQ(s.p5, 1.2);
  EXPECT_DOUBLE_EQ(s.p25, 2);
  EXPECT_DOUBLE_EQ(s.p50, 3);
  EXPECT_DOUBLE_EQ(s.p75, 4);
  EXPECT_DOUBLE_EQ(s.p95, 4.8);
  EXPECT_TRUE(std::isnan(s.median_low));
  EXPECT_DOUBLE_EQ(spread({1, 2}).p50, 1.5);
  EXPECT_TRUE(std::isnan(spread({}).p50));
}

TEST(Spread, IntervalHoldsTheMedianOfASkewedPopulation) {
  std::mt19937_64 random(20260101);
  std::exponential_distribution<double> draw(1);
  int held = 0;
  constexpr int kSamples = 4000;
  for (int i = 0; i < kSamples; ++i) {
    std::vector<double> sample(30);
    for (double& x : sample) x = draw(random);
    const Spread s = spread(sample);
    held += s.median_low <= std::log(2.0) && std::log(2.0) <= s.median_high;
  }
  EXPECT_GT(held, 0.95 * kSamples);
  EXPECT_LT(held, 0.98 * kSamples);  // 95.7% is what the ranks 10 and 21 of 30 give
}

}  // namespace
}  // namespace forcelayer::bench
