#include "runtime/viewer/vtk_overlay.h"

#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace forcelayer {
namespace {

struct Pixel {
  double x, y;
};

// Flat shapes in pixels, each in one colour.
class Shapes {
 public:
  Shapes() {
    colours_->SetNumberOfComponents(4);
    data_->SetPoints(points_);
    data_->SetLines(lines_);
    data_->SetPolys(polygons_);
    data_->GetCellData()->SetScalars(colours_);
    mapper_->SetInputData(data_);
    actor_->SetMapper(mapper_);
  }

  vtkActor2D* actor() { return actor_; }

  void clear() {
    points_->Reset();
    polygons_->Reset();
    colours_->Reset();
  }

  void polygon(const std::vector<Pixel>& corners, const Colour& colour, double opacity) {
    std::vector<vtkIdType> ids;
    for (const Pixel& corner : corners) {
      ids.push_back(points_->InsertNextPoint(corner.x, corner.y, 0));
    }
    polygons_->InsertNextCell(static_cast<vtkIdType>(ids.size()), ids.data());
    for (const double value : {colour[0], colour[1], colour[2], opacity}) {
      colours_->InsertNextValue(static_cast<unsigned char>(std::lround(255 * value)));
    }
    points_->Modified();
    polygons_->Modified();
    colours_->Modified();
    data_->Modified();
  }

  void box(double x0, double y0, double x1, double y1, const Colour& colour, double opacity) {
    polygon({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, colour, opacity);
  }

 private:
  vtkNew<vtkPoints> points_;
  vtkNew<vtkCellArray> lines_, polygons_;
  vtkNew<vtkUnsignedCharArray> colours_;
  vtkNew<vtkPolyData> data_;
  vtkNew<vtkPolyDataMapper2D> mapper_;
  vtkNew<vtkActor2D> actor_;
};

void draw_swatch(Shapes& shapes, const LegendEntry& entry, double x, double y, double size) {
  const double r = size / 2;
  const auto round_shape = [&](double radius, int corners) {
    std::vector<Pixel> loop;
    for (int n = 0; n < corners; ++n) {
      const double a = 2 * std::numbers::pi * n / corners;
      loop.push_back({x + r + radius * std::cos(a), y + r + radius * std::sin(a)});
    }
    shapes.polygon(loop, entry.colour, entry.opacity);
  };
  switch (entry.swatch) {
    case Swatch::kSquare:
      shapes.box(x, y, x + size, y + size, kInk, 1);
      shapes.box(x + 1, y + 1, x + size - 1, y + size - 1, kPaper, 1);
      shapes.box(x + 1, y + 1, x + size - 1, y + size - 1, entry.colour, entry.opacity);
      break;
    case Swatch::kFramedSquare:
      shapes.box(x, y, x + size, y + size, kInk, 1);
      shapes.box(x + 0.16 * size, y + 0.16 * size, x + 0.84 * size, y + 0.84 * size, entry.colour,
                 entry.opacity);
      break;
    case Swatch::kDot:
      round_shape(0.3 * size, 16);
      break;
    case Swatch::kSmallSquare:
      shapes.box(x + 0.3 * size, y + 0.3 * size, x + 0.7 * size, y + 0.7 * size, entry.colour,
                 entry.opacity);
      break;
    case Swatch::kDiamond:
      round_shape(0.45 * size, 4);
      break;
    case Swatch::kArrow:
      shapes.box(x, y + 0.44 * size, x + 0.6 * size, y + 0.56 * size, entry.colour, entry.opacity);
      shapes.polygon(
          {{x + 0.55 * size, y + 0.2 * size}, {x + size, y + r}, {x + 0.55 * size, y + 0.8 * size}},
          entry.colour, entry.opacity);
      break;
    case Swatch::kLine:
      shapes.box(x, y + 0.43 * size, x + size, y + 0.57 * size, entry.colour, entry.opacity);
      break;
    case Swatch::kCoil:
      for (int n = 0; n < 4; ++n) {
        const double left = x + 0.25 * n * size;
        shapes.polygon({{left, y + 0.15 * size},
                        {left + 0.07 * size, y + 0.15 * size},
                        {left + 0.25 * size, y + 0.85 * size},
                        {left + 0.18 * size, y + 0.85 * size}},
                       entry.colour, entry.opacity);
      }
      break;
  }
}

}  // namespace

struct Overlay::Drawing {
  vtkRenderer* renderer;
  double scale;
  Shapes shapes;
  std::vector<vtkSmartPointer<vtkTextActor>> texts;
  std::vector<std::string> title;
  std::vector<LegendEntry> legend;

