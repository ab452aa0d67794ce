#include "workbench/disassembly/pair_proof.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "formats/path/path_file.h"
#include "workbench/exact/exact_walk.h"
#include "workbench/exact/seat_meshes.h"
#include "workbench/exact/seat_walk.h"
#include "workbench/exact/watch.h"
#include "workbench/pairs/near_boxes.h"

namespace forcelayer::disassembly {
namespace {

using clearance::CenterPath;
using exact::Moment;
using pairs::Shape;

// Resolution of the travel at which a stretch begins and ends, m: as in a study.
constexpr double kTravelM = 16e-6;
// Resolution of a least distance, m and as a fraction of it: as in a study.
constexpr double kWithinM = 1e-7, kWithinFraction = 1e-5;
// How often a proof is asked whether it goes on, at 5 to 50 us each: so the answer is the same on
// each machine. A pair that takes longer stays undecided. A lid of 1,000 triangles that lifts off
// its housing takes some 2^15.
constexpr std::uint64_t kMaxAsked = 1 << 16;
// The same of one moment at which a violation is looked for: a place that is far too deep is among
// the first that are looked at.
constexpr std::uint64_t kMaxAskedAtMoment = 1 << 7;
// Moments at which a violation is looked for before a proof is tried: most blocked motions are
// found here. Halves of the path find a neighbor, equal pieces find what is farther away.
constexpr int kHalves = 12, kPieces = 16;

class Budget {
 public:
  explicit Budget(std::uint64_t max_asked = kMaxAsked) : max_asked_(max_asked) {}
  bool may_go_on() { return ++asked_ < max_asked_; }
  bool is_spent() const { return asked_ >= max_asked_; }

 private:
  std::uint64_t max_asked_, asked_ = 0;
};

// The box around a box that is placed at a pose.
mesh::Box placed(const mesh::Box& box, const Pose& pose) {
  mesh::Box around = mesh::empty_box();
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 own(corner & 1 ? box.high[0] : box.low[0],
                         corner & 2 ? box.high[1] : box.low[1],
                         corner & 4 ? box.high[2] : box.low[2]);
    const glm::dvec3 p = pose.position_m + pose.orientation * own;
    mesh::extend(around, mesh::Vec3d{p.x, p.y, p.z});
  }
  return around;
}

class PairPath {
 public:
  PairPath(const CenterPath& path, const Shape& part, const Shape& object,
           const Installed& installed, const PairRule& rule)
      : path_(path),
        part_(part),
        object_(object),
        installed_(installed),
        rule_(rule),
        distance_(object.mesh(), part.mesh()),
        walk_(path, distance_, distance_, rule.rounding_m) {}

  bool is_seen_blocked() {
    if (!installed_.is_seat) return is_violated_somewhere();
    return installed_.is_enclosed || (installed_.is_known && is_deep_somewhere());
  }

  PairOutcome check() {
    const Moment begin{0, 0}, end{path_.poses() - 1, 0};
    const double counted_m = rule_.required_m + rule_.margin_m();
    if (!installed_.is_seat) return far_from(begin, end, counted_m);
    if (installed_.is_enclosed) return PairOutcome::kBlocked;
    if (!installed_.is_known) return PairOutcome::kUndecided;
    // Far enough for what follows to be proven from its first piece on.
    const auto left = walk_.first_as_far({begin, end}, counted_m + kTravelM, kTravelM);
    if (!left) return PairOutcome::kUndecided;
    const PairOutcome in_seat = in_seat_until(*left);
    return in_seat == PairOutcome::kFree ? far_from(*left, end, counted_m) : in_seat;
  }

 private:
  template <typename Visit>
  bool any_moment(const Visit& visit) {
    const double from_s = path_.time_s({0, 0}), to_s = path_.time_s({path_.poses() - 1, 0});
    const auto at = [&](double fraction) { return path_.at(from_s + fraction * (to_s - from_s)); };
    for (int n = 1; n < kPieces; ++n) {
      if (visit(at(static_cast<double>(n) / kPieces))) return true;
    }
    for (int n = kHalves; n > 4; --n) {
      if (visit(at(std::ldexp(1.0, -n)))) return true;
    }
    return false;
  }

