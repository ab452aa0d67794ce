// The vector kernel of the distance field: sixteen, eight or four points at a time, for the widest
// vectors that the machine has. The arithmetic is that of runtime/field/distance_field.h, without
// fused multiply-add, so that every width gives the same bits.
#pragma once

#include "runtime/field/distance_bricks.h"
#include "runtime/field/force_field.h"
#include "runtime/query/contact_query.h"

namespace forcelayer {

// The constants of the push in distance_field.h.
inline constexpr float kLeastSlope = 0.1f;    // per voxel: below, a direction is not trusted
inline constexpr float kBeyondSlope = 0.05f;  // of the normal that counts beside the slope
inline constexpr float kBuriedVoxels = 1.5f;  // depth from which it begins to, in full a half later
inline constexpr float kNoDirection = 1e-6f;  // lengths below are directionless

// What turns codes into metres.
struct DistanceCodes {
  float voxel_size_m = 0;
  float zero_code = 0;
  float voxels_per_code = 0;
};

// ForceField::measure.
void measure_by_distance(const CollectedPoints& points, const DistanceCodes& codes,
                         DistanceBricks& bricks, FieldSamples& samples) noexcept;

}  // namespace forcelayer
