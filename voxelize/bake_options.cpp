#include "voxelize/bake_options.h"

#include <algorithm>
#include <cmath>

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
    return wrong("compliance", "needs stored distances", "leave out --lean and --metric chebyshev");
  }
  if (Status checked = check_compliance(options.compliance); !checked) return checked;
  const double layer = force_layer_voxels(options);
  if (!(layer + 1 <= distance::kMostRangeVoxels &&
        options.layers + layer <= distance::kMaxBakedLayers + 1)) {
    return wrong("compliance", "is too deep: layers and compliance take more than 31 voxels",
                 "use larger voxels");
  }
  if (options.range_m > 0 && options.range_m / options.voxel_size_m < layer + 1) {
    return wrong("range", "ends less than a voxel below the compliance", "leave it out");
  }
  return {};
}

// Metric and range.
Status check_kind(const BakeOptions& options) {
  if (options.metric == Metric::kEuclidean && options.layers == 0) {
    return wrong("layers", "are none: there is nothing for the metric to measure",
                 "use --layers 1 or more, or --metric chebyshev");
  }
  if (Status depth = check_compliance_depth(options); !depth) return depth;
  if (options.range_m == 0) return {};
  if (!stores_distances(options)) {
    return wrong("range", "has no meaning without stored distances", "leave it out");
  }
  const double voxels = options.range_m / options.voxel_size_m;
  if (!(voxels >= distance::kLeastRangeVoxels && voxels <= distance::kMostRangeVoxels)) {
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

double force_layer_voxels(const BakeOptions& options) {
  if (options.compliance.empty()) return 1;
  return std::max(1.0, options.compliance.back().depth_m / options.voxel_size_m);
}

}  // namespace forcelayer::voxelize
