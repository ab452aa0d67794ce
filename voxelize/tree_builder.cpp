#include "voxelize/tree_builder.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

#include "voxelize/brick_bits.h"
#include "voxelize/brick_cutter.h"
#include "voxelize/built_tree.h"
#include "voxelize/clearance.h"
#include "voxelize/sharing.h"

namespace forcelayer {
namespace {

// All entries uniform and the same.
bool is_collapsible(const Entries& entries) {
  return is_uniform(entries[0]) &&
         std::all_of(entries.begin(), entries.end(),
                     [&](std::uint32_t entry) { return entry == entries[0]; });
}

struct OffsetNodes {
  std::vector<Coord> origins;  // ascending
  std::vector<BuiltNode> nodes;
  ValueCounts counts;
};

OffsetNodes offset_nodes(const LayerOffset& offset) {
  struct Scratch {
    NodeHalo halo;
    NodeCodes codes;
    ValueCounts counts;
  };
  OffsetNodes result;
  result.origins = offset.nodes();
  result.nodes.resize(result.origins.size());
  tbb::enumerable_thread_specific<Scratch> scratches;
  tbb::parallel_for(std::size_t{0}, result.nodes.size(), [&](std::size_t i) {
    Scratch& scratch = scratches.local();
    scratch.counts += offset.codes(result.origins[i], scratch.halo, scratch.codes);
    result.nodes[i] = cut_into_bricks(scratch.codes);
  });
  for (const Scratch& scratch : scratches) result.counts += scratch.counts;
  return result;
}

// Puts the nodes and the uniform space around them into a tree, collapsed where it is uniform.
class TreeAssembly {
 public:
  TreeAssembly(const MaskTree& interior, const std::array<std::uint32_t, 3>& dims)
      : interior_(interior) {
    tree_.dims = dims;
    tree_.directory.assign(std::size_t{dims[0]} * dims[1] * dims[2], kFreeEntry);
  }

  BuiltTree run(OffsetNodes&& nodes, ValueCounts& counts);

 private:
  struct Placed {  // a node's place in the tree
    std::size_t block;
    unsigned entry;
    std::size_t node;
    auto operator<=>(const Placed&) const = default;
  };
  static constexpr std::uint64_t kNodeVoxels = 64 * 64 * 64;

  std::size_t block_at(const Coord& voxel) const {
    return (static_cast<std::size_t>(voxel.x() >> 9) * tree_.dims[1] +
            static_cast<std::size_t>(voxel.y() >> 9)) *
               tree_.dims[2] +
           static_cast<std::size_t>(voxel.z() >> 9);
  }
  std::vector<Placed> placed(const std::vector<Coord>& origins) const;
  std::uint32_t add_node(BuiltNode&& node);
  std::uint32_t add_block(const Entries& entries);

  const MaskTree& interior_;
  BuiltTree tree_;
};

// In the order of the tree: blocks, and nodes within a block.
std::vector<TreeAssembly::Placed> TreeAssembly::placed(const std::vector<Coord>& origins) const {
  std::vector<Placed> order;
  order.reserve(origins.size());
  for (std::size_t i = 0; i < origins.size(); ++i) {
    order.push_back({block_at(origins[i]), UpperMaskNode::coordToOffset(origins[i]), i});
  }
  std::sort(order.begin(), order.end());
  return order;
}

std::uint32_t TreeAssembly::add_node(BuiltNode&& node) {
  if (is_collapsible(node.entries)) return node.entries[0];
  tree_.lower.push_back(std::move(node));
  return static_cast<std::uint32_t>(tree_.lower.size() - 1);
}

std::uint32_t TreeAssembly::add_block(const Entries& entries) {
  if (is_collapsible(entries)) return entries[0];
  tree_.upper.push_back(entries);
  return static_cast<std::uint32_t>(tree_.upper.size() - 1);
}

BuiltTree TreeAssembly::run(OffsetNodes&& nodes, ValueCounts& counts) {
  counts = nodes.counts;
  for (auto tile = interior_.cbeginValueOn(); tile; ++tile) {
    tree_.directory[block_at(tile.getCoord())] = kInteriorEntry;
    counts.interior += 512 * kNodeVoxels;
  }
  const std::vector<Placed> order = placed(nodes.origins);
  for (std::size_t i = 0; i < order.size();) {
    const std::size_t block = order[i].block;
    if (tree_.directory[block] == kInteriorEntry) counts.interior -= 512 * kNodeVoxels;
    Entries entries;
    entries.fill(tree_.directory[block]);
    if (const auto* tiles = interior_.probeConstNode<UpperMaskNode>(nodes.origins[order[i].node])) {
      for_each_set(mask_of(tiles->getValueMask()),
                   [&](unsigned n) { entries[n] = kInteriorEntry; });
    }
    std::uint64_t solid_nodes =
        static_cast<std::uint64_t>(std::count(entries.begin(), entries.end(), kInteriorEntry));
    for (; i < order.size() && order[i].block == block; ++i) {
      std::uint32_t& entry = entries[order[i].entry];
      if (entry == kInteriorEntry) --solid_nodes;  // the node counts its own voxels
      entry = add_node(std::move(nodes.nodes[order[i].node]));
    }
    counts.interior += solid_nodes * kNodeVoxels;
    tree_.directory[block] = add_block(entries);
  }
  return std::move(tree_);
}

}  // namespace

VoxelTree build_tree(const LayerOffset& offset, const MaskTree& interior,
                     const std::array<std::uint32_t, 3>& directory_dims, ValueCounts& counts) {
  BuiltTree built = TreeAssembly(interior, directory_dims).run(offset_nodes(offset), counts);
  add_clearance(built);
  return share_equal(std::move(built));
}

}  // namespace forcelayer
