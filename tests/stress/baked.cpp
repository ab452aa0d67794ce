#include "tests/stress/baked.h"

#include <stdexcept>

namespace forcelayer::stress {

Voxmap BakedScene::open(test::VoxelKind kind) const {
  const auto path = folder_ / test::name_of(kind);
  if (!std::filesystem::exists(path)) {
    bake_scene_file(mesh_, voxel_size_m_, kind, path, standoff_m_);
  }
  auto voxmap = Voxmap::open(path);
  if (!voxmap) throw std::runtime_error(to_line(voxmap.error()));
  return std::move(*voxmap);
}

BakedPart::BakedPart(mesh::Mesh mesh, double voxel_size_m, double covering_radius_m)
    : mesh_(std::move(mesh)) {
  bake_part_file(mesh_, voxel_size_m, folder_ / "part.pshell", covering_radius_m);
}

Pshell BakedPart::open() const {
  auto shell = Pshell::open(folder_ / "part.pshell");
  if (!shell) throw std::runtime_error(to_line(shell.error()));
  return std::move(*shell);
}

}  // namespace forcelayer::stress
