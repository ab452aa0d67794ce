// The finished nodes of a scene's last bake, in a cache. The next bake of the scene builds only the
// nodes around a change.
#pragma once

#include <atomic>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "voxelize/cache/cache_folder.h"
#include "voxelize/distance/dilation.h"
#include "voxelize/tree/built_tree.h"
#include "voxelize/tree/sharing.h"
#include "voxelize/tree/stored_nodes.h"

namespace forcelayer::tree {

// A remembered node, without its entries and bricks.
struct NodeMemo {
  cache::Digest key;        // node_keys()
  std::uint32_t entry = 0;  // uniform without clearance, or the number of a lower node of the tree
  std::uint32_t interior = 0, surface = 0, proximity = 0;  // voxels
  NodeGaps gaps;
  std::uint16_t reserved = 0;

  distance::ValueCounts counts() const { return {interior, surface, proximity}; }
};

class NodeMemory {
 public:
  // `scene` names the memory. Different scenes of one name and voxel size replace each other's
  // memory, which costs time alone: a node is found by its key.
  NodeMemory(const cache::CacheFolder& cache, std::string_view scene, double voxel_size_m);

  // Null for an unknown key. Any thread may call these two.
  const NodeMemo* find(const cache::Digest& key) const;
  BuiltNode node(const NodeMemo& memo) const;  // finished, with its own bricks

  std::size_t asked() const { return asked_; }  // calls of find()
  std::size_t found() const { return found_; }  // those that were not null

  // Replaces the memory by the nodes of a finished tree.
  void keep(const std::vector<NodeMemo>& nodes, const VoxelTree& tree) const;

 private:
  struct KeyHash {
    std::size_t operator()(const cache::Digest& key) const { return key.low; }
  };
  void read(std::span<const std::byte> bytes);

  mutable std::atomic<std::size_t> asked_ = 0, found_ = 0;
  const cache::CacheFolder& cache_;
  cache::Digest slot_;
  std::optional<cache::CacheEntry> entry_;
  std::span<const NodeMemo> memos_;
  StoredNodes nodes_;
  std::unordered_map<cache::Digest, const NodeMemo*, KeyHash> index_;
};

}  // namespace forcelayer::tree
