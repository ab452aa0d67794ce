#include "runtime/devices/motion_script.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "formats/path/path_file.h"
#include "runtime/coupling/coupling.h"

namespace forcelayer::devices {

MotionScript::MotionScript(std::vector<Row> rows) : rows_(std::move(rows)) {}

MotionScript MotionScript::still(const Pose& world_from_handle) {
  return MotionScript({{0, world_from_handle}});
}

Result<MotionScript> MotionScript::read(const std::filesystem::path& path) {
  const auto poses = read_path(path, PathOf::kHandle);
  if (!poses) return poses.error();
  std::vector<Row> rows;
  rows.reserve(poses->size());
  for (const PathRow& row : *poses) {
    const auto& p = row.position_m;
    const auto& q = row.orientation_wxyz;
    rows.push_back({row.time_s, {{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}}});
  }
  return MotionScript(std::move(rows));
}

std::size_t MotionScript::segment(double time_s) const noexcept {
  const auto next = std::upper_bound(rows_.begin(), rows_.end(), time_s,
                                     [](double t, const Row& row) { return t < row.time_s; });
  return next == rows_.begin() ? 0 : static_cast<std::size_t>(next - rows_.begin()) - 1;
}

Pose MotionScript::pose(double time_s) const noexcept {
  if (time_s <= rows_.front().time_s) return rows_.front().world_from_handle;
  const std::size_t at = segment(time_s);
  if (at + 1 == rows_.size()) return rows_.back().world_from_handle;
  const Row &a = rows_[at], &b = rows_[at + 1];
  const double fraction = (time_s - a.time_s) / (b.time_s - a.time_s);
  const Pose &from = a.world_from_handle, &to = b.world_from_handle;
  const glm::dvec3 turn =
      coupling::rotation_vector(to.orientation * glm::conjugate(from.orientation)) * fraction;
  return {from.position_m + (to.position_m - from.position_m) * fraction,
          glm::normalize(coupling::rotation_by(turn) * from.orientation)};
}

Twist MotionScript::velocity(double time_s) const noexcept {
  if (time_s < rows_.front().time_s) return {};
  const std::size_t at = segment(time_s);
  if (at + 1 == rows_.size()) return {};
  const Row &a = rows_[at], &b = rows_[at + 1];
  const double seconds = b.time_s - a.time_s;
  const Pose &from = a.world_from_handle, &to = b.world_from_handle;
  return {(to.position_m - from.position_m) / seconds,
          coupling::rotation_vector(to.orientation * glm::conjugate(from.orientation)) / seconds};
}

}  // namespace forcelayer::devices
