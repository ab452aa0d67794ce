#include "tests/bench/bench_mesh.h"

#include <algorithm>

namespace forcelayer::bench {

mesh::Mesh merged(const mesh::Scene& scene, double scale) {
  mesh::Mesh mesh;
  for (const mesh::MeshObject& part : scene.objects) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const mesh::Vec3d& vertex : scene.mesh_of(part).vertices) {
      mesh::Vec3d world = mesh::apply(part.world_from_mesh, vertex);
      for (double& x : world) x *= scale;
      mesh.vertices.push_back(world);
    }
    for (const mesh::Triangle& t : scene.mesh_of(part).triangles) {
      mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
  }
  return mesh;
}

double longest_side(const mesh::Mesh& mesh) {
  double longest = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    const auto by_axis = [d](const mesh::Vec3d& a, const mesh::Vec3d& b) { return a[d] < b[d]; };
    const auto [low, high] =
        std::minmax_element(mesh.vertices.begin(), mesh.vertices.end(), by_axis);
    longest = std::max(longest, (*high)[d] - (*low)[d]);
  }
  return longest;
}

}  // namespace forcelayer::bench
