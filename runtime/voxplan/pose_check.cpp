#include "runtime/voxplan/pose_check.h"

#include <algorithm>
#include <array>

#include "runtime/clearance/path_walk.h"

namespace forcelayer::voxplan {
namespace {

using clearance::CenterPath;
using clearance::LeftOut;
using clearance::Moment;
using clearance::SeatStretch;

// Beyond the stored reach a search tells distances, which takes long, and no rule needs it.
double cap_voxels(const Problem& problem, double required_voxels) {
  return std::max(required_voxels + 1, clearance::reach_voxels(problem.scene.header()));
}

LeftOut with_seat(LeftOut left_out, const std::optional<SeatStretch>& seat) {
  if (!seat) return left_out;
  for (const field::SeatObject& object : seat->objects()) {
    left_out.resize(std::max<std::size_t>(left_out.size(), object.object + 1u), 0);
    if (object.object != 0) left_out[object.object] = 1;
  }
  return left_out;
}

// The straight motion between two poses of the centroid frame.
CenterPath motion(const Problem& problem, const Pose& from, const Pose& to) {
  return {std::array{row_of(0, from), row_of(1, to)}, glm::dvec3(0),
          problem.part.header().bounding_radius_m};
}

double share_of(const Moment& moment) { return static_cast<double>(moment.pose) + moment.share; }

}  // namespace

Result<std::unique_ptr<PoseCheck>> PoseCheck::create(const Problem& problem) {
  auto seat = SeatStretch::find(problem.scene, problem.part, problem.world_from_start);
  if (!seat) return seat.error();
  return std::unique_ptr<PoseCheck>(new PoseCheck(problem, std::move(*seat)));
}

PoseCheck::PoseCheck(const Problem& problem, std::optional<SeatStretch> seat)
    : problem_(problem),
      required_(problem.scene, problem.part, problem.clearance_m),
      seat_(std::move(seat)),
      but_seat_(with_seat(problem.allowed, seat_)),
      clear_(problem.scene, problem.part, problem.allowed, cap_voxels(problem, required_.voxels())),
      in_seat_(problem.scene, problem.part, but_seat_, cap_voxels(problem, required_.voxels())) {}

bool PoseCheck::holds(Rule rule, const Pose& pose) {
  ++tested_;
  part(rule).forget();
  const double required = required_.voxels();
  if (part(rule).at(pose, 0, required, required).voxels < required) return false;
  return rule == Rule::kClear || !has_seat() || !seat_->pushed_in(pose, problem_.allowed);
}

double PoseCheck::share_kept(Rule rule, const Pose& from, const Pose& to, bool or_nothing) {
  const CenterPath path = motion(problem_, from, to);
  const Moment begin{0, 0};
  Moment end{1, 0};
  clearance::PathWalk walk(path, part(rule), problem_.scene.voxel_size_m(),
                           {required_.voxels(), required_.voxels()});
  end = walk.kept_until(begin, end, or_nothing);
  tested_ += walk.tested();
  if (share_of(end) == 0 || rule == Rule::kClear || !has_seat()) return share_of(end);
  const auto pushed = seat_->first_pushed_in(path, begin, end, problem_.allowed);
  if (!pushed) return share_of(end);
  // It was tested in steps of half a voxel: the last but one was right.
  const double steps = path.travel_m({1, 0}) / (0.5 * problem_.scene.voxel_size_m());
  return or_nothing ? 0 : std::max(0.0, share_of(pushed->moment) - 1.001 / std::max(1.0, steps));
}

double PoseCheck::share_kept(Rule rule, const Pose& from, const Pose& to) {
  return share_kept(rule, from, to, false);
}

bool PoseCheck::is_kept(Rule rule, const Pose& from, const Pose& to) {
  return share_kept(rule, from, to, true) == 1;
}

double PoseCheck::clearance_m(const Pose& pose) {
  ++tested_;
  clear_.forget();
  return required_.clearance_m(clear_.at(pose, 0, cap_voxels(problem_, required_.voxels())).voxels);
}

std::uint32_t PoseCheck::met(Rule rule, const Pose& from, const Pose& to) {
  const double share = share_kept(rule, from, to);
  if (share == 1) return 0;
  const double step = 0.5 * problem_.scene.voxel_size_m() / travel_between_m(problem_, from, to);
  for (int n = 0; n < 8; ++n) {
    const Pose there = pose_between(from, to, std::min(1.0, share + n * step));
    part(rule).forget();
    const auto least = part(rule).at(there, 0, required_.voxels());
    if (least.point != clearance::LeastDistance::kNone) {
      return part(rule).nearest(part(rule).place_m(there, least.point)).object;
    }
    if (rule == Rule::kClear || !has_seat()) continue;
    if (const auto pushed = seat_->pushed_in(there, problem_.allowed)) return pushed->object;
  }
  return 0;
}

const std::vector<SeatStretch::Floor>& PoseCheck::floors(const Pose& pose) {
  floors_.clear();
  if (has_seat()) seat_->find_floors(pose, floors_);
  return floors_;
}

}  // namespace forcelayer::voxplan
