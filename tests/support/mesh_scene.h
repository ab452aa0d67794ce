// Random scenes of meshes, for the property tests of the bake.
#pragma once

#include <vector>

#include "tests/support/baked_scene.h"
#include "tests/support/soups.h"

namespace forcelayer::reference {

// Meshes in voxels of 1 m.
struct MeshScene {
  std::vector<mesh::Mesh> meshes;
  std::vector<mesh::Vec3d> seeds_m;

  std::vector<voxelize::SceneObject> objects() const { return objects_of(meshes); }
  std::vector<LatticeMesh> lattice() const {
    std::vector<LatticeMesh> list;
    for (const mesh::Mesh& mesh : meshes) list.push_back(snapped(mesh, mesh::Affine{}, 1));
    return list;
  }
};

// Up to `largest` objects of up to `extent` voxels, around a place where blocks, nodes and bricks
// meet more often than not.
inline MeshScene random_scene(Random& random, double extent, std::int64_t largest) {
  MeshScene scene;
  mesh::Vec3d place;
  for (double& x : place) {
    x = static_cast<double>(whole(random, -3, 3) * 512 + whole(random, -8, 8));
  }
  for (std::int64_t n = whole(random, 1, largest); n > 0; --n) {
    mesh::Vec3d center = place;
    for (double& x : center) x += real(random, -extent / 3, extent / 3);
    scene.meshes.push_back(random_object(random, center, real(random, 1, extent)));
  }
  return scene;
}

}  // namespace forcelayer::reference
