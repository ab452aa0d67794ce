#include "runtime/field/tangent_plane.h"

#include <algorithm>
#include <cmath>

namespace forcelayer::field {

TangentPlaneField::TangentPlaneField(const Voxmap& voxmap)
    : voxel_size_m_(static_cast<float>(voxmap.voxel_size_m())) {
  const VoxmapHeader& header = voxmap.header();
  if (header.bits_per_voxel == 2) return;
  distances_ = &voxmap.view();
  zero_code_ = static_cast<float>(header.zero_code);
  voxels_per_code_ = static_cast<float>(header.quantum_m / header.voxel_size_m);
}

// How far a point lies behind its plane.
inline float TangentPlaneField::depth_voxels(const query::CollectedPoints& points,
                                             std::uint32_t i) const noexcept {
  const float from_center = points.nx[i] * (0.5f - points.fx[i]) +
                            points.ny[i] * (0.5f - points.fy[i]) +
                            points.nz[i] * (0.5f - points.fz[i]);
  if (distances_ == nullptr) return from_center;
  const auto code =
      static_cast<float>(distances_->lookup(points.vx[i], points.vy[i], points.vz[i]).code);
  return from_center + (zero_code_ - code) * voxels_per_code_;
}

void TangentPlaneField::measure(const query::CollectedPoints& points,
                                FieldSamples& samples) const noexcept {
  for (std::uint32_t i = 0; i < points.count; ++i) {
    const float nx = points.nx[i], ny = points.ny[i], nz = points.nz[i];
    float depth = depth_voxels(points, i);
    const auto value = static_cast<VoxelValue>(points.value[i]);
    if (distances_ == nullptr) {
      if (value == VoxelValue::kInterior) depth = 0.5f;
      if (value == VoxelValue::kProximity) depth -= std::abs(nx) + std::abs(ny) + std::abs(nz);
    } else if (value == VoxelValue::kProximity) {
      depth = std::min(depth, 0.0f);
    }
    samples.depth_m[i] = depth * voxel_size_m_;
    samples.dx[i] = nx;
    samples.dy[i] = ny;
    samples.dz[i] = nz;
    samples.gx[i] = nx;
    samples.gy[i] = ny;
    samples.gz[i] = nz;
  }
}

}  // namespace forcelayer::field