  bool is_violated_somewhere() {
    const double near_m = rule_.required_m - rule_.rounding_m;
    return any_moment([&](const Moment& moment) {
      const auto near =
          distance_.nearer_than(path_.world_from_center(moment), std::max(near_m, kTinyM));
      return near && (near->distance_m < near_m || near->distance_m == 0);
    });
  }

  bool is_deep_somewhere() {
    if (!installed_.is_settled) return false;
    const exact::SeatWalk seat = seat_walk();
    return any_moment([&](const Moment& moment) {
      const Pose pose = path_.world_from_center(moment);
      if (!distance_.nearer_than(pose, kTinyM)) return false;
      Budget budget(kMaxAskedAtMoment);
      const exact::Watch watch([&] { return budget.may_go_on(); });
      try {
        return seat.at_pose(pose, installed_.allowed_m()).found_m > installed_.allowed_m();
      } catch (const exact::Stopped&) {
        if (!budget.is_spent()) throw;
        return false;
      }
    });
  }

  exact::SeatWalk seat_walk() const {
    const double margin_m =
        exact::seat_margin_m(part_.bodies(), object_.bodies(), rule_.margin_m());
    return {path_, part_.bodies(), object_.bodies(), distance_, exact::kSeatWithin * margin_m};
  }

  PairOutcome in_seat_until(const Moment& left) {
    const Moment begin{0, 0};
    if (!installed_.is_settled) {  // no depth is known where two open surfaces meet
      const auto met = walk_.nearer_than({begin, left}, rule_.rounding_m, kTravelM, true);
      return met.empty() ? PairOutcome::kFree : PairOutcome::kUndecided;
    }
    // Surfaces that are apart as installed may not meet: a wall that is thinner than the deviations
    // would not show as a depth.
    if (installed_.gap_m > rule_.rounding_m) {
      const auto met = walk_.nearer_than({begin, left}, rule_.rounding_m, kTravelM, true);
      if (!met.empty()) return PairOutcome::kUndecided;
    }
    exact::SeatWalk seat = seat_walk();
    const auto deeper = seat.deeper_than(begin, left, installed_.allowed_m(), kTravelM);
    if (deeper.empty()) return PairOutcome::kFree;
    return std::any_of(deeper.begin(), deeper.end(), [](const auto& s) { return s.is_deeper; })
               ? PairOutcome::kBlocked
               : PairOutcome::kUndecided;
  }

  PairOutcome far_from(const Moment& from, const Moment& to, double counted_m) {
    const auto near = walk_.nearer_than({from, to}, counted_m, kTravelM, true);
    if (near.empty()) return PairOutcome::kFree;
    const double nearest_m = std::min(walk_.at(near.front().from, false).measured.distance_m,
                                      walk_.at(near.front().to, false).measured.distance_m);
    const bool is_nearer = nearest_m == 0 || nearest_m < rule_.required_m - rule_.rounding_m;
    return is_nearer ? PairOutcome::kBlocked : PairOutcome::kUndecided;
  }

  static constexpr double kTinyM = 1e-12;  // surfaces that are nearer meet

  const CenterPath& path_;
  const Shape& part_;
  const Shape& object_;
  const Installed& installed_;
  const PairRule& rule_;
  exact::MeshPair distance_;
  exact::ExactWalk walk_;
};

}  // namespace

double end_gap_m(const PairRule& rule) { return rule.required_m + rule.margin_m() + 4 * kTravelM; }

double swept_gap_m(const CenterPath& path, const mesh::Box& part, const mesh::Box& object) {
  double gap_m = pairs::distance_of(placed(part, path.world_from_center({0, 0})), object);
  for (std::size_t pose = 1; pose < path.poses(); ++pose) {
    const Moment from{pose - 1, 0}, to{pose, 0};
    mesh::Box swept = placed(part, path.world_from_center(from));
    mesh::extend(swept, placed(part, path.world_from_center(to)));
    gap_m = std::min(gap_m, pairs::distance_of(swept, object) - path.deviation_m(from, to));
  }
  return gap_m;
}

