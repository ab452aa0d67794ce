#include "tests/bench/spread.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace forcelayer::bench {

std::size_t values_beyond_median(std::size_t n) {
  constexpr double kEachSide = 0.025;
  const auto draws = static_cast<double>(n);
  double below = 0;  // probability of at most `r` draws below the median
  for (std::size_t r = 0; r < n; ++r) {
    const auto k = static_cast<double>(r);
    below += std::exp(std::lgamma(draws + 1) - std::lgamma(k + 1) - std::lgamma(draws - k + 1) -
                      draws * std::log(2.0));
    if (below > kEachSide) return r == 0 ? SIZE_MAX : r - 1;
  }
  return SIZE_MAX;
}

Spread spread(std::vector<double> sample) {
  std::erase_if(sample, [](double x) { return !std::isfinite(x); });
  std::sort(sample.begin(), sample.end());
  const std::size_t n = sample.size();
  const auto at = [&](double fraction) -> double {
    if (n == 0) return NAN;
    const double place = fraction * static_cast<double>(n - 1);
    const auto i = static_cast<std::size_t>(place);
    const double next = sample[std::min(i + 1, n - 1)];
    return sample[i] + (place - static_cast<double>(i)) * (next - sample[i]);
  };
  Spread s{n, at(0.05), at(0.25), at(0.5), at(0.75), at(0.95), NAN, NAN};
  const std::size_t beyond = values_beyond_median(n);
  if (beyond < n) s.median_low = sample[beyond], s.median_high = sample[n - 1 - beyond];
  return s;
}

}  // namespace forcelayer::bench
