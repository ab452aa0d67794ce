// From static objects to the force layer in a 512-tree: the whole bake in memory.
//
//   snap -> scan conversion (G) -> flood (F, hence I), each object by itself
//        -> unite -> offset by layers -> 512-tree with clearance
//
// Euclidean layers of two bits start from near_voxels() in place of G and are one layer then; wider
// voxels take the united sets and the snapped meshes.
//
// The sets are those of the paper's sections 4.1 and 4.2; the result is the same for any number of
// threads and any order of objects and triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/mesh/voxel_overlap.h"
#include "formats/result.h"
#include "formats/voxmap_writer.h"
#include "voxelize/cache/digest.h"
#include "voxelize/compliance.h"

namespace forcelayer {

class CacheFolder;

inline constexpr std::uint32_t kMaxBakedLayers = 30;

// One static object in its final pose. The mesh is not owned.
struct SceneObject {
  std::string name;
  const Mesh* mesh = nullptr;       // null: read_mesh() gives it
  Affine world_from_mesh;           // to metres: the mesh's unit is part of it
  std::vector<Vec3d> free_seeds_m;  // world; they open this object alone
  double deviation_m = 0;           // of the mesh from the truth (tessellation, quantisation)
  std::function<Result<const Mesh*>()> read_mesh = {};  // called by one thread at a time
  std::optional<Digest> mesh_digest = {};               // of all of the mesh; needed for a cache
};

struct BakeOptions {
  double voxel_size_m = 0;
  std::uint32_t layers = 2;            // k, at most kMaxBakedLayers
  Metric metric = Metric::kChebyshev;  // Euclidean layers need k of 1 or more
  std::uint32_t bits = 2;              // 4 and 8: quantised distances; Euclidean only
  // How deep distances inside the zero force are kept (4, 8 bits); 0: default_range_voxels().
  double range_m = 0;
  // Force over depth of a soft covering (4, 8 bits), whose zero force lies as far above the
  // interior as the covering is deep, and at least a voxel. None: the model's own stiffness.
  Compliance compliance = {};
  std::vector<Vec3d> free_seeds_m;  // world; they open every object that encloses them
  double mesh_deviation_m = 0;      // declared deviation of all meshes from the truth
  // World box x0, y0, z0, x1, y1, z1: what lies outside the voxels that it touches is left out.
  std::optional<std::array<double, 6>> roi_m = {};
  bool find_cavities = false;          // ObjectReport::cavities
  bool find_narrow_passages = false;   // Cavity::opens_at_half_size; bakes enclosing parts again
  int threads = 0;                     // 0: as many as the machine has
  const CacheFolder* cache = nullptr;  // where objects that did not change are found again
  std::string scene_name = {};         // with a cache: bakes of this name share unchanged nodes
  std::function<void(const char* stage, double share_done)> progress;  // may be empty
};

// Whether an object's voxels are those of near_voxels() in place of G.
inline bool grows_surface(const BakeOptions& options) {
  return options.metric == Metric::kEuclidean && options.bits == 2;
}

// How deep the force layer of stored distances is, voxels.
inline double force_layer_voxels(const BakeOptions& options) {
  if (options.compliance.empty()) return 1;
  return std::max(1.0, options.compliance.back().depth_m / options.voxel_size_m);
}

// A connected piece of an object's interior: solid, or the inside of a closed shell. The voxels
// alone cannot tell; a free seed opens it.
struct Cavity {
  std::uint64_t voxels = 0;
  VoxelIndex seed_voxel{};  // world voxel index; its centre is a point inside
  // At half the voxel size the outside reaches it: what closed it is a gap narrower than a voxel.
  bool opens_at_half_size = false;
};
inline constexpr std::size_t kMaxReportedCavities = 64;  // of an object

struct ObjectReport {
  std::string name;
  std::uint64_t triangles = 0;
  std::uint64_t degenerate_triangles = 0;  // no area after snapping
  std::uint64_t geometry_voxels = 0;       // |G|
  std::uint64_t interior_voxels = 0;       // |I|
  std::uint64_t cavity_count = 0;
  std::vector<Cavity> cavities;  // the largest first, at most kMaxReportedCavities
  bool from_cache = false;       // its voxels were found in the cache
  bool skipped = false;          // it cannot touch the region of interest
};

// Wall time by stage; objects are baked side by side, and then scan, flood, cavities, cache and
// unite add up theirs.
struct StageSeconds {
  double snap = 0, scan = 0, flood = 0, near = 0, cavities = 0, cache = 0, unite = 0, tree = 0;
};

// A finished bake, which owns what VoxmapContent points to.
struct Bake {
  VoxmapHeader header{};
  std::vector<std::uint32_t> directory, upper_nodes, lower_nodes, bricks;
  std::vector<float> compliance;
  std::vector<ObjectReport> objects;  // in the order given
  // With a cache: nodes of 64^3 voxels near surfaces, and how many did not have to be built.
  std::uint64_t nodes = 0, reused_nodes = 0;
  StageSeconds seconds;

  VoxmapContent content(std::string_view provenance) const {
    return {header, directory, upper_nodes, lower_nodes, bricks, compliance, provenance};
  }
};

// Errors: kBakeTooLarge before any memory is taken, kSceneInvalid for a seed inside geometry or a
// position beyond the lattice, kMeshEmpty where there is no triangle at all, kUsage for options out
// of range.
Result<Bake> bake(std::span<const SceneObject> objects, const BakeOptions& options);

// Bakes the objects into the cache of the options and goes no further: a share of a bake. The
// result has reports and seconds alone. No objects, or none with triangles, is no error.
Result<Bake> bake_parts(std::span<const SceneObject> objects, const BakeOptions& options);

}  // namespace forcelayer
