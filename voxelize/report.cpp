#include "voxelize/report.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/command/command.h"

namespace forcelayer {

nlohmann::ordered_json report_of(const Bake& bake, const RunFacts& run) {
  using Json = nlohmann::ordered_json;
  const VoxmapHeader& header = bake.header;
  const double voxel_m3 = std::pow(header.voxel_size_m, 3);
  Json origin_m = Json::array();
  for (const std::int64_t voxel : header.origin_voxel) {
    origin_m.push_back(static_cast<double>(voxel) * header.voxel_size_m);
  }
  Json parts = Json::array();
  for (const ObjectReport& object : bake.objects) {
    parts.push_back({{"name", object.name},
                     {"triangles", object.triangles},
                     {"degenerate_triangles", object.degenerate_triangles},
                     {"geometry_voxels", object.geometry_voxels},
                     {"interior_voxels", object.interior_voxels},
                     {"interior_m3", static_cast<double>(object.interior_voxels) * voxel_m3}});
  }
  const StageSeconds& seconds = bake.seconds;
  return {{"voxel_size_m", header.voxel_size_m},
          {"origin_voxel", header.origin_voxel},
          {"origin_m", origin_m},
          {"dims", header.dims_voxels},
          {"layers", header.offset_layers},
          {"counts",
           {{"interior", header.interior_voxels},
            {"surface", header.surface_voxels},
            {"proximity", header.proximity_voxels}}},
          {"triangles", header.triangles},
          {"static_deviation_m", header.static_deviation_m},
          {"parts", parts},
          {"seconds",
           {{"read", run.read_s},
            {"snap", seconds.snap},
            {"scan", seconds.scan},
            {"flood", seconds.flood},
            {"unite", seconds.unite},
            {"tree", seconds.tree},
            {"write", run.write_s},
            {"total", run.total_s}}},
          {"peak_rss_bytes", peak_rss_bytes()},
          {"file_bytes", run.file_bytes},
          {"threads", run.threads}};
}

}  // namespace forcelayer
