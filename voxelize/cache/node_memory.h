// The finished nodes of a scene's last bake, in a cache: the next bake of the scene builds only the
// nodes around what changed.
#pragma once

#include <atomic>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "voxelize/cache/cache_folder.h"
#include "voxelize/masks/dilation.h"
#include "voxelize/tree/built_tree.h"
#include "voxelize/tree/sharing.h"

namespace forcelayer {

// What is remembered of a node besides its entries and bricks.
struct NodeMemo {
  Digest key;               // of everything that the node depends on
  std::uint32_t entry = 0;  // uniform without clearance, or the number of a lower node of the tree
  std::uint32_t interior = 0, surface = 0, proximity = 0;  // voxels
  NodeNearness reach;
  std::uint16_t reserved = 0;

  ValueCounts counts() const { return {interior, surface, proximity}; }
};

class NodeMemory {
 public:
  // `scene` names what is baked. Bakes of other scenes of the same name and voxel size replace each
  // other's memory, and lose time alone: a node is taken over by its key.
  NodeMemory(const CacheFolder& cache, std::string_view scene, double voxel_size_m);

  // Null where there is none. Any thread may call these two.
  const NodeMemo* find(const Digest& key) const;
  BuiltNode node(const NodeMemo& memo) const;  // finished, with its own bricks

  std::size_t asked() const { return asked_; }  // calls of find()
  std::size_t found() const { return found_; }  // that found something

  // Replaces what is remembered by the nodes of a finished tree.
  void keep(const std::vector<NodeMemo>& nodes, const VoxelTree& tree) const;

 private:
  struct KeyHash {
    std::size_t operator()(const Digest& key) const { return key.low; }
  };
  void read(std::span<const std::byte> bytes);

  mutable std::atomic<std::size_t> asked_ = 0, found_ = 0;
  const CacheFolder& cache_;
  Digest slot_;
  std::optional<CacheEntry> entry_;
  std::span<const NodeMemo> memos_;
  std::span<const std::uint32_t> lower_nodes_, bricks_;
  std::unordered_map<Digest, const NodeMemo*, KeyHash> index_;
};

}  // namespace forcelayer
