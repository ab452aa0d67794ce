#include "runtime/field_probe.h"

#include <algorithm>

#include "runtime/surface_directions.h"

namespace forcelayer {
namespace {

// A point stands for between these shares of the mean area: a shell may hold points of almost no
// area at its edges, which must still hold the part off.
constexpr float kLeastWeight = 0.25f, kMostWeight = 4.0f;

}  // namespace

FieldProbe::FieldProbe(ContactQuery& query, const ForceField& field, CollectedPoints& points,
                       FieldSamples& samples)
    : query_(query),
      field_(field),
      points_(points),
      samples_(samples),
      mean_area_m2_(static_cast<float>(mean_point_area_m2(query.shell()))) {}

void FieldProbe::look_up(const Pose& world_from_center, ContactSet& out) noexcept {
  query_.run(world_from_center, points_);
  read(out);
}

void FieldProbe::read(ContactSet& out) noexcept {
  field_.measure(points_, samples_);
  out.count = samples_.count;
  out.interior = points_.interior_count;
  out.surface = points_.surface_count;
  out.proximity = points_.proximity_count;
  out.outside_map = points_.outside_map;
  const float* weight_m2 = query_.shell().view().weight_m2;
  for (std::uint32_t i = 0; i < samples_.count; ++i) {
    const std::uint32_t at = samples_.at[i];
    Contact& c = out.contacts[i];
    c.arm_m = {points_.rx[at], points_.ry[at], points_.rz[at]};
    c.direction = {samples_.dx[i], samples_.dy[i], samples_.dz[i]};
    c.depth_m = samples_.depth_m[i];
    c.point = points_.index[at];
    c.weight = std::clamp(weight_m2[c.point] / mean_area_m2_, kLeastWeight, kMostWeight);
    c.interior = points_.value[at] == static_cast<std::uint8_t>(VoxelValue::kInterior) ? 1 : 0;
  }
  if (field_.has_exact_slopes()) return;
  const auto voxel_size_m = static_cast<float>(query_.voxmap().voxel_size_m());
  average_directions(points_, samples_, voxel_size_m, -voxel_size_m, out);
}

}  // namespace forcelayer
