#include "pointshell/sample/covering_points.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/pshell_format.h"
#include "pointshell/certificate/point_grid.h"
#include "pointshell/part/pieces.h"
#include "pointshell/sample/feature_points.h"
#include "pointshell/sample/front_sampling.h"
#include "pointshell/sample/hole_filling.h"
#include "pointshell/sample/order.h"
#include "pointshell/sample/relaxation.h"
#include "pointshell/sample/stored_position.h"

namespace forcelayer::sample {
namespace {

// All lengths in covering radii. The perfect covering of a plane has a spacing of sqrt(3) = 1.73.
// Rows that meet do not fit, so a front of narrower spacing leaves fewer holes.
struct Recipe {
  double spacing;
  int centroid_steps;
  double centroid_factor;
  int ball_steps;
  double ball_factor;
  int steps_per_look_around;  // neighbors are looked up again after so many steps
  int rounds;                 // of adding points in holes
  int round_steps;            // to smallest balls, in each round
  double
      hole_separation;   // of the points added in one round, so that their neighbors can make room
  double relaxed_reach;  // around holes
};
constexpr Recipe kFull{1.60, 8, 1.8, 6, 1.15, 3, 30, 4, 6.5, 4};
constexpr Recipe kFast{1.53, 1, 1.5, 1, 1.15, 4, 0, 2, 4, 3};

// The way that points may move before neighbors are looked up again. First steps are long, later
// steps are short.
constexpr double kFirstSlack = 0.3, kLaterSlack = 0.1;
// Relaxation aims a little below the radius, which leaves room for rounding positions to floats.
constexpr double kAim = 0.9998;

class CoveringBuilder {
 public:
  CoveringBuilder(const part::TriangleTree& tree, double radius, const Recipe& recipe,
                  const std::function<void(double)>& progress)
      : recipe_(recipe),
        radius_(radius),
        aim_(kAim * radius),
        progress_(progress),
        relaxation_(tree, radius, spread(tree)) {}

  std::vector<part::Vec3> build() {
    for (int n = 0; n < recipe_.centroid_steps; ++n) {
      step_all(CellCenter::kCentroid, recipe_.centroid_factor);
    }
    for (int n = 0; n < recipe_.ball_steps; ++n) {
      step_all(CellCenter::kSmallestBall, recipe_.ball_factor);
    }
    for (int round = 0; round < recipe_.rounds && mend_holes(); ++round) {
      progress_(0.5 + 0.4 * round / recipe_.rounds);
    }
    std::vector<part::Vec3> positions;
    for (const part::Vec3& position : relaxation_.positions())
      positions.push_back(as_stored(position));
    return positions;
  }

 private:
  // Feature points, which stay, and the front's in block order, so that points near in space are
  // near in memory.
  std::vector<Relaxation::Point> spread(const part::TriangleTree& tree) const {
    std::vector<part::SurfacePoint> all = feature_points(tree.part(), radius_);
    const std::size_t features = all.size();
    const auto front = hexagonal_front(tree, recipe_.spacing * radius_, all);
    all.insert(all.end(), front.begin(), front.end());
    std::vector<part::Vec3> positions;
    for (const part::SurfacePoint& point : all) positions.push_back(point.position);
    std::vector<Relaxation::Point> ordered;
    for (const std::uint32_t n :
         block_order(positions, kDefaultBlockPoints, kDefaultSuperBlockBlocks)) {
      ordered.push_back({all[n], n < features});
    }
    return ordered;
  }

  void step_all(CellCenter center, double factor) {
    if (steps_done_ % recipe_.steps_per_look_around == 0) {
      relaxation_.choose_all((steps_done_ == 0 ? kFirstSlack : kLaterSlack) * radius_);
    }
    relaxation_.step(center, factor);
    ++steps_done_;
    progress_(0.5 * steps_done_ / (recipe_.centroid_steps + recipe_.ball_steps));
  }

