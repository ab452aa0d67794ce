// The voxels of one object in a cache: G, I and what the report says about them.
#pragma once

#include <memory>
#include <optional>

#include "voxelize/bake.h"
#include "voxelize/cache/cache_folder.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/scan/snap.h"

namespace forcelayer {

// One object by itself, before it is united with the others.
struct PartFacts {
  enum Knows : std::uint64_t { kCavities = 1, kNarrowPassages = 2 };
  std::uint64_t knows = 0;
  std::uint64_t triangles = 0;
  std::uint64_t degenerate_triangles = 0;
  std::uint64_t geometry_voxels = 0;
  std::uint64_t interior_voxels = 0;
  VoxelBox box;  // of the voxels that hold corners of triangles
  double snap_error_m = 0;
  std::uint64_t cavity_count = 0;
};
struct PartVoxels {
  std::unique_ptr<MaskTree> geometry,
      interior;  // G (or near_voxels()) and I, counted from the scene's origin
};

// The digest of everything that an object's voxels depend on; nothing where the object does not
// say what its mesh is. The scene, its layers (but where grows_surface()) and its region of
// interest are no part of it.
std::optional<Digest> part_key(const SceneObject& object, const BakeOptions& options);

// An object found in the cache. Reading its voxels is left for later.
class CachedPart {
 public:
  static std::optional<CachedPart> find(const CacheFolder& cache, const Digest& key);

  const PartFacts& facts() const { return facts_; }
  const std::vector<Cavity>& cavities() const { return cavities_; }
  // Nothing where the entry is no tree after all.
  std::optional<PartVoxels> voxels(const VoxelIndex& scene_origin) const;

 private:
  explicit CachedPart(CacheEntry entry) : entry_(std::move(entry)) {}

  CacheEntry entry_;
  PartFacts facts_;
  std::vector<Cavity> cavities_;
};

void keep_part(const CacheFolder& cache, const Digest& key, const PartFacts& facts,
               const std::vector<Cavity>& cavities, const PartVoxels& voxels,
               const VoxelIndex& scene_origin);

}  // namespace forcelayer
