#include "runtime/field/field_probe.h"

#include <algorithm>

#include "formats/guard.h"

namespace forcelayer::field {
namespace {

// Least and largest weight of a point. A shell may hold points of almost no area at its edges,
// which must still hold the part off.
constexpr float kLeastWeight = 0.25f, kMostWeight = 4.0f;

}  // namespace

FieldProbe::FieldProbe(query::ContactQuery& query, const ForceField& field,
                       query::CollectedPoints& points, FieldSamples& samples)
    : query_(query),
      field_(field),
      points_(points),
      samples_(samples),
      weight_(query.shell().view().point_count) {
  const VoxmapHeader& header = query.voxmap().header();
  guard_m_ = field.proves_distances() ? static_cast<float>(guard_distance_m(header)) : 0;
  free_m_ = field.proves_distances() ? static_cast<float>(free_distance_m(header)) : 0;
  told_by_distance_ = field.proves_distances() && has_standoff(header);
  const auto mean_m2 = static_cast<float>(mean_point_area_m2(query.shell()));
  const float* weight_m2 = query.shell().view().weight_m2;
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    weight_[i] = std::clamp(weight_m2[i] / mean_m2, kLeastWeight, kMostWeight);
  }
}

void FieldProbe::look_up(const Pose& world_from_center, ContactSet& out) noexcept {
  query_.run(world_from_center, points_);
  read(out);
}

// The points that the guard keeps out, and the least proven distance.
void FieldProbe::bar(ContactSet& out) const noexcept {
  out.barred = 0;
  out.least_distance_m = free_m_;
  out.nearest = ContactSet::kNone;
  std::uint32_t proximity = 0;  // points of value 3 that are not barred
  for (std::uint32_t i = 0; i < out.count; ++i) {
    bool barred =
        !told_by_distance_ && out.value[i] == static_cast<std::uint8_t>(VoxelValue::kInterior);
    if (field_.proves_distances()) {
      const float distance_m = samples_.distance_m[i];
      barred = barred || distance_m < guard_m_;
      if (distance_m < out.least_distance_m) {
        out.least_distance_m = distance_m;
        out.nearest = i;
      }
    }
    out.is_barred[i] = barred ? 1 : 0;
    out.barred += barred ? 1 : 0;
    proximity += !barred && out.value[i] == static_cast<std::uint8_t>(VoxelValue::kProximity);
  }
  if (!told_by_distance_) return;
  out.interior = out.barred;
  out.proximity = proximity;
  out.surface = out.count - out.barred - proximity;
}

void FieldProbe::read(ContactSet& out) noexcept {
  field_.measure(points_, samples_);
  out.count = points_.count;
  out.interior = points_.interior_count;
  out.surface = points_.surface_count;
  out.proximity = points_.proximity_count;
  out.outside_map = points_.outside_map;
  const auto copy = [&out](const auto& from, auto& to) {
    std::copy_n(from.begin(), out.count, to.begin());
  };
  copy(points_.rx, out.rx), copy(points_.ry, out.ry), copy(points_.rz, out.rz);
  copy(samples_.dx, out.ux), copy(samples_.dy, out.uy), copy(samples_.dz, out.uz);
  copy(samples_.depth_m, out.depth_m);
  copy(points_.index, out.point);
  copy(points_.value, out.value);
  for (std::uint32_t i = 0; i < out.count; ++i) out.weight[i] = weight_[out.point[i]];
  bar(out);
  if (field_.has_exact_slopes()) return;
  const auto voxel_size_m = static_cast<float>(query_.voxmap().voxel_size_m());
  average_directions(points_, samples_, voxel_size_m, -voxel_size_m, out);
}

}  // namespace forcelayer::field
