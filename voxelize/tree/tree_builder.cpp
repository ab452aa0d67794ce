#include "voxelize/tree/tree_builder.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <utility>

#include "formats/lattice/brick_bits.h"
#include "voxelize/tree/brick_cutter.h"
#include "voxelize/tree/built_tree.h"
#include "voxelize/tree/clearance.h"
#include "voxelize/tree/node_keys.h"
#include "voxelize/tree/sharing.h"
#include "voxelize/tree/tree_box.h"

namespace forcelayer::tree {
namespace {

// Counts what threads have done.
class DoneNodes {
 public:
  DoneNodes(const NodeProgress& progress, std::size_t count) : progress_(progress), count_(count) {}

  void one_more() {
    done_.fetch_add(1, std::memory_order_relaxed);
    if (!progress_ || !telling_.try_lock()) return;
    const std::lock_guard lock(telling_, std::adopt_lock);
    progress_(static_cast<double>(done_.load(std::memory_order_relaxed)) /
              static_cast<double>(count_));
  }

 private:
  const NodeProgress& progress_;
  const std::size_t count_;
  std::atomic<std::size_t> done_{0};
  std::mutex telling_;
};

// All entries uniform and the same.
bool is_collapsible(const Entries& entries) {
  return is_uniform(entries[0]) &&
         std::all_of(entries.begin(), entries.end(),
                     [&](std::uint32_t entry) { return entry == entries[0]; });
}

// The nodes that may hold more than one value.
struct SceneNodes {
  explicit SceneNodes(std::vector<masks::Coord> at)
      : origins(std::move(at)),
        nodes(origins.size()),
        counts(nodes.size()),
        entries(nodes.size()) {}

  std::vector<masks::Coord> origins;  // ascending
  std::vector<BuiltNode> nodes;
  std::vector<distance::ValueCounts> counts;
  std::vector<cache::Digest> keys;     // empty without a memory
  std::vector<std::uint32_t> entries;  // the nodes' entries in the tree
};

struct MeasuredNodes {
  SceneNodes distances, objects;  // none of objects where they are not told apart
  std::vector<std::unique_ptr<masks::LowerMaskNode>> grown;  // none where the surface does not grow
};

MeasuredNode measured(const distance::NodeDistances& node) {
  return {cut_into_bricks(node),
          node.objects != nullptr ? cut_into_bricks(*node.objects) : BuiltNode()};
}

MeasuredNodes measure_nodes(const distance::LayerOffset& around,
                            const distance::DistanceCodes& distances, const DistanceMemory* memory,
                            const NodeProgress& progress) {
  std::vector<masks::Coord> origins = around.nodes();
  MeasuredNodes result{SceneNodes(origins), SceneNodes({}), {}};
  if (distances.grows_surface()) result.grown.resize(origins.size());
  if (distances.tells_objects()) result.objects = SceneNodes(std::move(origins));
  if (memory != nullptr) result.distances.keys.resize(result.distances.nodes.size());
  DoneNodes done(progress, result.distances.nodes.size());
  tbb::parallel_for(std::size_t{0}, result.distances.nodes.size(), [&](std::size_t i) {
    const masks::Coord& origin = result.distances.origins[i];
    std::optional<MeasuredNode> node;
    if (memory != nullptr) {
      result.distances.keys[i] = memory->key(distances, origin);
      node = memory->find(result.distances.keys[i], distances, origin);
    }
    if (!node) {
      const distance::NodeDistances& codes = distances.codes(origin);
      node = measured(codes);
      if (distances.grows_surface()) result.grown[i] = masks::node_of_rows(codes.grown, origin);
    }
    result.distances.nodes[i] = std::move(node->distances);
    if (distances.tells_objects()) result.objects.nodes[i] = std::move(node->objects);
    done.one_more();
  });
  return result;
}

SceneNodes build_nodes(const distance::LayerOffset& offset, const NodeMemory* memory,
                       const NodeProgress& progress) {
  struct Scratch {
    distance::NodeHalo halo;
    distance::NodeCodes codes;
  };
  SceneNodes result(offset.nodes());
  if (memory != nullptr) result.keys = node_keys(offset, result.origins);
  tbb::enumerable_thread_specific<Scratch> scratches;
  DoneNodes done(progress, result.nodes.size());
  tbb::parallel_for(std::size_t{0}, result.nodes.size(), [&](std::size_t i) {
    done.one_more();
    const NodeMemo* memo = memory != nullptr ? memory->find(result.keys[i]) : nullptr;
    if (memo != nullptr) {
      result.counts[i] = memo->counts();
      result.nodes[i] = memory->node(*memo);
      return;
    }
    Scratch& scratch = scratches.local();
    result.counts[i] = offset.codes(result.origins[i], scratch.halo, scratch.codes);
    result.nodes[i] = cut_into_bricks(scratch.codes);
  });
  return result;
}

// Puts the nodes and the uniform space around them into a tree and collapses uniform boxes.
class TreeAssembly {
 public:
  // Uniform entries where no node is: `outside`, or `inside` where the interior covers the box.
  TreeAssembly(const masks::MaskTree& interior, const masks::KeptBox& kept,
               const std::array<std::uint32_t, 3>& dims, std::uint32_t outside,
               std::uint32_t inside)
      : interior_(interior), kept_(kept), outside_(outside), inside_(inside) {
    tree_.dims = dims;
    tree_.directory.assign(std::size_t{dims[0]} * dims[1] * dims[2], outside);
  }

