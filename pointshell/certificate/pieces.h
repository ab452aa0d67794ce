// Pieces of triangles: bisection, and cutting a whole part into tiles of bounded size.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "pointshell/part.h"
#include "pointshell/vec3.h"

namespace forcelayer {

using Piece = std::array<Vec3, 3>;  // corners

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

inline Vec3 centroid(const Piece& p) { return (1.0 / 3) * (p[0] + p[1] + p[2]); }

inline double area(const Piece& p) { return length(cross(p[1] - p[0], p[2] - p[0])) / 2; }

// Largest distance of a corner from `place`.
inline double reach_from(const Vec3& place, const Piece& p) {
  return std::sqrt(std::max(
      {length_squared(p[0] - place), length_squared(p[1] - place), length_squared(p[2] - place)}));
}

inline Piece triangle_piece(const Part& part, std::size_t t) {
  const Triangle& corners = part.triangles[t];
  return {part.vertices[corners[0]], part.vertices[corners[1]], part.vertices[corners[2]]};
}

// Bisects all triangles into tiles with no edge longer than `longest_edge_m`, and hands them to
// `take` in batches, always the same for the same part, so that memory stays bounded. Ends early
// where `take` returns false.
void for_each_tile_batch(const Part& part, double longest_edge_m,
                         const std::function<bool(std::span<const Piece>)>& take);

}  // namespace forcelayer
