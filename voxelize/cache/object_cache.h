// The voxels of one object in a cache: G, I, the grown surface and the facts that the report needs.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "voxelize/cache/cache_folder.h"
#include "voxelize/fill/cavity.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/masks/voxel_box.h"

namespace forcelayer::cache {

// Facts of one object by itself, before it is united with the others. Kept as it lies in memory.
struct ObjectFacts {
  enum Knows : std::uint64_t { kCavities = 1, kNarrowPassages = 2 };
  std::uint64_t knows = 0;
  std::uint64_t triangles = 0;
  std::uint64_t degenerate_triangles = 0;  // no area after snapping
  std::uint64_t geometry_voxels = 0;       // |G|
  std::uint64_t interior_voxels = 0;       // |I|
  masks::VoxelBox box;                     // of the voxels that hold corners of triangles
  double snap_error_m = 0;
  std::uint64_t cavity_count = 0;
};

// Counted from the scene's origin.
struct ObjectVoxels {
  std::unique_ptr<masks::MaskTree> geometry;  // G
  std::unique_ptr<masks::MaskTree> interior;  // I
  std::unique_ptr<masks::MaskTree> grown;     // grow_surface(); null where objects do not grow
};

// An object found in the cache. Its voxels are read later.
class CachedObject {
 public:
  static std::optional<CachedObject> find(const CacheFolder& cache, const Digest& key);

  const ObjectFacts& facts() const { return facts_; }
  const std::vector<fill::Cavity>& cavities() const { return cavities_; }
  // Nothing where the entry turns out to be damaged.
  std::optional<ObjectVoxels> voxels(const lattice::VoxelIndex& scene_origin) const;

 private:
  explicit CachedObject(CacheEntry entry) : entry_(std::move(entry)) {}

  CacheEntry entry_;
  ObjectFacts facts_;
  std::vector<fill::Cavity> cavities_;
};

void keep_object(const CacheFolder& cache, const Digest& key, const ObjectFacts& facts,
                 const std::vector<fill::Cavity>& cavities, const ObjectVoxels& voxels,
                 const lattice::VoxelIndex& scene_origin);

}  // namespace forcelayer::cache
