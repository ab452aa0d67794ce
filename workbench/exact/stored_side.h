// On which side of the scene's solids a part lies whose surface meets none: by the sides that the
// baked scene stores, as far away from surfaces as is known.
#pragma once

#include <functional>

#include "forcelayer/pose.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"

namespace forcelayer::exact {

class StoredSide {
 public:
  // Both outlive this; the scene stores distances.
  StoredSide(const Voxmap& voxmap, const Pshell& shell) : voxmap_(voxmap), shell_(shell) {}

  // Whether a shell point lies inside of a solid, that `counts` is true of, where the surfaces of
  // part and scene are `distance_m` apart, give or take `margin_m`. The point's signed distance is
  // then that at least, or minus that at most: which of the two, its voxel tells. No where it does
  // not.
  bool is_inside(const Pose& world_from_center, double distance_m, double margin_m,
                 const std::function<bool(const glm::dvec3& place_m)>& counts) const;

 private:
  const Voxmap& voxmap_;
  const Pshell& shell_;
};

}  // namespace forcelayer::exact
