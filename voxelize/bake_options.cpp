#include "voxelize/bake_options.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "voxelize/distance/code_scale.h"
#include "voxelize/distance/euclidean_growth.h"

namespace forcelayer::voxelize {
namespace {

Error wrong(const char* what, std::string why, const char* mend) {
  return {ErrorCode::kUsage, "", what, std::move(why), mend};
}

// The compliance and the range that must hold it.
Status check_compliance_depth(const BakeOptions& options) {
  if (options.compliance.empty()) return {};
  if (!stores_distances(options)) {
    return wrong("compliance", "needs stored distances", "leave out --kind");
  }
  if (Status checked = check_compliance(options.compliance); !checked) return checked;
  const double layer = force_layer_voxels(options);
  if (!(layer + 1 <= distance::kMaxRangeVoxels &&
        options.layers + layer <= distance::kMaxBakedLayers + 1)) {
    return wrong("compliance",
                 "is too deep: layers and compliance together take more than 31 voxels",
                 "use larger voxels");
  }
  if (options.range_m > 0 && options.range_m / options.voxel_size_m < layer + 1) {
    return wrong("range", "must be at least one voxel more than the last depth of the compliance",
                 "leave out --range");
  }
  return {};
}

// The standoff, and that the force layer fits between it and the surface.
Status check_standoff(const BakeOptions& options) {
  if (options.standoff_m == 0) return {};
  if (!stores_distances(options)) {
    return wrong("standoff", "needs stored distances, because the guard uses them",
                 "leave out --kind, or use --layers");
  }
  if (options.layers != 0) {
    return wrong("standoff",
                 "cannot be combined with layers, because both set where the force begins",
                 "leave one of them out");
  }
  const double s = options.voxel_size_m, layer = force_layer_voxels(options);
  const double min_m = (layer + kMinInteriorVoxels) * s;
  // A unit in the last place of lengths that were divided and multiplied does not count.
  if (options.standoff_m >= min_m * (1 - 1e-9) &&
      options.standoff_m <= kMaxStandoffVoxels * s * (1 + 1e-9)) {
    return {};
  }
  char why[200];
  std::snprintf(
      why, sizeof why,
      "is %.4g mm, but must be at least %.4g mm (force layer of %.4g voxels + 888/1024 voxel) "
      "and at most %.4g mm (%.4g voxels)",
      options.standoff_m * 1e3, min_m * 1e3, layer, kMaxStandoffVoxels * s * 1e3,
      kMaxStandoffVoxels);
  return wrong("standoff", why,
               options.standoff_m < min_m ? "use a larger standoff, or smaller voxels"
                                          : "use a smaller standoff, or larger voxels");
}

// Metric and range.
Status check_kind(const BakeOptions& options) {
  if (Status standoff = check_standoff(options); !standoff) return standoff;
  if (options.standoff_m == 0 && options.metric == Metric::kEuclidean && options.layers == 0) {
    return wrong("layers", "must be at least 1, except with --kind paper",
                 "use --layers 1 or more, or --kind paper");
  }
  if (Status depth = check_compliance_depth(options); !depth) return depth;
  if (options.range_m == 0) return {};
  if (!stores_distances(options)) {
    return wrong("range", "has no effect without stored distances", "leave it out");
  }
  const double voxels = options.range_m / options.voxel_size_m;
  if (!(voxels >= distance::kMinRangeVoxels && voxels <= distance::kMaxRangeVoxels)) {
    return wrong("range", "is not between 2 and 32 voxels", "");
  }
  return {};
}

}  // namespace

Status check_options(const BakeOptions& options) {
  if (!(options.voxel_size_m >= kMinVoxelSizeM && options.voxel_size_m <= kMaxVoxelSizeM)) {
    return wrong("voxel size", "is not between 1e-9 and 1e6 meters", "");
  }
  if (options.layers > distance::kMaxBakedLayers) {
    return wrong("layers", "are more than " + std::to_string(distance::kMaxBakedLayers), "");
  }
  if (Status kind = check_kind(options); !kind) return kind;
  if (!(options.mesh_deviation_m >= 0 && std::isfinite(options.mesh_deviation_m))) {
    return wrong("mesh deviation", "is not a length of zero or more", "");
  }
  return {};
}

std::int64_t interior_radius_units(const BakeOptions& options) {
  if (options.standoff_m == 0) {
    return distance::interior_radius_units(static_cast<int>(options.layers));
  }
  const double units = (options.standoff_m / options.voxel_size_m - force_layer_voxels(options)) *
                       static_cast<double>(lattice::kSnapUnits);
  constexpr double kRounding = 1e-4;  // of the lengths, in lattice units
  return static_cast<std::int64_t>(std::ceil(units - kRounding));
}

double interior_radius_voxels(const BakeOptions& options) {
  return static_cast<double>(interior_radius_units(options)) /
         static_cast<double>(lattice::kSnapUnits);
}

double force_layer_voxels(const BakeOptions& options) {
  const double smallest = options.standoff_m > 0 ? kStandoffForceVoxels : 1;
  if (options.compliance.empty()) return smallest;
  return std::max(smallest, options.compliance.back().depth_m / options.voxel_size_m);
}

}  // namespace forcelayer::voxelize
