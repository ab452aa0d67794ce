// The force of a contact over its depth: straight, or by the compliance table of a soft scene
// (formats/voxmap_format.md, section 6).
#pragma once

#include <vector>

#include "formats/voxmap.h"

namespace forcelayer::field {

// Forces are in units of the field's stiffness K_ff, which belongs to the curve's steepest place: a
// table gives the curve's shape, and its own pressure where K_ff is steepest_pa_per_m() of the map
// times the points' mean area. No slope is above 1, so a loop that is stable with K_ff is stable
// with the curve.
class ForceCurve {
 public:
  ForceCurve() = default;  // straight: K_ff times the depth
  explicit ForceCurve(const Voxmap& voxmap);

  bool is_straight() const noexcept { return nodes_.empty(); }

  // The depth of the last entry, where the covering ends; 0 where the curve is straight.
  double end_m() const noexcept {
    return is_straight() ? 0 : step_m_ * static_cast<double>(nodes_.size() - 1);
  }

  // Depth of the force layer beyond one voxel, m.
  double deepening_m() const noexcept { return deepening_m_; }

  // Force over K_ff at a depth, m; a gap (a negative depth) stays what it is.
  double force_m(double depth_m) const noexcept {
    return is_straight() || !(depth_m > 0) ? depth_m : between_nodes(depth_m).force_m;
  }

  // The steepest slope over K_ff within a tenth of a voxel of a depth, above 0 and at most 1. A
  // part that comes to rest goes no farther in a frame.
  double slope(double depth_m) const noexcept;

  // Energy over K_ff at a depth of 0 or more, m^2: the integral of the force from no depth on.
  double energy_m2(double depth_m) const noexcept {
    if (is_straight()) return 0.5 * depth_m * depth_m;
    return between_nodes(depth_m).energy_m2;
  }

 private:
  struct Node {
    double force_m = 0, energy_m2 = 0;
    double slope = 1;  // slope() from here to the next node
  };
  Node between_nodes(double depth_m) const noexcept;

  double step_m_ = 0, deepening_m_ = 0;
  std::vector<Node> nodes_;  // at depths of 0, 1, 2, ... steps; the last force holds beyond
};

}  // namespace forcelayer::field