  BuiltTree run(SceneNodes& nodes, distance::ValueCounts& counts);

 private:
  struct NodePlace {
    std::size_t cell;  // of the directory
    unsigned entry;
    std::size_t node;
    auto operator<=>(const NodePlace&) const = default;
  };
  static constexpr std::uint64_t kNodeVoxels = 64 * 64 * 64;

  std::size_t cell_at(const masks::Coord& voxel) const {
    return (static_cast<std::size_t>(voxel.x() >> 9) * tree_.dims[1] +
            static_cast<std::size_t>(voxel.y() >> 9)) *
               tree_.dims[2] +
           static_cast<std::size_t>(voxel.z() >> 9);
  }
  masks::Coord cell_origin(std::size_t cell) const {
    return masks::Coord(static_cast<int>(cell / tree_.dims[2] / tree_.dims[1]) * 512,
                        static_cast<int>(cell / tree_.dims[2] % tree_.dims[1]) * 512,
                        static_cast<int>(cell % tree_.dims[2]) * 512);
  }
  std::vector<NodePlace> places_of(const std::vector<masks::Coord>& origins) const;
  lattice::BrickMask solid_nodes(const masks::Coord& cell) const;
  std::vector<std::size_t> solid_cells() const;
  std::uint32_t add_node(BuiltNode&& node);
  std::uint32_t add_upper(const Entries& entries);

