// Approximating a place by a convex combination of shell points, for the distance that the points'
// distances prove there.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "pointshell/certificate/point_grid.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::certificate {

// A convex combination c of shell points, made for a place q.
struct Combination {
  part::Vec3 place;          // c, m
  double second_moment = 0;  // sum of weight times |point - c|^2, m^2
  double gap = 0;            // |q - c|, m; infinite where no point is near
};

// Where every shell point is at least `point_distance` from a scene, q is at least this much less
// far from it: d^2 - |x|^2 is concave, so d(c)^2 >= point_distance^2 - second_moment. Infinite
// where the root does not exist. All in m.
inline double distance_loss(double point_distance, double second_moment, double gap) {
  const double squared = point_distance * point_distance - second_moment;
  if (!(squared >= 0)) return std::numeric_limits<double>::infinity();
  return point_distance - std::sqrt(squared) + gap;
}

// Searches for combinations of little loss; one of it per task, as it keeps scratch memory. The
// search may miss the best one; every combination that it returns is one.
class CombinationFinder {
 public:
  // In radii: combinations use points this close to the place.
  static constexpr double kReach = 2.2;

  // `grid` holds the points, in cells no smaller than kReach radii. The search aims at a small
  // loss for points at `point_distance` (m).
  CombinationFinder(const PointGrid& grid, double radius, double point_distance)
      : grid_(grid), radius_(radius), aim_(point_distance / radius) {}

  Combination at(const part::Vec3& place);

 private:
  struct Candidate {
    part::Vec3 offset;   // from the place, in radii
    double squared = 0;  // of that
    double cost = 0;     // of a unit of weight
    double weight = 0;
  };

  void minimize(double stiffness);
  std::size_t steepest(double stiffness) const;
  void settle(double stiffness);
  part::Vec3 offset_of_combination() const;
  void keep_if_better();

  const PointGrid& grid_;
  const double radius_;
  const double aim_;  // point_distance in radii
  std::vector<Candidate> candidates_;
  std::vector<std::size_t> support_;  // candidates of positive weight, at most 5
  double best_loss_ = 0;
  Combination best_;  // in radii, relative to the place
};

}  // namespace forcelayer::certificate
