// The distance between two meshes: FCL's trees of boxes find the nearest triangles, and
// triangle_distance.h measures them. It knows neither voxels nor points.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <memory>

#include "forcelayer/pose.h"
#include "workbench/exact/surfaces.h"

namespace forcelayer::exact {

// How far a measured distance may be off, as a fraction of the largest coordinate: most files store
// coordinates as 32-bit floats. The measurement itself is in double precision, far below it.
inline constexpr double kRounding = 0x1p-24;

struct MeshDistance {
  double distance_m = voxcheck::kNothingM;  // 0 where the surfaces meet
  std::size_t scene_triangle = 0;
  glm::dvec3 part_m{0}, scene_m{0};  // the nearest points, world; where they meet, one of both
};

class MeshPair {
 public:
  // `scene` in the world, `part` about its centroid.
  MeshPair(const Surface& scene, const Surface& part);
  ~MeshPair();
  MeshPair(MeshPair&&) noexcept;

  // `hint_m`: what the distance is expected to be no more than, so that the search is short.
  MeshDistance at(const Pose& world_from_center, double hint_m) const;

 private:
  struct Models;
  std::unique_ptr<Models> models_;
};

}  // namespace forcelayer::exact
