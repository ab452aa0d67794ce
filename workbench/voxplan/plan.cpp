#include "workbench/voxplan/plan.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "formats/command/report.h"
#include "formats/command/text.h"
#include "runtime/run/start_check.h"
#include "runtime/voxcheck/exact.h"
#include "runtime/voxcheck/object_names.h"
#include "runtime/voxcheck/words.h"
#include "workbench/voxplan/check/pose_check.h"
#include "workbench/voxplan/destination.h"
#include "workbench/voxplan/hand.h"
#include "workbench/voxplan/smooth/smoothed.h"
#include "workbench/voxplan/way.h"

namespace forcelayer::voxplan {
namespace {

constexpr double kFarthestVoxels = 1e6;  // of a goal: each voxel of a way is proven

// An error where the part cannot be at an end of its way: in its seat, or clear of everything.
Status check_end(const Problem& problem, const Pose& pose, const char* option, Rule rule,
                 bool quiet) {
  const auto checked = proven(problem, rows_of(problem, {}, {pose}, 1), rule, 1);
  if (!checked) return checked.error();
  if (const auto warning = part_in_scene_warning(problem.part, checked->seat_points)) {
    command::warn(*warning, quiet);
  }
  if (checked->clear()) return {};
  const clearance::Violation& worst = checked->violations.front();
  if (worst.worst.beyond_side) {
    return Error{ErrorCode::kUsage, "", option,
                 "the part is nearer there than --clearance to a cropped side of the scene, beyond "
                 "which nothing is known",
                 "bake the scene with a larger --roi, or without"};
  }
  const std::string object = voxcheck::object_name(problem.scene, worst.worst.object);
  if (worst.object_inside) {
    return Error{ErrorCode::kUsage, "", option,
                 (object.empty() ? "an object" : escaped(object)) + " lies inside the part there",
                 "bake the scene without it (--without), or check the pose"};
  }
  return Error{ErrorCode::kUsage, "", option,
               command::text("the part is nearer there than --clearance to %s: %.3f mm are proven",
                             object.empty() ? "the scene" : escaped(object).c_str(),
                             std::floor(1e6 * std::max(0.0, worst.clearance_m)) / 1e3),
               "ask for a smaller --clearance, --allow that object, or bake with smaller voxels: "
               "beside objects of the seat up to 1.7 voxels less are proven"};
}

// Where a path that does not prove clear is worst, first: of the centroid frame.
Pose worst_pose(const Problem& problem, const std::vector<PathRow>& rows,
                const clearance::CheckResult& checked) {
  const clearance::CenterPath path(rows, problem.part);
  return path.world_from_center(path.at(checked.violations.front().worst.time_s));
}

// The seat by the meshes. None where the part starts clear of all objects.
Result<std::unique_ptr<exact::SeatMeshes>> seat_of(const Problem& problem, const Options& options,
                                                   const exact::Meshes& meshes) {
  const auto check = PoseCheck::create(problem);
  if (!check) return check.error();
  const std::vector<std::uint32_t> objects = (*check)->seat_objects();
  if (objects.empty()) return std::unique_ptr<exact::SeatMeshes>();
  auto seat = std::make_unique<exact::SeatMeshes>(
      meshes.scene, meshes.part, problem.scene.voxel_size_m(), objects, problem.world_from_start,
      options.seat_depth_m.value_or(0));
  if (seat->never_settled().empty()) return seat;
  return Error{ErrorCode::kAnswerIsNo, options.part, "",
               "no path found: the part touches " +
                   voxcheck::listed_names(problem.scene, seat->never_settled()) +
                   ", and neither mesh is closed, so the meshes settle no path",
               "close one of the meshes, or search without --exact"};
}

// The verdict of voxcheck --exact on a path.
Result<clearance::CheckResult> settled(const Problem& problem, const std::vector<PathRow>& rows,
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
  auto checked = voxcheck::check_with_meshes(
      problem.scene, problem.part, clearance::CenterPath(rows, problem.part), request, asked,
      [&](const auto& question) { return exact::check_exactly(meshes, rows, question); });
  if (!checked) return checked.error();
  return std::move(checked->checked);
}

}  // namespace

Result<Plan> plan(const Problem& given, const Options& options, const exact::Meshes* meshes,
                  const std::function<void(double, double)>& progress) {
  Problem problem = given;
  const double begin_s = steady_s();
  const bool quiet = options.quiet;
  if (Status s = check_end(problem, problem.world_from_start, "--seat", Rule::kInSeat, quiet); !s) {
    return s.error();
  }
  std::optional<Pose> end;
  if (options.world_from_goal) {
    end = *options.world_from_goal * part_from_center(problem.part);
    const double way_m = glm::length(end->position_m - problem.world_from_start.position_m);
    if (!(way_m <= kFarthestVoxels * problem.scene.voxel_size_m())) {
      return Error{ErrorCode::kUsage, "", "--goal", "is more than a million voxels from the seat",
                   "check its unit"};
    }
    if (Status s = check_end(problem, *end, "--goal", Rule::kClear, quiet); !s) return s.error();
  }
  const Destination goal =
      end ? Destination::at(problem, *end) : Destination::out_of_scene(problem);
  if (!goal.is_known()) {
    return Error{ErrorCode::kUsage, "", "--goal",
                 "is missing, and all sides of the scene are cropped: beyond them nothing is known",
                 "give it, or bake the scene without --roi"};
  }
  std::unique_ptr<exact::SeatMeshes> seat;
  if (meshes != nullptr) {
    auto read = seat_of(problem, options, *meshes);
    if (!read) return read.error();
    seat = std::move(*read);
    problem.seat_meshes = seat.get();
  }
  Plan made;
  SearchRequest request;
  request.seed = options.seed;
  request.threads = options.threads;
  request.max_s = options.max_s;
  request.progress = progress;
  request.unproven_at = [&](const Way& in_seat, const Way& beyond) -> Result<std::optional<Pose>> {
    const auto wide = widened(problem, beyond, options.seed);
    if (!wide) return wide.error();
    const auto smooth = smoothed(problem, {in_seat, *wide});
    if (!smooth) return smooth.error();
    // Should the smoothest not prove clear as a whole, another may.
    for (const WholeWay& way : *smooth) {
      made.rows = rows_of(problem, way.in_seat, way.beyond, options.speed_mps);
      auto checked = meshes != nullptr ? settled(problem, made.rows, options, *meshes)
                                       : proven(problem, made.rows, Rule::kInSeat, options.threads);
      if (!checked) return checked.error();
      made.checked = std::move(*checked);
      if (made.checked.clear()) return std::optional<Pose>();
    }
    return std::optional<Pose>(worst_pose(problem, made.rows, made.checked));
  };
  auto found = search(problem, goal, request);
  if (!found) return found.error();
  made.search = std::move(*found);
  made.seconds = steady_s() - begin_s;
  return made;
}

}  // namespace forcelayer::voxplan
