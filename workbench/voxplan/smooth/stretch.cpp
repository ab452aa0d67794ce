#include "workbench/voxplan/smooth/stretch.h"

#include <algorithm>
#include <cmath>

#include "runtime/coupling/coupling.h"

namespace forcelayer::voxplan {
namespace {

constexpr double kMaxPoses = 200;        // of a stretch,
constexpr double kMinStepVoxels = 2;     // no nearer to each other than this
constexpr double kMinGain = 1e-3;        // of a shorter way across a detour
constexpr double kKept = 0.8;            // of the clearance of a pose that goes there
constexpr double kMinMoveVoxels = 0.01;  // of a pose
constexpr int kEvenings = 60;            // passes at most

constexpr double kCut = 0.25;     // of the legs beside it,
constexpr double kMinCut = 0.01;  // or half of that, and so on down to this

struct Twist {
  glm::dvec3 way_m, turn_m;
};

Twist twist_between(const Problem& problem, const Pose& from, const Pose& to) {
  return {to.position_m - from.position_m,
          coupling::rotation_vector(to.orientation * glm::conjugate(from.orientation)) *
              double{problem.part.header().bounding_radius_m}};
}

double dot(const Twist& a, const Twist& b) {
  return glm::dot(a.way_m, b.way_m) + glm::dot(a.turn_m, b.turn_m);
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

Stretch::Stretch(PoseCheck& check, Rule rule, Way way)
    : check_(check), problem_(check.problem()), rule_(rule), way_(std::move(way)) {}

// The clearance that no pose may lose; in a seat 0, for there only the rule counts.
double Stretch::worth_m(const Pose& pose) {
  return rule_ == Rule::kClear ? check_.clearance_m(pose) : 0;
}

void Stretch::add_poses() {
  const double all_m = length_m(problem_, &way_.front(), &way_.back());
  const double step_m = std::max(all_m / kMaxPoses, kMinStepVoxels * problem_.scene.voxel_size_m());
  way_ = with_more_poses(problem_, way_, step_m);
}

// Puts the poses between two of them on the straight way, where that is kept and shorter.
bool Stretch::cross(std::size_t from, std::size_t to) {
  const double before_m = length_m(problem_, &way_[from], &way_[to]);
  if (travel_between_m(problem_, way_[from], way_[to]) > (1 - kMinGain) * before_m) return false;
  const double min_m = *std::min_element(worth_m_.begin() + from, worth_m_.begin() + to + 1);
  Way across;
  std::vector<double> across_m;
  for (std::size_t i = from + 1; i < to; ++i) {
    const double fraction = static_cast<double>(i - from) / static_cast<double>(to - from);
    across.push_back(pose_between(way_[from], way_[to], fraction));
    across_m.push_back(worth_m(across.back()));
    if (across_m.back() < std::max(min_m, kKept * worth_m_[i])) return false;
  }
  if (!is_kept(way_[from], way_[to])) return false;
  std::copy(across.begin(), across.end(), way_.begin() + from + 1);
  std::copy(across_m.begin(), across_m.end(), worth_m_.begin() + from + 1);
  return true;
}

void Stretch::shorten(std::size_t first) {
  worth_m_.clear();
  for (const Pose& pose : way_) worth_m_.push_back(worth_m(pose));
  if (way_.size() < first + 2) return;
  const std::size_t last = way_.size() - 1, from = first - 1;
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
    for (std::size_t i = first; i + 1 < way_.size(); ++i) {
      const Pose there = pose_between(way_[i - 1], way_[i + 1], 0.5);
      if (travel_between_m(problem_, way_[i], there) < min_m) continue;
      const double there_m = worth_m(there);
      if (there_m < std::min({worth_m_[i - 1], worth_m_[i], worth_m_[i + 1]})) continue;
      if (!is_kept(way_[i - 1], there) || !is_kept(there, way_[i + 1])) continue;
      way_[i] = there;
      worth_m_[i] = there_m;
      moves = true;
    }
    if (!moves) break;
  }
}

void Stretch::cut_corners() {
  Way cut{way_.front()};
  for (std::size_t i = 1; i + 1 < way_.size(); ++i) {
    bool cuts = false;
    if (corner_rad(problem_, way_[i - 1], way_[i], way_[i + 1]) > kCornerRad) {
      for (double fraction = kCut; fraction >= kMinCut && !cuts; fraction /= 2) {
        const Pose before = pose_between(way_[i], way_[i - 1], fraction);
        const Pose behind = pose_between(way_[i], way_[i + 1], fraction);
        if (!is_kept(before, behind)) continue;
        cut.push_back(before);
        cut.push_back(behind);
        cuts = true;
      }
    }
    if (!cuts) cut.push_back(way_[i]);
  }
  cut.push_back(way_.back());
  way_ = std::move(cut);
}

}  // namespace forcelayer::voxplan
