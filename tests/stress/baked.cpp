#include "tests/stress/baked.h"

#include <stdexcept>

namespace forcelayer::stress {

BakedScene::BakedScene(Mesh mesh, double voxel_size_m, std::uint32_t layers)
    : mesh_(std::move(mesh)), voxel_size_m_(voxel_size_m) {
  bake_scene_file(mesh_, voxel_size_m, layers, folder_ / "scene.vox");
}

Voxmap BakedScene::open() const {
  auto voxmap = Voxmap::open(folder_ / "scene.vox");
  if (!voxmap) throw std::runtime_error(to_line(voxmap.error()));
  return std::move(*voxmap);
}

BakedPart::BakedPart(Mesh mesh, double voxel_size_m) : mesh_(std::move(mesh)) {
  bake_part_file(mesh_, voxel_size_m, folder_ / "part.pshell");
}

Pshell BakedPart::open() const {
  auto shell = Pshell::open(folder_ / "part.pshell");
  if (!shell) throw std::runtime_error(to_line(shell.error()));
  return std::move(*shell);
}

}  // namespace forcelayer::stress
