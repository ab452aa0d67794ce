#include "pointshell/sample/weights.h"

#include <algorithm>
#include <cmath>

#include "pointshell/part/parallel.h"
#include "pointshell/part/pieces.h"

namespace forcelayer::sample {
namespace {

double area_of(std::span<const part::Vec3> corners) {
  part::Vec3 doubled;
  for (std::size_t n = 2; n < corners.size(); ++n) {
    doubled += part::cross(corners[n - 1] - corners[0], corners[n] - corners[0]);
  }
  return part::length(doubled) / 2;
}

using Side = certificate::HiddenSurface::Side;

// The ball about the middle of the corners.
struct Ball {
  explicit Ball(std::span<const part::Vec3> corners) {
    for (const part::Vec3& corner : corners) middle += corner;
    middle = (1.0 / static_cast<double>(corners.size())) * middle;
    for (const part::Vec3& corner : corners) {
      radius = std::max(radius, part::length(corner - middle));
    }
  }
  part::Vec3 middle;
  double radius = 0;
};

double hidden_area(const certificate::HiddenSurface& hidden, std::uint32_t body,
                   const part::Piece& piece, double step) {
  const Ball ball(piece);
  const Side side = hidden.side_of(body, ball.middle, ball.radius);
  if (side == Side::kOuter) return 0;
  if (side == Side::kHidden) return area_of(piece);
  if (ball.radius <= step) return hidden.holds_ball(ball.middle, 0) ? area_of(piece) : 0;
  const auto [a, b] = part::bisected(piece, part::longest_edge(piece).from);
  return hidden_area(hidden, body, a, step) + hidden_area(hidden, body, b, step);
}

double outer_area(const certificate::HiddenSurface& hidden, std::uint32_t body,
                  std::span<const part::Vec3> corners, double step) {
  const double area = area_of(corners);
  if (!hidden.possible()) return area;
  const Ball ball(corners);
  const Side side = hidden.side_of(body, ball.middle, ball.radius);
  if (side == Side::kOuter) return area;
  if (side == Side::kHidden) return 0;
  double inside = 0;
  for (std::size_t n = 2; n < corners.size(); ++n) {
    inside += hidden_area(hidden, body, {corners[0], corners[n - 1], corners[n]}, step);
  }
  return std::max(0.0, area - inside);
}

}  // namespace

std::vector<double> area_weights(const RestrictedCells& cells, std::span<const part::Vec3> points,
                                 const certificate::HiddenSurface& hidden, double step) {
  const std::vector<std::uint32_t>& body = cells.tree().part().body;
  std::vector<double> areas(points.size());
  part::parallel_for_each_index(points.size(), 256, [&](std::size_t n) {
    cells.visit_cell(n, points, [&](const certificate::ConvexPolygon& polygon, std::uint32_t t) {
      areas[n] += outer_area(hidden, body[t], polygon.corners(), step);
    });
  });
  return areas;
}

}  // namespace forcelayer::sample
