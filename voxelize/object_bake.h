// One object of a scene by itself: snap, scan, fill, growth and cavities, or the cache in their
// place.
#pragma once

#include <mutex>

#include "voxelize/bake_options.h"
#include "voxelize/cache/object_cache.h"
#include "voxelize/scan/snap.h"
#include "voxelize/stopwatch.h"

namespace forcelayer::voxelize {

// An object on its way into the scene.
struct ObjectBake {
  cache::ObjectFacts facts;
  std::vector<fill::Cavity> cavities;
  std::optional<cache::Digest> key;           // its name in the cache
  std::optional<cache::CachedObject> cached;  // found there; its voxels are not read yet
  const mesh::Mesh* mesh = nullptr;           // not for a cached object, ...
  scan::SnappedObject snapped;                // ... unless distances are stored
  bool from_cache = false;                    // its voxels are the cache's
  StageSeconds seconds;
};

// Looks the object up. An entry that lacks what the options ask for does not count.
void find_in_cache(const SceneObject& object, const BakeOptions& options, ObjectBake& bake);

// Afterwards the object's facts are known. `reading` guards SceneObject::read_mesh.
Status snap_unless_cached(const SceneObject& object, const BakeOptions& options,
                          std::mutex& reading, ObjectBake& bake);

// The object's voxels, counted from `scene_origin`: from the cache, else by bake_voxels().
Result<cache::ObjectVoxels> object_voxels(const SceneObject& object, const BakeOptions& options,
                                          const lattice::VoxelIndex& scene_origin,
                                          std::mutex& reading, ObjectBake& bake);

// The voxels of a snapped object. Completes its facts, and keeps both in the cache.
Result<cache::ObjectVoxels> bake_voxels(const SceneObject& object, const BakeOptions& options,
                                        const lattice::VoxelIndex& scene_origin, ObjectBake& bake);

}  // namespace forcelayer::voxelize
