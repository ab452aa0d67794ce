// Which boxes of a tree have anything but background: free voxels, or their codes. Equal nodes are
// stored once and can stand in many places, so a small file can describe more empty places than a
// walk can visit. A walk that asks here enters none of them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "formats/voxmap.h"
#include "formats/voxmap_walk.h"

namespace forcelayer {

// For for_each_region_where(). Looks at each node of the file once. `view` must outlive it.
template <std::uint32_t kBits>
class OccupiedBoxes {
 public:
  OccupiedBoxes(const TreeView<kBits>& view, const TreeCounts& counts, std::uint32_t background)
      : view_(view), counts_(counts), background_(background) {
    lower_ = occupied(view.lower_nodes, counts.lower_nodes, [&](std::uint32_t brick) {
      const auto elements = view_.brick_codes(brick);
      return std::any_of(elements.begin(), elements.end(),
                         [&](std::uint32_t element) { return element != background_; });
    });
    upper_ = occupied(view.upper_nodes, counts.upper_nodes,
                      [&](std::uint32_t lower) -> bool { return lower_[lower]; });
  }

  // How many entries and voxels a walk over these boxes looks at: walk_steps().
  template <typename InUniform>
  double steps(InUniform in_uniform) const {
    const auto enters = [this](std::uint32_t edge, std::uint32_t node) -> bool {
      return edge == kLowerNodeEdge ? lower_[node] : upper_[node];
    };
    return walk_steps(view_, counts_, enters, in_uniform);
  }

  // For the box of a directory cell, or of an entry below it. True too for a brick that is empty.
  bool operator()(const std::array<std::int64_t, 3>& low, std::int64_t edge) const {
    std::array<std::int64_t, 3> at;
    for (std::size_t axis = 0; axis < 3; ++axis)
      at[axis] = low[axis] - view_.directory_origin[axis];
    const auto slot = [&](int shift) {
      return static_cast<std::uint32_t>((at[0] >> shift & 7) << 6 | (at[1] >> shift & 7) << 3 |
                                        (at[2] >> shift & 7));
    };
    std::uint32_t entry = view_.directory[((at[0] >> 9) * view_.directory_dims[1] + (at[1] >> 9)) *
                                              view_.directory_dims[2] +
                                          (at[2] >> 9)];
    if (is_uniform(entry)) return differs(entry);
    if (edge == kUpperNodeEdge) return upper_[entry];
    entry = view_.upper_nodes[std::uint64_t{entry} * kNodeEntries + slot(6)];
    if (is_uniform(entry)) return differs(entry);
    return edge == kBrickEdge || lower_[entry];
  }

 private:
  bool differs(std::uint32_t uniform) const {
    return TreeView<kBits>::uniform(uniform, 1).code != background_;
  }

  // For each node, whether an entry differs, or a child of which is_occupied is true.
  template <typename IsOccupied>
  std::vector<bool> occupied(const std::uint32_t* entries, std::uint64_t nodes,
                             const IsOccupied& is_occupied) const {
    std::vector<bool> found(nodes);
    for (std::uint64_t node = 0; node < nodes; ++node) {
      const std::uint32_t* const first = entries + node * kNodeEntries;
      found[node] = std::any_of(first, first + kNodeEntries, [&](std::uint32_t entry) {
        return is_uniform(entry) ? differs(entry) : is_occupied(entry);
      });
    }
    return found;
  }

  const TreeView<kBits>& view_;
  TreeCounts counts_;
  std::uint32_t background_;
  std::vector<bool> lower_, upper_;  // [node]
};

// The voxels that are not free.
inline OccupiedBoxes<kValueBits> occupied_boxes(const Voxmap& map) {
  return {map.view(), {map.upper_node_count(), map.lower_node_count(), 0, 0}, 0};
}

}  // namespace forcelayer
