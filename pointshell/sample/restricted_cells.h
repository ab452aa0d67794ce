// The Voronoi cells of points, restricted to a surface: for each point, the pieces of the triangles
// that are nearer to it than to any other point (Yan, Levy, Liu, Sun and Wang, "Isotropic remeshing
// with fast and exact computation of restricted Voronoi diagram", 2009).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pointshell/certificate/convex_polygon.h"
#include "pointshell/certificate/point_grid.h"
#include "pointshell/part/triangle_tree.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::sample {

// The cells of a chosen set of points. They are cut with lists of the points and triangles near
// each point, which stay valid while points move by up to `slack`.
class RestrictedCells {
 public:
  // In radii. A cell that reaches farther is cut to a cube of this half-edge. A cell whose surface
  // is covered by its point reaches at most 1.
  static constexpr double kReach = 1.2;

  // Cells reach at most `radius` far; beyond, they are cut off (at 1.2 radius or farther).
  RestrictedCells(const part::TriangleTree& tree, double radius) : tree_(tree), radius_(radius) {}

  // A grid of `positions` for find_lists.
  certificate::PointGrid grid_of(std::span<const part::Vec3> positions, double slack) const;
  // Finds what is near the points `chosen` of all `positions`, or near all.
  void find_lists(std::span<const part::Vec3> positions, const certificate::PointGrid& grid,
                  std::span<const std::uint32_t> chosen, double slack);
  void find_lists(std::span<const part::Vec3> positions);

  // Calls visit(polygon, triangle) for each piece of the cell of point chosen[n], where `positions`
  // are those of find_lists, moved by no more than the slack.
  template <typename Visit>
  void visit_cell(std::size_t n, std::span<const part::Vec3> positions, const Visit& visit) const {
    const Lists& lists = chunks_[n / kChunk];
    const std::size_t at = n % kChunk;
    Cutter cutter(lists.center[at], positions, lists.neighbors_of(at), radius_);
    for (const std::uint32_t t : lists.triangles_of(at)) {
      const auto [a, b, c] = part::triangle_piece(tree_.part(), t);
      cutter.polygon.assign(a, b, c);
      cutter.cut();
      if (!cutter.polygon.empty()) visit(cutter.polygon, t);
    }
  }

  const part::TriangleTree& tree() const { return tree_; }

  // The triangles that pieces of the cell of point chosen[n] can come from: those within kReach
  // radii and the slack.
  std::span<const std::uint32_t> triangles_near(std::size_t n) const {
    return chunks_[n / kChunk].triangles_of(n % kChunk);
  }

 private:
  double neighbor_reach(double slack) const { return 2 * (kReach * radius_ + slack); }

  static constexpr std::size_t kChunk = 128;  // points whose lists one task makes

  // The points and triangles near each point of one chunk.
  struct Lists {
    struct Range {
      std::uint32_t first = 0, count = 0;
    };
    std::vector<std::uint32_t> center;              // the chosen points
    std::vector<Range> neighbors_at, triangles_at;  // of each of them, in what follows
    std::vector<std::uint32_t> neighbors, triangles;

    std::span<const std::uint32_t> neighbors_of(std::size_t at) const {
      return {neighbors.data() + neighbors_at[at].first, neighbors_at[at].count};
    }
    std::span<const std::uint32_t> triangles_of(std::size_t at) const {
      return {triangles.data() + triangles_at[at].first, triangles_at[at].count};
    }
  };
  class ListMaker;

  // Cuts polygons down to one point's cell.
  struct Cutter {
    Cutter(std::uint32_t point, std::span<const part::Vec3> positions,
           std::span<const std::uint32_t> neighbors, double radius);
    void cut();
    void cut_to_cube();

    static constexpr std::size_t kMaxNeighbors = 64;
    struct Bisector {
      part::Vec3 normal;        // from the point to its neighbor
      double offset;            // of the plane: dot(normal, middle)
      double distance_squared;  // to the neighbor
      bool keep_in_plane;
    };
    certificate::ConvexPolygon polygon;
    part::Vec3 center;
    double radius;
    Bisector bisectors[kMaxNeighbors];
    std::size_t bisector_count = 0;
  };

  const part::TriangleTree& tree_;
  const double radius_;
  std::vector<Lists> chunks_;
};

}  // namespace forcelayer::sample
