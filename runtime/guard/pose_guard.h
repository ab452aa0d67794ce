// The guard: collects and measures the points of a pose, and marks those that may not be there.
// The default model keeps a pose only where accepts_pose() (point_rule.h) takes it.
#pragma once

#include <cstdint>
#include <span>

#include "runtime/field/field_probe.h"
#include "runtime/guard/point_rule.h"
#include "runtime/guard/seat_rule.h"

namespace forcelayer::guard {

class PoseGuard final : public field::ContactProbe {
 public:
  // All must outlive the guard; `points` and `samples` have room for every shell point.
  PoseGuard(query::ContactQuery& query, const field::ForceField& field,
            query::CollectedPoints& points, field::FieldSamples& samples);

  void query_pose(const Pose& world_from_center, field::ContactSet& out) noexcept override;
  // The second half of it, for points that the query has collected.
  void measure_and_judge(field::ContactSet& out) noexcept;
  void open_seat(bool open) noexcept override { seat_open_ = open && !seat_.seat().empty(); }
  void mark_crossings(const field::ContactSet& earlier, const glm::vec3& shift_m,
                      field::ContactSet& later) const noexcept override;
  std::uint32_t object_near(const glm::dvec3& world_m) const noexcept override {
    return probe_.object_near(world_m);
  }

  // Finds the seat of a part that starts at `world_from_center`: the objects that a shell point
  // touches there, that is, in whose force layer or nearer it lies. None is no error. Not for the
  // servo's thread. Errors, kUsage: the part penetrates the scene and no seat can be found, because
  // the scene stores no distances, the part lies deeper than they reach, or a sheet of the part
  // lies in a sheet of the scene. With the depth of the meshes the part may lie as deep as it does.
  Status find_seat(const Pose& world_from_center, SeatDepth depth = SeatDepth::kStored);
  const Seat& seat() const { return seat_.seat(); }

  // Whether query_pose() bars a point there that is nearest to an object of the open seat. Objects
  // with a mark in `left_out`, a table by number, do not count. In a fraction of its time.
  bool is_pushed_into_seat(const Pose& world_from_center,
                           std::span<const std::uint8_t> left_out) noexcept;

  // Whether a part with that seat may start elsewhere, at `world_from_center`. Not for the servo's
  // thread. Errors, kUsage: the guard bars a point there.
  Status check_clear(const Pose& world_from_center);

  // The object nearest to the i-th point of the last query_pose(); 0 where the map names none.
  std::uint32_t object_of(std::uint32_t i) const noexcept { return probe_.object_of(i); }

 private:
  void judge_points(field::ContactSet& out) noexcept;

  field::FieldProbe probe_;
  PointRule rule_;
  SeatRule seat_;
  bool seat_open_ = false;
};

}  // namespace forcelayer::guard
