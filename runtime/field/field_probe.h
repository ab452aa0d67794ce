// Field and distance at the shell points of a pose: the contact query and the force field in one
// look-up. What may be where is decided by runtime/guard.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "formats/bricks/unpacked_distances.h"
#include "runtime/field/contact_set.h"
#include "runtime/field/force_field.h"
#include "runtime/query/contact_query.h"

namespace forcelayer::field {

// Functions of `i` answer for the i-th point that the last query_pose() collected.
class FieldProbe {
 public:
  // All must outlive the probe; `points` and `samples` have room for every shell point.
  FieldProbe(query::ContactQuery& query, const ForceField& field, query::CollectedPoints& points,
             FieldSamples& samples);

  // Collects the points near the scene with the part at a pose, and measures them.
  void query_pose(const Pose& world_from_center) noexcept;
  // The second half of it: measures the points that the query collected.
  void measure_points() noexcept;
  // Writes the collected points to `out`: counts by value, arms, directions, depths and weights.
  void copy_contacts(ContactSet& out) const noexcept;

  const query::ContactQuery& query() const noexcept { return query_; }
  const Voxmap& voxmap() const noexcept { return query_.voxmap(); }
  const query::CollectedPoints& points() const noexcept { return points_; }
  const FieldSamples& samples() const noexcept { return samples_; }
  bool proves_distances() const noexcept { return field_.proves_distances(); }

  std::uint32_t count() const noexcept { return points_.count; }
  std::uint32_t point(std::uint32_t i) const noexcept { return points_.index[i]; }
  glm::vec3 arm_m(std::uint32_t i) const noexcept {
    return {points_.rx[i], points_.ry[i], points_.rz[i]};
  }
  glm::vec3 normal(std::uint32_t i) const noexcept {
    return {points_.nx[i], points_.ny[i], points_.nz[i]};
  }
  glm::vec3 slope(std::uint32_t i) const noexcept {
    return {samples_.gx[i], samples_.gy[i], samples_.gz[i]};
  }
  glm::vec3 gradient(std::uint32_t i) const noexcept {
    return {samples_.ex[i], samples_.ey[i], samples_.ez[i]};
  }
  float zero_force_m() const noexcept { return zero_force_m_; }
  // A measure, and no bound: the interpolated stored distance from the scene's surface.
  float stored_distance_m(std::uint32_t i) const noexcept {
    return zero_force_m_ + samples_.from_zero_force_m[i];
  }
  // Whether the point is of an open sheet of the part, and has no inside.
  bool is_two_sided(std::uint32_t i) const noexcept {
    const std::uint8_t* const two_sided = query_.shell().view().two_sided;
    return two_sided != nullptr && two_sided[points_.index[i]] != 0;
  }
  // Whether one of the stored distances around the point lies deeper inside a solid than this.
  bool lies_beside_solid(std::uint32_t i, float depth_m) const noexcept;
  // The i-th point's voxel, relative to the map's directory, and its place there, [0, 1).
  glm::ivec3 voxel(std::uint32_t i) const noexcept {
    return {points_.vx[i], points_.vy[i], points_.vz[i]};
  }
  glm::vec3 in_voxel(std::uint32_t i) const noexcept {
    return {points_.fx[i], points_.fy[i], points_.fz[i]};
  }
  // Whether the map has distances from one voxel to another.
  bool has_distances(const glm::ivec3& low, const glm::ivec3& high) const noexcept;
  // The stored distances, in voxels, of the eight centers from a voxel on, z fastest.
  std::array<float, 8> cell_distances(const glm::ivec3& voxel) const noexcept;
  // The object nearest to the point; 0 where the map names none.
  std::uint32_t object_of(std::uint32_t i) const noexcept;

  // The object nearest to a place. 0 where the map names none, and where it did not measure the
  // distance: a number is a hint there.
  std::uint32_t object_near(const glm::dvec3& world_m) const noexcept;

 private:
  void forget_sides() noexcept;

  query::ContactQuery& query_;
  const ForceField& field_;
  query::CollectedPoints& points_;
  FieldSamples& samples_;
  mutable std::optional<UnpackedDistances> unpacked_;  // no answer depends on its content
  std::vector<float> weight_;                          // Contact::weight of every shell point
  float zero_force_m_;  // the zero-force surface, from the static mesh
};

}  // namespace forcelayer::field
