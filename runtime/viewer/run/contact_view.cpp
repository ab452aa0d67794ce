#include "runtime/viewer/run/contact_view.h"

#include <algorithm>
#include <utility>

namespace forcelayer {

const char* frame_kind_name(FrameKind kind) {
  switch (kind) {
    case FrameKind::kFree:
      return "free space";
    case FrameKind::kProximity:
      return "proximity";
    case FrameKind::kForceLayer:
      return "in the force layer, no contact";
    case FrameKind::kContact:
      return "contact";
    case FrameKind::kGuardCut:
      return "contact, motion cut by the guard";
    case FrameKind::kPenetration:
      return "PENETRATION";
  }
  return "";
}

FrameKind ContactView::kind() const {
  if (interior > 0) return FrameKind::kPenetration;
  if (contacts > 0) return FrameKind::kContact;
  if (surface > 0) return FrameKind::kForceLayer;
  return proximity > 0 ? FrameKind::kProximity : FrameKind::kFree;
}

Pose world_from_center(const Pose& world_from_part, const Pshell& shell) {
  const auto& center_m = shell.header().center_m;
  return world_from_part * Pose{{center_m[0], center_m[1], center_m[2]}, {1, 0, 0, 0}};
}

ContactProbe::ContactProbe(const Voxmap& voxmap, const Pshell& shell,
                           std::unique_ptr<ForceField> field)
    : shell_(shell), query_(voxmap, shell), field_(std::move(field)) {
  points_.reserve(shell.view().point_count);
  samples_.reserve(shell.view().point_count);
}

ContactView ContactProbe::at(const Pose& world_from_part) {
  const Pose pose = world_from_center(world_from_part, shell_);
  query_.run(pose, points_);
  field_->evaluate(points_, samples_);
  ContactView view;
  view.proximity = points_.proximity_count;
  view.surface = points_.surface_count;
  view.interior = points_.interior_count;
  for (std::uint32_t n = 0; n < points_.count; ++n) {
    view.points.push_back(
        {pose.position_m + glm::dvec3(points_.rx[n], points_.ry[n], points_.rz[n]),
         {points_.nx[n], points_.ny[n], points_.nz[n]},
         static_cast<VoxelValue>(points_.value[n])});
  }
  for (std::uint32_t n = 0; n < samples_.count; ++n) {
    ViewPoint& point = view.points[samples_.at[n]];
    point.depth_m = samples_.depth_m[n];
    point.direction = {samples_.dx[n], samples_.dy[n], samples_.dz[n]};
    if (point.value != VoxelValue::kInterior) ++view.contacts;
    view.deepest_m = std::max(view.deepest_m, point.depth_m);
  }
  return view;
}

}  // namespace forcelayer
