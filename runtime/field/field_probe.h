// The default model's view of a baked scene: the contact query, the force field, and directions
// averaged over neighboring contacts, in one look-up.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/bricks/unpacked_distances.h"
#include "runtime/field/contact_set.h"
#include "runtime/field/force_field.h"
#include "runtime/field/seat.h"
#include "runtime/query/contact_query.h"
#include "runtime/query/shell_neighbors.h"

namespace forcelayer::field {

class FieldProbe final : public ContactProbe {
 public:
  // All must outlive the probe; `points` and `samples` have room for every shell point. The guard
  // bars points from where their proven distance is below guard_distance_m(), beside the interior.
  // In a map with a standoff the proven distance alone tells: the interior is where a point is
  // barred, and other points of value 1 count as points of the force layer.
  FieldProbe(query::ContactQuery& query, const ForceField& field, query::CollectedPoints& points,
             FieldSamples& samples);

  void look_up(const Pose& world_from_center, ContactSet& out) noexcept override;
  void open_seat(bool open) noexcept override { seat_open_ = open && !seat_.empty(); }

  // A sheet, or a plate of less than some two voxels, has no inside that would tell who has gone
  // through: it is told by the way. A point has where it moved against the direction in which its
  // side lay, to where the distance rises again, and no negative distance is near. It is to be
  // pushed back to the side it came from.
  void bar_crossings(const ContactSet& earlier, const glm::vec3& way_m,
                     ContactSet& later) const noexcept override;

  // Finds the seat of a part that starts at `world_from_center`: the objects that a shell point
  // touches there, that is, in whose force layer or nearer it lies. None is no error. Not for the
  // servo's thread. Errors, kUsage: the part penetrates the scene and no seat can be told, because
  // the scene stores no distances, the part lies deeper than they tell, or a sheet of the part lies
  // in a sheet of the scene.
  Status find_seat(const Pose& world_from_center);
  const Seat& seat() const { return seat_; }

  // Whether look_up() bars a point there that is nearest to an object of the open seat, those left
  // out apart: a table by number, of objects that do not count. In a fraction of its time.
  bool is_pushed_into_seat(const Pose& world_from_center,
                           std::span<const std::uint8_t> left_out) noexcept;

  // Whether a part with that seat may start elsewhere, at `world_from_center`. Not for the servo's
  // thread. Errors, kUsage: the guard bars a point there.
  Status check_clear(const Pose& world_from_center);

  // 0 where the map names none, and where it did not measure the distance: a number is a hint
  // there.
  std::uint32_t object_near(const glm::dvec3& world_m) const noexcept override;

  // The object nearest to the i-th point of the last look_up(); 0 where the map names none.
  std::uint32_t object_of(std::uint32_t i) const noexcept;

  // The second half of look_up(): depth and direction of the points that the query collected.
  void read(ContactSet& out) noexcept;

 private:
  bool is_two_sided(std::uint32_t i) const noexcept;
  void forget_sides() noexcept;
  void bar(ContactSet& out) const noexcept;
  bool touches_in_corner(std::uint32_t i) const noexcept;
  bool is_in_corner(std::uint32_t i) const noexcept;
  bool lies_in_corners() const noexcept;
  void apply_seat(ContactSet& out) const noexcept;
  // An edge of the scene between two neighboring points (between_points.cpp).
  struct Between;
  std::optional<Between> between(std::uint32_t a, std::uint32_t b) const noexcept;
  struct BetweenSink;
  void look_between(BetweenSink& sink) noexcept;
  bool is_pushed_between(std::span<const std::uint8_t> left_out) noexcept;
  void press_between(std::uint32_t a, std::uint32_t b, const Between& found,
                     ContactSet& out) const noexcept;
  void find_between(Seat& seat);
  void apply_between(ContactSet& out) noexcept;
  glm::vec3 arm_m(std::uint32_t i) const noexcept {
    return {points_.rx[i], points_.ry[i], points_.rz[i]};
  }
  glm::vec3 normal(std::uint32_t i) const noexcept {
    return {points_.nx[i], points_.ny[i], points_.nz[i]};
  }
  glm::vec3 slope(std::uint32_t i) const noexcept {
    return {samples_.gx[i], samples_.gy[i], samples_.gz[i]};
  }
  float stored_distance_m(std::uint32_t i) const noexcept;
  bool lies_beside_solid(std::uint32_t i) const noexcept;
  Status check_depth(const SeatObject& object) const;
  Status check_side(std::uint32_t i) const;
  std::string name_of(std::uint32_t object) const;

  query::ContactQuery& query_;
  const ForceField& field_;
  query::CollectedPoints& points_;
  FieldSamples& samples_;
  mutable std::optional<UnpackedDistances> unpacked_;  // no answer depends on what is there
  std::vector<float> weight_;                          // Contact::weight of every shell point
  float guard_m_, free_m_;                             // 0 where nothing is proven
  float zero_force_m_;  // the zero-force surface, from the static mesh
  Seat seat_;
  std::vector<float> in_seat_m_;  // of every shell point: its distance there where it touches, or 0
  // Which points are neighbors; made with the first seat. Per shell point its place among the
  // collected points, where it is of tilted_.
  std::optional<query::ShellNeighbors> neighbors_;
  float neighbor_m_ = 0;  // so near two of them are
  std::vector<std::uint32_t> place_, tilted_;
  // The slope of the field there, of points that touch in a corner; 1 elsewhere.
  std::vector<float> in_seat_steepness_;
  std::uint32_t corner_points_ = 0;  // their number
  bool seat_open_ = false;
  bool told_by_distance_;  // and not by value 1
};

// A point whose interpolated distance has at least this slope lies in front of one face.
inline constexpr float kFaceSlope = 0.9f;

// The direction in which the static surface faces at a contact: the field's slope, averaged over
// neighbors.
//
// There are two estimates of it. The point's own normal is the part's: where an edge or a tilted
// face touches, it is off by the tilt, and always to the same side. A part pushed along its normals
// would push itself along the surface and give the hand energy without end. The slope of the level
// field is the scene's, but along a plane that is oblique to the grid it is off by ten degrees and
// more, to all sides. That error has a wave-length of about a voxel, so it averages out over the
// collected points around, near contacts included.
//
// Sets the direction of every contact of `set` that is deeper than `least_depth_m`. `samples` are
// the field's measure() of `points`, and contact n of `set` is sample n.
//
// The average runs over 32 samples in the shell's order, which keeps neighbors together: the 16
// before the contact, the contact and the 15 after it; at the ends of the list its first or last
// 32. A slope g_i at the distance r counts with the weight
//     max(0, 1 - r^2 / R^2)^2 max(0, g . g_i)^2,    R = kNeighbourVoxels voxels,
// so that a wall that faces another way does not count. Where the slopes cancel, the field's own
// direction takes over. Vectors of every width give the same bits.
void average_directions(const query::CollectedPoints& points, const FieldSamples& samples,
                        float voxel_size_m, float least_depth_m, ContactSet& set) noexcept;

inline constexpr float kNeighbourVoxels = 5.0f;

}  // namespace forcelayer::field
