#include "workbench/viewer/vtk/strip.h"

#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "workbench/viewer/plan/legend.h"
#include "workbench/viewer/plan/style.h"
#include "workbench/viewer/run/moment.h"
#include "workbench/viewer/vtk/shapes.h"

namespace forcelayer::viewer {
namespace {

// In pixels of the design.
constexpr double kHeight = 104, kLeft = 150, kRight = 30, kBottom = 14;
constexpr double kBarStep = 5, kBars = 5 * kBarStep + 2;
constexpr double kMinWidth = 320, kMinHeight = 300;  // of a window that has room for the strip
constexpr double kButton = 26, kButtonHigh = 18, kButtonGap = 4, kSpeed = 44;  // beside the buttons
static_assert(static_cast<double>(FrameKind::kPenetration) * kBarStep < kBars);
constexpr std::size_t kLargestCurve = 2000;  // points

// One set of lines or polygons in pixels.
struct Shape {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkPolyData> data;
  vtkNew<vtkActor2D> actor;

  Shape(vtkRenderer* renderer, const Color& color, bool filled, double scale) {
    data->SetPoints(points);
    if (filled) {
      data->SetPolys(cells);
    } else {
      data->SetLines(cells);
    }
    vtkNew<vtkPolyDataMapper2D> mapper;
    mapper->SetInputData(data);
    actor->SetMapper(mapper);
    actor->GetProperty()->SetColor(color[0], color[1], color[2]);
    actor->GetProperty()->SetLineWidth(static_cast<float>(1.5 * scale));
    renderer->AddActor2D(actor);
  }

  void set(const std::vector<std::array<double, 2>>& corners) {
    points->Reset();
    cells->Reset();
    cells->InsertNextCell(static_cast<int>(corners.size()));
    for (const auto& corner : corners) {
      cells->InsertCellPoint(points->InsertNextPoint(corner[0], corner[1], 0));
    }
    points->Modified();
    cells->Modified();
    data->Modified();
  }
};

// Shapes that are drawn where they are declared among others.
struct Bars : Shapes {
  explicit Bars(vtkRenderer* renderer) { renderer->AddActor2D(actor()); }
};

}  // namespace

struct Strip::Drawing {
  Drawing(vtkRenderer* words, double pixels)
      : renderer(words),
        scale(pixels),
        paper(words, kBackground, true, scale),
        frame(words, kEdgeColor, false, scale),
        bars(words),
        curve(words, kInk, false, scale),
        now(words, kContactColor, false, scale),
        buttons(words) {
    paper.actor->GetProperty()->SetOpacity(0.85);
    for (vtkTextActor* words_of : {text.Get(), speed.Get()}) {
      words_of->GetTextProperty()->SetFontSize(static_cast<int>(std::lround(13 * scale)));
      words_of->GetTextProperty()->SetColor(kInk[0], kInk[1], kInk[2]);
      renderer->AddActor2D(words_of);
    }
    text->SetPosition((kLeft + 4) * scale, (kBottom + kHeight - 16) * scale);
  }

  // Left end of a button; the speed is written behind the last one.
  double left_of(PlayButton button) const {
    const double from_right =
        kRight + kSpeed + (kButton + kButtonGap) * (3 - static_cast<int>(button));
    return width - from_right * scale;
  }
  double low_of_buttons() const { return (kBottom + kHeight - kButtonHigh - 3) * scale; }

  void draw_button(PlayButton button) {
    const double x = left_of(button), y = low_of_buttons(), w = kButton * scale,
                 h = kButtonHigh * scale;
    buttons.box(x, y, x + w, y + h, kEdgeColor, 1);
    buttons.box(x + scale, y + scale, x + w - scale, y + h - scale, kBackground, 1);
    const double left = x + 0.3 * w, right = x + 0.7 * w, low = y + 0.25 * h, high = y + 0.75 * h;
    const double bar = 0.13 * w, middle = y + 0.5 * h, thin = 0.06 * h;
    if (button == PlayButton::kPlay && play->playing) {
      buttons.box(left, low, left + bar, high, kInk, 1);
      buttons.box(right - bar, low, right, high, kInk, 1);
    } else if (button == PlayButton::kPlay) {
      buttons.polygon({{left, low}, {right, middle}, {left, high}}, kInk, 1);
    } else {
      buttons.box(left, middle - thin, right, middle + thin, kInk, 1);
      if (button == PlayButton::kSlower) return;
      const double center = x + 0.5 * w;
      buttons.box(center - thin, middle - 0.2 * w, center + thin, middle + 0.2 * w, kInk, 1);
    }
  }

  void draw_buttons() {
    buttons.clear();
    speed->SetVisibility(play.has_value());
    if (!play) return;
    for (const PlayButton button : kButtons) draw_button(button);
    speed->SetInput(text_of("%g x", play->speed).c_str());
    speed->SetPosition(width - (kRight + kSpeed) * scale, low_of_buttons() + 2 * scale);
  }

