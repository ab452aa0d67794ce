#include "voxelize/kept_box.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "formats/voxmap_format.h"

namespace forcelayer {
namespace {

using Voxel = std::array<std::int64_t, 3>;

Voxel child_low(const Voxel& low, std::size_t n, std::int64_t edge) {
  return {low[0] + static_cast<std::int64_t>(n >> 6) * edge,
          low[1] + static_cast<std::int64_t>(n >> 3 & 7) * edge,
          low[2] + static_cast<std::int64_t>(n & 7) * edge};
}

Voxel block_low(std::size_t index, const std::array<std::uint32_t, 3>& dims) {
  return {static_cast<std::int64_t>(index / dims[2] / dims[1]) * kUpperNodeEdge,
          static_cast<std::int64_t>(index / dims[2] % dims[1]) * kUpperNodeEdge,
          static_cast<std::int64_t>(index % dims[2]) * kUpperNodeEdge};
}

// Distance in voxels from a box to what lies beyond a cropped side; 0 where it reaches beyond.
std::int64_t known_distance(const Voxel& low, std::int64_t edge, const KeptBox& kept) {
  std::int64_t least = kMaxClearance;
  for (std::size_t d = 0; d < 3; ++d) {
    const auto axis = static_cast<int>(d);
    if (kept.cropped_sides & 1u << (2 * d)) {
      least = std::min(least, low[d] - kept.box.min()[axis] + 1);
    }
    if (kept.cropped_sides & 2u << (2 * d)) {
      least = std::min(least, kept.box.max()[axis] - (low[d] + edge - 1) + 1);
    }
  }
  return std::max<std::int64_t>(least, 0);
}

void clip(std::uint32_t& entry, const Voxel& low, std::int64_t edge, const KeptBox& kept) {
  if (!is_free(entry)) return;
  const auto known = static_cast<std::uint32_t>(known_distance(low, edge, kept));
  entry = uniform_entry(0, std::min(uniform_clearance(entry), known));
}

// The smallest box, found by looking only at what could make it larger.
class TightBox {
 public:
  TightBox(const VoxelTree& tree, std::uint32_t bits, std::uint32_t free_code)
      : tree_(tree), bits_(bits), free_code_(free_code) {}

  void look_at(std::uint32_t entry, const Voxel& low, std::int64_t edge) {
    if (is_free(entry) || inside(low, edge)) return;
    if (is_uniform(entry)) {
      include(low, edge);
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

  const VoxelBox& box() const { return box_; }

 private:
  void look_at_brick(std::uint32_t brick, const Voxel& low) {
    const std::size_t word_voxels = 32 / bits_, words = kNodeEntries / word_voxels;
    for (std::size_t n = 0; n < kNodeEntries; ++n) {
      const std::uint32_t word = tree_.bricks[brick * words + n / word_voxels];
      const std::uint32_t code = word >> bits_ * (n % word_voxels) & ((1u << bits_) - 1);
      if (bits_ == 2 ? code != 0 : code < free_code_) include(child_low(low, n, 1), 1);
    }
  }

  bool inside(const Voxel& low, std::int64_t edge) const {
    for (std::size_t d = 0; d < 3; ++d) {
      if (low[d] < box_.low[d] || low[d] + edge - 1 > box_.high[d]) return false;
    }
    return true;
  }

  void include(const Voxel& low, std::int64_t edge) {
    box_.include({low, {low[0] + edge - 1, low[1] + edge - 1, low[2] + edge - 1}});
  }

  const VoxelTree& tree_;
  std::uint32_t bits_, free_code_;
  VoxelBox box_;
};

}  // namespace

void clip_clearance(BuiltTree& tree, const KeptBox& kept) {
  tbb::parallel_for(std::size_t{0}, tree.directory.size(), [&](std::size_t i) {
    const Voxel block = block_low(i, tree.dims);
    std::uint32_t& entry = tree.directory[i];
    clip(entry, block, kUpperNodeEdge, kept);
    if (is_uniform(entry)) return;
    for (std::size_t n = 0; n < kNodeEntries; ++n) {
      const Voxel node = child_low(block, n, kLowerNodeEdge);
      std::uint32_t& node_entry = tree.upper[entry][n];
      clip(node_entry, node, kLowerNodeEdge, kept);
      if (is_uniform(node_entry)) continue;
      for (std::size_t m = 0; m < kNodeEntries; ++m) {
        clip(tree.lower[node_entry].entries[m], child_low(node, m, kBrickEdge), kBrickEdge, kept);
      }
    }
  });
}

VoxelBox tight_box(const VoxelTree& tree, const std::array<std::uint32_t, 3>& directory_dims,
                   std::uint32_t bits, std::uint32_t free_code) {
  TightBox tight(tree, bits, free_code);
  for (std::size_t i = 0; i < tree.directory.size(); ++i) {
    tight.look_at(tree.directory[i], block_low(i, directory_dims), kUpperNodeEdge);
  }
  return tight.box();
}

}  // namespace forcelayer
