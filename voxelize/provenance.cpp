#include "voxelize/provenance.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "formats/command/command.h"

namespace forcelayer {
namespace {

std::string hex(XXH128_hash_t hash) {
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                static_cast<unsigned long long>(hash.low64));
  return text;
}

// Hash of a mesh in its pose: vertices, triangles and transform.
std::string content_hash(const Mesh& mesh, const Affine& world_from_mesh) {
  const XXH128_hash_t parts[] = {
      XXH3_128bits(mesh.vertices.data(), mesh.vertices.size() * sizeof(Vec3d)),
      XXH3_128bits(mesh.triangles.data(), mesh.triangles.size() * sizeof(Triangle)),
      XXH3_128bits(world_from_mesh.linear.data(), sizeof world_from_mesh.linear),
      XXH3_128bits(world_from_mesh.translation.data(), sizeof world_from_mesh.translation)};
  return hex(XXH3_128bits(parts, sizeof parts));
}

}  // namespace

std::string provenance_of(const Scene& scene, const BakeOptions& options) {
  using Json = nlohmann::ordered_json;
  Json parts = Json::array();
  for (const ScenePart& part : scene.parts) {
    parts.push_back({{"name", part.name},
                     {"xxh128", content_hash(scene.mesh_of(part), part.world_from_mesh)},
                     {"free_seeds_m", part.free_seeds_m},
                     {"mesh_deviation_m", part.deviation_m}});
  }
  const Json json = {{"tool", std::string("voxelize ") + kVersion},
                     {"voxel_size_m", options.voxel_size_m},
                     {"layers", options.layers},
                     {"free_seeds_m", options.free_seeds_m},
                     {"mesh_deviation_m", options.mesh_deviation_m},
                     {"parts", parts}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace forcelayer
