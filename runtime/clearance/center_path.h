// A part's path as the poses of its centroid frame, and how far its points travel along it. Between
// two poses the centroid goes straight and the orientation turns the short way round, both evenly.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/path/path_file.h"
#include "formats/pshell.h"

namespace forcelayer::clearance {

// A moment of a path: the pose `pose`, or a fraction of the way from it to the next, in [0, 1).
struct Moment {
  std::size_t pose = 0;
  double fraction = 0;
};

class CenterPath {
 public:
  // `rows`: world_from_part, at least one. `center_m`: the centroid in the part's frame; no point
  // that matters is farther from it than `radius_m`.
  CenterPath(std::span<const PathRow> rows, const glm::dvec3& center_m, double radius_m);
  CenterPath(std::span<const PathRow> rows, const Pshell& shell);

  std::size_t poses() const { return time_s_.size(); }
  double time_s(const Moment& moment) const;
  Moment at(double time_s) const;  // the first or the last where the path has no such time
  Pose world_from_center(const Moment& moment) const;

  // A bound on how far any point of the part has travelled since the first pose, along its arc, m.
  double travel_m(const Moment& moment) const;

  // A bound on the rounding of the centroid's place at a moment, and of the travel from one moment
  // to another, m: it grows with the length of the path and with its distance from the origin.
  double rounding_m() const;

  // A bound on how far any point of the part travels from one pose to another, m.
  double travel_between_m(const Pose& from, const Pose& to) const;

  // The first pose from `first` to `last` whose travel_m() is more than `travel_m`; `last` where
  // there is none.
  std::size_t pose_beyond(double travel_m, std::size_t first, std::size_t last) const;

  // The middle of the travel between two moments: a pose where there is one between them, else a
  // fraction of the motion.
  Moment middle(const Moment& from, const Moment& to) const;

  // The poses strictly between two moments: from `first` to before `beyond`.
  struct Between {
    std::size_t first, beyond;
    std::size_t count() const { return beyond > first ? beyond - first : 0; }
  };
  static Between between(const Moment& a, const Moment& b) {
    return {a.pose + 1, b.fraction > 0 ? b.pose + 1 : b.pose};
  }

  // How far any point deviates at most, m, from the straight way between where it is at two
  // moments, as long as the part goes from one to the other. Takes time with each pose between.
  double deviation_m(const Moment& a, const Moment& b) const;

 private:
  double arc_deviation_m(double turn_rad) const;

  double radius_m_;        // of the part about the centroid
  double farthest_m_ = 0;  // of the part's origin from the world's, and the centroid's arm
  std::vector<double> time_s_, travel_m_;
  std::vector<double> turn_rad_;  // from each pose to the next
  std::vector<Pose> world_from_center_;
};

// A row's pose.
Pose pose_of(const PathRow& row);

}  // namespace forcelayer::clearance
