// Distances that spread through a cube of cells, from each cell to its 26 neighbors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace forcelayer::tree {

// A cube of 8x8x8 cells with a margin of 0..7 cells on every side: planes of constant x, each of
// rows along z.
template <class Distance>  // std::uint8_t or std::uint16_t
class ClearanceCube {
 public:
  static constexpr int kMaxMargin = 7;

  explicit ClearanceCube(int margin)
      : margin_(margin), width_(8 + 2 * margin), stride_((width_ * width_ + 63) / 64 * 64) {}

  int margin() const { return margin_; }
  int width() const { return width_; }

  // Cells (x, y, 0..7); cells of the margin have coordinates below 0 and above 7.
  Distance* row(int x, int y) { return plane(x) + (y + margin_) * width_ + margin_; }

  // The width x width cells of constant x. 64 cells before and after it may be read and written.
  Distance* plane(int x) { return cells_.data() + kPadding + (x + margin_) * stride_; }

  // Lowers every cell c of the middle 8x8x8 to the minimum, over the cells e within `margin` steps,
  // of distance(e) + edge * (Chebyshev distance of c and e). Sums saturate. Afterwards the margin's
  // cells are undefined.
  void spread(Distance edge);

  static constexpr int kMaxWidth = 8 + 2 * kMaxMargin;
  static constexpr int kMaxPlane = (kMaxWidth * kMaxWidth + 63) / 64 * 64;
  static constexpr int kPadding = 64;

 private:
  int margin_, width_, stride_;
  alignas(64) std::array<Distance, kMaxWidth * kMaxPlane + 2 * kPadding> cells_;
};

}  // namespace forcelayer::tree
