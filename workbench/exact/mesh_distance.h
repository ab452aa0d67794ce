// The distance between two meshes at a pose, and whether they stay apart while one of them moves:
// trees of boxes find the triangles, and triangle_distance.h measures them. It knows neither voxels
// nor points.
//
// A triangle of the part that moves stays in the hull of its corners at both ends of the motion,
// but for the bend of their ways. Where a direction parts each hull from each triangle of the scene
// by more than a distance, the meshes are nowhere nearer in between. A face that slides along
// another is settled for a long way at once, because the direction is that of their normals: the
// bounds by how far points travel (exact_walk.h) know nothing of where to.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>

#include "forcelayer/pose.h"
#include "workbench/exact/surface/surfaces.h"

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
  // A surface with the tree of its triangles, which several pairs may share.
  struct Mesh;
  // None for a surface without triangles.
  static std::shared_ptr<const Mesh> mesh_of(const Surface& surface);

  // `scene` in the world, `part` about its centroid.
  MeshPair(const Surface& scene, const Surface& part);
  MeshPair(std::shared_ptr<const Mesh> scene, std::shared_ptr<const Mesh> part);
  ~MeshPair();
  MeshPair(MeshPair&&) noexcept;

  // `hint_m`: what the distance is expected to be no more than, so that the search is short.
  MeshDistance at(const Pose& world_from_center, double hint_m) const;

  // The same where the distance is less than `beyond_m`; none where it is not.
  std::optional<MeshDistance> nearer_than(const Pose& world_from_center, double beyond_m) const;

  // Whether the two are found to stay `min_m` apart or more while the part goes from one pose of
  // its centroid frame to another, and none of its places leaves its straight way by more than
  // `bend_m`. No says nothing.
  bool stays_apart(const Pose& from, const Pose& to, double bend_m, double min_m) const;

 private:
  struct Nearest;
  Nearest nearest(const Pose& world_from_center, double beyond_m) const;

  std::shared_ptr<const Mesh> scene_, part_;  // none where one of both is empty
};

}  // namespace forcelayer::exact
