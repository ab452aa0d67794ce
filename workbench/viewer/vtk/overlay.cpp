#include "workbench/viewer/vtk/overlay.h"

#include <vtkNew.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <sstream>
#include <string_view>

#include "workbench/viewer/vtk/shapes.h"
#include "workbench/viewer/vtk/triad.h"

namespace forcelayer::viewer {
namespace {

void draw_swatch(Shapes& shapes, const LegendEntry& entry, double x, double y, double size) {
  const double r = size / 2;
  const auto round_shape = [&](double radius, int corners) {
    std::vector<Pixel> loop;
    for (int n = 0; n < corners; ++n) {
      const double a = 2 * std::numbers::pi * n / corners;
      loop.push_back({x + r + radius * std::cos(a), y + r + radius * std::sin(a)});
    }
    shapes.polygon(loop, entry.color, entry.opacity);
  };
  switch (entry.swatch) {
    case Swatch::kSquare:
      shapes.box(x, y, x + size, y + size, kInk, 1);
      shapes.box(x + 1, y + 1, x + size - 1, y + size - 1, kBackground, 1);
      shapes.box(x + 1, y + 1, x + size - 1, y + size - 1, entry.color, entry.opacity);
      break;
    case Swatch::kFramedSquare:
      shapes.box(x, y, x + size, y + size, kInk, 1);
      shapes.box(x + 0.16 * size, y + 0.16 * size, x + 0.84 * size, y + 0.84 * size, entry.color,
                 entry.opacity);
      break;
    case Swatch::kDot:
      round_shape(0.3 * size, 16);
      break;
    case Swatch::kSmallSquare:
      shapes.box(x + 0.3 * size, y + 0.3 * size, x + 0.7 * size, y + 0.7 * size, entry.color,
                 entry.opacity);
      break;
    case Swatch::kDiamond:
      round_shape(0.45 * size, 4);
      break;
    case Swatch::kArrow:
      shapes.box(x, y + 0.44 * size, x + 0.6 * size, y + 0.56 * size, entry.color, entry.opacity);
      shapes.polygon(
          {{x + 0.55 * size, y + 0.2 * size}, {x + size, y + r}, {x + 0.55 * size, y + 0.8 * size}},
          entry.color, entry.opacity);
      break;
    case Swatch::kLine:
      shapes.box(x, y + 0.43 * size, x + size, y + 0.57 * size, entry.color, entry.opacity);
      break;
    case Swatch::kCoil:
      for (int n = 0; n < 4; ++n) {
        const double left = x + 0.25 * n * size;
        shapes.polygon({{left, y + 0.15 * size},
                        {left + 0.07 * size, y + 0.15 * size},
                        {left + 0.25 * size, y + 0.85 * size},
                        {left + 0.18 * size, y + 0.85 * size}},
                       entry.color, entry.opacity);
      }
      break;
  }
}

}  // namespace

struct Overlay::Drawing {
  vtkRenderer* renderer;
  double full_scale;  // in a picture that is large enough
  double scale = 1;
  Shapes shapes;
  std::vector<vtkSmartPointer<vtkTextActor>> texts;
  std::vector<std::string> title;
  std::vector<LegendEntry> legend;
  std::optional<FrameKind> state;
  std::vector<TreeLine> tree;
  std::optional<DrawnMeasure> measure;
  std::size_t first_line = 0, drawn_lines = 0;  // of the tree, as drawn: from `tree_top` down,
  double tree_top = 0, tree_right = 0, line_height = 0;  // so far to the right, each so high

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
    look->SetBackgroundColor(kBackground.data());
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

  double title_right = 0, title_bottom = 0;  // of the title as drawn

  // A row of cells, more of them filled the weightier the frame, and its name; returns the new y.
  double draw_state(double y) {
    constexpr double kCell = 15, kGap = 4, kSize = 18;
    y -= 1.6 * kSize * scale;
    const double left = 18 * scale, low = y + 3 * scale;
    const int cells = static_cast<int>(FrameKind::kPenetration);
    for (int n = 0; n < cells; ++n) {
      const double x = left + n * (kCell + kGap) * scale, side = kCell * scale, rim = 1.5 * scale;
      shapes.box(x, low, x + side, low + side, kInk, 1);
      const bool filled = n < static_cast<int>(*state);
      shapes.box(x + rim, low + rim, x + side - rim, low + side - rim,
                 filled ? color_of(*state) : kBackground, 1);
    }
    const double words = left + (cells * (kCell + kGap) + 6) * scale;
    title_right =
        std::max(title_right, words + write(frame_kind_name(*state), words, y, kSize, true));
    return y;
  }

  // Words that together are wider than that, on as many lines as it takes.
  std::vector<std::string> folded(const std::string& words, double size, double width) {
    std::vector<std::string> lines;
    std::istringstream stream(words);
    for (std::string word; stream >> word;) {
      const std::string longer = lines.empty() ? word : lines.back() + ' ' + word;
      if (!lines.empty() && text_width(longer, size) <= width) {
        lines.back() = longer;
      } else {
        lines.push_back(word);
      }
    }
    return lines;
  }

