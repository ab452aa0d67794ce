#include "runtime/field/field_probe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>

#include "runtime/field/average_directions.h"

namespace forcelayer::field {
namespace {

// Least weight of a point: a shell may hold points of no area at its edges.
constexpr float kMinWeight = 1e-3f;

}  // namespace

FieldProbe::FieldProbe(query::ContactQuery& query, const ForceField& field,
                       query::CollectedPoints& points, FieldSamples& samples)
    : query_(query),
      field_(field),
      points_(points),
      samples_(samples),
      weight_(query.shell().view().point_count),
      zero_force_m_(static_cast<float>(query.voxmap().header().zero_force_m)) {
  constexpr unsigned kSlotBits = 6;  // a frame asks for places near each other
  if (query.voxmap().distances() != nullptr) {
    unpacked_.emplace(*query.voxmap().distances(), kSlotBits);
  }
  const auto mean_m2 = static_cast<float>(mean_point_area_m2(query.shell()));
  const float* weight_m2 = query.shell().view().weight_m2;
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    weight_[i] = std::max(weight_m2[i] / mean_m2, kMinWeight);
  }
}

void FieldProbe::query_pose(const Pose& world_from_center) noexcept {
  query_.run(world_from_center, points_);
  measure_points();
}

void FieldProbe::measure_points() noexcept {
  forget_sides();
  field_.measure(points_, samples_);
}

// The normal of a point without an inside says nothing: with zero in its place, the field takes
// every direction from the scene's slope, and gives no depth where there is none.
void FieldProbe::forget_sides() noexcept {
  if (query_.shell().view().two_sided == nullptr) return;
  for (std::uint32_t i = 0; i < points_.count; ++i) {
    if (is_two_sided(i)) points_.nx[i] = points_.ny[i] = points_.nz[i] = 0;
  }
}

void FieldProbe::copy_contacts(ContactSet& out) const noexcept {
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
  if (field_.has_exact_slopes()) return;
  const auto voxel_size_m = static_cast<float>(voxmap().voxel_size_m());
  average_directions(points_, samples_, voxel_size_m, -voxel_size_m, out);
}

std::uint32_t FieldProbe::object_of(std::uint32_t i) const noexcept {
  const ObjectView* const objects = voxmap().objects();
  if (objects == nullptr) return 0;
  return objects->lookup(points_.vx[i], points_.vy[i], points_.vz[i]).code;
}

std::uint32_t FieldProbe::object_near(const glm::dvec3& world_m) const noexcept {
  if (voxmap().objects() == nullptr || !unpacked_) return 0;
  const glm::dvec3 at = glm::floor(world_m / voxmap().voxel_size_m());
  constexpr double kFar = 9e15;  // more than any voxel's index
  if (!(std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) < kFar)) return 0;
  const auto x = static_cast<std::int64_t>(at.x), y = static_cast<std::int64_t>(at.y),
             z = static_cast<std::int64_t>(at.z);
  const auto voxel = voxmap().in_directory(x, y, z);
  if (!voxel) return 0;
  const std::uint32_t code = unpacked_->code((*voxel)[0], (*voxel)[1], (*voxel)[2]);
  if (code == 0 || code == kMaxDistanceCode) return 0;
  return voxmap().objects()->lookup((*voxel)[0], (*voxel)[1], (*voxel)[2]).code;
}

bool FieldProbe::lies_beside_solid(std::uint32_t i, float depth_m) const noexcept {
  const DistanceView& distances = *voxmap().distances();
  const VoxmapHeader& header = voxmap().header();
  // A center on the surface has the code below that of zero.
  const double limit_code = header.distance_zero_code - 1 - depth_m / header.distance_quantum_m;
  const std::array<std::int32_t, 3> low{points_.vx[i] - (points_.fx[i] < 0.5f ? 1 : 0),
                                        points_.vy[i] - (points_.fy[i] < 0.5f ? 1 : 0),
                                        points_.vz[i] - (points_.fz[i] < 0.5f ? 1 : 0)};
  for (int n = 0; n < 8; ++n) {
    const std::int32_t x = low[0] + (n >> 2), y = low[1] + (n >> 1 & 1), z = low[2] + (n & 1);
    if (!distances.contains(x, y, z)) continue;
    if (unpacked_->code(x, y, z) < limit_code) return true;
  }
  return false;
}

bool FieldProbe::has_distances(const glm::ivec3& low, const glm::ivec3& high) const noexcept {
  const DistanceView& distances = *voxmap().distances();
  return distances.contains(low.x, low.y, low.z) && distances.contains(high.x, high.y, high.z);
}

// A code stands for the middle of its step.
std::array<float, 8> FieldProbe::cell_distances(const glm::ivec3& voxel) const noexcept {
  const VoxmapHeader& header = voxmap().header();
  const auto step = static_cast<float>(header.distance_quantum_m / header.voxel_size_m);
  const float zero = static_cast<float>(header.distance_zero_code) - 0.5f;
  const std::array<std::uint32_t, 8> codes = unpacked_->cell(voxel.x, voxel.y, voxel.z);
  std::array<float, 8> distances;
  for (std::size_t n = 0; n < 8; ++n) distances[n] = (static_cast<float>(codes[n]) - zero) * step;
  return distances;
}

}  // namespace forcelayer::field
