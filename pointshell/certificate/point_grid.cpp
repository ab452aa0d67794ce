#include "pointshell/certificate/point_grid.h"

#include <bit>

#include "pointshell/part/parallel.h"

namespace forcelayer::certificate {

PointGrid::PointGrid(std::span<const part::Vec3> points, double cell_size)
    : inverse_cell_size_(1 / cell_size),
      column_(points.size()),
      position_(points.size()),
      index_(points.size()) {
  constexpr std::size_t kGrain = 2048, kFewestBuckets = 16;
  const std::size_t buckets = std::bit_ceil(points.size() / 2 + kFewestBuckets);
  mask_ = buckets - 1;
  shift_ = 64 - std::countr_zero(buckets);
  std::vector<std::uint32_t> bucket(points.size()), rank(points.size());
  part::parallel_for_each_index(points.size(), kGrain, [&](std::size_t n) {
    const Cell cell = cell_of(points[n]);
    bucket[n] = static_cast<std::uint32_t>(bucket_of(column_of(cell), cell.k));
  });
  // A counting sort, of which one thread only counts.
  ends_.assign(buckets + 1, 0);
  for (std::size_t n = 0; n < points.size(); ++n) rank[n] = ends_[bucket[n] + 1]++;
  for (std::size_t n = 0; n < buckets; ++n) ends_[n + 1] += ends_[n];
  part::parallel_for_each_index(points.size(), kGrain, [&](std::size_t n) {
    const std::uint32_t at = ends_[bucket[n]] + rank[n];
    column_[at] = column_of(cell_of(points[n]));
    position_[at] = points[n];
    index_[at] = static_cast<std::uint32_t>(n);
  });
}

}  // namespace forcelayer::certificate
