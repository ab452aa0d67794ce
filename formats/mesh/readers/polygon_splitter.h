// Polygons of a mesh file as triangles.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"

namespace forcelayer::mesh {

// Splits polygons into triangles that cover the polygon's own area: a convex polygon as a fan from
// its first corner, any other by clipping ears in its best plane (Newell's normal). Counts the
// polygons that are not planar or cross themselves, for the file's warnings.
class PolygonSplitter {
 public:
  // Appends corners.size() - 2 triangles to `mesh`, oriented as the polygon is. At least three
  // corners, all of them finite vertices of `mesh`.
  void split(std::span<const std::uint32_t> corners, Mesh& mesh);

  // A line for polygons that are not planar and one for those that cross themselves.
  void add_warnings(std::vector<std::string>& warnings) const;

 private:
  struct Point {
    double x, y;
  };

  static constexpr std::size_t kClipped = ~std::size_t{0};

  // A corner in the triangle of another one between these neighbors, as it was found last: while
  // all three are there, the other one is no ear. Without it a polygon of n corners takes n^3.
  struct Blocker {
    std::size_t previous = kClipped, next = kClipped, corner = 0;
  };

  void project(std::span<const std::uint32_t> corners, const Mesh& mesh, const Vec3d& normal);
  void note_planarity(std::span<const std::uint32_t> corners, const Mesh& mesh,
                      const Vec3d& normal);
  double turn(std::size_t a, std::size_t b, std::size_t c) const;
  bool is_convex() const;
  void clip_ears(std::span<const std::uint32_t> corners, Mesh& mesh);
  bool is_ear(std::size_t tip);
  std::size_t find_ear(std::size_t from, std::size_t left);

  std::vector<Point> points_;           // the corners in the plane, counter-clockwise
  std::vector<std::size_t> next_;       // ring of the corners that are not yet clipped
  std::vector<std::size_t> previous_;   // the same, backwards; kClipped of the others
  std::vector<Blocker> blockers_;       // of each corner
  std::uint64_t not_planar_ = 0;        // polygons
  double largest_deviation_units_ = 0;  // from the best plane, file units
  std::uint64_t crossing_ = 0;          // polygons
};

}  // namespace forcelayer::mesh
