#include "workbench/voxplan/check/straight_blocks.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vector_relational.hpp>
#include <utility>

#include "workbench/exact/watch.h"

namespace forcelayer::voxplan {
namespace {

// The least step, as a fraction of the way. Steps are shorter near its beginning, in the seat.
constexpr double kMaxStep = 1.0 / 32, kMinStep = 0x1p-20;
constexpr int kBisections = 12;  // of the last step
// Fractions of the way, for a quick look. Where a part is deep in an object, that is seen at once.
constexpr double kLooks[] = {1.0 / 2, 1.0 / 4, 1.0 / 8, 1.0 / 32, 1.0 / 128, 3.0 / 4};

// A depth near the allowed one takes longest. After so many questions of a Watch it is given up.
constexpr int kMaxAsked = 500;

constexpr double kFar = std::numeric_limits<double>::infinity();

}  // namespace

StraightBlocks::StraightBlocks(const Problem& problem, const exact::Surface& scene,
                               const exact::Surface& part)
    : problem_(problem),
      scene_(scene),
      part_box_{glm::dvec3(kFar), glm::dvec3(-kFar)},
      part_mesh_(exact::MeshPair::mesh_of(part)) {
  const Pose& start = problem.world_from_start;
  double largest_m = std::max(scene.largest_m, part.largest_m);
  for (int axis = 0; axis < 3; ++axis) {
    largest_m = std::max(largest_m, std::abs(start.position_m[axis]) + part.largest_m);
  }
  near_m_ =
      problem.clearance_m - exact::kRounding * largest_m - scene.deviation_m - part.deviation_m;
  for (const glm::dvec3& vertex_m : part.vertices_m) {
    const glm::dvec3 place_m = start.position_m + start.orientation * vertex_m;
    part_box_.low_m = glm::min(part_box_.low_m, place_m);
    part_box_.high_m = glm::max(part_box_.high_m, place_m);
  }
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    const std::uint32_t object = scene.object[t];
    if (object < problem.allowed.size() && problem.allowed[object] != 0) continue;
    Box& box = objects_.try_emplace(object, Box{glm::dvec3(kFar), glm::dvec3(-kFar)}).first->second;
    for (const auto corner : scene.triangles[t]) {
      box.low_m = glm::min(box.low_m, scene.vertices_m[corner]);
      box.high_m = glm::max(box.high_m, scene.vertices_m[corner]);
    }
  }
}

// Whether the box through which the part's box moves is as near to the object's as the clearance.
bool StraightBlocks::may_meet(std::uint32_t object, const Pose& end) const {
  const Box& box = objects_.at(object);
  const glm::dvec3 shift_m = end.position_m - problem_.world_from_start.position_m;
  const glm::dvec3 low_m =
      glm::min(part_box_.low_m, part_box_.low_m + shift_m) - problem_.clearance_m;
  const glm::dvec3 high_m =
      glm::max(part_box_.high_m, part_box_.high_m + shift_m) + problem_.clearance_m;
  return glm::all(glm::lessThanEqual(low_m, box.high_m)) &&
         glm::all(glm::lessThanEqual(box.low_m, high_m));
}

// How far each point of the part may travel until this object is in the way; negative where it is.
// 0 where a depth takes too long.
double StraightBlocks::leeway_m(std::uint32_t object, const Pose& world_from_center) {
  if (is_of_seat(object)) {
    int asked = 0;
    const exact::Watch watch([&] { return ++asked < kMaxAsked; });
    try {
      return problem_.seat_meshes->leeway_m(object, world_from_center);
    } catch (const exact::Stopped&) {
      return 0;
    }
  }
  auto pair = pairs_.find(object);
  if (pair == pairs_.end()) {
    const exact::Surface surface = exact::only(scene_, {&object, 1});
    pair = pairs_.emplace(object, exact::MeshPair(exact::MeshPair::mesh_of(surface), part_mesh_))
               .first;
  }
  const double distance_m = pair->second.at(world_from_center, voxcheck::kNothingM).distance_m;
  return distance_m > 0 ? distance_m - near_m_ : -1;
}

// Where this object is first seen in the way; infinite where it is not.
double StraightBlocks::first_m(std::uint32_t object, const Pose& end) {
  exact::keep_going();
  const Pose& start = problem_.world_from_start;
  const double way_m = travel_between_m(problem_, start, end);
  const auto leeway_at_m = [&](double fraction) {
    return leeway_m(object, pose_between(start, end, fraction));
  };
  double free = 0, at = 0;  // fractions of the way
  for (double free_m = leeway_at_m(0); free_m >= 0;) {
    if (at >= 1) return kFar;
    free = at;
    at = std::min(1.0, at + std::max(free_m / way_m, std::clamp(at, kMinStep, kMaxStep)));
    free_m = leeway_at_m(at);
  }
  return first_between_m(object, end, free, at);
}

// A place where this object is in the way, as if it were from the first one on.
double StraightBlocks::about_first_m(std::uint32_t object, const Pose& end) {
  for (const double look : kLooks) {
    exact::keep_going();
    const Pose there = pose_between(problem_.world_from_start, end, look);
    if (leeway_m(object, there) < 0) return first_between_m(object, end, 0, look);
  }
  return kFar;
}

// Between two fractions of the way, of which the second is blocked.
double StraightBlocks::first_between_m(std::uint32_t object, const Pose& end, double free,
                                       double blocked) {
  const Pose& start = problem_.world_from_start;
  for (int n = 0; n < kBisections && blocked > free; ++n) {
    // Near its beginning a way ends at less than a thousandth of it.
    const double middle = free > 0 || n > 0 ? (free + blocked) / 2 : std::min(kMinStep, blocked);
    (leeway_m(object, pose_between(start, end, middle)) < 0 ? blocked : free) = middle;
  }
  return blocked * travel_between_m(problem_, start, end);
}

StraightBlock StraightBlocks::along(const Pose& end) {
  std::vector<std::pair<double, std::uint32_t>> met;
  std::vector<std::uint32_t> slow;
  const auto add = [&](double at_m, std::uint32_t object) {
    if (at_m < kFar) met.emplace_back(at_m, object);
  };
  for (const auto& [object, box] : objects_) {
    if (!may_meet(object, end)) continue;
    if (is_of_seat(object)) {
      slow.push_back(object);
    } else {
      add(first_m(object, end), object);
    }
  }
  for (const std::uint32_t object : slow) add(about_first_m(object, end), object);
  if (met.empty()) {
    for (const std::uint32_t object : slow) add(first_m(object, end), object);
  }
  std::sort(met.begin(), met.end());
  StraightBlock block;
  if (!met.empty()) block.at_m = met.front().first;
  for (const auto& [at_m, object] : met) block.objects.push_back(object);
  return block;
}

}  // namespace forcelayer::voxplan
