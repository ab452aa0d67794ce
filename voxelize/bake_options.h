// The input of a bake: the objects of the static scene, and the options.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/result.h"
#include "formats/voxmap_format.h"
#include "voxelize/cache/digest.h"
#include "voxelize/compliance.h"

namespace forcelayer::cache {
class CacheFolder;
}

namespace forcelayer::voxelize {

// One static object in its final pose. The mesh is not owned.
struct SceneObject {
  std::string name;
  const mesh::Mesh* mesh = nullptr;       // null: read_mesh() gives it
  mesh::Affine world_from_mesh;           // to meters, so it contains the mesh's unit
  std::vector<mesh::Vec3d> free_seeds_m;  // world; they open this object alone
  double deviation_m = 0;                 // of the mesh from the truth (tessellation, quantization)
  // Called by one thread at a time. The mesh may be let go after the last pointer to it.
  std::function<Result<std::shared_ptr<const mesh::Mesh>>()> read_mesh = {};
  std::optional<cache::Digest> mesh_digest = {};  // of all of the mesh; needed for a cache
  std::uint64_t triangle_count = 0;               // where read_mesh() gives the mesh
  double work = 0;  // that its voxels take, about: its part of the progress among the objects
};

// With a standoff, how deep the force layer is where no compliance makes it deeper, in voxels, and
// the largest standoff. The least is the depth of the force layer and kMinInteriorVoxels. A point
// alone holds a hand's whole force at 0.15 voxels (derive_parameters.cpp), before the guard does.
inline constexpr double kStandoffForceVoxels = 0.1, kMaxStandoffVoxels = 30;

struct BakeOptions {
  double voxel_size_m = 0;
  std::uint32_t layers = 2;  // k, at most kMaxBakedLayers; 0 with a standoff
  // With distances: how far from the mesh the force begins; 0: where the layers place it.
  double standoff_m = 0;
  Metric metric = Metric::kEuclidean;  // Euclidean layers need k of 1 or more
  bool distances = true;               // whether to store them; in the Euclidean metric alone
  bool objects = true;                 // whether to store the nearest ones; with distances alone
  // How deep below the zero-force surface distances are kept; 0: as deep as is usual.
  double range_m = 0;
  // Force over depth, with distances. The zero force lies as far above the interior as the
  // compliance is deep, and at least a voxel. Empty: the model's own stiffness.
  Compliance compliance = {};
  std::vector<mesh::Vec3d> free_seeds_m;  // world; they open every object that encloses them
  double mesh_deviation_m = 0;            // declared deviation of all meshes from the truth
  // World box x0, y0, z0, x1, y1, z1. Only the voxels that it touches are kept.
  std::optional<std::array<double, 6>> roi_m = {};
  bool find_cavities = false;         // ObjectReport::cavities
  bool find_narrow_passages = false;  // Cavity::opens_at_half_size; bakes enclosing objects again
  int threads = 0;                    // 0: as many as the machine has
  // Scenes whose triangles take more bytes keep them in a temporary file (scan::SpillFile).
  std::size_t max_triangle_bytes = std::size_t{512} << 20;
  const cache::CacheFolder* cache = nullptr;  // where objects that did not change are found again
  std::string scene_name = {};  // with a cache: bakes of this name reuse unchanged nodes
  std::function<void(const char* stage, double fraction_done)> progress;  // may be empty
};

// Errors (kUsage) for options out of range.
Status check_options(const BakeOptions& options);

// Whether layers are counted from grow_surface() in place of G.
inline bool grows_surface(const BakeOptions& options) {
  return options.metric == Metric::kEuclidean;
}

// Whether distances are stored beside the values.
inline bool stores_distances(const BakeOptions& options) {
  return options.distances && options.metric == Metric::kEuclidean;
}

// Whether the surface of each object grows by itself. Else the scene's grows where distances are
// measured; they are not beyond a cropped side, where layers need it, nor where a cache has them.
inline bool grows_objects(const BakeOptions& options) {
  return grows_surface(options) &&
         (!stores_distances(options) || options.roi_m.has_value() || options.cache != nullptr);
}

// Whether the nearest of `count` objects are stored beside the distances.
inline bool stores_objects(const BakeOptions& options, std::size_t count) {
  return options.objects && stores_distances(options) && count <= kMaxObjects;
}

// How deep the force layer is, in voxels.
double force_layer_voxels(const BakeOptions& options);

// Where the Euclidean interior ends, in lattice units from the mesh: as the layers say, or the
// force layer's depth below the standoff, rounded up.
std::int64_t interior_radius_units(const BakeOptions& options);
double interior_radius_voxels(const BakeOptions& options);

}  // namespace forcelayer::voxelize
