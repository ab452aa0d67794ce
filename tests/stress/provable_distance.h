// The most that the stored distances of a scene and the terms of a shell prove, slowly and in
// double precision, from the two files alone. No claim may be above it.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"

namespace forcelayer::stress {

class ProvableDistance {
 public:
  // Both must outlive this. The map stores distances.
  ProvableDistance(const Voxmap& voxmap, const Pshell& shell);

  // The part's surface at a pose: from the least of_place_m() of all shell points. Deviations of
  // the meshes are taken off; rounding is not. m.
  double of_part_m(const Pose& world_from_part) const;

  // Whether a shell point lies between centers of which one is beyond a cropped side: nothing is
  // known of it.
  bool touches_cropped_side(const Pose& world_from_part) const;

  // By the eight voxel centers around a place: voxmap_format.md, section 7.
  double by_cell_m(const glm::dvec3& world_m) const;
  // The scene lies outside of the balls that the codes state around their centers: the distance
  // from a place to the nearest place that none of 343 balls around it holds, to a hundredth of a
  // voxel and at most three voxels. No code proves more.
  double of_place_m(const glm::dvec3& world_m) const;

 private:
  double code_m(const glm::dvec3& voxel) const;
  bool is_cropped(const glm::dvec3& voxel) const;
  std::vector<glm::dvec3> places_at(const Pose& world_from_part) const;

  const Voxmap& voxmap_;
  const Pshell& shell_;
};

}  // namespace forcelayer::stress
