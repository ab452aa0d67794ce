#include "voxelize/provenance.h"

#include <nlohmann/json.hpp>

#include "formats/command/command.h"
#include "formats/mesh/content_hash.h"
#include "formats/mesh/missing_faces.h"
#include "formats/mesh/up_axis.h"

namespace forcelayer::voxelize {
namespace {

mesh::Hash128 hash_of(const cache::Digest& digest) { return {digest.low, digest.high}; }

}  // namespace

std::string provenance_of(const mesh::Scene& scene, std::span<const cache::MeshOutline> meshes,
                          const BakeOptions& options) {
  using Json = nlohmann::ordered_json;
  Json parts = Json::array();
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const mesh::MeshObject& part = scene.objects[i];
    parts.push_back(
        {{"name", part.name},
         {"xxh128", mesh::content_hash(hash_of(meshes[i].vertices), hash_of(meshes[i].triangles),
                                       part.world_from_mesh)},
         {"free_seeds_m", part.free_seeds_m},
         {"mesh_deviation_m", part.deviation_m}});
  }
  Json json = {{"tool", std::string("voxelize ") + command::kVersion},
               {"voxel_size_m", options.voxel_size_m},
               {"layers", options.layers},
               {"free_seeds_m", options.free_seeds_m},
               {"mesh_deviation_m", options.mesh_deviation_m},
               {"parts", parts}};
  if (!scene.missing_faces.empty()) json["missing_faces"] = mesh::json_of(scene.missing_faces);
  if (mesh::any_y_up_format(scene.assemblies)) json["up"] = mesh::name_of(scene.up);
  if (options.roi_m) json["roi_m"] = *options.roi_m;
  if (options.metric == Metric::kChebyshev) json["metric"] = "chebyshev";
  if (options.metric == Metric::kEuclidean && !options.distances) json["lean"] = true;
  if (options.standoff_m > 0) json["standoff_m"] = options.standoff_m;
  if (options.range_m > 0) json["range_m"] = options.range_m;
  for (const auto& [depth_m, pressure_pa] : options.compliance) {
    json["compliance"].push_back({{"depth_m", depth_m}, {"pressure_pa", pressure_pa}});
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace forcelayer::voxelize
