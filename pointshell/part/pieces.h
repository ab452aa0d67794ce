// Pieces of triangles: bisection, and cutting a whole part into tiles of bounded size.
#pragma once

#include <array>
#include <functional>
#include <span>
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

// The two halves on either side of the middle of the edge that starts at corner `from`.
inline std::array<Piece, 2> bisected(const Piece& piece, int from) {
  const Vec3 &a = piece[from], &b = piece[(from + 1) % 3], &c = piece[(from + 2) % 3];
  const Vec3 middle = 0.5 * (a + b);
  return {Piece{a, middle, c}, Piece{middle, b, c}};
}

// Bisects all triangles into tiles with no edge longer than `longest_edge_m`, and hands them to
// `take` in batches, always the same for the same part, so that memory stays bounded. Ends early
// where `take` returns false.
void for_each_tile_batch(const Part& part, double longest_edge_m,
                         const std::function<bool(std::span<const Piece>)>& take);

}  // namespace forcelayer::part
