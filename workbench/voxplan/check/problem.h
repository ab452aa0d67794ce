// The problem: which part leaves which scene, from which pose, and with which clearance.
#pragma once

#include <functional>
#include <glm/geometric.hpp>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/path/path_file.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/clearance/front.h"
#include "runtime/clearance/path_check.h"
#include "workbench/exact/seat_meshes.h"

namespace forcelayer::voxplan {

// Poses of the centroid frame. Between two of them the part moves straight.
using PosePath = std::vector<Pose>;

// Scene and part outlive this.
struct Problem {
  const Voxmap& scene;
  const Pshell& part;
  double clearance_m = 0;      // between the exact surfaces
  Pose world_from_start;       // of the part's centroid frame: its seat, where it touches something
  clearance::LeftOut allowed;  // objects that may be near
  // If meshes are given, they decide where the part may be in its seat, not its shell points.
  const exact::SeatMeshes* seat_meshes = nullptr;
  clearance::SeatDepth seat_depth = clearance::SeatDepth::kStored;
};

// The part's centroid frame in the part's.
inline Pose part_from_center(const Pshell& part) {
  const auto& c = part.header().center_m;
  return {{c[0], c[1], c[2]}, {1, 0, 0, 0}};
}

// The largest distance in m that a point of the part travels from one pose to another: the length
// of a motion.
double travel_between_m(const Problem& problem, const Pose& from, const Pose& to);

// The pose at a fraction of the motion between two poses. The centroid moves straight and the
// orientation turns through the smaller angle, both at constant speed.
Pose pose_between(const Pose& from, const Pose& to, double fraction);

// The same pose as a row of a path.
PathRow row_of(double time_s, const Pose& pose);

// All poses of a path, with more between them so that no two are farther apart than `step_m`.
std::vector<Pose> with_more_poses(const Problem& problem, const std::vector<Pose>& path,
                                  double step_m);

// The path up to the first pose for which `ends` is true. Tests a pose in every voxel of travel.
std::vector<Pose> up_to_first(const std::vector<Pose>& path, const Problem& problem,
                              const std::function<bool(const Pose&)>& ends);

}  // namespace forcelayer::voxplan
