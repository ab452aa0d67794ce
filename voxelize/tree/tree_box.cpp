#include "voxelize/tree/tree_box.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

#include "formats/voxmap_format.h"

namespace forcelayer::tree {
namespace {

using Voxel = std::array<std::int64_t, 3>;

Voxel child_low(const Voxel& low, std::size_t n, std::int64_t edge) {
  return {low[0] + static_cast<std::int64_t>(n >> 6) * edge,
          low[1] + static_cast<std::int64_t>(n >> 3 & 7) * edge,
          low[2] + static_cast<std::int64_t>(n & 7) * edge};
}

Voxel directory_cell_low(std::size_t index, const std::array<std::uint32_t, 3>& dims) {
  return {static_cast<std::int64_t>(index / dims[2] / dims[1]) * kUpperNodeEdge,
          static_cast<std::int64_t>(index / dims[2] % dims[1]) * kUpperNodeEdge,
          static_cast<std::int64_t>(index % dims[2]) * kUpperNodeEdge};
}

// The distance, in voxels, of a box from the nearest cropped side; 0 where it reaches beyond one.
std::int64_t known_distance(const Voxel& low, std::int64_t edge, const masks::KeptBox& kept) {
  std::int64_t smallest = kMaxClearance;
  for (std::size_t d = 0; d < 3; ++d) {
    const auto axis = static_cast<int>(d);
    if (kept.cropped_sides & 1u << (2 * d)) {
      smallest = std::min(smallest, low[d] - kept.box.min()[axis] + 1);
    }
    if (kept.cropped_sides & 2u << (2 * d)) {
      smallest = std::min(smallest, kept.box.max()[axis] - (low[d] + edge - 1) + 1);
    }
  }
  return std::max<std::int64_t>(smallest, 0);
}

void clip(std::uint32_t& entry, const Voxel& low, std::int64_t edge, const masks::KeptBox& kept) {
  if (!is_free(entry)) return;
  const auto known = static_cast<std::uint32_t>(known_distance(low, edge, kept));
  entry = uniform_entry(0, std::min(uniform_clearance(entry), known));
}

// Finds the smallest box by looking only at entries that could enlarge it.
class TightBox {
 public:
  explicit TightBox(const VoxelTree& tree) : tree_(tree) {}

  void look_at(std::uint32_t entry, const Voxel& low, std::int64_t edge) {
    const masks::VoxelBox box{low, {low[0] + edge - 1, low[1] + edge - 1, low[2] + edge - 1}};
    if (is_free(entry) || holds(box)) return;
    if (is_uniform(entry)) {
      box_.include(box);
    } else if (edge == kBrickEdge) {
      look_at_brick(entry, low);
    } else {
      const auto& nodes = edge == kUpperNodeEdge ? tree_.upper_nodes : tree_.lower_nodes;
      for (std::size_t n = 0; n < kNodeEntries; ++n) {
        look_at(nodes[std::size_t{entry} * kNodeEntries + n], child_low(low, n, edge / 8),
                edge / 8);
      }
    }
  }

  const masks::VoxelBox& box() const { return box_; }

 private:
  // By planes and rows of eight voxels along z.
  void look_at_brick(std::uint32_t brick, const Voxel& low) {
    constexpr std::int64_t kEdge = kBrickEdge;
    for (std::int64_t x = 0; x < kEdge; ++x) {
      const Voxel plane{low[0] + x, low[1], low[2]};
      if (holds({plane, {plane[0], plane[1] + kEdge - 1, plane[2] + kEdge - 1}})) continue;
      for (std::int64_t y = 0; y < kEdge; ++y) {
        const auto row = static_cast<std::size_t>((brick * kEdge + x) * kEdge + y);
        const std::uint32_t values = row_of_values(row);
        if (values == 0) continue;
        const Voxel first{plane[0], plane[1] + y, plane[2]};
        masks::VoxelBox box{first, first};
        box.low[2] += std::countr_zero(values) / 2;
        box.high[2] += (31 - std::countl_zero(values)) / 2;
        if (!holds(box)) box_.include(box);
      }
    }
  }

  // The eight values of a row, the first lowest. Rows are numbered through all bricks.
  std::uint32_t row_of_values(std::size_t row) const {
    return tree_.bricks[row / 2] >> row % 2 * 16 & 0xffff;
  }

  bool holds(const masks::VoxelBox& box) const {
    for (std::size_t d = 0; d < 3; ++d) {
      if (box.low[d] < box_.low[d] || box.high[d] > box_.high[d]) return false;
    }
    return true;
  }

  const VoxelTree& tree_;
  masks::VoxelBox box_;
};

}  // namespace

void clip_clearance(BuiltTree& tree, const masks::KeptBox& kept) {
  tbb::parallel_for(std::size_t{0}, tree.directory.size(), [&](std::size_t i) {
    const Voxel cell = directory_cell_low(i, tree.dims);
    std::uint32_t& entry = tree.directory[i];
    clip(entry, cell, kUpperNodeEdge, kept);
    if (is_uniform(entry)) return;
    for (std::size_t n = 0; n < kNodeEntries; ++n) {
      const Voxel node = child_low(cell, n, kLowerNodeEdge);
      std::uint32_t& node_entry = tree.upper[entry][n];
      clip(node_entry, node, kLowerNodeEdge, kept);
      if (is_uniform(node_entry)) continue;
      for (std::size_t m = 0; m < kNodeEntries; ++m) {
        clip(tree.lower[node_entry].entries[m], child_low(node, m, kBrickEdge), kBrickEdge, kept);
      }
    }
  });
}

masks::VoxelBox tight_box(const VoxelTree& tree,
                          const std::array<std::uint32_t, 3>& directory_dims) {
  TightBox tight(tree);
  for (std::size_t i = 0; i < tree.directory.size(); ++i) {
    tight.look_at(tree.directory[i], directory_cell_low(i, directory_dims), kUpperNodeEdge);
  }
  return tight.box();
}

}  // namespace forcelayer::tree
