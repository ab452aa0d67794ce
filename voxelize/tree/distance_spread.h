// Distances spreading through a cube of cells, from each to its 26 neighbours.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace forcelayer {

// A cube of 8x8x8 cells with a margin of 0..7 more on every side, as planes of constant x of rows
// along z.
template <class Distance>  // std::uint8_t or std::uint16_t
class DistanceField {
 public:
  static constexpr int kMaxMargin = 7;

  explicit DistanceField(int margin)
      : margin_(margin), width_(8 + 2 * margin), stride_((width_ * width_ + 63) / 64 * 64) {}

  int margin() const { return margin_; }
  int width() const { return width_; }

  // Cells (x, y, 0..7); cells of the margin have coordinates below 0 and above 7.
  Distance* row(int x, int y) { return plane(x) + (y + margin_) * width_ + margin_; }

  // The width x width cells of constant x. 64 cells before and behind it are there too.
  Distance* plane(int x) { return cells_.data() + kPadding + (x + margin_) * stride_; }

  // Lowers every cell of the middle 8x8x8 to the least, over all cells of the cube, of that cell's
  // distance and `edge` times the Chebyshev distance to it, as far as the margin is deep. Distances
  // saturate. The margin's own cells are spent.
  void spread(Distance edge);

  static constexpr int kMaxWidth = 8 + 2 * kMaxMargin;
  static constexpr int kMaxPlane = (kMaxWidth * kMaxWidth + 63) / 64 * 64;
  static constexpr int kPadding = 64;

 private:
  int margin_, width_, stride_;
  alignas(64) std::array<Distance, kMaxWidth * kMaxPlane + 2 * kPadding> cells_;
};

}  // namespace forcelayer