Installed measure_installed(const Shape& part, const Shape& object, const PairRule& rule) {
  Installed installed;
  if (rule.is_ignored) return installed;
  const double counted_m = rule.required_m + rule.margin_m();
  installed.gap_m = pairs::distance_of(part.box_m(), object.box_m());
  if (installed.gap_m > counted_m) return installed;
  Budget budget;
  const exact::Watch watch([&] { return budget.may_go_on(); });
  try {
    const exact::MeshPair distance(object.mesh(), part.mesh());
    const CenterPath path(std::vector<PathRow>(1), glm::dvec3(0), 0);
    const Pose pose = path.world_from_center({0, 0});
    installed.gap_m = distance.at(pose, voxcheck::kNothingM).distance_m;
    const double margin_m = exact::seat_margin_m(part.bodies(), object.bodies(), rule.margin_m());
    const exact::SeatWalk seat(path, part.bodies(), object.bodies(), distance,
                               exact::kSeatWithin * margin_m);
    installed.is_settled = seat.is_settled();
    if (installed.is_settled) {
      installed.depth_m = std::max(0.0, seat.at_pose(pose, std::nullopt).found_m);
    }
    installed.is_enclosed = installed.depth_m > 0 && installed.gap_m > rule.rounding_m;
    installed.is_seat = installed.gap_m < counted_m || installed.depth_m > 0;
    installed.margin_m = margin_m;
  } catch (const exact::Stopped&) {
    installed.is_seat = true;
    installed.is_known = false;
  }
  return installed;
}

bool is_seen_blocked(const CenterPath& path, const Shape& part, const Shape& object,
                     const Installed& installed, const PairRule& rule) {
  if (rule.is_ignored) return false;
  const double counted_m = rule.required_m + rule.margin_m();
  if (!installed.is_seat && swept_gap_m(path, part.box_m(), object.box_m()) >= counted_m) {
    return false;
  }
  Budget budget;
  const exact::Watch watch([&] { return budget.may_go_on(); });
  try {
    return PairPath(path, part, object, installed, rule).is_seen_blocked();
  } catch (const exact::Stopped&) {
    return false;
  }
}

PairOutcome check_pair(const CenterPath& path, const Shape& part, const Shape& object,
                       const Installed& installed, const PairRule& rule) {
  if (rule.is_ignored) return PairOutcome::kFree;
  const double counted_m = rule.required_m + rule.margin_m();
  if (!installed.is_seat && swept_gap_m(path, part.box_m(), object.box_m()) >= counted_m) {
    return PairOutcome::kFree;
  }
  const Pose end = path.world_from_center({path.poses() - 1, 0});
  if (pairs::distance_of(placed(part.box_m(), end), object.box_m()) < end_gap_m(rule)) {
    return PairOutcome::kUndecided;
  }
  Budget budget;
  const exact::Watch watch([&] { return budget.may_go_on(); });
  try {
    return PairPath(path, part, object, installed, rule).check();
  } catch (const exact::Stopped&) {
    return PairOutcome::kUndecided;
  }
}

std::optional<Nearest> nearest_along(const CenterPath& path, const Shape& part, const Shape& object,
                                     const PairRule& rule, double beyond_m) {
  if (rule.is_ignored) return std::nullopt;
  if (swept_gap_m(path, part.box_m(), object.box_m()) >= beyond_m) return std::nullopt;
  const exact::MeshPair distance(object.mesh(), part.mesh());
  exact::ExactWalk walk(path, distance, distance, rule.rounding_m);
  exact::Sample beyond;
  beyond.measured.distance_m = beyond_m;
  const auto least = walk.smallest({{{0, 0}, {path.poses() - 1, 0}}},
                                   std::max(kWithinM, rule.rounding_m), beyond, kWithinFraction);
  if (!(least.sample.measured.distance_m < beyond_m)) return std::nullopt;
  return Nearest{least.sample.measured.distance_m,
                 std::max(0.0, least.at_least_m - rule.margin_m()),
                 path.time_s(least.sample.moment)};
}

}  // namespace forcelayer::disassembly
