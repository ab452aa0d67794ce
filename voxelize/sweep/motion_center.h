// The point of a part that moves in a straight line between two rows of a path.
#pragma once

#include <span>

#include "formats/mesh/mesh.h"

namespace forcelayer::sweep {

struct MotionCenter {
  mesh::Vec3d at_m{};
  // The center that pointshell computes of the same part is at most this far from `at_m`. 0 where
  // both surely are the same point.
  double uncertainty_m = 0;
};

// The center for voxcheck is the one that pointshell computes. pointshell sends out rays to turn
// the faces outward, and then takes the centroid of the volume, or of the area where no volume is
// bounded. The same center comes without rays where each object consists of closed surfaces of one
// orientation, and where the part is one object of open surfaces only. For any other part `at_m` is
// the middle of its box, which contains both centroids. `parts`: the objects of the part, in
// meters, in the part's frame.
MotionCenter motion_center(std::span<const mesh::Mesh> parts);

}  // namespace forcelayer::sweep
