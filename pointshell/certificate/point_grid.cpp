#include "pointshell/certificate/point_grid.h"

#include <tbb/parallel_sort.h>

#include <bit>
#include <utility>

#include "pointshell/part/parallel.h"

namespace forcelayer::certificate {

PointGrid::PointGrid(std::span<const part::Vec3> points, double cell_size)
    : inverse_cell_size_(1 / cell_size) {
  constexpr std::size_t kGrain = 4096;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed(points.size());
  part::parallel_for_each_index(points.size(), kGrain, [&](std::size_t n) {
    keyed[n] = {key_of(cell_of(points[n])), static_cast<std::uint32_t>(n)};
  });
  tbb::parallel_sort(keyed.begin(), keyed.end());
  position_.resize(points.size());
  index_.resize(points.size());
  std::vector<std::uint64_t> sorted_keys(points.size());
  part::parallel_for_each_index(points.size(), kGrain, [&](std::size_t n) {
    sorted_keys[n] = keyed[n].first;
    index_[n] = keyed[n].second;
    position_[n] = points[keyed[n].second];
  });
  fill_table(sorted_keys);
}

void PointGrid::fill_table(const std::vector<std::uint64_t>& sorted_keys) {
  std::size_t cells = 0;
  for (std::size_t n = 0; n < sorted_keys.size(); ++n) {
    cells += n == 0 || sorted_keys[n] != sorted_keys[n - 1];
  }
  const std::size_t capacity = std::bit_ceil(2 * cells + 2);
  table_.assign(capacity, {});
  mask_ = capacity - 1;
  shift_ = 64 - std::countr_zero(capacity);
  for (std::size_t n = 0; n < sorted_keys.size();) {
    std::size_t end = n + 1;
    while (end < sorted_keys.size() && sorted_keys[end] == sorted_keys[n]) ++end;
    std::size_t at = slot_of(sorted_keys[n]);
    while (table_[at].count != 0) at = (at + 1) & mask_;
    table_[at] = {sorted_keys[n], static_cast<std::uint32_t>(n),
                  static_cast<std::uint32_t>(end - n)};
    n = end;
  }
}

}  // namespace forcelayer::certificate
