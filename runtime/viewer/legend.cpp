#include "runtime/viewer/legend.h"

namespace forcelayer {
namespace {

void add_scene(const PicturePlan& plan, const ViewScene& scene, std::vector<LegendEntry>& legend) {
  if (!scene.meshes.empty() && plan.shown[Shown::kMeshes]) {
    legend.push_back({Swatch::kSquare, kSceneColour, 1, "scene (mesh)"});
  }
  if (!scene.voxmap) return;
  if (plan.shown[Shown::kInterior]) {
    legend.push_back({Swatch::kSquare, kInteriorColour, 1, "interior voxels (value 1)"});
  }
  if (plan.shown[Shown::kForceLayer]) {
    legend.push_back({Swatch::kSquare, kForceLayerColour, plan.change ? 0.15 : 0.5,
                      plan.change ? "force layer as it is now" : "force layer (value 2)"});
  }
  if (plan.shown[Shown::kProximity]) {
    legend.push_back({Swatch::kSquare, kProximityColour, 0.4, "proximity (value 3)"});
  }
  if (plan.change) {
    legend.push_back({Swatch::kSquare, kAddedColour, 1, "force layer added"});
    legend.push_back({Swatch::kFramedSquare, kRemovedColour, 1, "force layer removed"});
  }
}

void add_moment(const PicturePlan& plan, const ViewScene& scene, std::vector<LegendEntry>& legend) {
  if (scene.part && plan.shown[Shown::kPart]) {
    legend.push_back({Swatch::kSquare, kPartColour, 1, "part (mesh)"});
  }
  if (scene.shell && plan.shown[Shown::kShell]) {
    legend.push_back({Swatch::kSquare, kPartColour, 1, "part (point shell)"});
  }
  if (plan.moment->world_from_target && plan.shown[Shown::kHandle]) {
    if (scene.part) legend.push_back({Swatch::kLine, kGhostColour, 1, "where the hand holds it"});
    legend.push_back({Swatch::kCoil, kGhostColour, 1, "virtual coupling"});
  }
  if (!plan.shown[Shown::kContacts]) return;
  if (scene.voxmap && scene.shell) {
    legend.push_back({Swatch::kArrow, kContactColour, 1, "contact: force on the part"});
    legend.push_back({Swatch::kDot, kForceLayerColour, 1, "point in the force layer, depth 0"});
    legend.push_back({Swatch::kSmallSquare, kProximityColour, 1, "point in proximity"});
    legend.push_back({Swatch::kDiamond, kPenetrationColour, 1, "point in interior"});
  }
  if (plan.moment->on_hand) {
    legend.push_back({Swatch::kArrow, kNetForceColour, 1, "force on the hand"});
  }
}

}  // namespace

Colour colour_of(FrameKind kind) {
  switch (kind) {
    case FrameKind::kFree:
      return kSceneColour;
    case FrameKind::kProximity:
      return kProximityColour;
    case FrameKind::kForceLayer:
      return kForceLayerColour;
    case FrameKind::kContact:
      return kContactColour;
    case FrameKind::kGuardCut:
      return kRemovedColour;
    case FrameKind::kPenetration:
      break;
  }
  return kPenetrationColour;
}

std::vector<LegendEntry> legend_of(const PicturePlan& plan, const ViewScene& scene) {
  std::vector<LegendEntry> legend;
  add_scene(plan, scene, legend);
  if (plan.moment) add_moment(plan, scene, legend);
  return legend;
}

}  // namespace forcelayer
