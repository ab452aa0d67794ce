// One object of a scene by itself: snap, scan, fill, growth and cavities, or the cache in their
// place.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

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
  std::shared_ptr<const mesh::Mesh> mesh;     // while `snapped` needs it
  scan::SnappedObject snapped;  // not for a cached object, unless distances are stored
  bool from_cache = false;      // its voxels are the cache's
  StageSeconds seconds;
};

// Shared by the objects of a bake.
struct MeshAccess {
  std::mutex reading;                    // guards SceneObject::read_mesh
  std::optional<scan::SpillFile> spill;  // where triangles are, if they are too many for memory

  scan::SpillFile* spill_file() { return spill ? &*spill : nullptr; }
};

// Looks the object up. An entry that lacks what the options ask for does not count.
void find_in_cache(const SceneObject& object, const BakeOptions& options, ObjectBake& bake);

// Afterwards the object's facts are known.
Status snap_unless_cached(const SceneObject& object, const BakeOptions& options, MeshAccess& meshes,
                          ObjectBake& bake);

// The object's voxels, counted from `scene_origin`: from the cache, else by bake_voxels().
Result<cache::ObjectVoxels> object_voxels(const SceneObject& object, const BakeOptions& options,
                                          const lattice::VoxelIndex& scene_origin,
                                          MeshAccess& meshes, ObjectBake& bake);

// The voxels of a snapped object. Completes its facts, and keeps both in the cache.
Result<cache::ObjectVoxels> bake_voxels(const SceneObject& object, const BakeOptions& options,
                                        const lattice::VoxelIndex& scene_origin, MeshAccess& meshes,
                                        ObjectBake& bake);

}  // namespace forcelayer::voxelize
