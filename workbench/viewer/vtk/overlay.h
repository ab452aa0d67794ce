// Words and keys over a picture: title, state, legend, scale bar.
#pragma once

#include <vtkRenderer.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "workbench/viewer/plan/legend.h"
#include "workbench/viewer/run/contact_view.h"

namespace forcelayer::viewer {

// A line of the tree of objects.
struct TreeLine {
  std::string words;
  std::size_t depth = 0;
  Color color{};
  double filled = 1;  // the fraction of its square that has the color: 0 hidden, 1 shown
  bool selected = false;
};

// A distance as it lies on the picture, in pixels from the lower left.
struct DrawnMeasure {
  double part_x, part_y, object_x, object_y;
  std::string words, object;
};

class Overlay {
 public:
  // `scale`: pixels of the picture per pixel of the design (2 where the picture is shrunk by 2).
  Overlay(vtkRenderer* renderer, double scale);
  ~Overlay();

  void set_title(const std::vector<std::string>& lines);     // top left, the first one larger
  void set_state(std::optional<FrameKind> state);            // under its first line; none: no
  void set_legend(const std::vector<LegendEntry>& entries);  // top right
  void set_measure(const DrawnMeasure& measure);
  // On the left under the title, as many as there is room for, the selected one among them.
  void set_tree(const std::vector<TreeLine>& lines);
  std::optional<std::size_t> tree_line_at(int x, int y) const;  // of the pixel, from the lower left
  // Draws everything anew for a picture of that many pixels, one of which is `meters_per_pixel`;
  // the lowest `reserved` pixels are left free. In a small picture words are smaller, long lines
  // are broken, and the legend ends where there is no more room.
  void lay_out(int width, int height, double meters_per_pixel, int reserved = 0);

 private:
  struct Drawing;
  std::unique_ptr<Drawing> drawing_;
};

// The length of 1, 2 or 5 times a power of ten that is nearest below `wanted_m`, and its name, as
// in "50 mm".
struct ScaleLength {
  double length_m;
  std::string name;
};
ScaleLength round_length(double wanted_m);

}  // namespace forcelayer::viewer
