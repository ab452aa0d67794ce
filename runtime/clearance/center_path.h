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

// A moment of a path: the pose `pose`, or a share of the way from it to the next, in [0, 1).
struct Moment {
  std::size_t pose = 0;
  double share = 0;
};

class CenterPath {
 public:
  // `rows`: world_from_part, at least one.
  CenterPath(std::span<const PathRow> rows, const Pshell& shell);

  std::size_t poses() const { return time_s_.size(); }
  double time_s(const Moment& moment) const;
  Pose world_from_center(const Moment& moment) const;

  // What no point of the shell has travelled more than since the first pose, along its arcs, m.
  double travel_m(const Moment& moment) const;

  // The first pose, of those from `first` to `last`, before which no point has travelled more than
  // `travel_m`; `last` where there is none.
  std::size_t pose_beyond(double travel_m, std::size_t first, std::size_t last) const;

  // How far a point of the shell deviates from the straight way between two moments of one motion
  // at most, m: at a radius r that turns by a, at equal shares of both ways, r a^2 / 8.
  double arc_deviation_m(std::size_t pose, double shares) const;

 private:
  double radius_m_;  // of the shell about the centroid
  std::vector<double> time_s_, travel_m_;
  std::vector<double> turn_rad_;  // from each pose to the next
  std::vector<Pose> world_from_center_;
};

// A row's pose.
Pose pose_of(const PathRow& row);

}  // namespace forcelayer::clearance