  const masks::MaskTree& interior_;
  const masks::KeptBox& kept_;
  std::uint32_t outside_, inside_;
  BuiltTree tree_;
};

// In the order of the tree: by directory cell, then by entry.
std::vector<TreeAssembly::NodePlace> TreeAssembly::places_of(
    const std::vector<masks::Coord>& origins) const {
  std::vector<NodePlace> order;
  order.reserve(origins.size());
  for (std::size_t i = 0; i < origins.size(); ++i) {
    order.push_back({cell_at(origins[i]), masks::UpperMaskNode::coordToOffset(origins[i]), i});
  }
  std::sort(order.begin(), order.end());
  return order;
}

std::uint32_t TreeAssembly::add_node(BuiltNode&& node) {
  if (is_collapsible(node.entries)) return node.entries[0];
  tree_.lower.push_back(std::move(node));
  return static_cast<std::uint32_t>(tree_.lower.size() - 1);
}

std::uint32_t TreeAssembly::add_upper(const Entries& entries) {
  if (is_collapsible(entries)) return entries[0];
  tree_.upper.push_back(entries);
  return static_cast<std::uint32_t>(tree_.upper.size() - 1);
}

// The nodes of a directory cell that are interior by the interior's tiles alone and not cropped.
lattice::BrickMask TreeAssembly::solid_nodes(const masks::Coord& cell) const {
  const auto* tiles = interior_.probeConstNode<masks::UpperMaskNode>(cell);
  lattice::BrickMask solid = tiles != nullptr            ? masks::mask_of(tiles->getValueMask())
                             : interior_.isValueOn(cell) ? lattice::full_mask()
                                                         : lattice::BrickMask{};
  if (!kept_.cropped() || kept_.box.isInside(openvdb::CoordBBox::createCube(cell, 512))) {
    return solid;
  }
  lattice::BrickMask kept;
  lattice::for_each_set(solid, [&](unsigned n) {
    if (kept_.box.isInside(openvdb::CoordBBox::createCube(masks::entry_origin(cell, n, 64), 64))) {
      set(kept, n);
    }
  });
  return kept;
}

// The directory cells that may have solid nodes, ascending.
std::vector<std::size_t> TreeAssembly::solid_cells() const {
  std::vector<std::size_t> cells;
  const auto add = [&](const masks::Coord& origin) {
    if (kept_.box.hasOverlap(openvdb::CoordBBox::createCube(origin, 512))) {
      cells.push_back(cell_at(origin));
    }
  };
  for (auto tile = interior_.cbeginValueOn(); tile; ++tile) add(tile.getCoord());
  for (auto upper = interior_.cbeginChildOn(); upper; ++upper) add(upper->origin());
  std::sort(cells.begin(), cells.end());
  return cells;
}

BuiltTree TreeAssembly::run(SceneNodes& nodes, distance::ValueCounts& counts) {
  for (const distance::ValueCounts& node : nodes.counts) counts += node;
  const std::vector<NodePlace> order = places_of(nodes.origins);
  const std::vector<std::size_t> solid = solid_cells();
  for (std::size_t i = 0, j = 0; i < order.size() || j < solid.size();) {
    const std::size_t cell = i == order.size()   ? solid[j]
                             : j == solid.size() ? order[i].cell
                                                 : std::min(order[i].cell, solid[j]);
    if (j < solid.size() && solid[j] == cell) ++j;
    Entries entries;
    entries.fill(outside_);
    lattice::BrickMask solid_entries = solid_nodes(cell_origin(cell));
    lattice::for_each_set(solid_entries, [&](unsigned n) { entries[n] = inside_; });
    for (; i < order.size() && order[i].cell == cell; ++i) {
      const unsigned n = order[i].entry;
      // The node's voxels are in nodes.counts.
      solid_entries.words[n >> 6] &= ~(std::uint64_t{1} << (n & 63));
      entries[n] = add_node(std::move(nodes.nodes[order[i].node]));
      nodes.entries[order[i].node] = entries[n];
    }
    counts.interior += static_cast<std::uint64_t>(count(solid_entries)) * kNodeVoxels;
    tree_.directory[cell] = add_upper(entries);
  }
  return std::move(tree_);
}

// The memos of the nodes. Entries are still numbers of built.lower.
std::vector<NodeMemo> memos_of(const SceneNodes& nodes, const BuiltTree& built) {
  std::vector<NodeMemo> memos(nodes.keys.size());
  for (std::size_t i = 0; i < memos.size(); ++i) {
    NodeMemo& memo = memos[i];
    memo.key = nodes.keys[i];
    memo.entry = nodes.entries[i];
    memo.interior = static_cast<std::uint32_t>(nodes.counts[i].interior);
    memo.surface = static_cast<std::uint32_t>(nodes.counts[i].surface);
    memo.proximity = static_cast<std::uint32_t>(nodes.counts[i].proximity);
    if (!is_uniform(memo.entry)) memo.gaps = built.lower[memo.entry].node_gaps;
  }
  return memos;
}

// The tree of the nodes with its clearance. Sets nodes.entries.
BuiltTree assemble(const distance::LayerOffset& offset,
                   const std::array<std::uint32_t, 3>& directory_dims, SceneNodes& nodes,
                   distance::ValueCounts& counts) {
  BuiltTree built =
      TreeAssembly(offset.interior(), offset.kept(), directory_dims, kFreeEntry, kInteriorEntry)
          .run(nodes, counts);
  add_clearance(built);
  if (offset.kept().cropped()) clip_clearance(built, offset.kept());
  return built;
}

}  // namespace

DistanceTrees build_distance_trees(const distance::LayerOffset& around,
                                   const distance::DistanceCodes& distances,
                                   const std::array<std::uint32_t, 3>& directory_dims,
                                   const DistanceMemory* memory, const NodeProgress& progress) {
  MeasuredNodes nodes = measure_nodes(around, distances, memory, progress);
  // The tree, and the nodes' entries as its own.
  const auto tree_of = [&](SceneNodes& of, std::uint32_t outside, std::uint32_t brick_parts) {
    distance::ValueCounts counts;  // of nothing here
    BuiltTree built = TreeAssembly(around.interior(), around.kept(), directory_dims,
                                   uniform_entry(outside), uniform_entry(0))
                          .run(of, counts);
    built.brick_parts = brick_parts;
    std::vector<std::uint32_t> lower_numbers;
    VoxelTree tree = share_equal(std::move(built), lower_numbers);
    for (std::uint32_t& entry : of.entries) {
      if (!is_uniform(entry)) entry = lower_numbers[entry];
    }
    return tree;
  };
  DistanceTrees trees;
  trees.distances = tree_of(nodes.distances, kMaxDistanceCode, kDistanceBrickParts);
  if (distances.grows_surface()) trees.grown = masks::tree_of_nodes(nodes.grown);
  if (distances.tells_objects()) trees.objects = tree_of(nodes.objects, 0, kObjectBrickParts);
  if (memory == nullptr) return trees;
  std::vector<DistanceMemory::Kept> kept;
  for (std::size_t i = 0; i < nodes.distances.keys.size(); ++i) {
    kept.push_back({nodes.distances.keys[i], nodes.distances.origins[i], nodes.distances.entries[i],
                    distances.tells_objects() ? nodes.objects.entries[i] : uniform_entry(0)});
  }
  memory->keep(kept, distances, trees.distances, trees.objects);
  return trees;
}

VoxelTree build_tree(const distance::LayerOffset& offset,
                     const std::array<std::uint32_t, 3>& directory_dims, const NodeMemory* memory,
                     distance::ValueCounts& counts, const NodeProgress& progress) {
  SceneNodes nodes = build_nodes(offset, memory, progress);
  BuiltTree built = assemble(offset, directory_dims, nodes, counts);
  std::vector<NodeMemo> memos = memos_of(nodes, built);
  std::vector<std::uint32_t> lower_numbers;
  VoxelTree tree = share_equal(std::move(built), lower_numbers);
  if (memory != nullptr) {
    for (NodeMemo& memo : memos) {
      if (!is_uniform(memo.entry)) memo.entry = lower_numbers[memo.entry];
    }
    memory->keep(memos, tree);
  }
  return tree;
}

}  // namespace forcelayer::tree
