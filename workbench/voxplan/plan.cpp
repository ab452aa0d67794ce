#include "workbench/voxplan/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "formats/command/report.h"
#include "formats/command/text.h"
#include "formats/command/verdict/verdict.h"
#include "runtime/run/start_check.h"
#include "runtime/voxcheck/exact.h"
#include "runtime/voxcheck/object_names.h"
#include "runtime/voxcheck/words.h"
#include "workbench/exact/enclosure.h"
#include "workbench/voxplan/check/pose_check.h"
#include "workbench/voxplan/check/straight_blocks.h"
#include "workbench/voxplan/destination.h"
#include "workbench/voxplan/pose_path.h"
#include "workbench/voxplan/search_worker.h"
#include "workbench/voxplan/smooth/smoothed.h"

namespace forcelayer::voxplan {
namespace {

using voxcheck::kRoundingM;

constexpr double kSpeedMps = 0.1;        // of the part along the path
constexpr double kFarthestVoxels = 1e6;  // distance of a goal; every voxel of a path is proven

// The verdict of voxcheck --exact on a path.
Result<voxcheck::ExactCheckResult> settled(const Problem& problem, const std::vector<PathRow>& rows,
                                           const Options& options, const exact::Meshes& meshes) {
  voxcheck::Options asked;
  static_cast<voxcheck::MeshOptions&>(asked) = options;
  asked.scene = options.scene;
  asked.part = options.part;
  asked.clearance_m = options.clearance_m;
  asked.world_from_seat = options.world_from_seat;
  asked.quiet = true;
  const clearance::CheckRequest request{problem.clearance_m, options.threads, problem.allowed,
                                        options.world_from_seat};
  return voxcheck::check_with_meshes(
      problem.scene, problem.part, clearance::CenterPath(rows, problem.part), request, asked,
      [&](const auto& question) { return exact::check_exactly(meshes, rows, question); });
}

// Why the part cannot be at a pose, which was checked; none if it can.
std::optional<Error> refusal_of(const Problem& problem, const clearance::CheckResult& checked,
                                const char* option) {
  if (checked.clear()) return std::nullopt;
  const clearance::Violation& worst = checked.violations.front();
  if (worst.worst.beyond_side) {
    return Error{ErrorCode::kUsage, "", option,
                 "the part is nearer to a cropped side of the scene than --clearance, and nothing "
                 "is known beyond this side",
                 "bake the scene with a larger --roi, or without --roi"};
  }
  const std::string object = voxcheck::shown_name(problem.scene, worst.worst.object);
  if (worst.object_inside) {
    return Error{ErrorCode::kUsage, "", option,
                 (object.empty() ? "an object" : object) + " lies inside the part at this pose",
                 "bake the scene without that object (--without), or check the pose"};
  }
  return Error{ErrorCode::kUsage, "", option,
               "the part is nearer to " + (object.empty() ? "the scene" : object) +
                   " than --clearance: only " +
                   command::length_text(std::max(0.0, worst.clearance_m)) + " are proven",
               "use a smaller --clearance, name this object in --allow, or bake with smaller "
               "voxels: the proven distance to an object of the seat is up to 1.7 voxels less than "
               "the true distance"};
}

// An error if the part cannot be at an end of its path: in its seat, or clear of everything. With
// `meshes` the meshes settle what the files refuse: then returns why they do.
Result<std::optional<Error>> check_end(const Problem& problem, const Pose& pose, const char* option,
                                       Rule rule, const Options& options,
                                       const exact::Meshes* meshes) {
  const std::vector<PathRow> rows = rows_of(problem, {}, {pose}, 1);
  auto checked = proven(problem, rows, rule, 1);
  if (!checked) return checked.error();
  std::optional<Error> by_files;
  if (!checked->seat_too_deep) by_files = refusal_of(problem, *checked, option);
  if (meshes != nullptr && (checked->seat_too_deep || by_files)) {
    auto exact = settled(problem, rows, options, *meshes);
    if (!exact) return exact.error();
    checked = std::move(exact->checked);
  }
  if (const auto warning =
          part_in_scene_warning(problem.scene, problem.part, pose, checked->seat_points)) {
    command::warn(*warning, options.quiet);
  }
  if (auto refusal = refusal_of(problem, *checked, option)) return *std::move(refusal);
  return by_files;
}

std::vector<std::uint32_t> numbers_of(const clearance::LeftOut& left_out) {
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t object = 0; object < left_out.size(); ++object) {
    if (left_out[object] != 0) numbers.push_back(object);
  }
  return numbers;
}

// The first of the worst poses of a path that is not proven clear, of the centroid frame.
Pose worst_pose(const Problem& problem, const std::vector<PathRow>& rows,
                const clearance::CheckResult& checked) {
  const clearance::CenterPath path(rows, problem.part);
  return path.world_from_center(path.at(checked.violations.front().worst.time_s));
}

// Whether the part moves in one direction and does not turn. Such a path is not made wider, which
// would bend it.
bool is_straight(const Problem& problem, const PlannedPath& path) {
  PosePath poses = path.in_seat;
  poses.insert(poses.end(), path.beyond.begin(), path.beyond.end());
  const double length_m = travel_between_m(problem, poses.front(), poses.back());
  const glm::dvec3 shift_m = poses.back().position_m - poses.front().position_m;
  if (!(length_m > 0) || !(glm::length(shift_m) > 0)) return false;
  return std::all_of(poses.begin(), poses.end(), [&](const Pose& pose) {
    const double fraction =
        glm::length(pose.position_m - poses.front().position_m) / glm::length(shift_m);
    const Pose on_line = pose_between(poses.front(), poses.back(), std::min(1.0, fraction));
    return travel_between_m(problem, on_line, pose) <= kRoundingM;
  });
}

// The seat by the meshes. Empty if the part starts clear of all objects.
Result<std::unique_ptr<exact::SeatMeshes>> seat_of(const Problem& problem, const Options& options,
                                                   const exact::Meshes& meshes) {
  const auto check = PoseCheck::create(problem);
  if (!check) return check.error();
  const std::vector<std::uint32_t> objects = (*check)->seat_objects();
  if (objects.empty()) return std::unique_ptr<exact::SeatMeshes>();
  auto seat = std::make_unique<exact::SeatMeshes>(meshes.scene, meshes.part, objects,
                                                  problem.world_from_start,
                                                  options.seat_depth_m.value_or(0));
  if (seat->never_settled().empty()) return seat;
  return Error{ErrorCode::kAnswerIsNo, options.part, "",
               "no path found: the part touches " +
                   voxcheck::listed_names(problem.scene, seat->never_settled()) +
                   ", and the meshes prove a path only if the part or the touched object is closed",
               "close all open edges of one of these meshes, or search without --exact"};
}

}  // namespace

