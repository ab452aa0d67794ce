#include "pointshell/sample/weights.h"

#include "pointshell/part/parallel.h"

namespace forcelayer {
namespace {

double area_of(std::span<const Vec3> corners) {
  Vec3 doubled;
  for (std::size_t n = 2; n < corners.size(); ++n) {
    doubled += cross(corners[n - 1] - corners[0], corners[n] - corners[0]);
  }
  return length(doubled) / 2;
}

}  // namespace

std::vector<double> area_weights(const RestrictedCells& cells, std::span<const Vec3> points) {
  std::vector<double> areas(points.size());
  parallel_for_each_index(points.size(), 256, [&](std::size_t n) {
    cells.visit_cell(n, points,
                     [&](const ConvexPolygon& polygon) { areas[n] += area_of(polygon.corners()); });
  });
  return areas;
}

}  // namespace forcelayer
