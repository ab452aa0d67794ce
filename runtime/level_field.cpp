#include "runtime/level_field.h"

#include <string>

namespace forcelayer {

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

LevelField::LevelField(const Voxmap& voxmap)
    : voxel_size_m_(static_cast<float>(voxmap.voxel_size_m())), bricks_(voxmap) {}

void LevelField::evaluate(const CollectedPoints& points, FieldSamples& samples) const noexcept {
  push_by_levels(points, voxel_size_m_, bricks_, samples);
}

void LevelField::measure(const CollectedPoints& points, FieldSamples& samples) const noexcept {
  measure_by_levels(points, voxel_size_m_, bricks_, samples);
}

}  // namespace forcelayer
