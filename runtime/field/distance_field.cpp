#include "runtime/field/distance_field.h"

namespace forcelayer {

std::optional<Error> DistanceField::unreadable(const Voxmap& voxmap) {
  if (voxmap.header().bits_per_voxel != 2) return std::nullopt;
  return Error{ErrorCode::kUsage, "", "distance field", "the scene stores the four values alone",
               "bake the scene with --bits 8, or use --force level"};
}

DistanceField::DistanceField(const Voxmap& voxmap)
    : codes_{static_cast<float>(voxmap.voxel_size_m()),
             static_cast<float>(voxmap.header().zero_code),
             static_cast<float>(voxmap.header().quantum_m / voxmap.voxel_size_m())},
      bricks_(voxmap) {}

void DistanceField::measure(const CollectedPoints& points, FieldSamples& samples) const noexcept {
  measure_by_distance(points, codes_, bricks_, samples);
}

}  // namespace forcelayer
