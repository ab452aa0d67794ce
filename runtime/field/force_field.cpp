#include "runtime/field/force_field.h"

#include "runtime/field/distance_field.h"
#include "runtime/field/level_field.h"
#include "runtime/field/tangent_plane.h"

namespace forcelayer::field {
namespace {

constexpr std::size_t kLanePadding = 64;  // elements behind the last that a vector store may write

}  // namespace

void FieldSamples::reserve(std::uint64_t points) {
  const std::size_t room = points + kLanePadding;
  for (auto* values :
       {&depth_m, &dx, &dy, &dz, &gx, &gy, &gz, &distance_m, &from_zero_force_m, &ex, &ey, &ez}) {
    values->resize(room);
  }
}

ForceKind usual_force(Model model, const Voxmap& voxmap) {
  if (model == Model::kPaper) return ForceKind::kTangentPlane;
  if (!DistanceField::unreadable(voxmap)) return ForceKind::kDistance;
  return LevelField::unreadable(voxmap) ? ForceKind::kTangentPlane : ForceKind::kLevel;
}

Result<std::unique_ptr<ForceField>> make_force_field(Model model, ForceKind kind,
                                                     const Voxmap& voxmap) {
  if (model == Model::kPaper && kind != ForceKind::kTangentPlane) {
    return Error{ErrorCode::kUsage, "", "--force",
                 "the paper's model can only use the tangent-plane force",
                 "leave out --force, or use --model default"};
  }
  if (kind == ForceKind::kLevel) {
    if (auto reason = LevelField::unreadable(voxmap)) return *reason;
    return std::unique_ptr<ForceField>(std::make_unique<LevelField>(voxmap));
  }
  if (kind == ForceKind::kDistance) {
    if (auto reason = DistanceField::unreadable(voxmap)) return *reason;
    return std::unique_ptr<ForceField>(std::make_unique<DistanceField>(voxmap));
  }
  return std::unique_ptr<ForceField>(std::make_unique<TangentPlaneField>(voxmap.voxel_size_m()));
}

double mean_point_area_m2(const Pshell& shell) {
  const PshellView& view = shell.view();
  double sum_m2 = 0;
  for (std::uint64_t i = 0; i < view.point_count; ++i) sum_m2 += view.weight_m2[i];
  return sum_m2 / static_cast<double>(view.point_count);
}

}  // namespace forcelayer::field
