#include "workbench/viewer/plan/legend.h"

#include <algorithm>
#include <cmath>

#include "workbench/viewer/plan/arrows.h"

namespace forcelayer::viewer {
namespace {

// The end of a name as far as a legend has room.
std::string short_name(const std::string& name) {
  constexpr std::size_t kMax = 28;
  const std::string shown = escaped(name);
  if (shown.size() <= kMax) return shown;
  std::size_t from = shown.size() - kMax;
  const std::size_t node = shown.find('/', from);
  if (node != std::string::npos) from = node + 1;
  while (from < shown.size() && (shown[from] & 0xc0) == 0x80) ++from;  // whole characters
  return "... " + shown.substr(from);
}

// Those that are shown.
void add_objects(const PicturePlan& plan, const ViewScene& scene,
                 std::vector<LegendEntry>& legend) {
  constexpr std::size_t kMax = 16;
  std::vector<std::size_t> shown;
  for (std::size_t n = 0; n < scene.meshes.size(); ++n) {
    const std::string& name = scene.meshes[n].name;
    if (std::find(plan.hidden.begin(), plan.hidden.end(), name) == plan.hidden.end()) {
      shown.push_back(n);
    }
  }
  const std::size_t count = shown.size();
  const std::size_t named = count <= kMax ? count : kMax - 1;
  for (std::size_t n = 0; n < named; ++n) {
    legend.push_back(
        {Swatch::kSquare, color_of_mesh(shown[n]), 1, short_name(scene.meshes[shown[n]].name)});
  }
  if (named == count) return;
  legend.push_back(
      {Swatch::kSquare, kBackground, 0, std::to_string(count - named) + " more objects"});
}

void add_scene(const PicturePlan& plan, const ViewScene& scene, std::vector<LegendEntry>& legend) {
  if (!scene.meshes.empty() && plan.shown[Item::kMeshes]) {
    if (plan.measure) {
      if (!plan.measure->object.empty()) {
        legend.push_back({Swatch::kSquare, kMeasuredColor, 1, short_name(plan.measure->object)});
      }
      legend.push_back({Swatch::kSquare, kSceneColor, 0.6, "other objects"});
    } else if (plan.color_objects) {
      add_objects(plan, scene, legend);
    } else {
      legend.push_back({Swatch::kSquare, kSceneColor, 1, "scene (mesh)"});
    }
  }
  if (!scene.missing_faces.empty() && plan.shown[Item::kMeshes]) {
    legend.push_back({Swatch::kFramedSquare, kMissingFaceColor, 1, "here the mesh lacks a face"});
  }
  if (!scene.voxmap) return;
  if (plan.shown[Item::kInterior]) {
    legend.push_back({Swatch::kSquare, kInteriorColor, 1, "interior voxels (value 1)"});
  }
  if (plan.shown[Item::kForceLayer]) {
    legend.push_back({Swatch::kSquare, kForceLayerColor, plan.change ? 0.15 : 0.5,
                      plan.change ? "current force layer" : "force layer (value 2)"});
  }
  if (plan.shown[Item::kProximity]) {
    legend.push_back({Swatch::kSquare, kProximityColor, 0.4, "proximity (value 3)"});
  }
  if (plan.change) {
    legend.push_back({Swatch::kSquare, kAddedColor, 1, "force layer added"});
    legend.push_back({Swatch::kFramedSquare, kRemovedColor, 1, "force layer removed"});
  }
}

void add_moment(const PicturePlan& plan, const ViewScene& scene, std::vector<LegendEntry>& legend) {
  if (scene.part && plan.shown[Item::kPart]) {
    legend.push_back(
        {Swatch::kSquare, kPartColor, plan.measure ? kMeasuredPartOpacity : 1, "part (mesh)"});
  }
  if (scene.shell && plan.shown[Item::kShell]) {
    legend.push_back({Swatch::kSquare, kPartColor, 1, "part (point shell)"});
  }
  if (!scene.part_missing_faces.empty() && (plan.shown[Item::kPart] || plan.shown[Item::kShell])) {
    legend.push_back({Swatch::kFramedSquare, kMissingFaceColor, 1, "here the part lacks a face"});
  }
  if (plan.moment->world_from_target && plan.shown[Item::kHandle]) {
    if (scene.part)
      legend.push_back({Swatch::kLine, kGhostColor, 1, "where the hand holds the part"});
    legend.push_back({Swatch::kCoil, kGhostColor, 1, "virtual coupling"});
  }
  if (!plan.shown[Item::kContacts]) return;
  if (scene.voxmap && scene.shell) {
    const Arrows arrows = arrows_of(scene, plan.moment->contacts);
    legend.push_back({Swatch::kArrow, kContactColor, 1,
                      text_of("contact force on the part (%g x the depth)", arrows.per_depth)});
    if (arrows.left_out > 0) {
      legend.push_back({Swatch::kDot, kContactColor, 1,
                        text_of("%zu shallower contacts have no arrow", arrows.left_out)});
    }
    legend.push_back({Swatch::kDot, kForceLayerColor, 1, "point in the force layer, depth 0"});
    legend.push_back({Swatch::kSmallSquare, kProximityColor, 1, "point in proximity"});
    legend.push_back({Swatch::kDiamond, kPenetrationColor, 1, "point in interior"});
  }
  if (scene.voxmap && scene.shell && scene.voxmap->distances() != nullptr) {
    legend.push_back({Swatch::kLine, kClearanceColor, 1, "clearance: the nearest points"});
  }
  if (plan.moment->on_hand) {
    legend.push_back({Swatch::kArrow, kNetForceColor, 1, "force on the hand"});
  }
}

}  // namespace

Color color_of_mesh(std::size_t number) {
  // Around the circle of hues in steps of the golden ratio, which never come back to where they
  // were; every other darker, so that neighbors differ in more than hue.
  const double hue = 6 * std::fmod(0.11 + 0.6180339887 * static_cast<double>(number), 1.0);
  const double value = number % 2 == 0 ? 0.93 : 0.68, saturation = 0.45;
  Color color;
  for (std::size_t n = 0; n < 3; ++n) {
    const double from = std::fmod(hue + (n == 0 ? 5 : n == 1 ? 3 : 1), 6.0);
    color[n] = value * (1 - saturation * std::clamp(std::min(from, 4 - from), 0.0, 1.0));
  }
  return color;
}

Color color_of(FrameKind kind) {
  switch (kind) {
    case FrameKind::kFree:
      return kSceneColor;
    case FrameKind::kProximity:
      return kProximityColor;
    case FrameKind::kForceLayer:
      return kForceLayerColor;
    case FrameKind::kContact:
      return kContactColor;
    case FrameKind::kGuardCut:
      return kRemovedColor;
    case FrameKind::kPenetration:
      break;
  }
  return kPenetrationColor;
}

std::vector<LegendEntry> legend_of(const PicturePlan& plan, const ViewScene& scene) {
  std::vector<LegendEntry> legend;
  add_scene(plan, scene, legend);
  if (plan.moment) add_moment(plan, scene, legend);
  if (!plan.path_m.empty()) {
    legend.push_back({Swatch::kLine, kPathColor, 1, "path of the part's middle"});
  }
  return legend;
}

}  // namespace forcelayer::viewer
