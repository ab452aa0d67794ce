#include "runtime/viewer/vtk/strip.h"

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
#include <string>

#include "runtime/viewer/plan/legend.h"
#include "runtime/viewer/plan/style.h"
#include "runtime/viewer/run/moment.h"
#include "runtime/viewer/vtk/shapes.h"

namespace forcelayer::viewer {
namespace {

constexpr int kHeight = 104, kLeft = 150, kRight = 30, kBottom = 14;  // pixels
constexpr int kBarStep = 5, kBars = 5 * kBarStep + 2;                 // pixels
static_assert(Strip::kTopPixel == kHeight + kBottom);
static_assert(static_cast<int>(FrameKind::kPenetration) * kBarStep < kBars);
constexpr std::size_t kLargestCurve = 2000;  // points

// One set of lines or polygons in pixels.
struct Shape {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkPolyData> data;
  vtkNew<vtkActor2D> actor;

  Shape(vtkRenderer* renderer, const Color& color, bool filled) {
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
    actor->GetProperty()->SetLineWidth(1.5f);
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
  explicit Drawing(vtkRenderer* words)
      : renderer(words),
        paper(words, kBackground, true),
        frame(words, kEdgeColor, false),
        bars(words),
        curve(words, kInk, false),
        now(words, kContactColor, false) {
    paper.actor->GetProperty()->SetOpacity(0.85);
    text->GetTextProperty()->SetFontSize(13);
    text->GetTextProperty()->SetColor(kInk[0], kInk[1], kInk[2]);
    text->SetPosition(kLeft + 4, kBottom + kHeight - 16);
    renderer->AddActor2D(text);
  }

  vtkRenderer* renderer;
  Shape paper, frame;
  Bars bars;
  Shape curve, now;
  vtkNew<vtkTextActor> text;
  double begin_s = 0, end_s = 1;
  int width = 1;
};

Strip::Strip(vtkRenderer* renderer) : drawing_(std::make_unique<Drawing>(renderer)) {}
Strip::~Strip() = default;

void Strip::draw(const std::vector<StripPoint>& points, double begin_s, double end_s, double now_s,
                 int width) {
  Drawing& d = *drawing_;
  d.begin_s = begin_s;
  d.end_s = std::max(end_s, begin_s + 1e-3);
  d.width = width;
  double highest_n = 1e-3;
  for (const StripPoint& point : points) highest_n = std::max(highest_n, point.force_n);
  const double span = std::max(1, width - kLeft - kRight);
  const auto x_of = [&](double t) {
    return kLeft + span * std::clamp((t - d.begin_s) / (d.end_s - d.begin_s), 0.0, 1.0);
  };
  constexpr double kForceHeight = kHeight - kBars - 22;
  const auto y_of = [&](double n) { return kBottom + kBars + kForceHeight * n / highest_n; };
  std::vector<std::array<double, 2>> curve;
  d.bars.clear();
  const std::size_t stride = 1 + points.size() / kLargestCurve;
  double bar_from = kLeft;
  FrameKind bar_kind = FrameKind::kFree;
  const auto end_bar = [&](double x) {
    if (bar_kind != FrameKind::kFree) {
      d.bars.box(bar_from, kBottom, std::max(x, bar_from + 1),
                 kBottom + kBarStep * static_cast<double>(bar_kind), color_of(bar_kind), 1);
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
  const double right = kLeft + span, top = kBottom + kHeight;
  d.paper.set({{kLeft, kBottom}, {right, kBottom}, {right, top}, {kLeft, top}});
  d.frame.set({{kLeft, kBottom}, {right, kBottom}, {right, top}, {kLeft, top}, {kLeft, kBottom}});
  d.now.set({{x_of(now_s), kBottom}, {x_of(now_s), top}});
  const std::array<std::string, 3> parts = {text_of("force on the hand, to %.3g N", highest_n),
                                            text_of("    %.2f to %.2f s", d.begin_s, d.end_s),
                                            "    bars: as the cells above"};
  std::string words;
  for (const std::string& part : parts) {
    d.text->SetInput((words + part).c_str());
    double extent[2] = {0, 0};
    d.text->GetSize(d.renderer, extent);
    if (extent[0] > span - 8) break;
    words += part;
  }
  d.text->SetInput(words.c_str());
}

void Strip::show(bool shown) {
  Drawing& d = *drawing_;
  for (vtkActor2D* actor : {d.paper.actor.Get(), d.frame.actor.Get(), d.bars.actor(),
                            d.curve.actor.Get(), d.now.actor.Get()}) {
    actor->SetVisibility(shown);
  }
  d.text->SetVisibility(shown);
}

std::optional<double> Strip::time_at(int x, int y) const {
  const Drawing& d = *drawing_;
  if (!d.text->GetVisibility()) return std::nullopt;
  if (y > kBottom + kHeight || x < kLeft || x > d.width - kRight) return std::nullopt;
  const double share = static_cast<double>(x - kLeft) / (d.width - kLeft - kRight);
  return d.begin_s + share * (d.end_s - d.begin_s);
}

}  // namespace forcelayer::viewer
