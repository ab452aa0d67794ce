// How near single places of a part and of a scene come to the other one along a path. Each answer
// is a lower bound for the whole path, between its poses as at them. Along a path that does not
// turn, a place moves along straight segments, whose distances are exact. Elsewhere distances are
// measured at moments, and min_between_m() (exact_walk.h) bounds them in between.
#pragma once

#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <vector>

#include "runtime/clearance/center_path.h"
#include "workbench/exact/body.h"
#include "workbench/exact/surface/surfaces.h"

namespace forcelayer::exact {

class VertexClearance {
 public:
  // `scene` in the world, `part` about its centroid. The path outlives this.
  VertexClearance(const clearance::CenterPath& path, const Surface& scene, const Surface& part);
  ~VertexClearance();

  // The least distance, m, of a place of the part (about its centroid) from the surface of the
  // scene, over the whole path, or `reach_m` where that is less. It is too small by at most
  // `within_m`, and by rounding alone where the path does not turn, and never too large but for
  // rounding. 0 for a place that lies inside of a solid of
  // the scene. Throws Stopped (watch.h).
  double of_part_m(const glm::dvec3& place_m, double reach_m, double within_m);

  // The same of a place of the scene (world) from the part.
  double of_scene_m(const glm::dvec3& place_m, double reach_m, double within_m);

  // Whether the path does not turn: no answer is then too small, but for rounding.
  bool is_exact() const { return !stops_.empty(); }

 private:
  struct Side;  // the surface that a place comes near to
  // A part of the path. It is cut in two where one place needs it, and stays cut for all.
  struct Span {
    clearance::Moment from, to;
    double travel_m = 0, deviation_m = 0;  // as of CenterPath
    std::size_t halves = 0;  // the number of the first half, before the second; 0: none
  };
  // A pose as a matrix.
  struct Placing {
    explicit Placing(const Pose& pose);
    glm::dmat3 turned;
    glm::dvec3 position_m;
  };

  Span span_of(const clearance::Moment& from, const clearance::Moment& to) const;
  std::size_t halves_of(std::size_t span);
  template <typename Placed>
  double least_m(const Side& other, const Placed& placed, double reach_m, double within_m);
  template <typename Placed>
  double least_bounded_m(const Side& other, const Placed& placed, double reach_m, double within_m);
  template <typename Placed>
  double least_straight_m(const Side& other, const Placed& placed, double reach_m) const;

  const clearance::CenterPath& path_;
  std::unique_ptr<Side> scene_, part_;
  std::vector<Span> spans_;       // the first is the whole path
  std::vector<Placing> middles_;  // [spans] where its halves meet, where it has any
  Placing begin_, end_;
  std::vector<Placing> stops_;  // all poses of a path that does not turn; else empty
};

}  // namespace forcelayer::exact
