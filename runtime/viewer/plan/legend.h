// The legend of a picture.
#pragma once

#include <string>
#include <vector>

#include "runtime/viewer/plan/picture_plan.h"
#include "runtime/viewer/plan/style.h"
#include "runtime/viewer/plan/view_scene.h"

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

// The entries for the items of the plan.
std::vector<LegendEntry> legend_of(const PicturePlan& plan, const ViewScene& scene);

}  // namespace forcelayer::viewer
