#include "pointshell/sample/weights.h"

#include "pointshell/part/parallel.h"

namespace forcelayer::sample {
namespace {

double area_of(std::span<const part::Vec3> corners) {
  part::Vec3 doubled;
  for (std::size_t n = 2; n < corners.size(); ++n) {
    doubled += part::cross(corners[n - 1] - corners[0], corners[n] - corners[0]);
  }
  return part::length(doubled) / 2;
}

}  // namespace

std::vector<double> area_weights(const RestrictedCells& cells, std::span<const part::Vec3> points) {
  std::vector<double> areas(points.size());
  part::parallel_for_each_index(points.size(), 256, [&](std::size_t n) {
    cells.visit_cell(n, points, [&](const certificate::ConvexPolygon& polygon) {
      areas[n] += area_of(polygon.corners());
    });
  });
  return areas;
}

}  // namespace forcelayer::sample
