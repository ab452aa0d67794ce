#include "runtime/field/level_field.h"

#include <string>

namespace forcelayer {

namespace {

LevelScale scale_of(const Voxmap& voxmap) {
  LevelScale scale;
  scale.voxel_size_m = static_cast<float>(voxmap.voxel_size_m());
  if (voxmap.header().metric == static_cast<std::uint32_t>(Metric::kEuclidean)) {
    scale.a = 0.8660254f;
    scale.b = 0.5f;
  }
  return scale;
}

}  // namespace

std::optional<Error> LevelField::unreadable(const Voxmap& voxmap) {
  const VoxmapHeader& header = voxmap.header();
  if (header.bits_per_voxel != 2) {
    return Error{ErrorCode::kUsage, "", "level field",
                 "the scene stores distances of " + std::to_string(header.bits_per_voxel) +
                     " bits, the level field reads two-bit values",
                 "leave --force out or use --force distance, or bake the scene with --bits 2"};
  }
  if (header.offset_layers == 0) {
    return Error{ErrorCode::kUsage, "", "level field",
                 "the scene has no offset layers, so its values jump from interior to proximity",
                 "bake the scene with --layers 1 or more, or use --force tangent-plane"};
  }
  return std::nullopt;
}

LevelField::LevelField(const Voxmap& voxmap) : scale_(scale_of(voxmap)), bricks_(voxmap) {}

void LevelField::measure(const CollectedPoints& points, FieldSamples& samples) const noexcept {
  measure_by_levels(points, scale_, bricks_, samples);
}

}  // namespace forcelayer
