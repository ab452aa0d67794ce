// Groups of bodies that a part holds several times, each far enough from all else that no shell
// point serves both: their points are made and proven once.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pointshell/part/part.h"

namespace forcelayer::part {

// A motion that keeps distances: turned or mirrored, and moved.
struct Motion {
  std::array<Vec3, 3> rows{Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Vec3 offset;

  Vec3 turned(const Vec3& p) const { return {dot(rows[0], p), dot(rows[1], p), dot(rows[2], p)}; }
  Vec3 moved(const Vec3& p) const { return turned(p) + offset; }
};

// The same motion in a frame whose origin is `origin` of this one.
Motion relative_to(const Motion& motion, const Vec3& origin);

// Groups of bodies, each ascending, by number. Two bodies are in one group where their boxes are at
// most `reach` apart along each axis, or where a chain of such bodies connects them. Bodies without
// triangles are in none.
std::vector<std::vector<std::uint32_t>> separate_groups(const Part& part, double reach);

struct Copy {
  Motion from_original;
  std::vector<std::uint32_t> bodies;  // [n] is the original's [n] again
};

// A body and its copies. A proof with `slack_m` to spare, of points, of places of the surface and
// of distances up to five radii between them, where the original stands, holds for all copies, with
// their points rounded to floats relative to any place within the part's box.
struct CopiedGroup {
  std::vector<std::uint32_t> bodies;  // the original, ascending
  std::vector<Copy> copies;           // at least one
  double slack_m = 0;                 // at most a thousandth of the radius
};

// The groups of separate_groups(), with a reach of two radii, that the part holds again. Of equal
// groups that with the first vertex is the original.
std::vector<CopiedGroup> find_copies(const Part& part, double radius);

// The triangle of an original that each triangle is again, or itself: [triangles].
std::vector<std::uint32_t> original_triangles(const Part& part,
                                              std::span<const CopiedGroup> groups);

}  // namespace forcelayer::part