  // Adds points in holes and relaxes around all of them; false when there are no holes.
  bool mend_holes() {
    std::vector<certificate::Hole> holes;
    std::vector<part::Vec3> places;
    for (std::size_t n = 0; n < relaxation_.positions().size(); ++n) {
      if (relaxation_.cell_radius(n) <= aim_) continue;
      holes.push_back({relaxation_.farthest_place(n), relaxation_.cell_radius(n), {}});
      places.push_back(holes.back().position);
    }
    if (holes.empty()) return false;
    for (const part::Vec3& place :
         deepest_holes(std::move(holes), recipe_.hole_separation * radius_)) {
      relaxation_.add(place);
    }
    relaxation_.choose(points_near(places), kLaterSlack * radius_);
    for (int n = 0; n < recipe_.round_steps; ++n) {
      relaxation_.step(CellCenter::kSmallestBall, recipe_.ball_factor);
    }
    return true;
  }

  std::vector<std::uint32_t> points_near(const std::vector<part::Vec3>& places) const {
    const double reach = recipe_.relaxed_reach * radius_;
    const certificate::PointGrid grid(places, reach);
    std::vector<std::uint32_t> near;
    for (std::uint32_t n = 0; n < relaxation_.positions().size(); ++n) {
      if (grid.nearest_distance(relaxation_.positions()[n], reach) < reach) near.push_back(n);
    }
    return near;
  }

  const Recipe recipe_;
  const double radius_, aim_;
  const std::function<void(double)>& progress_;
  Relaxation relaxation_;
  int steps_done_ = 0;
};

// The triangles that show where the surface is: where many are far smaller than the radius, a few
// in each small cube. Points are spread over these and relaxed among them; only the proof needs
// all.
std::vector<std::uint32_t> telling_triangles(const part::Part& part, double radius) {
  constexpr double kCube = 0.25, kSmall = 0.2;  // in radii: edges of cubes and of small triangles
  constexpr std::size_t kPerCube = 8;
  using Cube = std::array<std::int64_t, 3>;
  std::vector<std::uint32_t> telling;
  std::vector<std::pair<Cube, std::uint32_t>> small;
  for (std::uint32_t t = 0; t < part.triangles.size(); ++t) {
    const part::Piece piece = part::triangle_piece(part, t);
    if (part::longest_edge(piece).length_squared > kSmall * kSmall * radius * radius) {
      telling.push_back(t);
      continue;
    }
    const part::Vec3 p = (1 / (kCube * radius)) * part::centroid(piece);
    small.push_back(
        {{part::floor_to_int(p.x), part::floor_to_int(p.y), part::floor_to_int(p.z)}, t});
  }
  std::sort(small.begin(), small.end());
  for (std::size_t first = 0; first < small.size();) {
    std::size_t end = first + 1;
    while (end < small.size() && small[end].first == small[first].first) ++end;
    const std::size_t step = (end - first + kPerCube - 1) / kPerCube;
    for (std::size_t n = first; n < end; n += step) telling.push_back(small[n].second);
    first = end;
  }
  std::sort(telling.begin(), telling.end());
  return telling;
}

}  // namespace

CoveringPoints covering_points(const part::TriangleTree& tree, double radius, Effort effort,
                               const std::function<void(double)>& progress) {
  const Recipe& recipe = effort == Effort::kFast ? kFast : kFull;
  CoveringPoints covering;
  std::vector<std::uint32_t> telling = telling_triangles(tree.part(), radius);
  if (2 * telling.size() < tree.part().triangles.size()) {
    const part::TriangleTree thinned(tree.part(), std::move(telling));
    covering.positions = CoveringBuilder(thinned, radius, recipe, progress).build();
  } else {
    covering.positions = CoveringBuilder(tree, radius, recipe, progress).build();
  }
  covering.proof = fill_holes(tree.part(), radius, covering.positions);
  progress(1);
  return covering;
}

}  // namespace forcelayer::sample
