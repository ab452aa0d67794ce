// Scenes and parts for the stress tests: meshes, and the files that the project's own bakes make of
// them.
#pragma once

#include <filesystem>
#include <memory>

#include "formats/mesh/mesh.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::stress {

// A static scene, its mesh in world, m. Throws std::runtime_error where the bake fails.
class BakedScene {
 public:
  BakedScene(Mesh mesh, double voxel_size_m, std::uint32_t layers = 2);
  const Mesh& mesh() const { return mesh_; }
  double voxel_size_m() const { return voxel_size_m_; }
  Voxmap open() const;

 private:
  Mesh mesh_;
  double voxel_size_m_;
  test::ScratchFolder folder_;
};

// A moving part, its mesh in the part's frame, m. Throws std::runtime_error where the bake fails.
class BakedPart {
 public:
  BakedPart(Mesh mesh, double voxel_size_m);
  const Mesh& mesh() const { return mesh_; }
  Pshell open() const;

 private:
  Mesh mesh_;
  test::ScratchFolder folder_;
};

// The two bakes, in units of their own: both areas name their options alike.
void bake_scene_file(const Mesh& mesh, double voxel_size_m, std::uint32_t layers,
                     const std::filesystem::path& path);
void bake_part_file(const Mesh& mesh, double voxel_size_m, const std::filesystem::path& path);

}  // namespace forcelayer::stress
