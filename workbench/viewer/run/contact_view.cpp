#include "workbench/viewer/run/contact_view.h"

#include <algorithm>
#include <glm/geometric.hpp>
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
      return "contact, motion shortened by the guard";
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
  if (model_ == Model::kPaper || !(contacts_.min_distance_m > 0) || contacts_.outside_map) return;
  const double deviations_m = voxmap_.header().static_deviation_m +
                              shell_.header().part_deviation_m + query_.rounding_bound_m();
  const double proven_m =
      surface_distance_bound_m(shell_.surface_distance_terms(), double{contacts_.min_distance_m}) -
      deviations_m;
  if (!(proven_m > 0)) return;
  view.clearance_m = proven_m;
  view.at_least = contacts_.nearest == field::ContactSet::kNone;
  if (view.at_least) return;
  view.nearest_m = pose.position_m + glm::dvec3(contacts_[contacts_.nearest].arm_m);
  view.nearest_object = voxmap_.object_name(probe_.object_near(view.nearest_m));
  const std::size_t n = contacts_.nearest;
  const glm::dvec3 slope(samples_.gx[n], samples_.gy[n], samples_.gz[n]);
  const double steepness = glm::length(slope);
  const double distance_m = voxmap_.header().zero_force_m + double{samples_.from_zero_force_m[n]};
  view.nearest_scene_m = view.nearest_m;
  if (steepness > 0) view.nearest_scene_m -= distance_m / steepness * slope;
}

void ContactViewSource::find_seat(const Pose& world_from_part) {
  if (model_ == Model::kPaper) return;
  // A start that voxrun refuses has no seat, and its contacts are shown as they are.
  static_cast<void>(probe_.find_seat(world_from_center(world_from_part, shell_)));
}

ContactView ContactViewSource::at(const Pose& world_from_part) {
  ContactView view = look_up(world_from_part, true);
  if (view.seated_on.empty()) return view;
  // It may be as near as a force begins, and clear all the same.
  ContactView closed = look_up(world_from_part, false);
  view.clearance_m = closed.clearance_m;
  view.at_least = closed.at_least;
  view.nearest_object = std::move(closed.nearest_object);
  view.nearest_m = closed.nearest_m;
  view.nearest_scene_m = closed.nearest_scene_m;
  return view;
}

ContactView ContactViewSource::as_counted(const Pose& world_from_part, const ContactView& counted) {
  ContactView closed = look_up(world_from_part, false);
  if (probe_.seat().empty()) return closed;
  ContactView open = look_up(world_from_part, true);
  const auto off = [&counted](const ContactView& view) {
    const auto apart = [](std::uint32_t a, std::uint32_t b) {
      return std::max(a, b) - std::min(a, b);
    };
    return apart(view.surface, counted.surface) + apart(view.interior, counted.interior) +
           apart(view.contacts, counted.contacts);
  };
  return off(open) < off(closed) ? open : closed;
}

ContactView ContactViewSource::look_up(const Pose& world_from_part, bool seat_open) {
  const Pose pose = world_from_center(world_from_part, shell_);
  probe_.open_seat(seat_open);
  probe_.query_pose(pose, contacts_);
  const bool paper = model_ == Model::kPaper;
  ContactView view;
  view.proximity = contacts_.proximity;
  view.surface = contacts_.surface;
  view.interior = contacts_.interior;
  for (std::uint32_t n = 0; n < points_.count; ++n) {
    const field::Contact contact = contacts_[n];
    ViewPoint& point =
        view.points.emplace_back(ViewPoint{pose.position_m + glm::dvec3(contact.arm_m),
                                           {points_.nx[n], points_.ny[n], points_.nz[n]},
                                           static_cast<VoxelValue>(points_.value[n])});
    // An open seat lets its points into value 1, as deep as they were there.
    if (contacts_.seat_open && contacts_.of_seat[n] != 0 && contacts_.is_barred[n] == 0 &&
        point.value == VoxelValue::kInterior) {
      point.value = VoxelValue::kSurface;
    }
    // The paper's model feels the field's own directions, and nothing in the interior.
    if (!(contact.depth_m > 0) || (paper && point.value == VoxelValue::kInterior)) continue;
    point.depth_m = contact.depth_m;
    point.direction = paper ? glm::dvec3(samples_.dx[n], samples_.dy[n], samples_.dz[n])
                            : glm::dvec3(contact.direction);
    ++view.contacts;
    view.deepest_m = std::max(view.deepest_m, point.depth_m);
  }
  prove_clearance(pose, view);
  if (contacts_.seat_open && contacts_.seated > 0) {
    for (const guard::SeatObject& object : probe_.seat().objects()) {
      const std::string_view name = voxmap_.object_name(object.object);
      view.seated_on.emplace_back(name.empty() ? "the scene" : name);
    }
  }
  return view;
}

}  // namespace forcelayer::viewer
