#include "runtime/force_field.h"

#include "runtime/tangent_plane.h"

namespace forcelayer {

void FieldSamples::reserve(std::uint64_t points) {
  at.resize(points);
  for (auto* values : {&depth_m, &dx, &dy, &dz}) values->resize(points);
}

std::unique_ptr<ForceField> make_force_field(ForceKind kind, const Voxmap& voxmap) {
  switch (kind) {
    case ForceKind::kTangentPlane:
      break;
  }
  return std::make_unique<TangentPlaneField>(voxmap.voxel_size_m());
}

}  // namespace forcelayer
