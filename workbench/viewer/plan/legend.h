// The legend of a picture.
#pragma once

#include <string>
#include <vector>

#include "workbench/viewer/plan/picture_plan.h"
#include "workbench/viewer/plan/style.h"
#include "workbench/viewer/plan/view_scene.h"

namespace forcelayer::viewer {

// The mark before a legend entry's label, as it looks in the picture.
enum class Swatch { kSquare, kFramedSquare, kDot, kSmallSquare, kDiamond, kArrow, kLine, kCoil };

struct LegendEntry {
  Swatch swatch;
  Color color;
  double opacity;
  std::string label;
};

// The color that marks a kind of frame.
Color color_of(FrameKind kind);

// The color of the scene's mesh of this number. Meshes that follow each other differ clearly.
Color color_of_mesh(std::size_t number);

// The entries for the items of the plan.
std::vector<LegendEntry> legend_of(const PicturePlan& plan, const ViewScene& scene);

}  // namespace forcelayer::viewer
