// Sets of voxels of a 64^3 node and its surroundings as bits, 64 voxels along z in a word, and how
// such a set grows by layers. Internal to formats/audit/.
#pragma once

#include <vector>

#include "formats/audit/neighborhoods.h"

namespace forcelayer::voxmap_audit {

// A node and its surroundings: `margin` rows (up to 63) on each side along x and y, one word below
// and one above along z.
class NodeRows {
 public:
  static constexpr std::int64_t kNode = kLowerNodeEdge;
  using Rows = std::vector<std::uint64_t>;  // a word for each row along z

  NodeRows(const std::vector<BrickPlanes>& planes, const VoxmapView& view, std::int64_t margin);

  enum Set { kInterior, kUpToSurface, kUpToProximity };

  void fill(const Around& around);

  // The 64 rows of the node at x.
  const std::uint64_t* plane(Set set, std::int64_t x) const {
    return &sets_[set][kMiddle][index(x, 0)];
  }

  // A row along z, of the node or of its margin: the 64 voxels below, the node's, the 64 above. Of
  // kInterior and kUpToSurface, and as far as the margin reaches.
  using Column = std::array<std::uint64_t, 3>;
  Column column(Set set, std::int64_t x, std::int64_t y) const {
    const std::size_t at = index(x, y);
    return {sets_[set][kBelow][at], sets_[set][kMiddle][at], sets_[set][kAbove][at]};
  }

  // The voxels of the node that lie within `steps` of a voxel of `set`, rows [x][y]. `steps` is at
  // most the margin, and `set` is not kUpToProximity.
  const Rows& grown(Set set, std::int64_t steps);

 private:
  enum Along { kBelow, kMiddle, kAbove };
  struct ColumnRows;

  std::size_t index(std::int64_t x, std::int64_t y) const {
    return static_cast<std::size_t>((x + margin_) * width_ + y + margin_);
  }
  void fill_column(const Around& around, std::int64_t x, std::int64_t y);
  void store_rows(Along along, std::int64_t x, std::int64_t y, const std::uint64_t* low,
                  const std::uint64_t* high);
  bool column_rows(std::uint32_t node, std::int64_t begin, std::uint32_t first, std::uint32_t last,
                   ColumnRows& rows) const;

  const std::vector<BrickPlanes>& planes_;
  const VoxmapView& view_;
  std::int64_t margin_, width_;
  std::array<std::array<Rows, 3>, 3> sets_;  // [set][along]
  std::array<bool, 3> holds_any_{};          // [along]: whether some row is not zero
  Rows along_z_, along_y_, grown_;
};

}  // namespace forcelayer::voxmap_audit
