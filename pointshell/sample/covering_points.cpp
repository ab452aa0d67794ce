#include "pointshell/sample/covering_points.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "formats/pshell_format.h"
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
  // About which fractions of the time go into spreading points, the steps of all, and the rounds;
  // the proof takes the rest.
  double spread_fraction, steps_fraction, rounds_fraction;
};
constexpr Recipe kFull{1.60, 8, 1.8, 6, 1.15, 3, 30, 4, 6.5, 4, 0.08, 0.5, 0.33};
constexpr Recipe kFast{1.53, 1, 1.5, 1, 1.15, 4, 0, 2, 4, 3, 0.36, 0.37, 0};

// The way that points may move before neighbors are looked up again. First steps are long, later
// steps are short.
constexpr double kFirstSlack = 0.3, kLaterSlack = 0.1;
// Relaxation aims a little below the radius, which leaves room for rounding positions to floats.
constexpr double kAim = 0.9998;
// Where more than this fraction of the cells are too large, as between layers of thin surface,
// points are added closer together.
constexpr double kBareFraction = 0.25, kBareSeparation = 3;

class CoveringBuilder {
 public:
  CoveringBuilder(const part::TriangleTree& tree, double radius, const Recipe& recipe,
                  const part::Progress& progress)
      : recipe_(recipe),
        radius_(radius),
        aim_(kAim * radius),
        progress_(progress),
        relaxation_(tree, radius, spread(tree)) {}

  std::vector<part::Vec3> build() {
    progress_(recipe_.spread_fraction);
    for (int n = 0; n < recipe_.centroid_steps; ++n) {
      step_all(CellCenter::kCentroid, recipe_.centroid_factor);
    }
    for (int n = 0; n < recipe_.ball_steps; ++n) {
      step_all(CellCenter::kSmallestBall, recipe_.ball_factor);
    }
    for (int round = 0; round < recipe_.rounds && mend_holes(); ++round) {
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
    positions.reserve(all.size());
    for (const part::SurfacePoint& point : all) positions.push_back(point.position);
    std::vector<Relaxation::Point> ordered;
    ordered.reserve(all.size());
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
    progress_(recipe_.spread_fraction +
              recipe_.steps_fraction * steps_done_ / (recipe_.centroid_steps + recipe_.ball_steps));
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
    // The first rounds mend most holes and take longest, the last ones a few.
    const auto left = static_cast<double>(holes.size());
    first_holes_ = std::max(first_holes_, left);
    progress_(recipe_.spread_fraction + recipe_.steps_fraction +
              recipe_.rounds_fraction * (1 - std::sqrt(left / first_holes_)));
    const bool is_bare = kBareFraction * static_cast<double>(relaxation_.positions().size()) <
                         static_cast<double>(holes.size());
    const double separation = is_bare ? kBareSeparation : recipe_.hole_separation;
    relaxation_.add(deepest_holes(holes, separation * radius_));
    relaxation_.choose_near(places, recipe_.relaxed_reach * radius_, kLaterSlack * radius_);
    for (int n = 0; n < recipe_.round_steps; ++n) {
      relaxation_.step(CellCenter::kSmallestBall, recipe_.ball_factor);
    }
    return true;
  }

  const Recipe recipe_;
  const double radius_, aim_;
  const part::Progress& progress_;
  Relaxation relaxation_;
  int steps_done_ = 0;
  double first_holes_ = 0;
};

// Chooses triangles that show where the surface is: all that are wide, and of the narrow and small
// ones so many as give each small cube a few. Points are spread over these and relaxed among them;
// only the proof needs all.
class TellingTriangles {
 public:
  TellingTriangles(const part::Part& part, double radius) : part_(part), radius_(radius) {}

  std::vector<std::uint32_t> choose() {
    std::vector<std::pair<double, std::uint32_t>> narrow;  // less than the length, for the order
    for (std::uint32_t t = 0; t < part_.triangles.size(); ++t) {
      const double length_m =
          std::sqrt(part::longest_edge(part::triangle_piece(part_, t)).length_squared);
      if (is_wide(t, length_m)) {
        telling_.push_back(t);
      } else {
        narrow.push_back({-length_m, t});
      }
    }
    std::sort(narrow.begin(), narrow.end());
    for (const auto& [minus_length_m, t] : narrow) take_where_wanted(t, -minus_length_m);
    std::sort(telling_.begin(), telling_.end());
    return std::move(telling_);
  }

 private:
  // In radii: heights and lengths of wide triangles, edges of cubes.
  static constexpr double kWide = 0.2, kLong = 1024, kCube = 0.5;
  static constexpr int kPerCube = 2;

  bool is_wide(std::uint32_t t, double length_m) const {
    return length_m > kLong * radius_ ||
           part::length(part::doubled_area_normal(part_, t)) > kWide * radius_ * length_m;
  }

  // Takes the triangle where a cube along its longest edge has too few.
  void take_where_wanted(std::uint32_t t, double length_m) {
    const part::Piece piece = part::triangle_piece(part_, t);
    const int from = part::longest_edge(piece).from;
    const part::Vec3 along = piece[(from + 1) % 3] - piece[from];
    const int steps = 1 + static_cast<int>(length_m / (kCube * radius_));
    cubes_.clear();
    bool wanted = false;
    for (int n = 0; n < steps; ++n) {
      cubes_.push_back(part::cube_at(piece[from] + ((n + 0.5) / steps) * along, kCube * radius_));
      wanted = wanted || taken_[cubes_.back()] < kPerCube;
    }
    if (!wanted) return;
    telling_.push_back(t);
    for (const part::Cube& cube : cubes_) ++taken_[cube];
  }

  const part::Part& part_;
  const double radius_;
  std::vector<std::uint32_t> telling_;
  std::unordered_map<part::Cube, int, part::CubeHash> taken_;
  std::vector<part::Cube> cubes_;  // of the triangle in hand
};

}  // namespace

CoveringPoints covering_points(const part::TriangleTree& tree, double radius, Effort effort,
                               const part::Progress& progress) {
  const Recipe& recipe = effort == Effort::kFast ? kFast : kFull;
  CoveringPoints covering;
  std::vector<std::uint32_t> telling = TellingTriangles(tree.part(), radius).choose();
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
