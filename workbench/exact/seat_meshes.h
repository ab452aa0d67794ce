// Where a part may be in its seat, by the meshes: the short question of a search, pose by pose. It
// allows what the check of a whole path allows (ExactCheck), and leaves to that what may happen
// between two poses.
#pragma once

#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "forcelayer/pose.h"
#include "workbench/exact/body.h"
#include "workbench/exact/seat_walk.h"
#include "workbench/exact/surface/surfaces.h"

namespace forcelayer::exact {

// How closely a depth in a seat is found, as a fraction of seat_margin_m().
inline constexpr double kSeatWithin = 1.0 / 8;

// How much deeper than installed the part may go: by what deviations and rounding (`margin_m`) and
// cracks leave open.
double seat_margin_m(const Bodies& part, const Bodies& object, double margin_m);

// Adds the directions in which a part with these triangles may go straight: the normals of its
// largest flat sides, and where two of them meet. Unit vectors in the world, without sign; those
// that are there already are not added again.
void add_straight_axes(const Surface& surface, const glm::dquat& world_from_surface,
                       std::vector<glm::dvec3>& axes);

class SeatMeshes {
 public:
  // `objects` of the scene, by number, are the part's seat at `installed`, a pose of its centroid
  // frame. There it may go deeper by `depth_m`. `part` is about its centroid.
  SeatMeshes(const Surface& scene, const Surface& part, std::span<const std::uint32_t> objects,
             const Pose& installed, double depth_m);
  ~SeatMeshes();

  // How far each point of the part may travel from a pose until the part may be deeper in an object
  // than it may; 0 where it touches one. Negative: it is deeper, or not proven to be no deeper. For
  // many threads at a time.
  double leeway_m(const Pose& world_from_center) const;
  // The same of one object of the seat.
  double leeway_m(std::uint32_t object, const Pose& world_from_center) const;
  bool has(std::uint32_t object) const { return find(object) != nullptr; }

  // The object that it is deepest in beyond what is allowed there; none where it may be there.
  std::optional<std::uint32_t> blocked_by(const Pose& world_from_center) const;

  // Objects that the meshes never settle: they and the part have no inside, and meet where the part
  // is installed.
  const std::vector<std::uint32_t>& never_settled() const { return never_settled_; }

  // Objects that it overlaps for certain where it is installed, and by how much at least, m.
  const std::vector<std::pair<std::uint32_t, double>>& overlaps() const { return overlaps_; }

  // Directions in which a part may go straight, by its facets and those of its seat: along the
  // normals of the largest, and along where two of them meet. In the world, at the installed pose.
  const std::vector<glm::dvec3>& directions() const { return directions_; }

 private:
  struct Object;
  const Object* find(std::uint32_t number) const;
  double beyond_m(const Object& object, const Pose& world_from_center, bool closely) const;

  clearance::CenterPath path_;  // of one pose: a SeatWalk has one
  Bodies part_;
  std::vector<std::unique_ptr<Object>> objects_;
  std::vector<std::uint32_t> never_settled_;
  std::vector<std::pair<std::uint32_t, double>> overlaps_;
  std::vector<glm::dvec3> directions_;
};

}  // namespace forcelayer::exact
