#include "tests/stress/path_campaign.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "runtime/clearance/path_check.h"

namespace forcelayer::stress {
namespace {

using clearance::CenterPath;
using clearance::CheckResult;
using clearance::Moment;
using test::Random;

constexpr int kAloneEach = 4;  // one moment in so many is checked alone, too

PathRow row_of(double time_s, const Pose& pose) {
  const auto& p = pose.position_m;
  const auto& q = pose.orientation;
  return {time_s, {p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}};
}

// world_from_part of a centroid frame.
Pose part_of(const Pose& world_from_center, const Pshell& shell) {
  const auto& c = shell.header().center_m;
  return world_from_center * Pose{glm::dvec3(-c[0], -c[1], -c[2]), {1, 0, 0, 0}};
}

class Campaign {
 public:
  Campaign(const ClearanceScene& scene, std::uint64_t seed)
      : scene_(scene),
        random_(seed),
        baked_(scene),
        voxmap_(baked_.open_scene()),
        shell_(baked_.open_part()),
        judge_(scene.objects, scene.part, scene.voxel_size_m),
        approach_(scene, seed) {}

  void judge_one_path(JudgedPaths& judged) {
    const CenterPath path(random_path(), shell_);
    const double s = scene_.voxel_size_m;
    const auto result = checked(path, test::uniform(random_, 0, 12) * s);
    std::vector<std::pair<Moment, double>> exact;  // voxels
    const int each = path.poses() > 10 ? 1 : 8;
    for (std::size_t pose = 0; pose < path.poses(); ++pose) {
      const bool is_last = pose + 1 == path.poses();
      for (int n = 0; n < (is_last ? 1 : each); ++n) {
        const Moment moment{pose, n == 0 ? 0 : test::uniform(random_, 0, 0.999)};
        const Pose part = part_of(path.world_from_center(moment), shell_);
        exact.push_back({moment, judge_.exact_m(part) / s});
        judge_moment(path, result, moment, exact.back().second, judged);
      }
    }
    plant(path, exact, judged);
  }

 private:
  // Along random lines, with far ways between them.
  std::vector<PathRow> random_path() {
    const bool is_dense = test::integer(random_, 0, 1) == 0;
    const auto rows = test::integer(random_, 2, is_dense ? 40 : 8);
    std::vector<PathRow> path;
    Pose pose = approach_.begin();
    double time_s = 0;
    for (std::int64_t n = 0; n < rows; ++n) {
      path.push_back(row_of(time_s, pose));
      time_s += test::uniform(random_, 0.1, 1);
      // Some rows on, so that there is a way between two of them.
      for (std::int64_t k = is_dense ? 1 : test::integer(random_, 1, 6); k > 0; --k) {
        pose = approach_.next(pose, judge_.exact_m(pose));
      }
    }
    return path;
  }

  CheckResult checked(const CenterPath& path, double required_m) const {
    auto result = check_path(voxmap_, shell_, path, {required_m, 1, {}, {}});
    if (!result) throw std::runtime_error(to_line(result.error()));
    return std::move(*result);
  }

  void judge_moment(const CenterPath& path, const CheckResult& result, const Moment& moment,
                    double exact, JudgedPaths& judged) {
    const double s = scene_.voxel_size_m, time_s = path.time_s(moment);
    JudgedMoment m;
    m.exact = exact;
    m.premise_failed = scene_.roi_m.has_value();
    m.along = INFINITY;
    for (const auto& piece : result.curve) {
      if (piece.from_s <= time_s && time_s <= piece.to_s) {
        m.along = std::min(m.along, piece.clearance_m / s);
      }
    }
    if (judged.moments.size() % kAloneEach == 0) {
      const Pose part = part_of(path.world_from_center(moment), shell_);
      const CenterPath alone({{row_of(0, part)}}, shell_);
      const CheckResult of_it = checked(alone, std::clamp(exact, 1.0, 14.0) * s);
      m.alone = of_it.clearance_m / s;
    }
    judged.moments.push_back(m);
  }

  // Asks for more than there is at one of the moments.
  void plant(const CenterPath& path, const std::vector<std::pair<Moment, double>>& exact,
             JudgedPaths& judged) {
    const auto n = static_cast<std::size_t>(
        test::integer(random_, 0, static_cast<std::int64_t>(exact.size()) - 1));
    if (exact[n].second > 20) return;  // too far to search for
    const double required = exact[n].second + test::uniform(random_, 0.1, 2);
    const CheckResult result = checked(path, required * scene_.voxel_size_m);
    const double time_s = path.time_s(exact[n].first);
    ++judged.planted;
    judged.found +=
        std::any_of(result.violations.begin(), result.violations.end(),
                    [&](const auto& v) { return v.from_s <= time_s && time_s <= v.to_s; });
  }

  const ClearanceScene& scene_;
  Random random_;
  BakedClearance baked_;
  Voxmap voxmap_;
  Pshell shell_;
  ClearanceJudge judge_;
  Approach approach_;
};

}  // namespace

JudgedPaths judge_paths(const ClearanceScene& scene, std::uint64_t seed, int moments) {
  Campaign campaign(scene, seed);
  JudgedPaths judged;
  while (judged.moments.size() < static_cast<std::size_t>(moments)) campaign.judge_one_path(judged);
  return judged;
}

}  // namespace forcelayer::stress
