// Histograms of durations, and the ring between threads.
#include "runtime/loop/histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <thread>
#include <vector>

#include "runtime/machine/spsc_ring.h"

namespace forcelayer::test {
namespace {

TEST(Histogram, QuantilesAreWithinABucketOfTheSortedOnes) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    loop::DurationHistogram histogram;
    std::vector<std::uint64_t> values;
    std::uniform_real_distribution<double> exponent(0, 30);
    for (int i = 0; i < 5000; ++i) {
      values.push_back(static_cast<std::uint64_t>(std::exp2(exponent(random))));
      histogram.record(static_cast<std::int64_t>(values.back()));
    }
    std::sort(values.begin(), values.end());
    EXPECT_EQ(histogram.max_ns(), values.back());
    for (const double fraction : {0.001, 0.5, 0.99, 0.999, 1.0}) {
      const auto rank = static_cast<std::size_t>(std::ceil(fraction * 5000)) - 1;
      const double exact = static_cast<double>(values[rank]);
      const double found = static_cast<double>(histogram.quantile_ns(fraction));
      EXPECT_GE(found, exact) << "seed " << seed;
      EXPECT_LE(found, exact * (1 + 1.0 / 64) + 1) << "seed " << seed;
    }
  }
}

TEST(Histogram, TakesExtremesAndNothing) {
  loop::DurationHistogram histogram;
  EXPECT_EQ(histogram.quantile_ns(0.5), 0u);
  histogram.record(-5);
  EXPECT_EQ(histogram.quantile_ns(1), 0u);
  histogram.record(std::int64_t{1} << 62);
  EXPECT_EQ(histogram.max_ns(), std::uint64_t{1} << 62);
  EXPECT_EQ(histogram.count(), 2u);
}

TEST(SpscRing, HandsEveryItemOverInOrder) {
  machine::SpscRing<std::uint64_t> ring(64);
  constexpr std::uint64_t kItems = 20'000;
  std::thread producer([&] {
    for (std::uint64_t i = 0; i < kItems;) {
      if (ring.push(i))
        ++i;
      else
        std::this_thread::yield();
    }
  });
  std::uint64_t item = 0;
  for (std::uint64_t i = 0; i < kItems;) {
    if (!ring.pop(item)) {
      std::this_thread::yield();
      continue;
    }
    EXPECT_EQ(item, i);
    ++i;
  }
  producer.join();
  EXPECT_FALSE(ring.pop(item));
}

TEST(SpscRing, RefusesWhenFull) {
  machine::SpscRing<int> ring(3);  // rounded up to 4
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.push(i));
  EXPECT_FALSE(ring.push(4));
  int item = -1;
  EXPECT_TRUE(ring.pop(item));
  EXPECT_EQ(item, 0);
  EXPECT_TRUE(ring.push(4));
}

}  // namespace
}  // namespace forcelayer::test
