#include "formats/audit/voxmap_audit.h"

#include <string>

#include "formats/audit/contents.h"
#include "formats/audit/effort.h"
#include "formats/audit/parts.h"

namespace forcelayer {
namespace {

using voxmap_audit::Contents;
using voxmap_audit::Effort;
using voxmap_audit::Summary;
using voxmap_audit::untrue;

Status audit_counts(const VoxmapHeader& h, const Summary& scene, std::string_view name) {
  const struct {
    const char* field;
    const char* value;
    std::uint64_t said, counted;
  } facts[] = {{"interior_voxels", "1", h.interior_voxels, scene.counts[0]},
               {"surface_voxels", "2", h.surface_voxels, scene.counts[1]},
               {"proximity_voxels", "3", h.proximity_voxels, scene.counts[2]}};
  for (const auto& [field, value, said, counted] : facts) {
    if (said == counted) continue;
    return untrue(name, std::string("header (") + field + ")",
                  "is " + std::to_string(said) + ", but the tree has " + std::to_string(counted) +
                      " voxels of value " + value);
  }
  return {};
}

Status audit_tight_box(const VoxmapHeader& h, const Summary& scene, std::string_view name) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t extent = scene.tight.high[axis] - scene.tight.low[axis];
    const std::int64_t low = extent == 0 ? 0 : h.directory_origin[axis] + scene.tight.low[axis];
    if (h.origin_voxel[axis] == low && h.dims_voxels[axis] == static_cast<std::uint64_t>(extent)) {
      continue;
    }
    return untrue(name, "header (origin_voxel, dims_voxels)",
                  "is not the smallest box around all voxels that are not free: along axis " +
                      std::to_string(axis) + " the smallest box has " + std::to_string(extent) +
                      " voxels and begins at " + std::to_string(low));
  }
  return {};
}

}  // namespace

Status audit_voxmap(const Voxmap& map, std::string_view name) {
  const Contents contents(map);
  if (Status s = audit_counts(map.header(), contents.scene(), name); !s) return s;
  if (Status s = audit_tight_box(map.header(), contents.scene(), name); !s) return s;
  Effort effort(map.bytes().size());
  if (Status s = voxmap_audit::audit_clearances(map, contents, effort, name); !s) return s;
  if (Status s = voxmap_audit::audit_layers(map, contents, effort, name); !s) return s;
  if (Status s = voxmap_audit::audit_distances(map, effort, name); !s) return s;
  // Distances prove the layers as well: every surface voxel has one.
  if (Status s = map.distances() != nullptr
                     ? voxmap_audit::audit_code_neighbors(map, effort, name)
                     : voxmap_audit::audit_layer_count(map, contents, effort, name);
      !s) {
    return s;
  }
  return voxmap_audit::audit_objects(map, name);
}

}  // namespace forcelayer
