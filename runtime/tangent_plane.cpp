#include "runtime/tangent_plane.h"

#include <cmath>

namespace forcelayer {

void TangentPlaneField::evaluate(const CollectedPoints& points,
                                 FieldSamples& samples) const noexcept {
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    const auto value = static_cast<VoxelValue>(points.value[i]);
    if (value == VoxelValue::kProximity) continue;
    const float depth_voxels = value == VoxelValue::kInterior
                                   ? 0.5f
                                   : points.nx[i] * (0.5f - points.fx[i]) +
                                         points.ny[i] * (0.5f - points.fy[i]) +
                                         points.nz[i] * (0.5f - points.fz[i]);
    if (!(depth_voxels > 0.0f)) continue;
    samples.at[count] = i;
    samples.depth_m[count] = depth_voxels * voxel_size_m_;
    samples.dx[count] = points.nx[i];
    samples.dy[count] = points.ny[i];
    samples.dz[count] = points.nz[i];
    ++count;
  }
  samples.count = count;
}

void TangentPlaneField::measure(const CollectedPoints& points,
                                FieldSamples& samples) const noexcept {
  for (std::uint32_t i = 0; i < points.count; ++i) {
    const float nx = points.nx[i], ny = points.ny[i], nz = points.nz[i];
    float depth_voxels =
        nx * (0.5f - points.fx[i]) + ny * (0.5f - points.fy[i]) + nz * (0.5f - points.fz[i]);
    const auto value = static_cast<VoxelValue>(points.value[i]);
    if (value == VoxelValue::kInterior) depth_voxels = 0.5f;
    if (value == VoxelValue::kProximity) {
      depth_voxels -= std::abs(nx) + std::abs(ny) + std::abs(nz);
    }
    samples.at[i] = i;
    samples.depth_m[i] = depth_voxels * voxel_size_m_;
    samples.dx[i] = nx;
    samples.dy[i] = ny;
    samples.dz[i] = nz;
    samples.gx[i] = nx;
    samples.gy[i] = ny;
    samples.gz[i] = nz;
  }
  samples.count = points.count;
}

}  // namespace forcelayer
