// Static scenes with a closed formula for their distance, and their voxmaps by definition: the
// independent side of wrench_bench. Nothing of voxelize is used here.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "tests/support/voxel_kind.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::bench {

enum class StaticKind { kPlane, kSphere, kBore, kWedge };

// A static body in its local frame, placed in the world.
//   plane: solid z < 0.   sphere: about the origin.   bore: the space around the cylinder about z.
//   wedge: free for directions within free_angle / 2 of +z in the xz plane, for every y; above pi
//   it is a convex edge.
struct AnalyticStatic {
  StaticKind kind = StaticKind::kPlane;
  double radius_m = 0;
  double free_angle = 0;   // rad
  glm::dmat3 rotation{1};  // world_from_local
  glm::dvec3 origin_m{0};
  glm::dvec2 wall_shift_m{0};  // of a wedge's walls (x > 0, x < 0): added to their distances

  // Signed distance, positive outside, and its gradient. Exact in free space.
  double distance_m(const glm::dvec3& x, glm::dvec3* gradient = nullptr) const;

  // Whether the surface has a point in the closed cube of half edge `half_m` about `center`.
  bool meets_cube(const glm::dvec3& center, double half_m) const;

  // Outward normal of a wedge's wall, world: 0 for x > 0, 1 for x < 0.
  glm::dvec3 wall_normal(int wall) const;
};

// Sum of the absolute components.
inline double norm1(const glm::dvec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

using test::VoxelKind;

// How far in front of a surface with unit normal n the force begins, in voxels: on average over the
// surface's place on the lattice, or everywhere (distances).
double zero_force_voxels(VoxelKind kind, int layers, const glm::dvec3& n);

// The voxmap over the world box [low, high] in one of the kinds, by its definition.
test::VoxelScene bake(VoxelKind kind, const AnalyticStatic& body, double voxel_size_m, int layers,
                      const glm::dvec3& low, const glm::dvec3& high);

// The voxmap's values over the world box [low, high], by the definition of the bake: geometric
// surface where meets_cube(), interior elsewhere inside, then k Chebyshev layers.
test::VoxelScene bake(const AnalyticStatic& body, double voxel_size_m, int layers,
                      const glm::dvec3& low, const glm::dvec3& high);

// The exact distance at the voxel centers of a scene, as floats.
struct DenseFields {
  const test::VoxelScene& scene;
  std::vector<float> distance_m;

  DenseFields(const AnalyticStatic& body, const test::VoxelScene& values);
  float distance_at(const glm::ivec3& voxel) const;

 private:
  std::size_t index(glm::ivec3 voxel) const;  // clamped into the box
};

}  // namespace forcelayer::bench
