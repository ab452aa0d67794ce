#include "workbench/exact/enclosure.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <map>
#include <vector>

#include "workbench/exact/body.h"
#include "workbench/exact/mesh_distance.h"
#include "workbench/exact/surface/shells.h"
#include "workbench/exact/watch.h"

namespace forcelayer::exact {
namespace {

struct Box {
  glm::dvec3 low_m{std::numeric_limits<double>::infinity()},
      high_m{-std::numeric_limits<double>::infinity()};
  void grow(const glm::dvec3& place_m) {
    low_m = glm::min(low_m, place_m), high_m = glm::max(high_m, place_m);
  }
  bool holds(const Box& other) const {
    return glm::all(glm::lessThan(low_m, other.low_m)) &&
           glm::all(glm::greaterThan(high_m, other.high_m));
  }
};

// The connected pieces of each object whose boxes hold that of the part: `object` is the number of
// the piece, and `object_of` says of which object it is.
struct Pieces {
  Surface surface;
  std::vector<std::uint32_t> object_of;
};

Pieces pieces_around(const Surface& scene, const Box& part) {
  const std::vector<std::uint32_t> piece_of = pieces_of(scene);
  std::map<std::uint32_t, Box> boxes;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    for (const auto corner : scene.triangles[t]) boxes[piece_of[t]].grow(scene.vertices_m[corner]);
  }
  Pieces pieces;
  pieces.surface.vertices_m = scene.vertices_m;
  pieces.surface.largest_m = scene.largest_m;
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    const std::uint32_t piece = piece_of[t];
    if (!boxes[piece].holds(part)) continue;
    const auto number = static_cast<std::uint32_t>(pieces.object_of.size());
    const auto [at, is_new] = numbers.try_emplace(piece, number);
    if (is_new) pieces.object_of.push_back(scene.object[t]);
    pieces.surface.triangles.push_back(scene.triangles[t]);
    pieces.surface.object.push_back(at->second);
  }
  return pieces;
}

// The objects whose boxes hold that of the part.
Surface objects_around(const Surface& scene, const Box& part) {
  std::map<std::uint32_t, Box> boxes;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    for (const auto corner : scene.triangles[t]) {
      boxes[scene.object[t]].grow(scene.vertices_m[corner]);
    }
  }
  std::vector<std::uint32_t> around;
  for (const auto& [object, box] : boxes) {
    if (box.holds(part)) around.push_back(object);
  }
  return around.empty() ? Surface() : only(scene, around);
}

// Within this of contact, m.
constexpr double kContactM = 1e-6;
constexpr int kMaxSteps = 10000;

double straight_m(const MeshPair& pair, const Pose& from, const glm::dvec3& direction,
                  double longest_m) {
  double travel_m = 0;
  for (int n = 0; n < kMaxSteps && travel_m < longest_m; ++n) {
    keep_going();
    const Pose pose{from.position_m + travel_m * direction, from.orientation};
    const double free_m = pair.at(pose, voxcheck::kNothingM).distance_m;
    if (free_m < kContactM) break;
    travel_m += free_m;
  }
  return std::min(travel_m, longest_m);
}

}  // namespace

std::optional<std::uint32_t> enclosing_object(const Surface& scene, const Surface& part,
                                              const Pose& world_from_center, double margin_m) {
  if (part.triangles.empty()) return std::nullopt;
  const auto placed = [&](std::uint32_t corner) {
    return world_from_center.position_m + world_from_center.orientation * part.vertices_m[corner];
  };
  Box box;
  for (const mesh::Triangle& t : part.triangles) {
    for (const auto corner : t) box.grow(placed(corner));
  }
  const Surface around = objects_around(scene, box);
  if (around.triangles.empty()) return std::nullopt;
  const Pieces pieces = pieces_around(around, box);
  const part::Vec3 place = vec3_of(placed(part.triangles.front()[0]));
  for (std::uint32_t n = 0; n < pieces.object_of.size(); ++n) {
    const Surface piece = only(pieces.surface, {&n, 1});
    const Bodies bodies = bodies_of(piece, widest_crack_m(piece));
    if (!are_solid(bodies) || bodies.front()->crack_m() > 0 || !bodies.front()->holds(place)) {
      continue;
    }
    const double apart_m =
        MeshPair(piece, part).at(world_from_center, voxcheck::kNothingM).distance_m;
    if (apart_m > margin_m) return pieces.object_of[n];
  }
  return std::nullopt;
}

double farthest_straight_m(const Surface& scene, const Surface& part, const Pose& world_from_center,
                           double longest_m) {
  const MeshPair pair(scene, part);
  double farthest_m = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      glm::dvec3 direction(0);
      direction[axis] = sign;
      farthest_m = std::max(farthest_m, straight_m(pair, world_from_center, direction, longest_m));
    }
  }
  return farthest_m;
}

}  // namespace forcelayer::exact
