// A stretch of a way under one rule, made smooth between its first and its last pose.
#pragma once

#include <vector>

#include "workbench/voxplan/check/pose_check.h"

namespace forcelayer::voxplan {

// The turn of a way at the second of three poses, rad: between the twists from one to the next, the
// centroid's way and the turn times the part's radius.
double corner_rad(const Problem& problem, const Pose& before, const Pose& at, const Pose& behind);

constexpr double kCornerRad = 0.03;  // a corner that is cut

class Stretch {
 public:
  Stretch(PoseCheck& check, Rule rule, Way way);

  // No two poses are farther apart than a voxel or two, or a fraction of the whole way.
  void add_poses();
  // Straight across detours, from long ones to short ones.
  void shorten(std::size_t first);
  // Poses to the middle of their neighbors.
  void even(std::size_t first);
  // A corner by two, a quarter of its legs away from it (Chaikin) or nearer: the more often, the
  // nearer to a quadratic B-spline. One that no cut is kept of stays.
  void cut_corners();

  Way& way() { return way_; }

 private:
  double worth_m(const Pose& pose);
  bool is_kept(const Pose& from, const Pose& to) { return check_.is_kept(rule_, from, to); }
  bool cross(std::size_t from, std::size_t to);

  PoseCheck& check_;
  const Problem& problem_;
  Rule rule_;
  Way way_;
  std::vector<double> worth_m_;  // of each pose
};

}  // namespace forcelayer::voxplan
