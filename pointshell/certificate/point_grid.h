// Finding the points near a place: a sparse grid of cubic cells over a fixed set of points.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "pointshell/part/vec3.h"

namespace forcelayer::certificate {

class PointGrid {
 public:
  // Keeps a copy of the positions, ordered by cell. Queries reach `cell_size` far.
  PointGrid(std::span<const part::Vec3> points, double cell_size);

  // Calls visit(index, position) for every point within `radius` <= cell_size of `place`, and for
  // some farther ones. The order depends on the points alone.
  template <typename Visit>
  void visit_near(const part::Vec3& place, double radius, const Visit& visit) const {
    const Cell low = cell_of({place.x - radius, place.y - radius, place.z - radius});
    const Cell high = cell_of({place.x + radius, place.y + radius, place.z + radius});
    for (std::int64_t i = low.i; i <= high.i; ++i) {
      for (std::int64_t j = low.j; j <= high.j; ++j) {
        for (std::int64_t k = low.k; k <= high.k; ++k) {
          const Slot& slot = find(key_of({i, j, k}));
          for (std::uint32_t n = 0; n < slot.count; ++n) {
            visit(index_[slot.first + n], position_[slot.first + n]);
          }
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
  struct Slot {  // of the hash table; count 0: empty
    std::uint64_t key = 0;
    std::uint32_t first = 0, count = 0;
  };

  Cell cell_of(const part::Vec3& p) const {
    return {part::floor_to_int(p.x * inverse_cell_size_),
            part::floor_to_int(p.y * inverse_cell_size_),
            part::floor_to_int(p.z * inverse_cell_size_)};
  }
  // 21 bits an axis. Cells 2^21 apart share a key: a query then visits some points too many.
  static std::uint64_t key_of(const Cell& cell) {
    constexpr std::uint64_t kMask = (1u << 21) - 1;
    return (static_cast<std::uint64_t>(cell.i) & kMask) << 42 |
           (static_cast<std::uint64_t>(cell.j) & kMask) << 21 |
           (static_cast<std::uint64_t>(cell.k) & kMask);
  }
  std::size_t slot_of(std::uint64_t key) const {
    return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15u) >> shift_);
  }
  const Slot& find(std::uint64_t key) const {
    for (std::size_t at = slot_of(key);; at = (at + 1) & mask_) {
      if (table_[at].count == 0 || table_[at].key == key) return table_[at];
    }
  }
  void fill_table(const std::vector<std::uint64_t>& sorted_keys);

  double inverse_cell_size_;
  std::vector<part::Vec3> position_;  // ordered by cell
  std::vector<std::uint32_t> index_;  // of position_[n] in the span given
  std::vector<Slot> table_;           // open addressing, at most half full
  std::size_t mask_ = 0;
  int shift_ = 0;
};

}  // namespace forcelayer::certificate
