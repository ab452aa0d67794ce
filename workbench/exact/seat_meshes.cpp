#include "workbench/exact/seat_meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

namespace forcelayer::exact {
namespace {

constexpr std::size_t kMaxNormals = 8;    // of a surface: its flat sides by area
constexpr double kSameDirection = 1e-6;   // rad: directions nearer to each other are one
constexpr double kBlockedFraction = 0.5;  // resolution of the depth that tells which object blocks
constexpr double kMinCrossing = 1e-2;     // sine of the angle of two sides that meet in a line

double largest_m(const Surface& scene, const Surface& part, const Pose& installed) {
  double largest = std::max(scene.largest_m, part.largest_m);
  for (int axis = 0; axis < 3; ++axis) {
    largest = std::max(largest, std::abs(installed.position_m[axis]) + part.largest_m);
  }
  return largest;
}

void add(std::vector<glm::dvec3>& axes, const glm::dvec3& axis) {
  const bool is_known = std::any_of(axes.begin(), axes.end(), [&](const glm::dvec3& known) {
    return glm::length(glm::cross(known, axis)) < kSameDirection;
  });
  if (!is_known) axes.push_back(axis);
}

}  // namespace

void add_straight_axes(const Surface& surface, const glm::dquat& world_from_surface,
                       std::vector<glm::dvec3>& axes) {
  std::map<std::array<long long, 3>, std::pair<double, glm::dvec3>> sides;
  for (const mesh::Triangle& t : surface.triangles) {
    const glm::dvec3 &a = surface.vertices_m[t[0]], &b = surface.vertices_m[t[1]],
                     &c = surface.vertices_m[t[2]];
    glm::dvec3 normal = glm::cross(b - a, c - a);
    const double twice_area = glm::length(normal);
    if (!(twice_area > 0)) continue;
    normal /= twice_area;
    const int largest = std::abs(normal.x) > 0.6 ? 0 : std::abs(normal.y) > 0.6 ? 1 : 2;
    if (normal[largest] < 0) normal = -normal;
    std::array<long long, 3> key{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      key[axis] = std::llround(normal[static_cast<int>(axis)] / (16 * kSameDirection));
    }
    auto& [area, sum] = sides[key];
    area += twice_area;
    sum += twice_area * normal;
  }
  std::vector<std::pair<double, glm::dvec3>> by_area;
  for (const auto& [key, side] : sides) by_area.push_back(side);
  std::stable_sort(by_area.begin(), by_area.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  if (by_area.size() > kMaxNormals) by_area.resize(kMaxNormals);
  std::vector<glm::dvec3> normals;
  for (const auto& [area, sum] : by_area) {
    normals.push_back(world_from_surface * glm::normalize(sum));
  }
  for (const glm::dvec3& normal : normals) add(axes, normal);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const glm::dvec3 line = glm::cross(normals[i], normals[j]);
      if (glm::length(line) > kMinCrossing) add(axes, glm::normalize(line));
    }
  }
}

double seat_margin_m(const Bodies& part, const Bodies& object, double margin_m) {
  double crack_m = 0;
  for (const Bodies* bodies : {&part, &object}) {
    for (const auto& body : *bodies) crack_m = std::max(crack_m, body->crack_m());
  }
  return margin_m + 2 * crack_m;
}

struct SeatMeshes::Object {
  Object(std::uint32_t its_number, const Surface& surface, const Surface& part,
         const Bodies& part_bodies, const clearance::CenterPath& path, double rounding_m)
      : number(its_number),
        bodies(bodies_of(surface, widest_crack_m(surface))),
        distance(surface, part),
        deviations_m(rounding_m + surface.deviation_m + part.deviation_m),
        margin_m(seat_margin_m(part_bodies, bodies, deviations_m)),
        walk(path, part_bodies, bodies, distance, kSeatWithin * margin_m) {}

  std::uint32_t number;
  Bodies bodies;
  MeshPair distance;
  double deviations_m, margin_m, allowed_m = 0;
  SeatWalk walk;
};

SeatMeshes::SeatMeshes(const Surface& scene, const Surface& part,
                       std::span<const std::uint32_t> objects, const Pose& installed,
                       double depth_m)
    : path_(std::vector<PathRow>(1), glm::dvec3(0), 0),
      part_(bodies_of(part, widest_crack_m(part))) {
  const double rounding_m = kRounding * largest_m(scene, part, installed);
  std::vector<glm::dvec3> axes;
  add_straight_axes(part, installed.orientation, axes);
  for (const std::uint32_t number : objects) {
    const Surface surface = only(scene, {&number, 1});
    if (surface.triangles.empty()) continue;
    add_straight_axes(surface, {1, 0, 0, 0}, axes);
    auto object = std::make_unique<Object>(number, surface, part, part_, path_, rounding_m);
    const Depth depth = object->walk.at_pose(installed, std::nullopt);
    object->allowed_m = std::max(0.0, depth.found_m) + object->margin_m + depth_m;
    if (depth.found_m > object->margin_m) overlaps_.emplace_back(number, depth.found_m);
    if (!object->walk.is_settled() &&
        object->distance.at(installed, voxcheck::kNothingM).distance_m <= object->deviations_m) {
      never_settled_.push_back(number);
    }
    objects_.push_back(std::move(object));
  }
  for (const glm::dvec3& axis : axes) {
    directions_.push_back(axis);
    directions_.push_back(-axis);
  }
}

SeatMeshes::~SeatMeshes() = default;

// How much deeper than allowed it may be, which is not known `closely` where it is deeper; minus
// the distance where the two are apart.
double SeatMeshes::beyond_m(const Object& object, const Pose& world_from_center,
                            bool closely) const {
  if (!object.walk.is_settled()) {  // two open surfaces may not even meet
    const double apart_m = object.distance.at(world_from_center, voxcheck::kNothingM).distance_m;
    return apart_m > object.margin_m ? object.margin_m - apart_m : voxcheck::kNothingM;
  }
  Depth depth = object.walk.at_pose(world_from_center, object.allowed_m);
  if (depth.found_m > object.allowed_m && closely) {
    depth = object.walk.at_pose(world_from_center, std::nullopt, kBlockedFraction);
  }
  if (depth.at_most_m > object.allowed_m) return depth.at_most_m - object.allowed_m;
  return std::min(depth.at_most_m, 0.0);
}

double SeatMeshes::leeway_m(const Pose& world_from_center) const {
  double leeway_m = voxcheck::kNothingM;
  for (const auto& object : objects_) {
    leeway_m = std::min(leeway_m, -beyond_m(*object, world_from_center, false));
    if (leeway_m < 0) break;
  }
  return leeway_m;
}

double SeatMeshes::leeway_m(std::uint32_t object, const Pose& world_from_center) const {
  return -beyond_m(*find(object), world_from_center, false);
}

const SeatMeshes::Object* SeatMeshes::find(std::uint32_t number) const {
  const auto found = std::find_if(objects_.begin(), objects_.end(),
                                  [&](const auto& object) { return object->number == number; });
  return found == objects_.end() ? nullptr : found->get();
}

std::optional<std::uint32_t> SeatMeshes::blocked_by(const Pose& world_from_center) const {
  std::optional<std::uint32_t> deepest;
  double max_m = 0;
  for (const auto& object : objects_) {
    const double beyond = beyond_m(*object, world_from_center, true);
    if (beyond > max_m) deepest = object->number, max_m = beyond;
  }
  return deepest;
}

}  // namespace forcelayer::exact
