// The rule of the seat: how near an installed part may come to the objects that it touches, while
// its seat is open. Elsewhere the rule is that of point_rule.h.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/result.h"
#include "runtime/field/field_probe.h"
#include "runtime/guard/between_points.h"
#include "runtime/guard/flush_walls.h"
#include "runtime/guard/point_rule.h"
#include "runtime/guard/seat.h"
#include "runtime/guard/seat_kernel.h"

namespace forcelayer::guard {

class SeatRule {
 public:
  // Both must outlive this.
  SeatRule(field::FieldProbe& probe, const PointRule& rule);

  // As PoseGuard::find_seat(): set-up only. In find_seat.cpp.
  Status find(const Pose& world_from_center, SeatDepth depth = SeatDepth::kStored);
  const Seat& seat() const { return seat_; }
  std::string name_of(std::uint32_t object) const;

  // Points near an object of the seat follow its rule: force and guard where the part touches the
  // object, or as deep as it lies there, in place of the force layer and the guard before it.
  // `out` has the points that the probe queried last.
  void apply(field::ContactSet& out) noexcept;

  // Bars the points of the seat that have gone through a surface between two poses.
  //
  // A sheet has no inside that would show who has gone through, and a plate of less than some two
  // voxels hardly one: the motion does. Where such a wall is flush (FlushWalls), a point has gone
  // through if it was before the wall's middle, on the side on which its inward normal has the
  // part, and is behind it. The normal may be 80 degrees aside of the wall's; a point without an
  // inside is held before the middle. Elsewhere a point has gone through where it moved against the
  // direction in which its side lay, to where the distance rises again, and no solid is near that
  // is thicker than such a plate. It is to be pushed back to the side it came from.
  void mark_crossings(const field::ContactSet& earlier, const glm::vec3& shift_m,
                      field::ContactSet& later) const noexcept;

  // Whether apply() bars a point of the last query, objects with a mark in `left_out` apart.
  bool bars_any(std::span<const std::uint8_t> left_out) noexcept;

 private:
  float half_sheet_m() const noexcept;
  bool may_face_wall(std::uint32_t i) const noexcept;
  struct WallCrossing {
    bool crossed;
    float deeper_m;  // beyond the middle than a point may be
    glm::vec3 side;  // unit, to where it is to be pushed
  };
  std::optional<WallCrossing> flush_crossing(std::uint32_t i,
                                             const glm::vec3& moved_m) const noexcept;
  bool touches_in_corner(std::uint32_t i) const noexcept;
  bool is_in_corner(std::uint32_t i) const noexcept;
  bool lies_in_corners() const noexcept;
  Status check_depth(const SeatObject& object) const;
  Status check_side(std::uint32_t i) const;

  field::FieldProbe& probe_;
  const PointRule& rule_;
  BetweenPoints between_;
  FlushWalls walls_;
  Seat seat_;
  SeatTables tables_;  // of seat_
  NearestObjects nearest_;
  mutable std::vector<PointPair> turned_;  // room for mark_crossings()
  std::vector<float> in_seat_m_;  // of every shell point: its distance there where it touches, or 0
  // The slope of the field there, of points that touch in a corner; 1 elsewhere.
  std::vector<float> in_seat_steepness_;
  std::uint32_t corner_points_ = 0;  // their number
  float corner_m_;                   // points nearer than this to the scene touch it
};

}  // namespace forcelayer::guard
