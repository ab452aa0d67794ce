#include "workbench/exact/map/color_scale.h"

#include <algorithm>
#include <cmath>

namespace forcelayer::exact {

const std::vector<Rgb>& scale_colors() {
  static const std::vector<Rgb> kColors{{0x44, 0x01, 0x54}, {0x48, 0x28, 0x78}, {0x3e, 0x4a, 0x89},
                                        {0x31, 0x68, 0x8e}, {0x26, 0x82, 0x8e}, {0x1f, 0x9e, 0x89},
                                        {0x35, 0xb7, 0x79}, {0x6d, 0xcd, 0x59}, {0xb4, 0xde, 0x2c},
                                        {0xfd, 0xe7, 0x25}};
  return kColors;
}

Rgb color_at(double fraction) {
  if (fraction >= 1) return kBeyondScale;
  const std::vector<Rgb>& colors = scale_colors();
  const double at = std::max(0.0, fraction) * static_cast<double>(colors.size() - 1);
  const auto before = static_cast<std::size_t>(at);
  const double part = at - std::floor(at);
  Rgb color{};
  for (std::size_t n = 0; n < 3; ++n) {
    const double value = (1 - part) * colors[before][n] + part * colors[before + 1][n];
    color[n] = static_cast<std::uint8_t>(std::lround(value));
  }
  return color;
}

std::array<std::uint8_t, 4> linear_rgba(const Rgb& color) {
  std::array<std::uint8_t, 4> linear{0, 0, 0, 255};
  for (std::size_t n = 0; n < 3; ++n) {  // IEC 61966-2-1
    const double value = color[n] / 255.0;
    const double light = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
    linear[n] = static_cast<std::uint8_t>(std::lround(255 * light));
  }
  return linear;
}

}  // namespace forcelayer::exact
