// Detail finer than the covering radius, bounded as a whole: flat patches for many pieces of
// surface.
//
// Threads, grooves and fine meshes lie between two planes that are near each other. The rectangle
// midway between them stands for all of the surface there, which is within half the distance of the
// planes: such surface costs what a plain one costs. Bundles of tubes and deep grooves fill a box:
// it stands for all surface inside, however much there is. Where neither proves enough, the pieces
// are halved.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointshell/part/part.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::certificate {

// Convex polygons, one after the other.
class SurfacePieces {
 public:
  void add(std::span<const part::Vec3> polygon);
  std::size_t size() const { return ends_.size(); }
  std::span<const part::Vec3> operator[](std::size_t n) const {
    const std::size_t first = n == 0 ? 0 : ends_[n - 1];
    return std::span(corners_).subspan(first, ends_[n] - first);
  }
  std::span<const part::Vec3> corners() const { return corners_; }

  // The pieces on either side of the plane dot(normal, x) = offset; those across it are cut.
  std::array<SurfacePieces, 2> split(const part::Vec3& normal, double offset) const;

 private:
  std::vector<part::Vec3> corners_;
  std::vector<std::size_t> ends_;
};

// A rectangle and how far pieces of surface may be from it.
struct FlatPatch {
  std::array<part::Vec3, 4> corners;  // one after the other
  double gap = 0;                     // no place of the pieces is farther from the rectangle, m
};

// A box along the directions in which its pieces extend.
struct OrientedBox {
  part::Vec3 middle;
  std::array<part::Vec3, 3> half;  // from the middle to three faces, the longest first

  double radius() const;  // half a diagonal
  std::array<part::Vec3, 8> corners() const;
  FlatPatch patch() const;
};
OrientedBox box_around(const SurfacePieces& pieces);

// The pieces of a box smaller than this are looked at one by one, in covering radii.
inline constexpr double kSmallestHalved = 0.25;

// Calls bounded(patch) and filled(box, pieces) for patches and boxes that stand for all pieces.
// Where none does, as they say, the pieces are halved. Where they are small, or few, each(polygon)
// is called for them. `radius`: the covering radius, m.
template <typename Bounded, typename Filled, typename Each>
void bound_by_patches(const SurfacePieces& pieces, double radius, const Bounded& bounded,
                      const Filled& filled, const Each& each) {
  constexpr std::size_t kFew = 6;
  constexpr double kMaxGap = 0.025, kLargestBox = 0.75;  // radii
  if (pieces.size() == 0) return;
  const bool few = pieces.size() <= kFew;
  const OrientedBox box = box_around(pieces);
  if (!few && part::length(box.half[2]) <= kMaxGap * radius && bounded(box.patch())) return;
  if (!few && box.radius() <= kLargestBox * radius && filled(box, pieces)) return;
  if (few || box.radius() < kSmallestHalved * radius) {
    for (std::size_t n = 0; n < pieces.size(); ++n) each(pieces[n]);
    return;
  }
  for (const SurfacePieces& side : pieces.split(box.half[0], part::dot(box.half[0], box.middle))) {
    bound_by_patches(side, radius, bounded, filled, each);
  }
}

// Tiles by the cubes of a grid that their middles lie in.
struct TileGroups {
  std::vector<SurfacePieces> dense;   // those of each cube that holds many
  std::vector<std::uint32_t> sparse;  // the others, in their order
};
TileGroups group_tiles(std::span<const part::Piece> tiles, double cube_edge);

}  // namespace forcelayer::certificate
