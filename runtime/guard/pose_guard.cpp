#include "runtime/guard/pose_guard.h"

namespace forcelayer::guard {

PoseGuard::PoseGuard(query::ContactQuery& query, const field::ForceField& field,
                     query::CollectedPoints& points, field::FieldSamples& samples)
    : probe_(query, field, points, samples),
      rule_(query.voxmap().header(), field.proves_distances()),
      seat_(probe_, rule_) {}

void PoseGuard::query_pose(const Pose& world_from_center, field::ContactSet& out) noexcept {
  probe_.query_pose(world_from_center);
  judge_points(out);
}

void PoseGuard::judge_points(field::ContactSet& out) noexcept {
  probe_.copy_contacts(out);
  rule_.mark_points(probe_.samples().distance_m.data(), out);
  out.seat_open = seat_open_;
  out.seated = 0;
  if (seat_open_) seat_.apply(out);
}

void PoseGuard::measure_and_judge(field::ContactSet& out) noexcept {
  probe_.measure_points();
  judge_points(out);
}

void PoseGuard::mark_crossings(const field::ContactSet& earlier, const glm::vec3& shift_m,
                               field::ContactSet& later) const noexcept {
  seat_.mark_crossings(earlier, shift_m, later);
}

Status PoseGuard::find_seat(const Pose& world_from_center, SeatDepth depth) {
  seat_open_ = false;
  return seat_.find(world_from_center, depth);
}

bool PoseGuard::is_pushed_into_seat(const Pose& world_from_center,
                                    std::span<const std::uint8_t> left_out) noexcept {
  if (!seat_open_) return false;
  probe_.query_pose(world_from_center);
  return seat_.bars_any(left_out);
}

Status PoseGuard::check_clear(const Pose& world_from_center) {
  field::ContactSet there;
  there.reserve(probe_.query().shell().view().point_count);
  const bool open = seat_open_;
  open_seat(true);
  query_pose(world_from_center, there);
  seat_open_ = open;
  for (std::uint32_t i = 0; i < there.count; ++i) {
    if (there.is_barred[i] == 0) continue;
    const std::string object = seat_.name_of(object_of(i));
    return Error{
        ErrorCode::kUsage, "", "start",
        "outside its seat, the part is inside " + object + " or nearer to " + object +
            " than the guard allows",
        "start clear of the scene (--start), or leave out --seat: the start is then the seat"};
  }
  return {};
}

}  // namespace forcelayer::guard
