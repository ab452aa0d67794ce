// A piece of a path under one rule, made smooth between its first and its last pose.
#pragma once

#include <vector>

#include "workbench/voxplan/check/pose_check.h"

namespace forcelayer::voxplan {

// The angle of a path's corner at the second of three poses, rad: between the two motions as
// six-vectors, the shift of the centroid and the turn times the part's radius.
double corner_rad(const Problem& problem, const Pose& before, const Pose& at, const Pose& behind);

constexpr double kCornerRad = 0.03;  // sharper corners are cut

class Stretch {
 public:
  Stretch(PoseCheck& check, Rule rule, PosePath path);

  // Adds poses until no two are farther apart than two voxels, or a fraction of the whole path.
  void add_poses();
  // Replaces detours by straight motions, from long ones to short ones.
  void shorten(std::size_t first);
  // Moves poses to the middle of their neighbors.
  void even(std::size_t first);
  // Replaces each corner by two, a quarter of its legs away (Chaikin) or nearer. Repeated cuts come
  // near to a quadratic B-spline. A corner stays where no cut keeps the rule.
  void cut_corners();

  PosePath& path() { return path_; }

 private:
  double worth_m(const Pose& pose);
  bool is_kept(const Pose& from, const Pose& to) { return check_.is_kept(rule_, from, to); }
  bool cross(std::size_t from, std::size_t to);

  PoseCheck& check_;
  const Problem& problem_;
  Rule rule_;
  PosePath path_;
  std::vector<double> worth_m_;  // the clearance that each pose must keep
};

}  // namespace forcelayer::voxplan
