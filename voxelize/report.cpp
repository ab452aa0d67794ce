#include "voxelize/report.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "formats/command/command.h"
#include "formats/mesh/missing_faces.h"
#include "formats/mesh/up_axis.h"

namespace forcelayer::voxelize {

namespace {

using Json = nlohmann::ordered_json;

Json cavities_of(const ObjectReport& object, double voxel_size_m) {
  Json cavities = Json::array();
  for (const fill::Cavity& cavity : object.cavities) {
    mesh::Vec3d seed_m;
    for (std::size_t d = 0; d < 3; ++d) {
      seed_m[d] = (static_cast<double>(cavity.seed_voxel[d]) + 0.5) * voxel_size_m;
    }
    cavities.push_back(
        {{"volume_m3", static_cast<double>(cavity.voxels) * std::pow(voxel_size_m, 3)},
         {"free_seed_m", seed_m},
         {"opens_at_half_voxel_size", cavity.opens_at_half_size}});
  }
  return cavities;
}

Json report_of_object(const ObjectReport& object, const mesh::MeshFacts& facts,
                      double voxel_size_m) {
  return {{"name", object.name},
          {"triangles", object.triangles},
          {"degenerate_triangles", object.degenerate_triangles},
          {"duplicate_triangles", facts.duplicate_triangles},
          {"boundary_edges", facts.boundary_edges},
          {"non_manifold_edges", facts.non_manifold_edges},
          {"flipped_edges", facts.flipped_edges},
          {"geometry_voxels", object.geometry_voxels},
          {"interior_voxels", object.interior_voxels},
          {"interior_m3", static_cast<double>(object.interior_voxels) * std::pow(voxel_size_m, 3)},
          {"cavity_count", object.cavity_count},
          {"cavities", cavities_of(object, voxel_size_m)},
          {"from_cache", object.from_cache},
          {"outside_roi", object.skipped}};
}

// The nodes that --without left out.
Json left_out_of(const mesh::Scene& scene) {
  std::set<std::string> names;
  for (const mesh::Assembly& assembly : scene.assemblies) {
    names.insert(assembly.left_out.begin(), assembly.left_out.end());
  }
  names.insert(scene.parts_left_out.begin(), scene.parts_left_out.end());
  return names;
}

}  // namespace

Json report_of(const Bake& bake, const mesh::Scene& scene, std::span<const mesh::MeshFacts> facts,
               const BakeFacts& run) {
  const VoxmapHeader& header = bake.header;
  Json origin_m = Json::array();
  for (const std::int64_t voxel : header.origin_voxel) {
    origin_m.push_back(static_cast<double>(voxel) * header.voxel_size_m);
  }
  Json parts = Json::array();
  for (std::size_t i = 0; i < bake.objects.size(); ++i) {
    parts.push_back(report_of_object(bake.objects[i], facts[i], header.voxel_size_m));
  }
  const StageSeconds& seconds = bake.seconds;
  return {{"voxel_size_m", header.voxel_size_m},
          {"origin_voxel", header.origin_voxel},
          {"origin_m", origin_m},
          {"dims", header.dims_voxels},
          {"layers", header.offset_layers},
          {"metric", header.metric == static_cast<std::uint32_t>(Metric::kEuclidean) ? "euclidean"
                                                                                     : "chebyshev"},
          {"distances", has_distances(header)},
          {"object_count", header.object_count},
          {"zero_force_m", header.zero_force_m},
          {"counts",
           {{"interior", header.interior_voxels},
            {"surface", header.surface_voxels},
            {"proximity", header.proximity_voxels}}},
          {"valid_min_voxel", header.valid_min_voxel},
          {"valid_max_voxel", header.valid_max_voxel},
          {"cropped_sides", header.cropped_sides},
          {"triangles", header.triangles},
          {"scene_low_m", run.scene_box_m.low},
          {"scene_high_m", run.scene_box_m.high},
          {"static_deviation_m", header.static_deviation_m},
          {"missing_faces", mesh::json_of(scene.missing_faces)},
          {"without", left_out_of(scene)},
          {"up", mesh::name_of(scene.up)},
          {"triangle_bytes_on_disk", bake.bytes_on_disk},
          {"nodes", bake.nodes},
          {"nodes_from_cache", bake.reused_nodes},
          {"distance_nodes", bake.distance_nodes},
          {"distance_nodes_from_cache", bake.reused_distance_nodes},
          {"parts", parts},
          {"seconds",
           {{"read", run.read_s},
            {"snap", seconds.snap},
            {"scan", seconds.scan},
            {"flood", seconds.flood},
            {"near", seconds.near},
            {"cavities", seconds.cavities},
            {"cache", seconds.cache},
            {"unite", seconds.unite},
            {"tree", seconds.tree},
            {"write", run.write_s},
            {"total", run.total_s}}},
          {"expected", {{"thread_s", run.expected_thread_s}, {"bytes", run.expected_bytes}}},
          {"peak_rss_bytes", command::peak_rss_bytes()},
          {"file_bytes", run.file_bytes},
          {"threads", run.threads},
          {"warnings", run.warnings}};
}

}  // namespace forcelayer::voxelize
