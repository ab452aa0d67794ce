#include "runtime/viewer/run/contact_view.h"

#include <algorithm>
#include <utility>

#include "formats/surface_distance.h"

namespace forcelayer::viewer {

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

ContactViewSource::ContactViewSource(const Voxmap& voxmap, const Pshell& shell, Model model,
                                     std::unique_ptr<field::ForceField> field)
    : voxmap_(voxmap),
      shell_(shell),
      model_(model),
      query_(voxmap, shell),
      field_(std::move(field)),
      probe_(query_, *field_, points_, samples_) {
  points_.reserve(shell.view().point_count);
  samples_.reserve(shell.view().point_count);
  contacts_.reserve(shell.view().point_count);
}

// As DefaultModel::report_distance() and Simulation have it.
void ContactViewSource::prove_clearance(const Pose& pose, ContactView& view) const {
  if (model_ == Model::kPaper || !(contacts_.least_distance_m > 0) || contacts_.outside_map) return;
  const double deviations_m = voxmap_.header().static_deviation_m +
                              shell_.header().part_deviation_m + query_.rounding_bound_m();
  const double proven_m = surface_distance_bound_m(shell_.surface_distance_terms(),
                                                   double{contacts_.least_distance_m}) -
                          deviations_m;
  if (!(proven_m > 0)) return;
  view.clearance_m = proven_m;
  view.at_least = contacts_.nearest == field::ContactSet::kNone;
  if (view.at_least) return;
  view.nearest_m = pose.position_m + glm::dvec3(contacts_[contacts_.nearest].arm_m);
  view.nearest_object = voxmap_.object_name(probe_.object_near(view.nearest_m));
}

ContactView ContactViewSource::at(const Pose& world_from_part) {
  const Pose pose = world_from_center(world_from_part, shell_);
  probe_.look_up(pose, contacts_);
  ContactView view;
  view.proximity = points_.proximity_count;
  view.surface = points_.surface_count;
  view.interior = points_.interior_count;
  for (std::uint32_t n = 0; n < points_.count; ++n) {
    const field::Contact contact = contacts_[n];
    ViewPoint& point =
        view.points.emplace_back(ViewPoint{pose.position_m + glm::dvec3(contact.arm_m),
                                           {points_.nx[n], points_.ny[n], points_.nz[n]},
                                           static_cast<VoxelValue>(points_.value[n])});
    // The paper's model feels the field's own directions, and nothing in the interior.
    const bool paper = model_ == Model::kPaper;
    if (!(contact.depth_m > 0) || (paper && view.points.back().value == VoxelValue::kInterior))
      continue;
    point.depth_m = contact.depth_m;
    point.direction = paper ? glm::dvec3(samples_.dx[n], samples_.dy[n], samples_.dz[n])
                            : glm::dvec3(contact.direction);
    ++view.contacts;
    view.deepest_m = std::max(view.deepest_m, point.depth_m);
  }
  prove_clearance(pose, view);
  return view;
}

}  // namespace forcelayer::viewer
