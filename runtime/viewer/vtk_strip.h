// Force over time along the lower edge of a window.
#pragma once

#include <vtkRenderer.h>

#include <memory>
#include <vector>

#include "runtime/viewer/contact_view.h"

namespace forcelayer {

struct StripPoint {
  double time_s;
  double force_n;
};

class Strip {
 public:
  static constexpr int kTopPixel = 104;  // of the window's lower edge that it takes

  explicit Strip(vtkRenderer* renderer);
  ~Strip();

  // The curve of `points` over [begin_s, end_s] with a mark at `now_s`; `kind` is drawn as a bar at
  // the left whose width and colour tell the frame's kind.
  void draw(const std::vector<StripPoint>& points, double begin_s, double end_s, double now_s,
            FrameKind kind, int width, int height);

  // The time at a pixel of the window, or a negative number above the strip.
  double time_at(int x, int y) const;

 private:
  struct Drawing;
  std::unique_ptr<Drawing> drawing_;
};

}  // namespace forcelayer