  // A text whose lower left corner stands at (x, y); returns its width in pixels.
  double write(const std::string& words, double x, double y, double size, bool bold,
               bool to_the_left = false) {
    auto text = vtkSmartPointer<vtkTextActor>::New();
    text->SetInput(words.c_str());
    vtkTextProperty* look = text->GetTextProperty();
    look->SetFontFamilyToArial();
    look->SetFontSize(static_cast<int>(std::lround(size * scale)));
    look->SetColor(kInk.data());
    look->SetBold(bold);
    look->SetBackgroundColor(kPaper.data());
    look->SetBackgroundOpacity(0.75);
    double extent[2] = {0, 0};
    text->GetSize(renderer, extent);
    text->SetPosition(to_the_left ? x - extent[0] : x, y);
    renderer->AddActor2D(text);
    texts.push_back(text);
    return extent[0];
  }

  double text_width(const std::string& words, double size) {
    vtkNew<vtkTextActor> text;
    text->SetInput(words.c_str());
    text->GetTextProperty()->SetFontFamilyToArial();
    text->GetTextProperty()->SetFontSize(static_cast<int>(std::lround(size * scale)));
    double extent[2] = {0, 0};
    text->GetSize(renderer, extent);
    return extent[0];
  }

  void clear() {
    for (const auto& text : texts) renderer->RemoveActor2D(text);
    texts.clear();
    shapes.clear();
  }

  double title_right = 0, title_bottom = 0;  // of what draw_title() wrote

  void draw_title(int height) {
    constexpr double kLarge = 20, kSmall = 15;
    title_right = 0;
    double y = height - 14 * scale;
    for (std::size_t n = 0; n < title.size(); ++n) {
      const double size = n == 0 ? kLarge : kSmall;
      y -= 1.45 * size * scale;
      title_right =
          std::max(title_right, 18 * scale + write(title[n], 18 * scale, y, size, n == 0));
    }
    title_bottom = y;
  }

  void draw_legend(int width, int height) {
    constexpr double kSize = 14, kLine = 23;
    double widest = 0;
    for (const LegendEntry& entry : legend) {
      widest = std::max(widest, text_width(entry.label, kSize));
    }
    const double key = kSize * scale, gap = 10 * scale, margin = 16 * scale;
    const double left = width - margin - widest - gap - key;
    double y = height - margin - 4 * scale;
    if (title_right > left - 2 * gap) y = title_bottom - margin;  // no room beside the title
    if (!legend.empty()) {
      shapes.box(left - gap, y - (kLine * static_cast<double>(legend.size()) + 2) * scale,
                 width - margin + gap / 2, y + 4 * scale, kPaper, 0.8);
    }
    for (const LegendEntry& entry : legend) {
      y -= kLine * scale;
      draw_swatch(shapes, entry, left, y, key);
      write(entry.label, left + key + gap, y, kSize, false);
    }
  }

  void draw_scale_bar(int width, double metres_per_pixel, int reserved) {
    const ScaleLength bar = round_length(0.2 * width * metres_per_pixel);
    const double length = bar.length_m / metres_per_pixel;
    const double x = width - 24 * scale - length, y = 22 * scale + reserved, thick = 5 * scale;
    shapes.box(x - 2 * scale, y - 2 * scale, x + length + 2 * scale, y + thick + 2 * scale, kPaper,
               1);
    for (int n = 0; n < 4; ++n) {
      shapes.box(x + length * n / 4, y, x + length * (n + 1) / 4, y + thick,
                 n % 2 == 0 ? kInk : kPaper, 1);
    }
    shapes.box(x, y + thick - scale, x + length, y + thick, kInk, 1);
    shapes.box(x, y, x + length, y + scale, kInk, 1);
    write(bar.name, x + length, y + thick + 5 * scale, 14, false, true);
  }
};

Overlay::Overlay(vtkRenderer* renderer, double scale) : drawing_(std::make_unique<Drawing>()) {
  drawing_->renderer = renderer;
  drawing_->scale = scale;
  renderer->AddActor2D(drawing_->shapes.actor());
}

Overlay::~Overlay() = default;

void Overlay::set_title(const std::vector<std::string>& lines) { drawing_->title = lines; }

void Overlay::set_legend(const std::vector<LegendEntry>& entries) { drawing_->legend = entries; }

void Overlay::lay_out(int width, int height, double metres_per_pixel, int reserved) {
  drawing_->clear();
  drawing_->draw_title(height);
  drawing_->draw_legend(width, height);
  if (metres_per_pixel > 0) drawing_->draw_scale_bar(width, metres_per_pixel, reserved);
}

ScaleLength round_length(double wanted_m) {
  const double power = std::pow(10, std::floor(std::log10(wanted_m)));
  double length_m = power;
  for (const double factor : {2.0, 5.0}) {
    if (factor * power <= wanted_m) length_m = factor * power;
  }
  const char* unit = length_m < 0.9e-3 ? "um" : length_m < 0.9 ? "mm" : "m";
  const double in_unit = length_m * (length_m < 0.9e-3 ? 1e6 : length_m < 0.9 ? 1e3 : 1);
  char name[32];
  std::snprintf(name, sizeof name, "%g %s", in_unit, unit);
  return {length_m, name};
}

}  // namespace forcelayer