  // The parts of a line, which four spaces divide, on as many lines as the width asks for.
  std::vector<std::string> broken(const std::string& words, double size, double width) {
    constexpr std::string_view kGap = "    ";
    std::vector<std::string> lines;
    for (std::size_t from = 0; from <= words.size();) {
      const std::size_t to = std::min(words.find(kGap, from), words.size());
      const std::string part = words.substr(from, to - from);
      from = to + kGap.size();
      const std::string longer = lines.empty() ? part : lines.back() + std::string(kGap) + part;
      if (!lines.empty() && text_width(longer, size) <= width) {
        lines.back() = longer;
      } else if (text_width(part, size) <= width) {
        lines.push_back(part);
      } else {
        for (const std::string& line : folded(part, size, width)) lines.push_back(line);
      }
    }
    return lines;
  }

  void draw_title(int width, int height) {
    constexpr double kLarge = 20, kSmall = 15;
    const double margin = 18 * scale;
    title_right = 0;
    double y = height - 14 * scale;
    for (std::size_t n = 0; n < title.size(); ++n) {
      if (n == 1 && state) y = draw_state(y);
      const double size = n == 0 ? kLarge : kSmall;
      for (const std::string& line :
           broken(title[n], size, (n == 0 ? 0.9 : 1) * (width - margin))) {
        y -= 1.45 * size * scale;
        title_right = std::max(title_right, margin + write(line, margin, y, size, n == 0));
      }
    }
    title_bottom = y;
  }

  void draw_legend(int width, int height, int reserved) {
    constexpr double kSize = 14, kLine = 23;
    double widest = 0;
    for (const LegendEntry& entry : legend) {
      widest = std::max(widest, text_width(entry.label, kSize));
    }
    const double key = kSize * scale, gap = 10 * scale, margin = 16 * scale;
    const double left = width - margin - widest - gap - key;
    double y = height - margin - 4 * scale;
    if (title_right > left - 2 * gap) y = title_bottom - margin;  // no room beside the title
    const double lowest = reserved + 60 * scale;                  // above the scale bar
    auto room = static_cast<std::size_t>(std::max(0.0, (y - lowest) / (kLine * scale)));
    if (legend.empty() || room < 2) return;
    const bool whole = legend.size() <= room;
    if (whole) room = legend.size();
    shapes.box(left - gap, y - (kLine * static_cast<double>(room) + 2) * scale,
               width - margin + gap / 2, y + 4 * scale, kBackground, 0.8);
    for (std::size_t n = 0; n < room; ++n) {
      y -= kLine * scale;
      if (!whole && n + 1 == room) {
        write("a larger window shows more lines", left, y, kSize, false);
        break;
      }
      draw_swatch(shapes, legend[n], left, y, key);
      write(legend[n].label, left + key + gap, y, kSize, false);
    }
  }

  // Above what is reserved, and the triad.
  void draw_tree(int reserved) {
    constexpr double kSize = 14, kLine = 21, kIndent = 16;
    const double margin = 18 * scale, key = kSize * scale, gap = 8 * scale;
    line_height = kLine * scale;
    tree_top = title_bottom - 14 * scale;
    tree_right = 0;
    drawn_lines = 0;
    if (tree.empty()) return;
    const double bottom = std::max(reserved + 20 * scale, kTriadPixels * scale);
    const double room = (tree_top - bottom) / line_height;
    drawn_lines = std::min(tree.size(), static_cast<std::size_t>(std::max(0.0, room)));
    const auto chosen = static_cast<std::size_t>(
        std::find_if(tree.begin(), tree.end(), [](const TreeLine& line) { return line.selected; }) -
        tree.begin());
    if (chosen < first_line) first_line = chosen;
    if (chosen < tree.size() && chosen >= first_line + drawn_lines) {
      first_line = chosen + 1 - drawn_lines;
    }
    first_line = std::min(first_line, tree.size() - drawn_lines);
    for (std::size_t n = 0; n < drawn_lines; ++n) {
      const TreeLine& line = tree[first_line + n];
      const double x = margin + kIndent * scale * static_cast<double>(line.depth);
      const double y = tree_top - line_height * static_cast<double>(n + 1) + 3 * scale;
      shapes.box(x, y, x + key, y + key, kInk, 1);
      shapes.box(x + 1, y + 1, x + key - 1, y + key - 1, kBackground, 1);
      shapes.box(x + 1, y + 1, x + 1 + (key - 2) * line.filled, y + key - 1, line.color, 1);
      const double width = write(line.words, x + key + gap, y, kSize, line.selected);
      tree_right = std::max(tree_right, x + key + gap + width);
    }
  }

  void line(const Pixel& from, const Pixel& to, double thick, const Color& color) {
    const double dx = to.x - from.x, dy = to.y - from.y, length = std::hypot(dx, dy);
    if (length == 0) return;
    const double u = -dy / length * thick / 2, v = dx / length * thick / 2;
    shapes.polygon({{from.x + u, from.y + v},
                    {to.x + u, to.y + v},
                    {to.x - u, to.y - v},
                    {from.x - u, from.y - v}},
                   color, 1);
  }

