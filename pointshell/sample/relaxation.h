// Moving points over a surface so that their cells become round and equally large.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pointshell/part/triangle_tree.h"
#include "pointshell/sample/restricted_cells.h"

namespace forcelayer::sample {

// The place in its cell that a point moves to.
enum class CellCenter {
  kCentroid,      // Lloyd: evens out density
  kSmallestBall,  // the center of the smallest ball around the cell: reduces the covering radius
};

class Relaxation {
 public:
  struct Point {
    part::SurfacePoint place;
    bool fixed;  // never moves
  };
  // `radius` (m) is the covering radius that is aimed at.
  Relaxation(const part::TriangleTree& tree, double radius, std::span<const Point> points);

  // Chooses the points that the following steps move, and looks up what is near them. Good for
  // moves of up to `slack` (m).
  void choose_all(double slack);
  // The points nearer than `reach` (m) to any of `places`.
  void choose_near(std::span<const part::Vec3> places, double reach, double slack);

  // Moves each chosen point by `factor` times the way to its cell's center, and to the nearest
  // place on the surface. All move at once, so the order does not matter.
  void step(CellCenter center, double factor);

  // Appends a point at the place on the surface nearest to each of `places`.
  void add(std::span<const part::Vec3> places);

  const std::vector<part::Vec3>& positions() const { return positions_; }

  // The place of point `n`'s cell that is farthest from it, and its distance (m), as they were
  // before the last step that moved it.
  const part::Vec3& farthest_place(std::size_t n) const { return farthest_[n]; }
  double cell_radius(std::size_t n) const { return cell_radius_[n]; }

 private:
  struct Move {
    part::SurfacePoint to;
    part::Vec3 farthest;
    double cell_radius;
  };
  Move find_move(std::size_t n, CellCenter center, double factor) const;
  // The surface point nearest to `target`, of `triangles` and the one slid along.
  part::SurfacePoint slide(std::uint32_t triangle, const part::Vec3& target,
                           std::span<const std::uint32_t> triangles) const;

  const part::TriangleTree& tree_;
  const double radius_;
  RestrictedCells cells_;
  std::vector<part::Vec3> positions_, farthest_;
  std::vector<std::uint32_t> triangles_;  // that each point lies on
  std::vector<char> fixed_;
  std::vector<double> cell_radius_;
  std::vector<std::uint32_t> chosen_;  // ascending
  std::vector<Move> moves_;
};

}  // namespace forcelayer::sample
