#include "runtime/viewer/plan/legend.h"

namespace forcelayer::viewer {
namespace {

void add_scene(const PicturePlan& plan, const ViewScene& scene, std::vector<LegendEntry>& legend) {
  if (!scene.meshes.empty() && plan.shown[Item::kMeshes]) {
    legend.push_back({Swatch::kSquare, kSceneColor, 1, "scene (mesh)"});
  }
  if (!scene.missing_faces.empty() && plan.shown[Item::kMeshes]) {
    legend.push_back({Swatch::kFramedSquare, kMissingFaceColor, 1, "face missing from the mesh"});
  }
  if (!scene.voxmap) return;
  if (plan.shown[Item::kInterior]) {
    legend.push_back({Swatch::kSquare, kInteriorColor, 1, "interior voxels (value 1)"});
  }
  if (plan.shown[Item::kForceLayer]) {
    legend.push_back({Swatch::kSquare, kForceLayerColor, plan.change ? 0.15 : 0.5,
                      plan.change ? "force layer as it is now" : "force layer (value 2)"});
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
    legend.push_back({Swatch::kSquare, kPartColor, 1, "part (mesh)"});
  }
  if (scene.shell && plan.shown[Item::kShell]) {
    legend.push_back({Swatch::kSquare, kPartColor, 1, "part (point shell)"});
  }
  if (plan.moment->world_from_target && plan.shown[Item::kHandle]) {
    if (scene.part) legend.push_back({Swatch::kLine, kGhostColor, 1, "where the hand holds it"});
    legend.push_back({Swatch::kCoil, kGhostColor, 1, "virtual coupling"});
  }
  if (!plan.shown[Item::kContacts]) return;
  if (scene.voxmap && scene.shell) {
    legend.push_back({Swatch::kArrow, kContactColor, 1, "contact: force on the part"});
    legend.push_back({Swatch::kDot, kForceLayerColor, 1, "point in the force layer, depth 0"});
    legend.push_back({Swatch::kSmallSquare, kProximityColor, 1, "point in proximity"});
    legend.push_back({Swatch::kDiamond, kPenetrationColor, 1, "point in interior"});
  }
  if (plan.moment->on_hand) {
    legend.push_back({Swatch::kArrow, kNetForceColor, 1, "force on the hand"});
  }
}

}  // namespace

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
  return legend;
}

}  // namespace forcelayer::viewer
