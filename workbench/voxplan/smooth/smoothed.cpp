#include "workbench/voxplan/smooth/smoothed.h"

#include <algorithm>

#include "workbench/voxplan/check/pose_check.h"
#include "workbench/voxplan/smooth/stretch.h"

namespace forcelayer::voxplan {
namespace {

constexpr int kCuts = 5;               // passes of corner cutting
constexpr double kStraightVoxels = 2;  // the path goes straight out of the seat for so far
constexpr double kCut = 0.25,
                 kMinCut = 0.01;  // fraction of the legs at the joint, as in stretch.cpp

// A path that is made smooth stage by stage.
class Smoother {
 public:
  Smoother(const Problem& problem, PoseCheck& check, const PlannedPath& path)
      : problem_(problem), check_(check), path_(path) {}

  void smooth_in_seat();
  void smooth_beyond();
  void cut_joint();
  void cut_corners(Rule rule);
  const PlannedPath& path() const { return path_; }

 private:
  bool go_straight_on();
  PosePath to_clear(const PosePath& path) {
    return up_to_first(path, problem_,
                       [&](const Pose& p) { return check_.holds(Rule::kClear, p); });
  }

  const Problem& problem_;
  PoseCheck& check_;
  PlannedPath path_;
};

// The seat is left for good where the clearance is first proven. The rest must keep the clearance.
void Smoother::smooth_in_seat() {
  if (path_.in_seat.size() < 3) return;
  Stretch stretch(check_, Rule::kInSeat, path_.in_seat);
  stretch.add_poses();
  stretch.shorten(1);
  stretch.even(1);
  const PosePath& smooth = stretch.path();
  const PosePath in_seat = to_clear(smooth);
  PosePath beyond{in_seat.back()};
  for (std::size_t i = in_seat.size() - 1; i < smooth.size(); ++i) {
    if (travel_between_m(problem_, beyond.back(), smooth[i]) == 0) continue;
    if (!check_.is_kept(Rule::kClear, beyond.back(), smooth[i])) return;
    beyond.push_back(smooth[i]);
  }
  beyond.insert(beyond.end(), path_.beyond.begin() + 1, path_.beyond.end());
  path_ = {in_seat, beyond};
}

void Smoother::smooth_beyond() {
  const std::size_t first = go_straight_on() ? 2 : 1;
  Stretch stretch(check_, Rule::kClear, path_.beyond);
  stretch.shorten(first);
  stretch.even(first);
  path_.beyond = stretch.path();
}

// Lets the path go straight out of the seat for a step before it turns.
bool Smoother::go_straight_on() {
  if (path_.in_seat.size() < 2 || path_.beyond.size() < 2) return false;
  const Pose &last = path_.in_seat[path_.in_seat.size() - 2], &joint = path_.beyond.front();
  const double leg_m = travel_between_m(problem_, last, joint);
  if (leg_m == 0) return false;
  const double step_m = kStraightVoxels * problem_.scene.voxel_size_m();
  const Pose on = pose_between(last, joint, 1 + step_m / leg_m);
  if (!check_.is_kept(Rule::kClear, joint, on) ||
      !check_.is_kept(Rule::kClear, on, path_.beyond[1])) {
    return false;
  }
  path_.beyond.insert(path_.beyond.begin() + 1, on);
  return true;
}

// Cuts the corner where the seat is left. The part then leaves the seat somewhere on the cut.
void Smoother::cut_joint() {
  if (path_.in_seat.size() < 2 || path_.beyond.size() < 2) return;
  const Pose &last = path_.in_seat[path_.in_seat.size() - 2], &joint = path_.beyond.front(),
             &next = path_.beyond[1];
  if (corner_rad(problem_, last, joint, next) < kCornerRad) return;
  for (double fraction = kCut; fraction >= kMinCut; fraction /= 2) {
    const Pose before = pose_between(joint, last, fraction),
               behind = pose_between(joint, next, fraction);
    if (!check_.is_kept(Rule::kInSeat, before, behind)) continue;
    const PosePath across = to_clear({before, behind});
    if (!check_.is_kept(Rule::kClear, across.back(), behind)) continue;
    path_.in_seat.back() = before;
    path_.in_seat.push_back(across.back());
    path_.beyond.front() = behind;
    if (travel_between_m(problem_, across.back(), behind) > 0) {
      path_.beyond.insert(path_.beyond.begin(), across.back());
    }
    return;
  }
}

void Smoother::cut_corners(Rule rule) {
  PosePath& path = rule == Rule::kInSeat ? path_.in_seat : path_.beyond;
  if (path.size() < 3) return;
  Stretch stretch(check_, rule, path);
  for (int n = 0; n < kCuts; ++n) stretch.cut_corners();
  path = stretch.path();
}

}  // namespace

Result<std::vector<PlannedPath>> smoothed(const Problem& problem, const PlannedPath& path) {
  auto check = PoseCheck::create(problem);
  if (!check) return check.error();
  Smoother beyond(problem, **check, path);
  beyond.smooth_beyond();
  beyond.cut_corners(Rule::kClear);
  if (path.in_seat.empty()) return std::vector<PlannedPath>{beyond.path(), path};
  Smoother all(problem, **check, path);
  all.smooth_in_seat();
  all.smooth_beyond();
  Smoother but_joint = all;
  all.cut_joint();
  for (Smoother* each : {&all, &but_joint}) {
    each->cut_corners(Rule::kInSeat);
    each->cut_corners(Rule::kClear);
  }
  return std::vector<PlannedPath>{all.path(), but_joint.path(), beyond.path(), path};
}

}  // namespace forcelayer::voxplan
