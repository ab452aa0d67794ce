#include "runtime/field/tangent_plane.h"

#include <cmath>

namespace forcelayer::field {

void TangentPlaneField::measure(const query::CollectedPoints& points,
                                FieldSamples& samples) const noexcept {
  for (std::uint32_t i = 0; i < points.count; ++i) {
    const float nx = points.nx[i], ny = points.ny[i], nz = points.nz[i];
    float depth =
        nx * (0.5f - points.fx[i]) + ny * (0.5f - points.fy[i]) + nz * (0.5f - points.fz[i]);
    const auto value = static_cast<VoxelValue>(points.value[i]);
    if (value == VoxelValue::kInterior) depth = 0.5f;
    if (value == VoxelValue::kProximity) depth -= std::abs(nx) + std::abs(ny) + std::abs(nz);
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
