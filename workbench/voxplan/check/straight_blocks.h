// The objects in the way of a part that goes straight, by the meshes: seen at some poses, where a
// proof that there are none takes long. What is thinner than a step may be missed. A depth in a
// seat takes a hundred times as long as a distance: once something is seen in the way, objects of
// the seat are looked at in fewer poses.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <vector>

#include "workbench/exact/mesh_distance.h"
#include "workbench/voxplan/check/problem.h"

namespace forcelayer::voxplan {

struct StraightBlock {
  // So far from its start the part is nearer to an object than the clearance, or deeper in one of
  // its seat than allowed. Infinite where this was seen nowhere.
  double at_m = std::numeric_limits<double>::infinity();
  std::vector<std::uint32_t> objects;  // that are in the way, in the order in which it meets them
};

class StraightBlocks {
 public:
  // All outlive this. `scene` in the world, `part` about its centroid. Objects of
  // Problem::seat_meshes are in the way where the part is deeper in them than allowed.
  StraightBlocks(const Problem& problem, const exact::Surface& scene, const exact::Surface& part);

  // On the way from the start to `end`, a pose of the centroid frame with the same orientation.
  StraightBlock along(const Pose& end);

 private:
  double first_m(std::uint32_t object, const Pose& end);
  double about_first_m(std::uint32_t object, const Pose& end);
  double first_between_m(std::uint32_t object, const Pose& end, double free, double blocked);
  bool is_of_seat(std::uint32_t object) const {
    return problem_.seat_meshes != nullptr && problem_.seat_meshes->has(object);
  }
  double leeway_m(std::uint32_t object, const Pose& world_from_center);
  bool may_meet(std::uint32_t object, const Pose& end) const;

  struct Box {
    glm::dvec3 low_m, high_m;
  };

  const Problem& problem_;
  const exact::Surface& scene_;
  double near_m_;  // a measured distance below it is certainly less than the clearance
  Box part_box_;   // where the part starts
  std::map<std::uint32_t, Box> objects_;  // that count, with the boxes of their triangles
  std::shared_ptr<const exact::MeshPair::Mesh> part_mesh_;
  std::map<std::uint32_t, exact::MeshPair> pairs_;  // of those that were asked about
};

}  // namespace forcelayer::voxplan
