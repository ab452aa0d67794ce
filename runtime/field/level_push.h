// The vector kernel of the level field: sixteen, eight or four points at a time, for the widest
// vectors that the machine has. The arithmetic is that of runtime/field/level_field.h, without
// fused multiply-add, so that every width gives the same bits.
#pragma once

#include "runtime/field/force_field.h"
#include "runtime/field/level_bricks.h"
#include "runtime/query/contact_query.h"

namespace forcelayer {

// The constants of the push in level_field.h.
inline constexpr float kDisagreeing = 0.5625f;  // squared cosine up to which the slope counts alone
inline constexpr float kAgreementGain = 16.0f;
inline constexpr float kBuried = -0.5f;        // phi: below, the normal alone begins to count
inline constexpr float kBuriedNormal = 0.05f;  // and how much, beside the slope
inline constexpr float kWeak = 10.0f;          // over the length below which a push fades
inline constexpr float kTiny = 1e-6f;          // lengths below are directionless

// What a map's metric says about depth (level_field.h): a - (phi + b) |d|_1 voxels.
struct LevelScale {
  float voxel_size_m = 0;
  float a = 0;
  float b = 0;
};

// ForceField::measure. Where a push has no direction, the depth is -phi voxels in front of the
// layer and 0 behind, along the normal.
void measure_by_levels(const CollectedPoints& points, const LevelScale& scale, LevelBricks& bricks,
                       FieldSamples& samples) noexcept;

}  // namespace forcelayer