Result<Plan> plan(const Problem& given, const Options& options, const exact::Meshes* meshes,
                  const std::function<void(double, double)>& progress) {
  Problem problem = given;
  const double begin_s = steady_s();
  if (meshes != nullptr) problem.seat_depth = clearance::SeatDepth::kOfMeshes;
  Plan made;
  if (meshes != nullptr && !options.world_from_goal) {
    const exact::Surface counts = exact::without(meshes->scene, numbers_of(problem.allowed));
    made.search.enclosed_by =
        exact::enclosing_object(counts, meshes->part, problem.world_from_start,
                                counts.deviation_m + meshes->part.deviation_m + kRoundingM);
    if (made.search.enclosed_by) {
      const exact::Surface around = exact::only(counts, {&*made.search.enclosed_by, 1});
      made.search.out_m = exact::farthest_straight_m(around, meshes->part, problem.world_from_start,
                                                     around.largest_m);
      made.search.blocked_by = {*made.search.enclosed_by};
      made.seconds = made.search.seconds = steady_s() - begin_s;
      return made;
    }
  }
  const auto start =
      check_end(problem, problem.world_from_start, "--seat", Rule::kInSeat, options, meshes);
  if (!start) return start.error();
  std::optional<Pose> end;
  if (options.world_from_goal) {
    end = *options.world_from_goal * part_from_center(problem.part);
    const double travel_m = glm::length(end->position_m - problem.world_from_start.position_m);
    if (!(travel_m <= kFarthestVoxels * problem.scene.voxel_size_m())) {
      return Error{ErrorCode::kUsage, "", "--goal", "is more than a million voxels from the seat",
                   "check the unit of --goal"};
    }
    const auto there = check_end(problem, *end, "--goal", Rule::kClear, options, meshes);
    if (!there) return there.error();
    if (*there) return **there;
  }
  const Destination goal =
      end ? Destination::at(problem, *end) : Destination::out_of_scene(problem);
  if (!goal.is_known()) {
    return Error{ErrorCode::kUsage, "", "--goal",
                 "is missing, and all sides of the scene are cropped, so nothing is known outside "
                 "of the scene",
                 "add --goal, or bake the scene without --roi"};
  }
  std::unique_ptr<exact::SeatMeshes> seat;
  if (meshes != nullptr) {
    auto read = seat_of(problem, options, *meshes);
    if (!read) return read.error();
    seat = std::move(*read);
    problem.seat_meshes = seat.get();
    if (seat != nullptr) made.overlaps = seat->overlaps();
  }
  SearchRequest request;
  request.seed = options.seed;
  request.threads = options.threads;
  request.max_s = options.max_s;
  request.progress = progress;
  // Whether the path is proven clear as a whole, as written.
  const auto is_proven = [&](const PlannedPath& path) -> Result<bool> {
    made.rows = rows_of(problem, path.in_seat, path.beyond, kSpeedMps);
    if (meshes != nullptr) {
      auto checked = settled(problem, made.rows, options, *meshes);
      if (!checked) return checked.error();
      made.checked = std::move(checked->checked);
      made.exact = std::move(checked->exact);
    } else {
      auto checked = proven(problem, made.rows, Rule::kInSeat, options.threads);
      if (!checked) return checked.error();
      made.checked = std::move(*checked);
    }
    return made.checked.clear();
  };
  request.unproven_at = [&](const PosePath& in_seat,
                            const PosePath& beyond) -> Result<std::optional<Pose>> {
    if (const PlannedPath path{in_seat, beyond}; is_straight(problem, path)) {
      const auto is_clear = is_proven(path);
      if (!is_clear) return is_clear.error();
      if (*is_clear) return std::optional<Pose>();
    }
    const auto wide = widened(problem, beyond, options.seed);
    if (!wide) return wide.error();
    const auto smooth = smoothed(problem, {in_seat, *wide});
    if (!smooth) return smooth.error();
    // If the smoothest variant is not proven clear as a whole, another may be.
    for (const PlannedPath& path : *smooth) {
      const auto is_clear = is_proven(path);
      if (!is_clear) return is_clear.error();
      if (*is_clear) return std::optional<Pose>();
    }
    return std::optional<Pose>(worst_pose(problem, made.rows, made.checked));
  };
  std::optional<StraightBlocks> straight;
  if (meshes != nullptr) {
    straight.emplace(problem, meshes->scene, meshes->part);
    request.straight_way = [&](const Pose& to) -> Result<StraightWay> {
      StraightBlock block = straight->along(to);
      if (!block.objects.empty()) return StraightWay{{}, false, block.at_m, block.objects};
      const auto is_free = is_proven({{}, {problem.world_from_start, to}});
      if (!is_free) return is_free.error();
      StraightWay way;
      way.is_proven = *is_free;
      way.clearance_m = std::numeric_limits<double>::infinity();
      for (const clearance::Violation& violation : made.checked.violations) {
        way.clearance_m =
            std::min(way.clearance_m, violation.of_distance() ? violation.clearance_m : 0.0);
        way.blocked_by.push_back(violation.worst.object);
        if (violation.out_of_time) continue;
        const double fraction = (violation.from_s - made.rows.front().time_s) /
                                (made.rows.back().time_s - made.rows.front().time_s);
        way.blocked_at_m = std::min(
            way.blocked_at_m, fraction * travel_between_m(problem, problem.world_from_start, to));
      }
      return way;
    };
    request.is_straight_only = start->has_value();
  }
  auto found = search(problem, goal, request);
  if (!found) return found.error();
  made.search = std::move(*found);
  if (request.is_straight_only && !made.search.found) return **start;
  if (!made.search.found) made.rows = rows_of(problem, {}, made.search.farthest, kSpeedMps);
  made.seconds = steady_s() - begin_s;
  return made;
}

}  // namespace forcelayer::voxplan
