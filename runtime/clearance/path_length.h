// Positions along a path, in the way that people measure a motion: by how far the part's fastest
// point has travelled.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "formats/path/path_file.h"
#include "formats/pshell.h"
#include "runtime/clearance/center_path.h"

namespace forcelayer::clearance {

class PathLength {
 public:
  // The fastest shell point of each moment counts: of a turn about an axis, the one farthest from
  // it. It is sought among the points that lie farthest out in 200 directions: on a long round
  // part, another may be faster by 1%.
  PathLength(const CenterPath& path, const Pshell& part);

  // m since the first pose.
  double at_m(const Moment& moment) const;
  double whole_m() const { return at_pose_m_.back(); }

 private:
  std::vector<double> at_pose_m_;
};

}  // namespace forcelayer::clearance
