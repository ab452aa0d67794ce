// The one file of voxinfo that includes the mesh library; no_libraries.cpp replaces it in a build
// without.
#include "formats/mesh/writers/glb.h"
#include "formats/voxinfo/surface.h"

namespace forcelayer::voxinfo {

Status write_surface_glb(const SolidSurface& surface, const std::string& out) {
  mesh::GlbNode node;
  node.name = "solid";
  node.color = {0.6, 0.7, 0.8};
  node.triangles = surface.triangles;
  node.vertices_m.reserve(surface.vertices_m.size());
  for (const auto& [x, y, z] : surface.vertices_m) {
    node.vertices_m.push_back(
        {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
  }
  return mesh::write_glb(out, std::span(&node, 1), nullptr, mesh::Up::kZ);
}

}  // namespace forcelayer::voxinfo