  static constexpr std::array kButtons = {PlayButton::kSlower, PlayButton::kPlay,
                                          PlayButton::kFaster};
  vtkRenderer* renderer;
  double scale;
  Shape paper, frame;
  Bars bars;
  Shape curve, now;
  Bars buttons;
  vtkNew<vtkTextActor> text, speed;
  std::optional<PlayState> play;
  double begin_s = 0, end_s = 1;
  int width = 1;
};

Strip::Strip(vtkRenderer* renderer, double scale)
    : drawing_(std::make_unique<Drawing>(renderer, scale)) {}
Strip::~Strip() = default;

bool Strip::fits(int width, int height) const {
  return width >= kMinWidth * drawing_->scale && height >= kMinHeight * drawing_->scale;
}

int Strip::top_pixel() const {
  return static_cast<int>(std::lround((kHeight + kBottom) * drawing_->scale));
}

void Strip::set_play(const std::optional<PlayState>& play) { drawing_->play = play; }

void Strip::draw(const std::vector<StripPoint>& points, double begin_s, double end_s, double now_s,
                 int width) {
  Drawing& d = *drawing_;
  d.begin_s = begin_s;
  d.end_s = std::max(end_s, begin_s + 1e-3);
  d.width = width;
  const double low = kBottom * d.scale, left = kLeft * d.scale, bars = kBars * d.scale;
  const double right = std::max(left + 1, width - kRight * d.scale), top = low + kHeight * d.scale;
  double highest_n = 1e-3;
  for (const StripPoint& point : points) highest_n = std::max(highest_n, point.force_n);
  const auto x_of = [&](double t) {
    return left + (right - left) * std::clamp((t - d.begin_s) / (d.end_s - d.begin_s), 0.0, 1.0);
  };
  const double force_height = top - low - bars - 22 * d.scale;
  const auto y_of = [&](double n) { return low + bars + force_height * n / highest_n; };
  std::vector<std::array<double, 2>> curve;
  d.bars.clear();
  const std::size_t stride = 1 + points.size() / kLargestCurve;
  double bar_from = left;
  FrameKind bar_kind = FrameKind::kFree;
  const auto end_bar = [&](double x) {
    if (bar_kind != FrameKind::kFree) {
      d.bars.box(bar_from, low, std::max(x, bar_from + 1),
                 low + kBarStep * d.scale * static_cast<double>(bar_kind), color_of(bar_kind), 1);
    }
    bar_from = x;
  };
  for (std::size_t n = 0; n < points.size(); n += stride) {
    double group_n = 0;  // no peak is lost, and no short frame
    FrameKind group_kind = FrameKind::kFree;
    for (std::size_t m = n; m < std::min(points.size(), n + stride); ++m) {
      group_n = std::max(group_n, points[m].force_n);
      group_kind = std::max(group_kind, points[m].kind);
    }
    const double x = x_of(points[n].time_s);
    curve.push_back({x, y_of(group_n)});
    if (group_kind == bar_kind) continue;
    end_bar(x);
    bar_kind = group_kind;
  }
  if (!points.empty()) end_bar(x_of(points.back().time_s));
  d.curve.set(curve);
  d.paper.set({{left, low}, {right, low}, {right, top}, {left, top}});
  d.frame.set({{left, low}, {right, low}, {right, top}, {left, top}, {left, low}});
  d.now.set({{x_of(now_s), low}, {x_of(now_s), top}});
  d.draw_buttons();
  const double right_of_words = d.play ? d.left_of(PlayButton::kSlower) : right;
  const std::array<std::string, 3> parts = {text_of("force on the hand, up to %.3g N", highest_n),
                                            text_of("    %.2f to %.2f s", d.begin_s, d.end_s),
                                            "    bar colors: kinds of frames, see the legend"};
  std::string words;
  for (const std::string& part : parts) {
    d.text->SetInput((words + part).c_str());
    double extent[2] = {0, 0};
    d.text->GetSize(d.renderer, extent);
    if (extent[0] > right_of_words - left - 8 * d.scale) break;
    words += part;
  }
  d.text->SetInput(words.c_str());
}

void Strip::show(bool shown) {
  Drawing& d = *drawing_;
  for (vtkActor2D* actor : {d.paper.actor.Get(), d.frame.actor.Get(), d.bars.actor(),
                            d.curve.actor.Get(), d.now.actor.Get(), d.buttons.actor()}) {
    actor->SetVisibility(shown);
  }
  d.text->SetVisibility(shown);
  d.speed->SetVisibility(shown && d.play);
}

std::optional<PlayButton> Strip::button_at(int x, int y) const {
  const Drawing& d = *drawing_;
  if (!d.play || !d.text->GetVisibility()) return std::nullopt;
  const double low = d.low_of_buttons();
  if (y < low || y > low + kButtonHigh * d.scale) return std::nullopt;
  for (const PlayButton button : Drawing::kButtons) {
    const double left = d.left_of(button);
    if (x >= left && x <= left + kButton * d.scale) return button;
  }
  return std::nullopt;
}

std::optional<double> Strip::time_at(int x, int y) const {
  const Drawing& d = *drawing_;
  if (!d.text->GetVisibility()) return std::nullopt;
  const double left = kLeft * d.scale, right = d.width - kRight * d.scale;
  if (y > (kBottom + kHeight) * d.scale || x < left || x > right) return std::nullopt;
  return d.begin_s + (x - left) / (right - left) * (d.end_s - d.begin_s);
}

}  // namespace forcelayer::viewer
