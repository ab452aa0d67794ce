// The distances and nearest objects of a scene's last bake, node by node, in a cache. The next bake
// of the scene measures only the nodes around a change.
#pragma once

#include <atomic>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "voxelize/cache/cache_folder.h"
#include "voxelize/distance/distance_codes.h"
#include "voxelize/tree/built_tree.h"
#include "voxelize/tree/sharing.h"
#include "voxelize/tree/stored_nodes.h"

namespace forcelayer::tree {

// A node of both trees.
struct MeasuredNode {
  BuiltNode distances, objects;  // no objects where the map has none
};

class DistanceMemory {
 public:
  // `scene` names the memory, as of a NodeMemory. [objects of the DistanceCodes] `object_keys`: the
  // digest of everything that an object's place in the scene depends on. Nothing may be cropped.
  DistanceMemory(const cache::CacheFolder& cache, std::string_view scene, double voxel_size_m,
                 std::vector<cache::Digest> object_keys);

  // The digest of all that the distances of the node at `origin` depend on: its place, the objects
  // that come near it, the voxels in it and in the bricks around it, the scale. The numbers of the
  // objects are not in it.
  cache::Digest key(const distance::DistanceCodes& distances, const masks::Coord& origin) const;

  // Nothing for an unknown key. Any thread may call it.
  std::optional<MeasuredNode> find(const cache::Digest& key,
                                   const distance::DistanceCodes& distances,
                                   const masks::Coord& origin) const;

  std::size_t asked() const { return asked_; }  // calls of find()
  std::size_t found() const { return found_; }

  // A node of the finished trees: in each a uniform entry, or the number of a lower node.
  struct Kept {
    cache::Digest key;
    masks::Coord origin;
    std::uint32_t distances, objects;
  };
  // Replaces the memory by these.
  void keep(const std::vector<Kept>& nodes, const distance::DistanceCodes& distances,
            const VoxelTree& distance_tree, const VoxelTree& object_tree) const;

 private:
  struct Memo;
  struct KeyHash {
    std::size_t operator()(const cache::Digest& key) const { return key.low; }
  };
  void read(std::span<const std::byte> bytes);

  mutable std::atomic<std::size_t> asked_ = 0, found_ = 0;
  const cache::CacheFolder& cache_;
  std::vector<cache::Digest> object_keys_;
  cache::Digest slot_;
  std::optional<cache::CacheEntry> entry_;
  std::span<const Memo> memos_;
  std::span<const std::uint32_t> numbers_;  // of the objects near each node, one after the other
  StoredNodes distances_, objects_;
  std::unordered_map<cache::Digest, const Memo*, KeyHash> index_;
};

}  // namespace forcelayer::tree
