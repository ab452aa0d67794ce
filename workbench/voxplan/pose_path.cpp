#include "workbench/voxplan/pose_path.h"

#include <algorithm>
#include <cmath>

#include "runtime/coupling/coupling.h"
#include "workbench/voxplan/random.h"

namespace forcelayer::voxplan {
namespace {

constexpr double kMaxPoses = 200;     // of a path
constexpr double kMinStepVoxels = 2;  // between two poses
constexpr int kPasses = 12;
constexpr double kFirstShiftVoxels = 3,
                 kShrink = 0.8;  // the shift of the first pass, and its factor from pass to pass

double length_m(const Problem& problem, const PosePath& path) {
  double all_m = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    all_m += travel_between_m(problem, path[i - 1], path[i]);
  }
  return all_m;
}

// A random pose near `pose`: the centroid is shifted, and a point at the part's radius moves about
// as far by the turn.
Pose shifted(const Pose& pose, double shift_m, double radius_m, Random& random) {
  const double turn_m = random.normal() * shift_m;
  const glm::dvec3 turn_rad = random.direction() * (turn_m / radius_m);
  const double travel_m = random.normal() * shift_m;
  return {pose.position_m + random.direction() * travel_m,
          glm::normalize(coupling::rotation_by(turn_rad) * pose.orientation)};
}

}  // namespace

Result<PosePath> widened(const Problem& problem, const PosePath& path, std::uint64_t seed) {
  auto made = PoseCheck::create(problem);
  if (!made) return made.error();
  PoseCheck& check = **made;
  Random random(seed);
  const double step_m =
      std::max(length_m(problem, path) / kMaxPoses, kMinStepVoxels * problem.scene.voxel_size_m());
  PosePath wide = with_more_poses(problem, path, step_m);
  std::vector<double> clearance_m;
  for (const Pose& pose : wide) clearance_m.push_back(check.clearance_m(pose));
  const double radius_m = problem.part.header().bounding_radius_m;
  double shift_m = kFirstShiftVoxels * problem.scene.voxel_size_m();
  for (int pass = 0; pass < kPasses; ++pass, shift_m *= kShrink) {
    for (std::size_t i = 1; i + 1 < wide.size(); ++i) {
      // The middle of its neighbors is tried too: an even path feels smooth.
      const Pose middle = pose_between(wide[i - 1], wide[i + 1], 0.5);
      const Pose there =
          shifted(pose_between(wide[i], middle, random.fraction()), shift_m, radius_m, random);
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

std::vector<PathRow> rows_of(const Problem& problem, const PosePath& in_seat,
                             const PosePath& beyond, double speed_mps) {
  PosePath path = in_seat;
  path.insert(path.end(), beyond.begin() + (in_seat.empty() ? 0 : 1), beyond.end());
  const Pose center_from_part = inverse(part_from_center(problem.part));
  std::vector<PathRow> rows;
  double time_s = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) {
      const double travel_m = travel_between_m(problem, path[i - 1], path[i]);
      if (travel_m == 0) continue;
      time_s += travel_m / speed_mps;
    }
    rows.push_back(row_of(time_s, path[i] * center_from_part));
  }
  return rows;
}

Result<clearance::CheckResult> proven(const Problem& problem, const std::vector<PathRow>& rows,
                                      Rule rule, unsigned threads) {
  const clearance::CenterPath path(rows, problem.part);
  clearance::CheckRequest request{problem.clearance_m, threads, problem.allowed, {}, true};
  if (rule == Rule::kInSeat) {
    request.world_from_seat = problem.world_from_start * inverse(part_from_center(problem.part));
    request.seat_depth = problem.seat_depth;
  }
  return clearance::check_path(problem.scene, problem.part, path, request);
}

}  // namespace forcelayer::voxplan
