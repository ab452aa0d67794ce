#include "runtime/viewer/vtk_strip.h"

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

#include "runtime/viewer/moment.h"
#include "runtime/viewer/style.h"

namespace forcelayer {
namespace {

static_assert(Strip::kTopPixel == 90 + 14);
constexpr int kHeight = 90, kLeft = 150, kRight = 30, kBottom = 14;  // pixels
constexpr std::size_t kLargestCurve = 2000;                          // points

// One set of lines or polygons in pixels.
struct Shape {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkPolyData> data;
  vtkNew<vtkActor2D> actor;

  Shape(vtkRenderer* renderer, const Colour& colour, bool filled) {
    data->SetPoints(points);
    if (filled) {
      data->SetPolys(cells);
    } else {
      data->SetLines(cells);
    }
    vtkNew<vtkPolyDataMapper2D> mapper;
    mapper->SetInputData(data);
    actor->SetMapper(mapper);
    actor->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
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

Colour colour_of(FrameKind kind) {
  switch (kind) {
    case FrameKind::kFree:
      return kSceneColour;
    case FrameKind::kProximity:
      return kProximityColour;
    case FrameKind::kForceLayer:
      return kForceLayerColour;
    case FrameKind::kContact:
      return kContactColour;
    case FrameKind::kGuardCut:
      return kRemovedColour;
    case FrameKind::kPenetration:
      break;
  }
  return kPenetrationColour;
}

}  // namespace

struct Strip::Drawing {
  explicit Drawing(vtkRenderer* renderer)
      : paper(renderer, kPaper, true),
        bar(renderer, kInk, true),
        frame(renderer, kEdgeColour, false),
        curve(renderer, kInk, false),
        now(renderer, kContactColour, false) {
    paper.actor->GetProperty()->SetOpacity(0.85);
    text->GetTextProperty()->SetFontSize(13);
    text->GetTextProperty()->SetColor(kInk[0], kInk[1], kInk[2]);
    text->SetPosition(kLeft + 4, kBottom + kHeight - 16);
    renderer->AddActor2D(text);
  }

  Shape paper, bar, frame, curve, now;
  vtkNew<vtkTextActor> text;
  double begin_s = 0, end_s = 1;
  int width = 1;
};

Strip::Strip(vtkRenderer* renderer) : drawing_(std::make_unique<Drawing>(renderer)) {}
Strip::~Strip() = default;

void Strip::draw(const std::vector<StripPoint>& points, double begin_s, double end_s, double now_s,
                 FrameKind kind, int width, int height) {
  Drawing& d = *drawing_;
  d.begin_s = begin_s;
  d.end_s = std::max(end_s, begin_s + 1e-3);
  d.width = width;
  double highest_n = 1e-3;
  for (const StripPoint& point : points) highest_n = std::max(highest_n, point.force_n);
  const double span = width - kLeft - kRight;
  const auto x_of = [&](double t) {
    return kLeft + span * std::clamp((t - d.begin_s) / (d.end_s - d.begin_s), 0.0, 1.0);
  };
  const auto y_of = [&](double n) { return kBottom + (kHeight - 22) * n / highest_n; };
  std::vector<std::array<double, 2>> curve;
  const std::size_t stride = 1 + points.size() / kLargestCurve;
  for (std::size_t n = 0; n < points.size(); n += stride) {
    double group_n = 0;  // no peak is lost
    for (std::size_t m = n; m < std::min(points.size(), n + stride); ++m) {
      group_n = std::max(group_n, points[m].force_n);
    }
    curve.push_back({x_of(points[n].time_s), y_of(group_n)});
  }
  d.curve.set(curve);
  const double right = width - kRight, top = kBottom + kHeight;
  d.paper.set({{kLeft, kBottom}, {right, kBottom}, {right, top}, {kLeft, top}});
  d.frame.set({{kLeft, kBottom}, {right, kBottom}, {right, top}, {kLeft, top}, {kLeft, kBottom}});
  d.now.set({{x_of(now_s), kBottom}, {x_of(now_s), top}});
  // The weightier the frame, the wider the bar: it is read without its colour.
  const double bar = 2 + 3 * static_cast<double>(kind);
  const Colour colour = colour_of(kind);
  d.bar.actor->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
  d.bar.set(
      {{0, 0}, {bar, 0}, {bar, static_cast<double>(height)}, {0, static_cast<double>(height)}});
  d.text->SetInput(
      text_of("force on the hand, to %.3g N    %.2f to %.2f s", highest_n, d.begin_s, d.end_s)
          .c_str());
}

double Strip::time_at(int x, int y) const {
  const Drawing& d = *drawing_;
  if (y > kBottom + kHeight || x < kLeft || x > d.width - kRight) return -1;
  const double share = static_cast<double>(x - kLeft) / (d.width - kLeft - kRight);
  return d.begin_s + share * (d.end_s - d.begin_s);
}

}  // namespace forcelayer
