#include "workbench/study/curve.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "formats/command/text.h"

namespace forcelayer::study {
namespace {

using command::text;

constexpr double kWidth = 900, kHeight = 320, kLeft = 64, kRight = 16, kTop = 16, kBottom = 44;
constexpr double kShown = 3;            // times what is required, or the least clearance: the top
constexpr std::size_t kColumns = 1500;  // of steps; more cannot be seen

// A tick every 1, 2 or 5 times a power of ten, some six of them.
double tick_of(double span) {
  const double power = std::pow(10, std::floor(std::log10(span / 6)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (span / (step * power) <= 8) return step * power;
  }
  return 10 * power;
}

// The multiples of a tick in a span. Where doubles are so far apart that they are one and the same,
// there are no more than elsewhere.
std::vector<double> ticks_of(double from, double span) {
  constexpr int kMax = 12;
  const double tick = tick_of(span), first = std::ceil(from / tick);
  std::vector<double> ticks;
  for (int n = 0; n < kMax && (first + n) * tick <= from + span * (1 + 1e-9); ++n) {
    ticks.push_back((first + n) * tick);
  }
  return ticks;
}

class Drawing {
 public:
  Drawing(double length_m, double top_m)
      : length_m_(std::max(length_m, 1e-9)), top_m_(std::max(top_m, 1e-9)) {}

  double x(double along_m) const {
    return kLeft + (kWidth - kLeft - kRight) * std::clamp(along_m / length_m_, 0.0, 1.0);
  }
  double y(double m) const {
    return kHeight - kBottom - (kHeight - kTop - kBottom) * std::clamp(m / top_m_, 0.0, 1.0);
  }

  void band(const nlohmann::json& stretches, const char* style) {
    for (const auto& s : stretches) {
      const double left = x(s["from_m"]), right = std::max(x(s["to_m"]), left + 1);
      svg_ += text("<rect x=\"%.1f\" y=\"%.0f\" width=\"%.1f\" height=\"%.1f\" class=\"%s\"/>\n",
                   left, kTop, right - left, kHeight - kTop - kBottom, style);
    }
  }

  void axes() {
    const double low = y(0);
    for (const double mm : ticks_of(0, top_m_ * 1e3)) {
      svg_ += text(
          "<path d=\"M%.0f %.1fH%.0f\" class=\"grid\"/><text x=\"%.0f\" y=\"%.1f\" "
          "text-anchor=\"end\">%g</text>\n",
          kLeft, y(mm / 1e3), kWidth - kRight, kLeft - 6, y(mm / 1e3) + 4, mm);
    }
    for (const double mm : ticks_of(0, length_m_ * 1e3)) {
      svg_ += text(
          "<path d=\"M%.1f %.1fv4\" class=\"axis\"/><text x=\"%.1f\" y=\"%.1f\" "
          "text-anchor=\"middle\">%g</text>\n",
          x(mm / 1e3), low, x(mm / 1e3), low + 18, mm);
    }
    svg_ += text("<path d=\"M%.0f %.0fV%.1fH%.0f\" class=\"axis\"/>\n", kLeft, kTop, low,
                 kWidth - kRight);
    svg_ += text(
        "<text x=\"%.0f\" y=\"%.1f\" text-anchor=\"middle\">position along the path, mm</text>\n",
        (kLeft + kWidth) / 2, kHeight - 8);
    svg_ += text(
        "<text transform=\"translate(16 %.1f) rotate(-90)\" text-anchor=\"middle\">proven "
        "clearance, mm</text>\n",
        (kTop + low) / 2);
  }

  // Steps that fall on one column are drawn as the least of them.
  void steps(const std::vector<CurvePiece>& steps) {
    svg_ += "<path class=\"curve\" d=\"";
    const double column = (kWidth - kLeft - kRight) / kColumns;
    const char* to = "M";
    for (std::size_t i = 0; i < steps.size();) {
      const double left = x(steps[i].from_m);
      double smallest = steps[i].clearance_m, right = x(steps[i].to_m);
      for (++i; i < steps.size() && x(steps[i].to_m) < left + column; ++i) {
        smallest = std::min(smallest, steps[i].clearance_m);
        right = x(steps[i].to_m);
      }
      svg_ += text("%s%.2f %.2fH%.2f", to, left, y(smallest), right);
      to = "L";
    }
    svg_ += "\"/>\n";
  }

  void required(double m) {
    svg_ += text(
        "<path d=\"M%.0f %.1fH%.0f\" class=\"required\"/><text x=\"%.0f\" y=\"%.1f\">%.4g mm "
        "required</text>\n",
        kLeft, y(m), kWidth - kRight, kLeft + 4, y(m) - 5, 1e3 * m);
  }

  void smallest(double along_m, double m) {
    svg_ += text("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4\" class=\"least\"/>\n", x(along_m), y(m));
  }

  std::string finish() const {
    return text(
               "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" "
               "height=\"%.0f\" role=\"img\" aria-label=\"proven clearance along the path\" "
               "data-length-m=\"%.9g\" data-top-m=\"%.9g\" data-left=\"%.0f\" "
               "data-right=\"%.0f\" data-top=\"%.0f\" data-bottom=\"%.0f\">\n",
               kWidth, kHeight, kWidth, kHeight, length_m_, top_m_, kLeft, kWidth - kRight, kTop,
               kHeight - kBottom) +
           "<style>text{font:12px "
           "sans-serif;fill:#222}.grid{stroke:#ddd}.axis{stroke:#222;fill:none}"
           ".curve{stroke:#0072b2;stroke-width:1.8;fill:none}.required{stroke:#d55e00;"
           "stroke-dasharray:7 4;fill:none}.seat{fill:#e8e8e8}.violation{fill:#f6d5c3}"
           ".least{fill:#000}</style>\n"
           "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n" +
           svg_ + "</svg>\n";
  }

 private:
  double length_m_, top_m_;
  std::string svg_;
};

}  // namespace

Result<std::vector<CurvePiece>> read_curve(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);  // names of the columns
  std::vector<CurvePiece> pieces;
  while (std::getline(file, line)) {
    CurvePiece p;
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf", &p.from_s, &p.to_s, &p.clearance_m,
                    &p.from_m, &p.to_m) == 5) {
      pieces.push_back(p);
    }
  }
  if (pieces.empty()) return Error{ErrorCode::kReadFailed, path, "", "contains no curve", ""};
  return pieces;
}

Result<std::string> curve_svg(const std::string& curve, const nlohmann::json& verdict) {
  const auto steps = read_curve(curve);
  if (!steps) return steps.error();
  const double required_m = verdict["required_clearance_m"];
  const auto& smallest = verdict["min_clearance"];
  double max_m = 0;
  for (const CurvePiece& s : *steps) max_m = std::max(max_m, s.clearance_m);
  const double named_m = std::max<double>(required_m, smallest["clearance_m"]);
  Drawing drawing(steps->back().to_m,
                  std::max(std::min(max_m, kShown * named_m), 1.1 * required_m));
  drawing.band(verdict["seated"], "seat");
  drawing.band(verdict["violations"], "violation");
  drawing.axes();
  drawing.required(required_m);
  drawing.steps(*steps);
  const bool exact = smallest.contains("exact_m") && smallest["exact_m"].is_number();
  drawing.smallest(smallest["along_path_m"], smallest[exact ? "exact_m" : "clearance_m"]);
  return drawing.finish();
}

}  // namespace forcelayer::study
