// Order statistics of a sample: what is said of every figure that is measured over many cases.
#pragma once

#include <cstddef>
#include <vector>

namespace forcelayer::bench {

// Quantiles are interpolated linearly between neighboring values (Hyndman and Fan's type 7).
struct Spread {
  std::size_t n = 0;
  double p5, p25, p50, p75, p95;  // NAN of no values
  // Two values of the sample between which the median of what it was drawn from lies with a
  // probability of at least 95%, whatever the distribution; NAN of fewer than six values.
  double median_low, median_high;
};

// Values that are not finite are left out.
Spread spread(std::vector<double> sample);

// How many values lie outside that interval at each end, of n in all: the largest number r for
// which fewer than r of n draws fall on one side of the median with a probability of at most 2.5%;
// less one. SIZE_MAX where there is none.
std::size_t values_beyond_median(std::size_t n);

}  // namespace forcelayer::bench
