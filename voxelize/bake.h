// From static objects to the force layer in a 512-tree: the whole bake in memory.
//
//   snap -> scan conversion (G) -> flood (F, hence I), each object by itself
//        -> unite -> offset by layers -> 512-tree with clearance
//
// The sets are those of the paper's sections 4.1 and 4.2; the result is the same for any number of
// threads and any order of objects and triangles.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/result.h"
#include "formats/voxmap_writer.h"

namespace forcelayer {

inline constexpr std::uint32_t kMaxBakedLayers = 30;

// One static object in its final pose. The mesh is not owned.
struct SceneObject {
  std::string name;
  const Mesh* mesh = nullptr;
  Affine world_from_mesh;           // to metres: the mesh's unit is part of it
  std::vector<Vec3d> free_seeds_m;  // world; they open this object alone
  double deviation_m = 0;           // of the mesh from the truth (tessellation, quantisation)
};

struct BakeOptions {
  double voxel_size_m = 0;
  std::uint32_t layers = 2;         // k, at most kMaxBakedLayers
  std::vector<Vec3d> free_seeds_m;  // world; they open every object that encloses them
  double mesh_deviation_m = 0;      // declared deviation of all meshes from the truth
  int threads = 0;                  // 0: as many as the machine has
  std::function<void(const char* stage, double share_done)> progress;  // may be empty
};

struct ObjectReport {
  std::string name;
  std::uint64_t triangles = 0;
  std::uint64_t degenerate_triangles = 0;  // no area after snapping
  std::uint64_t geometry_voxels = 0;       // |G|
  std::uint64_t interior_voxels = 0;       // |I|
};

// Wall time by stage; objects are baked side by side, and then scan, flood and unite add up theirs.
struct StageSeconds {
  double snap = 0, scan = 0, flood = 0, unite = 0, tree = 0;
};

// A finished bake, which owns what VoxmapContent points to.
struct Bake {
  VoxmapHeader header{};
  std::vector<std::uint32_t> directory, upper_nodes, lower_nodes, bricks;
  std::vector<ObjectReport> objects;  // in the order given
  StageSeconds seconds;

  VoxmapContent content(std::string_view provenance) const {
    return {header, directory, upper_nodes, lower_nodes, bricks, {}, provenance};
  }
};

// Errors: kBakeTooLarge before any memory is taken, kSceneInvalid for a seed inside geometry or a
// position beyond the lattice, kMeshEmpty where there is no triangle at all, kUsage for options out
// of range.
Result<Bake> bake(std::span<const SceneObject> objects, const BakeOptions& options);

}  // namespace forcelayer
