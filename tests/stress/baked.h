// Scenes and parts for the stress tests: meshes, and the files that the project's own bakes make of
// them.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "formats/mesh/mesh.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/voxel_kind.h"

namespace forcelayer::stress {

// A static scene, its mesh in world, m. By one thread at a time.
class BakedScene {
 public:
  // `standoff_m`: of kFull, which is then the only kind; 0: as layers say.
  BakedScene(mesh::Mesh mesh, double voxel_size_m, double standoff_m = 0)
      : mesh_(std::move(mesh)), voxel_size_m_(voxel_size_m), standoff_m_(standoff_m) {}
  const mesh::Mesh& mesh() const { return mesh_; }
  double voxel_size_m() const { return voxel_size_m_; }

  // The scene in voxels of a kind, baked when that kind is first asked for. Throws
  // std::runtime_error where that fails.
  Voxmap open(test::VoxelKind kind = test::VoxelKind::kChebyshev) const;

 private:
  mesh::Mesh mesh_;
  double voxel_size_m_, standoff_m_;
  test::ScratchFolder folder_;
};

// A moving part, its mesh in the part's frame, m; a covering radius of 0 is the usual one. Throws
// std::runtime_error where the bake fails.
class BakedPart {
 public:
  BakedPart(mesh::Mesh mesh, double voxel_size_m, double covering_radius_m = 0);
  const mesh::Mesh& mesh() const { return mesh_; }
  Pshell open() const;

 private:
  mesh::Mesh mesh_;
  test::ScratchFolder folder_;
};

// The two bakes, in units of their own: both areas name their options alike.
void bake_scene_file(const mesh::Mesh& mesh, double voxel_size_m, test::VoxelKind kind,
                     const std::filesystem::path& path, double standoff_m = 0,
                     const std::optional<std::array<double, 6>>& roi_m = {});
// Several objects, numbered in their order, with distances; within a region of interest (world box,
// low corner and high corner, m) where there is one.
void bake_objects_file(std::span<const mesh::Mesh> objects, double voxel_size_m,
                       const std::filesystem::path& path, double standoff_m = 0,
                       const std::optional<std::array<double, 6>>& roi_m = {});
void bake_part_file(const mesh::Mesh& mesh, double voxel_size_m, const std::filesystem::path& path,
                    double covering_radius_m = 0);

}  // namespace forcelayer::stress
