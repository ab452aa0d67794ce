#include "runtime/voxplan/way.h"

#include <algorithm>
#include <cmath>

#include "runtime/coupling/coupling.h"
#include "runtime/voxplan/random.h"

namespace forcelayer::voxplan {
namespace {

constexpr double kMostPoses = 200;      // of a way that is widened
constexpr double kLeastStepVoxels = 2;  // between two of them
constexpr int kPasses = 12;
constexpr double kFirstShiftVoxels = 3, kShrink = 0.8;  // of what is tried, from pass to pass
constexpr int kEvenings = 60;                           // passes of smoothed()
constexpr int kCuts = 4;                                // times that its corners are cut
constexpr double kCornerRad = 0.03;                     // a corner that is cut

double length_m(const Problem& problem, const Way& way) {
  double all_m = 0;
  for (std::size_t i = 1; i < way.size(); ++i) {
    all_m += travel_between_m(problem, way[i - 1], way[i]);
  }
  return all_m;
}

// A pose near another: its centroid shifted, and turned by as much at the part's radius.
Pose shifted(const Pose& pose, double shift_m, double radius_m, Random& random) {
  const glm::dvec3 turn_rad = random.direction() * (random.normal() * shift_m / radius_m);
  return {pose.position_m + random.direction() * (random.normal() * shift_m),
          glm::normalize(coupling::rotation_by(turn_rad) * pose.orientation)};
}

// The turn of the centroid's way at the second of three poses.
double corner_rad(const Pose& a, const Pose& b, const Pose& c) {
  const glm::dvec3 in_m = b.position_m - a.position_m, out_m = c.position_m - b.position_m;
  const double lengths = glm::length(in_m) * glm::length(out_m);
  if (!(lengths > 0)) return 0;
  return std::atan2(glm::length(glm::cross(in_m, out_m)), glm::dot(in_m, out_m));
}

class Smoother {
 public:
  Smoother(const Problem& problem, PoseCheck& check, const Way& way)
      : problem_(problem), check_(check), way_(way) {}
  Way run(const Way& in_seat) {
    even(go_straight_on(in_seat) ? 2 : 1);
    for (int n = 0; n < kCuts; ++n) cut_corners();
    return way_;
  }

 private:
  bool go_straight_on(const Way& in_seat);
  void even(std::size_t first);
  void cut_corners();

