// Force over time along the lower edge of a window, with the buttons of playing.
#pragma once

#include <vtkRenderer.h>

#include <memory>
#include <optional>
#include <vector>

#include "workbench/viewer/run/contact_view.h"

namespace forcelayer::viewer {

struct StripPoint {
  double time_s;
  double force_n;
  FrameKind kind;
};

enum class PlayButton { kSlower, kPlay, kFaster };

// The state that the buttons show.
struct PlayState {
  bool playing;
  double speed;  // in run time per time
};

class Strip {
 public:
  // `scale`: pixels of the window per pixel of the design.
  Strip(vtkRenderer* renderer, double scale);
  ~Strip();

  bool fits(int width, int height) const;  // whether a window has room for it
  int top_pixel() const;                   // of the window's lower edge that it takes

  // The force of `points` over [begin_s, end_s] with a mark at `now_s`, over bars that are the
  // higher the weightier the frames.
  void draw(const std::vector<StripPoint>& points, double begin_s, double end_s, double now_s,
            int width);
  void show(bool shown);
  void set_play(const std::optional<PlayState>& play);  // none: no buttons; drawn by draw()

  // The button at a pixel of the window.
  std::optional<PlayButton> button_at(int x, int y) const;
  // The time at a pixel of the window; none beside the strip.
  std::optional<double> time_at(int x, int y) const;

 private:
  struct Drawing;
  std::unique_ptr<Drawing> drawing_;
};

}  // namespace forcelayer::viewer
