// The question: which part leaves which scene, from where, and with which clearance.
#pragma once

#include <functional>
#include <glm/geometric.hpp>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/path/path_file.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/clearance/front.h"
#include "workbench/exact/seat_meshes.h"

namespace forcelayer::voxplan {

// Poses of the centroid frame; between two of them the part goes straight.
using Way = std::vector<Pose>;

// Scene and part outlive this.
struct Problem {
  const Voxmap& scene;
  const Pshell& part;
  double clearance_m = 0;      // between the exact surfaces
  Pose world_from_start;       // of the part's centroid frame: its seat, where it touches something
  clearance::LeftOut allowed;  // objects that may be near
  // Where meshes are given: they tell where the part may be in its seat, and not its shell points.
  const exact::SeatMeshes* seat_meshes = nullptr;
};

// The part's centroid frame in the part's.
inline Pose part_from_center(const Pshell& part) {
  const auto& c = part.header().center_m;
  return {{c[0], c[1], c[2]}, {1, 0, 0, 0}};
}

// How far a point of the part travels at most from one pose to another, m: the length of a motion.
double travel_between_m(const Problem& problem, const Pose& from, const Pose& to);

// The pose at a fraction of the motion between two: the centroid goes straight and the orientation
// turns the short way round, both evenly.
Pose pose_between(const Pose& from, const Pose& to, double fraction);

// The same pose as a row of a path.
PathRow row_of(double time_s, const Pose& pose);

// Poses along a way, no two farther apart than `step_m`, its own among them.
std::vector<Pose> with_more_poses(const Problem& problem, const std::vector<Pose>& way,
                                  double step_m);

// The way up to the first pose, looked for every voxel of travel, for which `ends` says so.
std::vector<Pose> up_to_first(const std::vector<Pose>& way, const Problem& problem,
                              const std::function<bool(const Pose&)>& ends);

}  // namespace forcelayer::voxplan
