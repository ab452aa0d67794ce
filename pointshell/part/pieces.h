// Pieces of triangles: bisection, and cutting a whole part into tiles of bounded size.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "pointshell/part/part.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::part {

struct LongestEdge {
  int from = 0;  // the edge runs from corner `from` to the next
  double length_squared = 0;
};

inline LongestEdge longest_edge(const Piece& piece) {
  LongestEdge longest{0, length_squared(piece[1] - piece[0])};
  for (int corner = 1; corner < 3; ++corner) {
    const double squared = length_squared(piece[(corner + 1) % 3] - piece[corner]);
    if (squared > longest.length_squared) longest = {corner, squared};
  }
  return longest;
}

// Whether the triangle is a line or a point, but for rounding: its direction says nothing.
bool is_flat(const Piece& piece);

// The two halves on either side of the middle of the edge that starts at corner `from`.
inline std::array<Piece, 2> bisected(const Piece& piece, int from) {
  const Vec3 &a = piece[from], &b = piece[(from + 1) % 3], &c = piece[(from + 2) % 3];
  const Vec3 middle = 0.5 * (a + b);
  return {Piece{a, middle, c}, Piece{middle, b, c}};
}

// A triangle that is long and thin. Bisecting it again and again would give slivers beside each
// other, (length / edge)^1.6 of them; slices across its longest edge are (length / edge).
class Needle {
 public:
  // Nothing where the triangle is no needle next to pieces with edges of `longest_edge_m`.
  static std::optional<Needle> of(const Piece& piece, double longest_edge_m);

  std::size_t slices() const { return slices_; }
  // The pieces of a slice: up to three triangles with no edge longer than `longest_edge_m`.
  template <typename Take>
  void visit_slice(std::size_t slice, const Take& take) const {
    const double t0 = fraction(slice), t1 = fraction(slice + 1);
    const Vec3 a = on_edge(t0), b = on_edge(t1), c = beside_edge(t1), d = beside_edge(t0);
    // Where the triangle has no area, d is a and c is b: one piece is taken all the same.
    if (t0 < foot_ && foot_ < t1) {
      take(Piece{a, b, apex_});
      take_unless_in_others({b, c, apex_}, take);
      take_unless_in_others({a, apex_, d}, take);
    } else if (b == c) {
      take(Piece{a, c, d});
    } else {
      take(Piece{a, b, c});
      take_unless_in_others({a, c, d}, take);
    }
  }
  // The slices [first, last) that may reach into the box.
  std::pair<std::size_t, std::size_t> slices_near(const Box& box) const;

 private:
  double fraction(std::size_t slice) const {
    return static_cast<double>(slice) / static_cast<double>(slices_);
  }
  Vec3 on_edge(double t) const { return t == 1 ? to_ : from_ + t * (to_ - from_); }
  Vec3 beside_edge(double t) const {
    if (t == 0) return from_;
    if (t == 1) return to_;
    return t < foot_ ? from_ + (t / foot_) * (apex_ - from_)
                     : apex_ + ((t - foot_) / (1 - foot_)) * (to_ - apex_);
  }
  // A piece with two equal corners is a side of the slice's other pieces.
  template <typename Take>
  static void take_unless_in_others(const Piece& piece, const Take& take) {
    if (!(piece[0] == piece[1] || piece[1] == piece[2] || piece[2] == piece[0])) take(piece);
  }

  Vec3 from_, to_, apex_;  // the ends of the longest edge, and the third corner
  double foot_ = 0;        // of the apex, as a fraction of the way along the edge
  double height_ = 0;      // of the apex above the edge, m
  std::size_t slices_ = 0;
};

// Cuts all triangles into tiles with no edge longer than `longest_edge_m`, and hands them to
// `take` in batches, always the same for the same part, so that memory stays bounded. Ends early
// where `take` returns false.
void for_each_tile_batch(const Part& part, double longest_edge_m,
                         const std::function<bool(std::span<const Piece>)>& take);

}  // namespace forcelayer::part
