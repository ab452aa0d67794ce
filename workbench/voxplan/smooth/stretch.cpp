#include "workbench/voxplan/smooth/stretch.h"

#include <algorithm>
#include <cmath>

#include "runtime/coupling/coupling.h"

namespace forcelayer::voxplan {
namespace {

constexpr double kMaxPoses = 200;        // of a piece
constexpr double kMinStepVoxels = 2;     // between two added poses
constexpr double kMinGain = 1e-3;        // a shortcut must be shorter by this fraction
constexpr double kKept = 0.8;            // fraction of its clearance that a moved pose keeps
constexpr double kMinMoveVoxels = 0.01;  // smaller moves of a pose are left out
constexpr int kEvenings = 60;            // largest number of passes

constexpr double kCut = 0.25;     // fraction of the legs at a corner,
constexpr double kMinCut = 0.01;  // halved down to this until the rule is kept

struct Twist {
  glm::dvec3 shift_m, turn_m;
};

Twist twist_between(const Problem& problem, const Pose& from, const Pose& to) {
  return {to.position_m - from.position_m,
          coupling::rotation_vector(to.orientation * glm::conjugate(from.orientation)) *
              double{problem.part.header().bounding_radius_m}};
}

double dot(const Twist& a, const Twist& b) {
  return glm::dot(a.shift_m, b.shift_m) + glm::dot(a.turn_m, b.turn_m);
}

double length_m(const Problem& problem, const Pose* first, const Pose* last) {
  double all_m = 0;
  for (; first != last; ++first) all_m += travel_between_m(problem, first[0], first[1]);
  return all_m;
}

}  // namespace

double corner_rad(const Problem& problem, const Pose& before, const Pose& at, const Pose& behind) {
  const Twist in = twist_between(problem, before, at), out = twist_between(problem, at, behind);
  const double lengths_m2 = std::sqrt(dot(in, in) * dot(out, out));
  return lengths_m2 > 0 ? std::acos(std::clamp(dot(in, out) / lengths_m2, -1.0, 1.0)) : 0;
}

Stretch::Stretch(PoseCheck& check, Rule rule, PosePath path)
    : check_(check), problem_(check.problem()), rule_(rule), path_(std::move(path)) {}

// The clearance of a pose. It is 0 in a seat, where only the rule of the seat counts.
double Stretch::worth_m(const Pose& pose) {
  return rule_ == Rule::kClear ? check_.clearance_m(pose) : 0;
}

void Stretch::add_poses() {
  const double all_m = length_m(problem_, &path_.front(), &path_.back());
  const double step_m = std::max(all_m / kMaxPoses, kMinStepVoxels * problem_.scene.voxel_size_m());
  path_ = with_more_poses(problem_, path_, step_m);
}

// Puts the poses between two others on the straight motion, if it keeps the rule and is shorter.
bool Stretch::cross(std::size_t from, std::size_t to) {
  const double before_m = length_m(problem_, &path_[from], &path_[to]);
  if (travel_between_m(problem_, path_[from], path_[to]) > (1 - kMinGain) * before_m) return false;
  const double min_m = *std::min_element(worth_m_.begin() + from, worth_m_.begin() + to + 1);
  PosePath across;
  std::vector<double> across_m;
  for (std::size_t i = from + 1; i < to; ++i) {
    const double fraction = static_cast<double>(i - from) / static_cast<double>(to - from);
    across.push_back(pose_between(path_[from], path_[to], fraction));
    across_m.push_back(worth_m(across.back()));
    if (across_m.back() < std::max(min_m, kKept * worth_m_[i])) return false;
  }
  if (!is_kept(path_[from], path_[to])) return false;
  std::copy(across.begin(), across.end(), path_.begin() + from + 1);
  std::copy(across_m.begin(), across_m.end(), worth_m_.begin() + from + 1);
  return true;
}

void Stretch::shorten(std::size_t first) {
  worth_m_.clear();
  for (const Pose& pose : path_) worth_m_.push_back(worth_m(pose));
  if (path_.size() < first + 2) return;
  const std::size_t last = path_.size() - 1, from = first - 1;
  for (std::size_t span = last - from; span >= 2; span = span * 2 / 3) {
    for (std::size_t i = from; i < last; i += std::max<std::size_t>(1, span / 4)) {
      cross(i, std::min(i + span, last));
    }
  }
}

void Stretch::even(std::size_t first) {
  const double min_m = kMinMoveVoxels * problem_.scene.voxel_size_m();
  for (int pass = 0; pass < kEvenings; ++pass) {
    bool moves = false;
    for (std::size_t i = first; i + 1 < path_.size(); ++i) {
      const Pose there = pose_between(path_[i - 1], path_[i + 1], 0.5);
      if (travel_between_m(problem_, path_[i], there) < min_m) continue;
      const double there_m = worth_m(there);
      if (there_m < std::min({worth_m_[i - 1], worth_m_[i], worth_m_[i + 1]})) continue;
      if (!is_kept(path_[i - 1], there) || !is_kept(there, path_[i + 1])) continue;
      path_[i] = there;
      worth_m_[i] = there_m;
      moves = true;
    }
    if (!moves) break;
  }
}

void Stretch::cut_corners() {
  PosePath cut{path_.front()};
  for (std::size_t i = 1; i + 1 < path_.size(); ++i) {
    bool cuts = false;
    if (corner_rad(problem_, path_[i - 1], path_[i], path_[i + 1]) > kCornerRad) {
      for (double fraction = kCut; fraction >= kMinCut && !cuts; fraction /= 2) {
        const Pose before = pose_between(path_[i], path_[i - 1], fraction);
        const Pose behind = pose_between(path_[i], path_[i + 1], fraction);
        if (!is_kept(before, behind)) continue;
        cut.push_back(before);
        cut.push_back(behind);
        cuts = true;
      }
    }
    if (!cuts) cut.push_back(path_[i]);
  }
  cut.push_back(path_.back());
  path_ = std::move(cut);
}

}  // namespace forcelayer::voxplan
