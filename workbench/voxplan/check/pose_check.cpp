#include "workbench/voxplan/check/pose_check.h"

#include <algorithm>
#include <array>

#include "workbench/exact/watch.h"

namespace forcelayer::voxplan {
namespace {

using clearance::CenterPath;
using clearance::KnownEnds;
using clearance::LeftOut;
using clearance::Moment;
using clearance::SeatStretch;

constexpr double kRefusedVoxels = 1;  // of travel around a refused pose

// The distance up to which check_path() searches. With a smaller cap some distances would come out
// smaller, and the start itself could be refused.
double cap_voxels(const Problem& problem, double required_voxels) {
  return std::max(required_voxels + 2, clearance::reach_voxels(problem.scene.header())) + 1;
}

// Within the stored distances if they are enough, because no search is needed there.
double clear_cap_voxels(const Problem& problem, double required_voxels) {
  const double reach = clearance::reach_voxels(problem.scene.header());
  return required_voxels + 2 <= reach ? reach : cap_voxels(problem, required_voxels);
}

LeftOut with_seat(const LeftOut& left_out, const std::optional<SeatStretch>& seat,
                  const clearance::RequiredDistance& required) {
  return seat ? clearance::with_objects(left_out, seat->near_objects(required)) : left_out;
}

// Nothing is allowed once the time is over: no exception may leave through OMPL, which would lose
// its states.
double leeway_m(const exact::SeatMeshes& meshes, const Pose& world_from_center) {
  try {
    return meshes.leeway_m(world_from_center);
  } catch (const exact::Stopped&) {
    return -1;
  }
}

// The straight motion between two poses of the centroid frame.
CenterPath motion(const Problem& problem, const Pose& from, const Pose& to) {
  return {std::array{row_of(0, from), row_of(1, to)}, glm::dvec3(0),
          problem.part.header().bounding_radius_m};
}

double fraction_of(const Moment& moment) {
  return static_cast<double>(moment.pose) + moment.fraction;
}

}  // namespace

Result<std::unique_ptr<PoseCheck>> PoseCheck::create(const Problem& problem) {
  if (problem.scene.distances() != nullptr) {
    // A part that starts clear of everything has no seat. Looking for one would take a fifth of a
    // short search.
    std::unique_ptr<PoseCheck> check(new PoseCheck(problem, {}));
    if (check->holds(Rule::kClear, problem.world_from_start)) return check;
  }
  auto seat =
      SeatStretch::find(problem.scene, problem.part, problem.world_from_start, problem.seat_depth);
  if (!seat) return seat.error();
  return std::unique_ptr<PoseCheck>(new PoseCheck(problem, std::move(*seat)));
}

PoseCheck::PoseCheck(const Problem& problem, std::optional<SeatStretch> seat)
    : problem_(problem),
      required_(problem.scene, problem.part, problem.clearance_m),
      seat_(std::move(seat)),
      but_seat_(with_seat(problem.allowed, seat_, required_)),
      clear_(problem.scene, problem.part, problem.allowed,
             clear_cap_voxels(problem, required_.voxels())),
      in_seat_(problem.scene, problem.part, but_seat_, cap_voxels(problem, required_.voxels())) {}

bool PoseCheck::holds(Rule rule, const Pose& pose) {
  clearance::MinDistance known;
  return holds(rule, pose, known);
}

bool PoseCheck::holds(Rule rule, const Pose& pose, clearance::MinDistance& known) {
  ++tested_;
  if (is_refused(pose)) return false;
  part(rule).forget();
  const double required = required_.voxels();
  known = part(rule).at(pose, 0, required, required);
  if (known.voxels < required) return false;
  if (rule == Rule::kClear || !has_seat()) return true;
  if (problem_.seat_meshes != nullptr) return leeway_m(*problem_.seat_meshes, pose) >= 0;
  return !seat_->is_pushed_in(pose, problem_.allowed);
}

std::vector<std::uint32_t> PoseCheck::seat_objects() const {
  if (!has_seat()) return {};
  std::vector<std::uint32_t> objects = seat_->near_objects(required_);
  std::erase_if(objects, [&](std::uint32_t object) {
    return object < problem_.allowed.size() && problem_.allowed[object] != 0;
  });
  return objects;
}

void PoseCheck::refuse(const Pose& pose) {
  const double from_start_m = travel_between_m(problem_, problem_.world_from_start, pose);
  if (!(from_start_m > 0)) return;
  refused_.push_back(
      {pose, std::min(kRefusedVoxels * problem_.scene.voxel_size_m(), from_start_m / 2)});
}

bool PoseCheck::is_refused(const Pose& pose) const {
  return std::any_of(refused_.begin(), refused_.end(), [&](const Refused& refused) {
    return travel_between_m(problem_, pose, refused.pose) < refused.within_m;
  });
}

// The fraction of a motion before its first refused pose, to within half of kRefusedVoxels. From
// each pose the motion may go on for as long as it cannot come near a refused one.
double PoseCheck::fraction_not_refused(const Pose& from, const Pose& to) const {
  const double travel_m = travel_between_m(problem_, from, to);
  double fraction = 1;
  for (const Refused& refused : refused_) {
    if (travel_between_m(problem_, from, refused.pose) > travel_m + refused.within_m) continue;
    double kept = 0;
    for (double at = 0; at < fraction;) {
      const double off_m = travel_between_m(problem_, pose_between(from, to, at), refused.pose);
      if (off_m < refused.within_m) {
        fraction = kept;
        break;
      }
      kept = at;
      at += std::max(off_m - refused.within_m, refused.within_m / 2) / travel_m;
    }
  }
  return fraction;
}

double PoseCheck::fraction_kept(Rule rule, const Pose& from, const Pose& to, bool or_nothing,
                                KnownEnds& known) {
  const double fraction = fraction_by_rule(rule, from, to, or_nothing, known);
  ++motions_tested_;
  if (fraction == 1) {
    ++motions_kept_;
    kept_m_ += travel_between_m(problem_, from, to);
  }
  return fraction;
}

double PoseCheck::fraction_by_rule(Rule rule, const Pose& from, const Pose& to, bool or_nothing,
                                   KnownEnds& known) {
  if (!refused_.empty()) {
    const double fraction = fraction_not_refused(from, to);
    if (fraction < 1 && (or_nothing || fraction == 0)) return 0;
    if (fraction < 1) {
      KnownEnds before{known.first, {KnownEnds::kUnknown}};
      return fraction *
             fraction_by_proofs(rule, from, pose_between(from, to, fraction), false, before);
    }
  }
  return fraction_by_proofs(rule, from, to, or_nothing, known);
}

double PoseCheck::fraction_by_proofs(Rule rule, const Pose& from, const Pose& to, bool or_nothing,
                                     KnownEnds& known) {
  const CenterPath path = motion(problem_, from, to);
  const Moment begin{0, 0};
  Moment end{1, 0};
  clearance::PathWalk walk(path, part(rule), problem_.scene.voxel_size_m(),
                           {required_.voxels(), required_.voxels()});
  end = walk.kept_until(begin, end, or_nothing, known);
  tested_ += walk.tested();
  if (fraction_of(end) == 0 || rule == Rule::kClear || !has_seat()) return fraction_of(end);
  if (problem_.seat_meshes != nullptr) {
    const double fraction = fraction_by_meshes(from, to, fraction_of(end));
    return or_nothing && fraction < 1 ? 0 : fraction;
  }
  const auto pushed = seat_->first_moment_pushed_in(path, begin, end, problem_.allowed);
  if (!pushed) return fraction_of(end);
  // The motion was tested in steps of half a voxel: the last but one kept the rule.
  const double steps = path.travel_m({1, 0}) / (0.5 * problem_.scene.voxel_size_m());
  return or_nothing ? 0 : std::max(0.0, fraction_of(*pushed) - 1.001 / std::max(1.0, steps));
}

// Tests pose after pose. Each step is as long as no point of the part can come deeper, but not
// shorter than the step between two tests.
double PoseCheck::fraction_by_meshes(const Pose& from, const Pose& to, double largest) {
  const double travel_m = travel_between_m(problem_, from, to);
  const double step_m = mesh_step_voxels_ * problem_.scene.voxel_size_m();
  double kept = 0;
  for (double fraction = 0;;) {
    ++tested_;
    const double free_m = leeway_m(*problem_.seat_meshes, pose_between(from, to, fraction));
    if (free_m < 0) return kept;
    kept = fraction;
    if (fraction == largest) return largest;
    fraction =
        travel_m > 0 ? std::min(largest, fraction + std::max(free_m, step_m) / travel_m) : largest;
  }
}

double PoseCheck::fraction_kept(Rule rule, const Pose& from, const Pose& to) {
  KnownEnds known;
  return fraction_kept(rule, from, to, false, known);
}

bool PoseCheck::is_kept(Rule rule, const Pose& from, const Pose& to) {
  KnownEnds known;
  return is_kept(rule, from, to, known);
}

bool PoseCheck::is_kept(Rule rule, const Pose& from, const Pose& to, KnownEnds& known) {
  return fraction_kept(rule, from, to, true, known) == 1;
}

double PoseCheck::clearance_m(const Pose& pose) {
  ++tested_;
  clear_.forget();
  const double cap = clear_cap_voxels(problem_, required_.voxels());
  return required_.clearance_m(clear_.at(pose, 0, cap).voxels);
}

std::uint32_t PoseCheck::met(Rule rule, const Pose& from, const Pose& to) {
  const double fraction = fraction_kept(rule, from, to);
  if (fraction == 1) return 0;
  const double step = 0.5 * problem_.scene.voxel_size_m() / travel_between_m(problem_, from, to);
  for (int n = 0; n < 8; ++n) {
    const Pose there = pose_between(from, to, std::min(1.0, fraction + n * step));
    // The seat is tested first: near its objects, another object counts as up to 1.7 voxels nearer
    // than it is.
    if (rule == Rule::kInSeat && problem_.seat_meshes != nullptr) {
      if (const auto object = problem_.seat_meshes->blocked_by(there)) return *object;
    } else if (rule == Rule::kInSeat && has_seat()) {
      if (const auto pushed = seat_->pushed_in(there, problem_.allowed)) return pushed->object;
    }
    part(rule).forget();
    const auto smallest = part(rule).at(there, 0, required_.voxels());
    if (smallest.point != clearance::MinDistance::kNone) {
      return part(rule).nearest(part(rule).place_m(there, smallest.point)).object;
    }
  }
  return 0;
}

const std::vector<SeatStretch::Floor>& PoseCheck::floors(const Pose& pose) {
  floors_.clear();
  if (has_seat()) seat_->find_floors(pose, floors_);
  return floors_;
}

}  // namespace forcelayer::voxplan