  const Problem& problem_;
  PoseCheck& check_;
  Way way_;
};

// A way out of a seat goes straight on for a step before it turns.
bool Smoother::go_straight_on(const Way& in_seat) {
  if (in_seat.size() < 2 || way_.size() < 2) return false;
  const Pose &last = in_seat[in_seat.size() - 2], &joint = way_.front();
  const glm::dvec3 leg_m = joint.position_m - last.position_m;
  if (!(glm::length(leg_m) > 0)) return false;
  const double step_m = kLeastStepVoxels * problem_.scene.voxel_size_m();
  Pose on = joint;
  on.position_m += leg_m * (step_m / glm::length(leg_m));
  if (!check_.is_kept(Rule::kClear, joint, on) || !check_.is_kept(Rule::kClear, on, way_[1])) {
    return false;
  }
  way_.insert(way_.begin() + 1, on);
  return true;
}

// Poses to the middle of their neighbors, where no clearance falls below the least of the three.
void Smoother::even(std::size_t first) {
  std::vector<double> clearance_m;
  for (const Pose& pose : way_) clearance_m.push_back(check_.clearance_m(pose));
  for (int pass = 0; pass < kEvenings; ++pass) {
    for (std::size_t i = first; i + 1 < way_.size(); ++i) {
      const Pose there = pose_between(way_[i - 1], way_[i + 1], 0.5);
      const double there_m = check_.clearance_m(there);
      if (there_m < std::min({clearance_m[i - 1], clearance_m[i], clearance_m[i + 1]})) continue;
      if (!check_.is_kept(Rule::kClear, way_[i - 1], there) ||
          !check_.is_kept(Rule::kClear, there, way_[i + 1])) {
        continue;
      }
      way_[i] = there;
      clearance_m[i] = there_m;
    }
  }
}

// Each corner by two, a quarter of its legs away from it (Chaikin): the more often, the nearer to a
// quadratic B-spline. A cut that is not kept leaves its corner.
void Smoother::cut_corners() {
  Way cut{way_.front()};
  for (std::size_t i = 1; i + 1 < way_.size(); ++i) {
    const Pose before = pose_between(way_[i], way_[i - 1], 0.25);
    const Pose behind = pose_between(way_[i], way_[i + 1], 0.25);
    const bool cuts = corner_rad(way_[i - 1], way_[i], way_[i + 1]) > kCornerRad &&
                      check_.is_kept(Rule::kClear, before, behind);
    if (cuts) {
      cut.push_back(before);
      cut.push_back(behind);
    } else {
      cut.push_back(way_[i]);
    }
  }
  cut.push_back(way_.back());
  way_ = std::move(cut);
}

}  // namespace

Result<Way> widened(const Problem& problem, const Way& way, std::uint64_t seed) {
  auto made = PoseCheck::create(problem);
  if (!made) return made.error();
  PoseCheck& check = **made;
  Random random(seed);
  const double step_m = std::max(length_m(problem, way) / kMostPoses,
                                 kLeastStepVoxels * problem.scene.voxel_size_m());
  Way wide = with_more_poses(problem, way, step_m);
  std::vector<double> clearance_m;
  for (const Pose& pose : wide) clearance_m.push_back(check.clearance_m(pose));
  const double radius_m = problem.part.header().bounding_radius_m;
  double shift_m = kFirstShiftVoxels * problem.scene.voxel_size_m();
  for (int pass = 0; pass < kPasses; ++pass, shift_m *= kShrink) {
    for (std::size_t i = 1; i + 1 < wide.size(); ++i) {
      // Toward the middle of its neighbors, too: a way that is even is felt as smooth.
      const Pose middle = pose_between(wide[i - 1], wide[i + 1], 0.5);
      const Pose there =
          shifted(pose_between(wide[i], middle, random.share()), shift_m, radius_m, random);
      const double there_m = check.clearance_m(there);
      if (there_m <= clearance_m[i]) continue;
      if (!check.is_kept(Rule::kClear, wide[i - 1], there) ||
          !check.is_kept(Rule::kClear, there, wide[i + 1])) {
        continue;
      }
      wide[i] = there;
      clearance_m[i] = there_m;
    }
  }
  return wide;
}

Result<Way> smoothed(const Problem& problem, const Way& in_seat, const Way& way) {
  auto made = PoseCheck::create(problem);
  if (!made) return made.error();
  Smoother smoother(problem, **made, way);
  return smoother.run(in_seat);
}

std::vector<PathRow> rows_of(const Problem& problem, const Way& in_seat, const Way& beyond,
                             double speed_mps) {
  Way way = in_seat;
  way.insert(way.end(), beyond.begin() + (in_seat.empty() ? 0 : 1), beyond.end());
  const Pose center_from_part = inverse(part_from_center(problem.part));
  std::vector<PathRow> rows;
  double time_s = 0;
  for (std::size_t i = 0; i < way.size(); ++i) {
    if (i > 0) {
      const double travel_m = travel_between_m(problem, way[i - 1], way[i]);
      if (travel_m == 0) continue;
      time_s += travel_m / speed_mps;
    }
    rows.push_back(row_of(time_s, way[i] * center_from_part));
  }
  return rows;
}

Result<clearance::CheckResult> proven(const Problem& problem, const std::vector<PathRow>& rows,
                                      Rule rule, unsigned threads) {
  const clearance::CenterPath path(rows, problem.part);
  clearance::CheckRequest request{problem.clearance_m, threads, problem.allowed, {}, true};
  if (rule == Rule::kInSeat) {
    request.world_from_seat = problem.world_from_start * inverse(part_from_center(problem.part));
  }
  return clearance::check_path(problem.scene, problem.part, path, request);
}

}  // namespace forcelayer::voxplan
