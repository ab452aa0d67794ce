// The whole bake in memory: from static objects to the force layer in a 512-tree.
//
//   each object:  snap -> scan (G) -> fill (I) [-> grow by Euclidean distance]
//   the scene:    unite -> layers -> bricks -> tree with clearance -> equal parts shared
//                       -> distances and nearest objects -> bricks -> trees -> equal parts shared
//
// voxelize/README.md follows a triangle through these stages. The voxels are the sets of the
// paper's sections 4.1 and 4.2; the bytes are the same for any number of threads and any order of
// objects and triangles, but that objects are numbered in their order.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/voxmap_writer.h"
#include "voxelize/bake_options.h"
#include "voxelize/fill/cavity.h"
#include "voxelize/stopwatch.h"
#include "voxelize/tree/sharing.h"

namespace forcelayer::voxelize {

struct ObjectReport {
  std::string name;
  std::uint64_t triangles = 0;
  std::uint64_t degenerate_triangles = 0;  // no area after snapping
  std::uint64_t geometry_voxels = 0;       // |G|
  std::uint64_t interior_voxels = 0;       // |I|
  std::uint64_t cavity_count = 0;
  std::vector<fill::Cavity> cavities;  // the largest first, at most kMaxReportedCavities
  bool from_cache = false;             // its voxels were found in the cache
  bool skipped = false;                // it cannot touch the region of interest
};

// A finished bake, which owns what VoxmapContent points to.
struct Bake {
  VoxmapHeader header{};
  tree::VoxelTree values, distances, nearest_objects;
  std::string object_names;           // as in the file
  std::vector<float> compliance;      // Pa over depth
  std::vector<ObjectReport> objects;  // in the order given
  // With a cache: nodes of 64^3 voxels near surfaces, and how many did not have to be built.
  std::uint64_t nodes = 0, reused_nodes = 0;
  std::uint64_t distance_nodes = 0, reused_distance_nodes = 0;  // the same, of distances
  std::size_t bytes_on_disk = 0;  // of triangles that waited in a temporary file
  StageSeconds seconds;

  static TreeContent content_of(const tree::VoxelTree& tree) {
    return {tree.directory, tree.upper_nodes, tree.lower_nodes, tree.bricks};
  }
  VoxmapContent content(std::string_view provenance) const {
    return {header,
            content_of(values),
            content_of(distances),
            content_of(nearest_objects),
            object_names,
            compliance,
            provenance};
  }
};

// A header with the fields that the options alone decide: voxel size, layers, metric and the
// lengths of force and distances.
VoxmapHeader header_lengths(const BakeOptions& options);

// Errors: kBakeTooLarge before any memory is taken, kSceneInvalid for a seed inside geometry or a
// position beyond the lattice, kMeshEmpty where there is no triangle at all, kUsage for options out
// of range.
Result<Bake> bake(std::span<const SceneObject> objects, const BakeOptions& options);

// The errors of bake() that come before it takes memory for voxels.
Status check_size(std::span<const SceneObject> objects, const BakeOptions& options);

// A shard of a bake: bakes the objects into the cache of the options and stops there. The result
// has reports and seconds alone. No objects, or none with triangles, is no error.
Result<Bake> bake_shard(std::span<const SceneObject> objects, const BakeOptions& options);

}  // namespace forcelayer::voxelize
