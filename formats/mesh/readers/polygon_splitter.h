// Polygons of a mesh file as triangles.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/mesh/readers/plane_points.h"

namespace forcelayer::mesh {

// Splits polygons into triangles that cover the polygon's own area: a convex polygon as a fan from
// its first corner, any other by clipping ears in its best plane (Newell's normal). Takes n log n
// steps for n corners, about, whatever the outline. Counts the polygons that are not planar or
// cross themselves, for the file's warnings.
class PolygonSplitter {
 public:
  // Appends corners.size() - 2 triangles to `mesh`, oriented as the polygon is. At least three
  // corners, all of them finite vertices of `mesh`.
  void split(std::span<const std::uint32_t> corners, Mesh& mesh);

  // A line for polygons that are not planar and one for those that cross themselves.
  void add_warnings(std::vector<std::string>& warnings) const;

 private:
  using Point = PlanePoints::Point;

  void project(std::span<const std::uint32_t> corners, const Mesh& mesh, const Vec3d& normal);
  void note_planarity(std::span<const std::uint32_t> corners, const Mesh& mesh,
                      const Vec3d& normal);
  double turn(std::size_t a, std::size_t b, std::size_t c) const;
  bool is_convex() const;
  void clip_ears(std::span<const std::uint32_t> corners, Mesh& mesh);
  bool is_ear(std::size_t tip);
  std::size_t find_ear(std::size_t from, std::size_t left);
  void clip(std::size_t tip);

  std::vector<Point> points_;          // the corners in the plane, counter-clockwise
  std::vector<std::size_t> next_;      // ring of the corners that are not yet clipped
  std::vector<std::size_t> previous_;  // the same, backwards
  std::set<std::size_t> open_;         // of the ring: corners that are not known to be no ears
  PlanePoints in_ring_;                // where corners of the ring stand
  // For each place: corners that are no ears while a corner stands there.
  std::vector<std::vector<std::size_t>> blocked_by_;
  std::size_t looks_left_ = 0;          // at corners again, before any corner is clipped
  std::uint64_t not_planar_ = 0;        // polygons
  double largest_deviation_units_ = 0;  // from the best plane, file units
  std::uint64_t crossing_ = 0;          // polygons
};

}  // namespace forcelayer::mesh
