// Force over time along the lower edge of a window.
#pragma once

#include <vtkRenderer.h>

#include <memory>
#include <optional>
#include <vector>

#include "runtime/viewer/run/contact_view.h"

namespace forcelayer::viewer {

struct StripPoint {
  double time_s;
  double force_n;
  FrameKind kind;
};

class Strip {
 public:
  static constexpr int kTopPixel = 118;  // of the window's lower edge that it takes
  static constexpr int kLeastWidth = 320, kLeastHeight = 300;  // of a window that has room for it

  explicit Strip(vtkRenderer* renderer);
  ~Strip();

  // The force of `points` over [begin_s, end_s] with a mark at `now_s`, over bars that are the
  // higher the weightier the frames.
  void draw(const std::vector<StripPoint>& points, double begin_s, double end_s, double now_s,
            int width);
  void show(bool shown);

  // The time at a pixel of the window; none beside the strip.
  std::optional<double> time_at(int x, int y) const;

 private:
  struct Drawing;
  std::unique_ptr<Drawing> drawing_;
};

}  // namespace forcelayer::viewer