  void dot(const Pixel& at, double radius, const Color& color) {
    std::vector<Pixel> loop;
    for (int n = 0; n < 20; ++n) {
      const double a = 2 * std::numbers::pi * n / 20;
      loop.push_back({at.x + radius * std::cos(a), at.y + radius * std::sin(a)});
    }
    shapes.polygon(loop, color, 1);
  }

  // Words at the end of a thin line that leads away from a place.
  void note(const std::string& words, const Pixel& at, const Pixel& towards, double away, int width,
            int height) {
    if (words.empty()) return;
    constexpr double kSize = 16;
    const double edge = 20 * scale, extent = text_width(words, kSize);
    Pixel end{at.x + towards.x * away * scale, at.y + towards.y * away * scale};
    end.x = std::clamp(end.x, edge + (towards.x < 0 ? extent : 0),
                       width - edge - (towards.x < 0 ? 0 : extent));
    end.y = std::clamp(end.y, 3 * edge, height - 6 * edge);
    line(at, end, 1.5 * scale, kInk);
    const double y = end.y + (towards.y < 0 ? -kSize * scale : 3 * scale);
    write(words, end.x, y, kSize, true, towards.x < 0);
  }

  void draw_measure(int width, int height) {
    const Pixel part{measure->part_x, measure->part_y};
    const Pixel object{measure->object_x, measure->object_y};
    const Pixel middle{(part.x + object.x) / 2, (part.y + object.y) / 2};
    const double length = std::hypot(object.x - part.x, object.y - part.y);
    Pixel away{1, 0};
    if (length > 0) away = {(object.x - part.x) / length, (object.y - part.y) / length};
    const Pixel across = away.x >= 0 ? Pixel{-away.y, away.x} : Pixel{away.y, -away.x};
    line(part, object, 7 * scale, kBackground);
    line(part, object, 3.5 * scale, kContactColor);
    for (const Pixel& end : {part, object}) {
      dot(end, 7 * scale, kBackground);
      dot(end, 5 * scale, kContactColor);
    }
    note(measure->words, middle, across, 60, width, height);
    note(measure->object, object, away, 70, width, height);
    note("part", part, {-away.x, -away.y}, 70, width, height);
  }

  void draw_scale_bar(int width, double meters_per_pixel, int reserved) {
    const ScaleLength bar = round_length(0.2 * width * meters_per_pixel);
    const double length = bar.length_m / meters_per_pixel;
    const double x = width - 24 * scale - length, y = 22 * scale + reserved, thick = 5 * scale;
    shapes.box(x - 2 * scale, y - 2 * scale, x + length + 2 * scale, y + thick + 2 * scale,
               kBackground, 1);
    for (int n = 0; n < 4; ++n) {
      shapes.box(x + length * n / 4, y, x + length * (n + 1) / 4, y + thick,
                 n % 2 == 0 ? kInk : kBackground, 1);
    }
    shapes.box(x, y + thick - scale, x + length, y + thick, kInk, 1);
    shapes.box(x, y, x + length, y + scale, kInk, 1);
    write(bar.name, x + length, y + thick + 5 * scale, 14, false, true);
  }
};

Overlay::Overlay(vtkRenderer* renderer, double scale) : drawing_(std::make_unique<Drawing>()) {
  drawing_->renderer = renderer;
  drawing_->full_scale = scale;
  renderer->AddActor2D(drawing_->shapes.actor());
}

Overlay::~Overlay() = default;

void Overlay::set_title(const std::vector<std::string>& lines) { drawing_->title = lines; }

void Overlay::set_state(std::optional<FrameKind> state) { drawing_->state = state; }

void Overlay::set_tree(const std::vector<TreeLine>& lines) { drawing_->tree = lines; }

std::optional<std::size_t> Overlay::tree_line_at(int x, int y) const {
  const Drawing& d = *drawing_;
  if (d.drawn_lines == 0 || x > d.tree_right || y > d.tree_top) return std::nullopt;
  const auto line = static_cast<std::size_t>((d.tree_top - y) / d.line_height);
  if (line >= d.drawn_lines) return std::nullopt;
  return d.first_line + line;
}

void Overlay::set_measure(const DrawnMeasure& measure) { drawing_->measure = measure; }

void Overlay::set_legend(const std::vector<LegendEntry>& entries) { drawing_->legend = entries; }

void Overlay::lay_out(int width, int height, double meters_per_pixel, int reserved) {
  constexpr double kWidth = 800, kHeight = 600, kSmallest = 0.75;  // of words that can be read
  Drawing& d = *drawing_;
  const double fraction = std::min(width / kWidth, height / kHeight) / d.full_scale;
  d.scale = d.full_scale * std::clamp(fraction, kSmallest, 1.0);
  d.clear();
  d.draw_title(width, height);
  d.draw_tree(reserved);
  if (d.measure) d.draw_measure(width, height);
  d.draw_legend(width, height, reserved);
  if (meters_per_pixel > 0) d.draw_scale_bar(width, meters_per_pixel, reserved);
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

}  // namespace forcelayer::viewer
