#include "tests/stress/provable_distance.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <queue>
#include <vector>

namespace forcelayer::stress {
namespace {

constexpr int kWindow = 3;  // voxels around a place whose balls are looked at
constexpr double kToleranceVoxels = 0.01;

struct Ball {
  glm::dvec3 middle;
  double radius;
};

// A cube that may hold a place outside of all balls.
struct Cube {
  double distance = 0;  // of the cube from the origin
  glm::dvec3 middle{0};
  double half = kWindow;

  bool operator<(const Cube& other) const { return distance > other.distance; }
};

bool holds(const Ball& ball, const glm::dvec3& middle, double half) {
  const glm::dvec3 farthest = glm::abs(middle - ball.middle) + half;
  return glm::dot(farthest, farthest) <= ball.radius * ball.radius;
}

bool some_holds(const std::vector<Ball>& balls, const glm::dvec3& middle, double half) {
  return std::any_of(balls.begin(), balls.end(),
                     [&](const Ball& ball) { return holds(ball, middle, half); });
}

// The distance from the origin to the nearest place outside of all balls, or kWindow; less than
// that by at most the tolerance. Cubes are looked at in the order of their distance.
double distance_to_bare(const std::vector<Ball>& balls) {
  double bare = kWindow;
  std::priority_queue<Cube> cubes;
  cubes.push({});
  while (!cubes.empty()) {
    const Cube cube = cubes.top();
    cubes.pop();
    if (cube.distance >= bare - kToleranceVoxels) return cube.distance;
    if (some_holds(balls, cube.middle, cube.half)) continue;
    if (!some_holds(balls, cube.middle, 0)) bare = std::min(bare, glm::length(cube.middle));
    for (int n = 0; n < 8; ++n) {
      Cube part;
      part.half = cube.half / 2;
      for (int a = 0; a < 3; ++a) {
        part.middle[a] = cube.middle[a] + (n >> a & 1 ? part.half : -part.half);
      }
      part.distance = glm::length(glm::max(glm::abs(part.middle) - part.half, glm::dvec3(0)));
      if (part.distance < bare) cubes.push(part);
    }
  }
  return bare;
}

}  // namespace

ProvableDistance::ProvableDistance(const Voxmap& voxmap, const Pshell& shell)
    : voxmap_(voxmap), shell_(shell) {}

bool ProvableDistance::is_cropped(const glm::dvec3& voxel) const {
  const VoxmapHeader& h = voxmap_.header();
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const bool below = voxel[axis] < static_cast<double>(h.valid_min_voxel[a]);
    const bool above = voxel[axis] >= static_cast<double>(h.valid_max_voxel[a]);
    if (below && (h.cropped_sides >> (2 * a) & 1) != 0) return true;
    if (above && (h.cropped_sides >> (2 * a + 1) & 1) != 0) return true;
  }
  return false;
}

// The lower bound of a center: 0 where there is none.
double ProvableDistance::code_m(const glm::dvec3& voxel) const {
  if (is_cropped(voxel)) return 0;
  return std::max(0.0, voxmap_.min_distance_m(static_cast<std::int64_t>(voxel.x),
                                              static_cast<std::int64_t>(voxel.y),
                                              static_cast<std::int64_t>(voxel.z)));
}

// World places of all shell points.
std::vector<glm::dvec3> ProvableDistance::places_at(const Pose& world_from_part) const {
  const PshellView view = shell_.view();
  const auto& c = shell_.header().center_m;
  std::vector<glm::dvec3> places;
  for (std::uint64_t i = 0; i < view.point_count; ++i) {
    const glm::dvec3 in_part =
        glm::dvec3(c[0], c[1], c[2]) + glm::dvec3(view.x[i], view.y[i], view.z[i]);
    places.push_back(world_from_part.orientation * in_part + world_from_part.position_m);
  }
  return places;
}

bool ProvableDistance::touches_cropped_side(const Pose& world_from_part) const {
  if (voxmap_.header().cropped_sides == 0) return false;
  const auto places = places_at(world_from_part);
  return std::any_of(places.begin(), places.end(), [this](const glm::dvec3& place_m) {
    const glm::dvec3 low = glm::floor(place_m / voxmap_.voxel_size_m() - 0.5);
    return is_cropped(low) || is_cropped(low + 1.0);
  });
}

double ProvableDistance::by_cell_m(const glm::dvec3& world_m) const {
  const double s = voxmap_.voxel_size_m();
  const glm::dvec3 at = world_m / s - 0.5, low = glm::floor(at), t = at - low;
  double squared = -s * s * (t.x * (1 - t.x) + t.y * (1 - t.y) + t.z * (1 - t.z));
  for (int n = 0; n < 8; ++n) {
    const glm::ivec3 corner(n & 1, n >> 1 & 1, n >> 2);
    const glm::dvec3 fraction = glm::mix(1.0 - t, t, glm::dvec3(corner));
    const glm::dvec3 center = low + glm::dvec3(corner);
    const double min_m = code_m(center);
    squared += fraction.x * fraction.y * fraction.z * min_m * min_m;
  }
  return std::sqrt(std::max(0.0, squared));
}

double ProvableDistance::of_place_m(const glm::dvec3& world_m) const {
  const double s = voxmap_.voxel_size_m();
  const glm::dvec3 voxel = glm::floor(world_m / s);
  std::vector<Ball> balls;
  for (int x = -kWindow; x <= kWindow; ++x) {
    for (int y = -kWindow; y <= kWindow; ++y) {
      for (int z = -kWindow; z <= kWindow; ++z) {
        const glm::dvec3 center = voxel + glm::dvec3(x, y, z);
        const double radius_m = code_m(center);
        if (radius_m > 0) balls.push_back({center + 0.5 - world_m / s, radius_m / s});
      }
    }
  }
  // Large ones first: they hold most.
  std::sort(balls.begin(), balls.end(),
            [](const Ball& a, const Ball& b) { return a.radius > b.radius; });
  return distance_to_bare(balls) * s;
}

double ProvableDistance::of_part_m(const Pose& world_from_part) const {
  // Those that are nearest by the cells first: once these are farther, no other is nearer.
  std::vector<std::pair<double, glm::dvec3>> places;
  for (const glm::dvec3& place_m : places_at(world_from_part)) {
    places.emplace_back(by_cell_m(place_m), place_m);
  }
  std::sort(places.begin(), places.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  double min_m = 1e300;
  for (const auto& [by_cell, place_m] : places) {
    if (by_cell >= min_m) break;
    min_m = std::min(min_m, std::max(by_cell, of_place_m(place_m)));
  }
  const double proven_m = surface_distance_bound_m(shell_.surface_distance_terms(), min_m);
  return std::max(
      0.0, proven_m - voxmap_.header().static_deviation_m - shell_.header().part_deviation_m);
}

}  // namespace forcelayer::stress
