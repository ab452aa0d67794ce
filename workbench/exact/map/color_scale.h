// Colors for lengths: viridis (van der Walt and Smith 2015, public domain, CC0), in which equal
// steps look equal, also to the color-blind and in gray.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace forcelayer::exact {

using Rgb = std::array<std::uint8_t, 3>;  // sRGB

// The colors of the scale in equal steps from the first to the last.
const std::vector<Rgb>& scale_colors();

// The color at a fraction of the scale; one behind the end is no color of it.
Rgb color_at(double fraction);
inline constexpr Rgb kBeyondScale{190, 190, 190};

// The same as glTF has colors at vertices: linear, and opaque.
std::array<std::uint8_t, 4> linear_rgba(const Rgb& color);

}  // namespace forcelayer::exact
