// Finding the points near a place: a sparse grid of cubic cells over a fixed set of points.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "pointshell/part/vec3.h"

namespace forcelayer::certificate {

class PointGrid {
 public:
  // Keeps a copy of the positions, ordered by cell.
  PointGrid(std::span<const part::Vec3> points, double cell_size);

  // Calls visit(index, position) for every point within `radius` of `place`, and for some farther
  // ones. Fast where the radius is about a cell's size. The order depends on the points alone.
  template <typename Visit>
  void visit_near(const part::Vec3& place, double radius, const Visit& visit) const {
    const Cell low = cell_of({place.x - radius, place.y - radius, place.z - radius});
    const Cell high = cell_of({place.x + radius, place.y + radius, place.z + radius});
    const std::int64_t last = std::min(high.k, low.k + static_cast<std::int64_t>(mask_));
    for (std::int64_t i = low.i; i <= high.i; ++i) {
      for (std::int64_t j = low.j; j <= high.j; ++j) {
        const std::uint64_t column = column_of({i, j, 0});
        // Cells along z have buckets one after the other, up to the last bucket.
        for (std::int64_t k = low.k; k <= last;) {
          const std::size_t first = bucket_of(column, k);
          const std::size_t count = std::min<std::size_t>(last - k + 1, mask_ + 1 - first);
          for (std::uint32_t n = ends_[first]; n < ends_[first + count]; ++n) {
            if (column_[n] == column) visit(index_[n], position_[n]);
          }
          k += static_cast<std::int64_t>(count);
        }
      }
    }
  }

  // Distance from `place` to the nearest point, or `radius` where none is nearer.
  double nearest_distance(const part::Vec3& place, double radius) const {
    double best = radius * radius;
    visit_near(place, radius, [&](std::uint32_t, const part::Vec3& position) {
      best = std::min(best, part::length_squared(position - place));
    });
    return std::sqrt(best);
  }

 private:
  struct Cell {
    std::int64_t i, j, k;
  };
  Cell cell_of(const part::Vec3& p) const {
    return {part::floor_to_int(p.x * inverse_cell_size_),
            part::floor_to_int(p.y * inverse_cell_size_),
            part::floor_to_int(p.z * inverse_cell_size_)};
  }
  // Columns along z. Those 2^32 apart count as one: a query then visits some points too many.
  static std::uint64_t column_of(const Cell& cell) {
    return static_cast<std::uint64_t>(cell.i) << 32 | static_cast<std::uint32_t>(cell.j);
  }
  // Far cells may share a bucket, also those of one column.
  std::size_t bucket_of(std::uint64_t column, std::int64_t k) const {
    return ((column * 0x9e3779b97f4a7c15u >> shift_) + static_cast<std::uint64_t>(k)) & mask_;
  }

  double inverse_cell_size_;
  // The points by bucket, in each bucket as they were given.
  std::vector<std::uint64_t> column_;
  std::vector<part::Vec3> position_;
  std::vector<std::uint32_t> index_;  // in the span given
  std::vector<std::uint32_t> ends_;   // of the bucket before each: [buckets + 1]
  std::size_t mask_ = 0;
  int shift_ = 0;
};

}  // namespace forcelayer::certificate
