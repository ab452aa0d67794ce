#include "runtime/voxrun/motion_watch.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace forcelayer::voxrun {
namespace {

double angle_between(const Pose& a, const Pose& b) {
  return 2 * std::acos(std::min(1.0, std::abs(glm::dot(a.orientation, b.orientation))));
}

}  // namespace

void MotionWatch::see(const Frame& frame) noexcept {
  if (frame.input.valid != kInputValid || frame.result.report.faults != 0) return;
  if (!(glm::length(frame.result.wrench.force_n) > kNoForceN ||
        frame.result.report.touched[0].force_n > 0)) {
    return;
  }
  const Pose& part = frame.result.report.world_from_center;
  const Pose& pulled_to = frame.world_from_target;
  const double stretch_m = glm::length(part.position_m - pulled_to.position_m);
  if (stretch_m <= kNoPullM * motion_scale_ && angle_between(part, pulled_to) <= kNoPullRad) {
    return;
  }
  const Pose wanted =
      script_.pose(frame.time_s) * inverse(frame.input.world_from_handle) * pulled_to;
  const double off_m = glm::length(part.position_m - wanted.position_m);
  const double off_rad = angle_between(part, wanted);
  if (off_m < followed_.off_m || (off_m == followed_.off_m && off_rad <= followed_.off_rad)) return;
  followed_ = {off_m, off_rad, frame.time_s, loop::touched_in(frame)};
}

}  // namespace forcelayer::voxrun
