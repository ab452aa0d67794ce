// What the marks of a picture mean.
#pragma once

#include <string>
#include <vector>

#include "runtime/viewer/picture_plan.h"
#include "runtime/viewer/style.h"
#include "runtime/viewer/view_scene.h"

namespace forcelayer {

// What a legend entry draws before its label, as its mark looks in the picture.
enum class Swatch { kSquare, kFramedSquare, kDot, kSmallSquare, kDiamond, kArrow, kLine, kCoil };

struct LegendEntry {
  Swatch swatch;
  Colour colour;
  double opacity;
  std::string label;
};

// What marks a frame beside its name and its height.
Colour colour_of(FrameKind kind);

// The entries for what the plan shows.
std::vector<LegendEntry> legend_of(const PicturePlan& plan, const ViewScene& scene);

}  // namespace forcelayer
