#include "workbench/voxplan/smooth/smoothed.h"

#include <algorithm>

#include "workbench/voxplan/check/pose_check.h"
#include "workbench/voxplan/smooth/stretch.h"

namespace forcelayer::voxplan {
namespace {

constexpr int kCuts = 5;                       // times that corners are cut
constexpr double kStraightVoxels = 2;          // on from the seat, before the way turns
constexpr double kCut = 0.25, kMinCut = 0.01;  // of the legs at the joint, as of other corners

// The way as it is made smooth, stage by stage.
class Smoother {
 public:
  Smoother(const Problem& problem, PoseCheck& check, const WholeWay& way)
      : problem_(problem), check_(check), way_(way) {}

  void smooth_in_seat();
  void smooth_beyond();
  void cut_joint();
  void cut_corners(Rule rule);
  const WholeWay& way() const { return way_; }

 private:
  bool go_straight_on();
  Way to_clear(const Way& way) {
    return up_to_first(way, problem_, [&](const Pose& p) { return check_.holds(Rule::kClear, p); });
  }

  const Problem& problem_;
  PoseCheck& check_;
  WholeWay way_;
};

// The seat is left for good where the clearance is first proven: the rest must keep that.
void Smoother::smooth_in_seat() {
  if (way_.in_seat.size() < 3) return;
  Stretch stretch(check_, Rule::kInSeat, way_.in_seat);
  stretch.add_poses();
  stretch.shorten(1);
  stretch.even(1);
  const Way& smooth = stretch.way();
  const Way in_seat = to_clear(smooth);
  Way beyond{in_seat.back()};
  for (std::size_t i = in_seat.size() - 1; i < smooth.size(); ++i) {
    if (travel_between_m(problem_, beyond.back(), smooth[i]) == 0) continue;
    if (!check_.is_kept(Rule::kClear, beyond.back(), smooth[i])) return;
    beyond.push_back(smooth[i]);
  }
  beyond.insert(beyond.end(), way_.beyond.begin() + 1, way_.beyond.end());
  way_ = {in_seat, beyond};
}

void Smoother::smooth_beyond() {
  const std::size_t first = go_straight_on() ? 2 : 1;
  Stretch stretch(check_, Rule::kClear, way_.beyond);
  stretch.shorten(first);
  stretch.even(first);
  way_.beyond = stretch.way();
}

// A way out of a seat goes straight on for a step before it turns.
bool Smoother::go_straight_on() {
  if (way_.in_seat.size() < 2 || way_.beyond.size() < 2) return false;
  const Pose &last = way_.in_seat[way_.in_seat.size() - 2], &joint = way_.beyond.front();
  const double leg_m = travel_between_m(problem_, last, joint);
  if (leg_m == 0) return false;
  const double step_m = kStraightVoxels * problem_.scene.voxel_size_m();
  const Pose on = pose_between(last, joint, 1 + step_m / leg_m);
  if (!check_.is_kept(Rule::kClear, joint, on) ||
      !check_.is_kept(Rule::kClear, on, way_.beyond[1])) {
    return false;
  }
  way_.beyond.insert(way_.beyond.begin() + 1, on);
  return true;
}

// The corner where the seat is left: across it, and the seat is left somewhere on that way.
void Smoother::cut_joint() {
  if (way_.in_seat.size() < 2 || way_.beyond.size() < 2) return;
  const Pose &last = way_.in_seat[way_.in_seat.size() - 2], &joint = way_.beyond.front(),
             &next = way_.beyond[1];
  if (corner_rad(problem_, last, joint, next) < kCornerRad) return;
  for (double fraction = kCut; fraction >= kMinCut; fraction /= 2) {
    const Pose before = pose_between(joint, last, fraction),
               behind = pose_between(joint, next, fraction);
    if (!check_.is_kept(Rule::kInSeat, before, behind)) continue;
    const Way across = to_clear({before, behind});
    if (!check_.is_kept(Rule::kClear, across.back(), behind)) continue;
    way_.in_seat.back() = before;
    way_.in_seat.push_back(across.back());
    way_.beyond.front() = behind;
    if (travel_between_m(problem_, across.back(), behind) > 0) {
      way_.beyond.insert(way_.beyond.begin(), across.back());
    }
    return;
  }
}

void Smoother::cut_corners(Rule rule) {
  Way& way = rule == Rule::kInSeat ? way_.in_seat : way_.beyond;
  if (way.size() < 3) return;
  Stretch stretch(check_, rule, way);
  for (int n = 0; n < kCuts; ++n) stretch.cut_corners();
  way = stretch.way();
}

}  // namespace

Result<std::vector<WholeWay>> smoothed(const Problem& problem, const WholeWay& way) {
  auto check = PoseCheck::create(problem);
  if (!check) return check.error();
  Smoother beyond(problem, **check, way);
  beyond.smooth_beyond();
  beyond.cut_corners(Rule::kClear);
  if (way.in_seat.empty()) return std::vector<WholeWay>{beyond.way(), way};
  Smoother all(problem, **check, way);
  all.smooth_in_seat();
  all.smooth_beyond();
  Smoother but_joint = all;
  all.cut_joint();
  for (Smoother* each : {&all, &but_joint}) {
    each->cut_corners(Rule::kInSeat);
    each->cut_corners(Rule::kClear);
  }
  return std::vector<WholeWay>{all.way(), but_joint.way(), beyond.way(), way};
}

}  // namespace forcelayer::voxplan
