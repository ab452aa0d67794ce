#include "pointshell/sample/relaxation.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "pointshell/part/parallel.h"
#include "pointshell/sample/smallest_ball.h"

namespace forcelayer::sample {
namespace {

constexpr std::size_t kPointsPerTask = 32, kPlacesPerTask = 8;
// In radii. A target this close to the triangle that the point slid along is on it.
constexpr double kOnTriangle = 1e-7;

// Area and first moment of the pieces of a cell.
class Centroid {
 public:
  void add(std::span<const part::Vec3> corners) {
    for (std::size_t n = 2; n < corners.size(); ++n) {
      const part::Vec3 &a = corners[0], &b = corners[n - 1], &c = corners[n];
      const double area = part::length(part::cross(b - a, c - a)) / 2;
      area_ += area;
      moment_ += (area / 3) * (a + b + c);
    }
  }
  part::Vec3 of(const part::Vec3& without_area) const {
    return area_ > 0 ? (1 / area_) * moment_ : without_area;
  }

 private:
  double area_ = 0;
  part::Vec3 moment_;
};

}  // namespace

Relaxation::Relaxation(const part::TriangleTree& tree, double radius, std::span<const Point> points)
    : tree_(tree), radius_(radius), cells_(tree, radius) {
  for (const Point& point : points) {
    positions_.push_back(point.place.position);
    triangles_.push_back(point.place.triangle);
    fixed_.push_back(point.fixed);
  }
  farthest_ = positions_;
  cell_radius_.resize(positions_.size());
}

void Relaxation::choose_all(double slack) {
  chosen_.resize(positions_.size());
  std::iota(chosen_.begin(), chosen_.end(), 0u);
  cells_.find_lists(positions_, cells_.grid_of(positions_, slack), chosen_, slack);
}

void Relaxation::choose_near(std::span<const part::Vec3> places, double reach, double slack) {
  const certificate::PointGrid grid = cells_.grid_of(positions_, slack);
  std::vector<char> near(positions_.size());
  part::parallel_for_each_index(places.size(), kPlacesPerTask, [&](std::size_t n) {
    grid.visit_near(places[n], reach, [&](std::uint32_t point, const part::Vec3& position) {
      if (part::length(position - places[n]) < reach) {
        std::atomic_ref(near[point]).store(1, std::memory_order_relaxed);
      }
    });
  });
  chosen_.clear();
  for (std::uint32_t n = 0; n < near.size(); ++n) {
    if (near[n]) chosen_.push_back(n);
  }
  cells_.find_lists(positions_, grid, chosen_, slack);
}

part::SurfacePoint Relaxation::slide(std::uint32_t triangle, const part::Vec3& target,
                                     std::span<const std::uint32_t> triangles) const {
  const part::SurfacePoint along = tree_.nearest(target, {&triangle, 1});
  const double on_triangle = kOnTriangle * radius_;
  if (triangles.empty() ||
      part::length_squared(along.position - target) <= on_triangle * on_triangle) {
    return along;
  }
  return tree_.nearest(target, triangles);
}

Relaxation::Move Relaxation::find_move(std::size_t n, CellCenter center, double factor) const {
  const std::uint32_t point = chosen_[n];
  const part::Vec3& place = positions_[point];
  Move move{{place, triangles_[point]}, place, 0};
  Centroid centroid;
  std::vector<part::Vec3> corners;
  double farthest_squared = 0;
  cells_.visit_cell(n, positions_, [&](const certificate::ConvexPolygon& polygon, std::uint32_t) {
    for (const part::Vec3& corner : polygon.corners()) {
      const double squared = part::length_squared(corner - place);
      if (squared > farthest_squared) farthest_squared = squared, move.farthest = corner;
    }
    if (center == CellCenter::kCentroid) {
      centroid.add(polygon.corners());
    } else {
      corners.insert(corners.end(), polygon.corners().begin(), polygon.corners().end());
    }
  });
  move.cell_radius = std::sqrt(farthest_squared);
  if (farthest_squared == 0 || fixed_[point]) return move;
  const part::Vec3 middle =
      center == CellCenter::kCentroid ? centroid.of(place) : smallest_ball(corners).center;
  move.to = slide(triangles_[point], place + factor * (middle - place), cells_.triangles_near(n));
  return move;
}

void Relaxation::step(CellCenter center, double factor) {
  moves_.resize(chosen_.size());
  part::parallel_for_each_index(chosen_.size(), kPointsPerTask,
                                [&](std::size_t n) { moves_[n] = find_move(n, center, factor); });
  part::parallel_for_each_index(chosen_.size(), kPointsPerTask, [&](std::size_t n) {
    const std::uint32_t point = chosen_[n];
    positions_[point] = moves_[n].to.position;
    triangles_[point] = moves_[n].to.triangle;
    farthest_[point] = moves_[n].farthest;
    cell_radius_[point] = moves_[n].cell_radius;
  });
}

void Relaxation::add(std::span<const part::Vec3> places) {
  std::vector<part::SurfacePoint> added(places.size());
  part::parallel_for_each_index(places.size(), kPlacesPerTask,
                                [&](std::size_t n) { added[n] = tree_.nearest(places[n]).point; });
  for (const part::SurfacePoint& point : added) {
    positions_.push_back(point.position);
    triangles_.push_back(point.triangle);
    fixed_.push_back(false);
    farthest_.push_back(point.position);
    cell_radius_.push_back(0);
  }
}

}  // namespace forcelayer::sample
