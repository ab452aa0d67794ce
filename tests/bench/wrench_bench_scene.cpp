#include "tests/bench/wrench_bench_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "tests/support/distance_scene.h"
#include "tests/support/shape_scene.h"

namespace forcelayer::bench {
namespace {

// Whether the half-plane n . p = 0, u . p >= 0 (through the origin) meets the cube: the largest
// u . p over cube and plane, by duality the least support of u - l n over its breakpoints.
bool half_plane_meets(const glm::dvec3& c, double half, const glm::dvec3& n, const glm::dvec3& u) {
  if (std::abs(glm::dot(n, c)) > half * norm1(n)) return false;
  double smallest = 1e300;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(n[axis]) < 1e-12) continue;
    const glm::dvec3 w = u - (u[axis] / n[axis]) * n;
    smallest = std::min(smallest, glm::dot(w, c) + half * norm1(w));
  }
  return smallest >= 0;
}

// Least and largest distance of the cube from the line through the origin along `axes[2]`.
std::array<double, 2> distances_from_axis(const glm::dmat3& axes, const glm::dvec3& c,
                                          double half) {
  const glm::dvec2 center(glm::dot(axes[0], c), glm::dot(axes[1], c));
  std::array<glm::dvec2, 3> edge{};
  for (int i = 0; i < 3; ++i) edge[i] = half * glm::dvec2(axes[0][i], axes[1][i]);
  const auto corner = [&](int mask) {
    glm::dvec2 at = center;
    for (int i = 0; i < 3; ++i) at += (mask >> i & 1) ? edge[i] : -edge[i];
    return at;
  };
  double smallest = 1e300, largest = 0;
  for (int mask = 0; mask < 8; ++mask) {
    const glm::dvec2 a = corner(mask);
    largest = std::max(largest, glm::length(a));
    for (int i = 0; i < 3; ++i) {
      if (mask >> i & 1) continue;
      const glm::dvec2 d = corner(mask | 1 << i) - a;
      const double length2 = glm::dot(d, d);
      const double t = length2 > 0 ? std::clamp(-glm::dot(a, d) / length2, 0.0, 1.0) : 0;
      smallest = std::min(smallest, glm::length(a + t * d));
    }
  }
  bool holds_axis = true;
  for (const glm::dvec2& e : edge) {
    const glm::dvec2 across(-e.y, e.x);
    double reach = 0;
    for (const glm::dvec2& other : edge) reach += std::abs(glm::dot(across, other));
    holds_axis = holds_axis && std::abs(glm::dot(across, center)) <= reach;
  }
  return {holds_axis ? 0 : smallest, largest};
}

}  // namespace

glm::dvec3 AnalyticStatic::wall_normal(int wall) const {
  const double side = wall == 0 ? 1 : -1;
  return rotation * glm::dvec3(-side * std::cos(free_angle / 2), 0, std::sin(free_angle / 2));
}

double AnalyticStatic::distance_m(const glm::dvec3& x, glm::dvec3* gradient) const {
  const glm::dvec3 q = glm::transpose(rotation) * (x - origin_m);
  double distance = 0;
  glm::dvec3 g(0);
  if (kind == StaticKind::kPlane) {
    distance = q.z, g = {0, 0, 1};
  } else if (kind == StaticKind::kSphere) {
    const double r = glm::length(q);
    distance = r - radius_m, g = q / r;
  } else if (kind == StaticKind::kBore) {
    const double r = std::hypot(q.x, q.y);
    distance = radius_m - r, g = glm::dvec3(-q.x, -q.y, 0) / std::max(r, 1e-12);
  } else if (wall_shift_m != glm::dvec2(0)) {
    const double a = glm::dot(wall_normal(0), x - origin_m) + wall_shift_m[0];
    const double b = glm::dot(wall_normal(1), x - origin_m) + wall_shift_m[1];
    if (gradient != nullptr) *gradient = wall_normal(a < b ? 0 : 1);
    return std::min(a, b);
  } else {
    const double side = q.x < 0 ? -1 : 1;
    const glm::dvec2 p(side * q.x, q.z);
    const glm::dvec2 wall(std::sin(free_angle / 2), std::cos(free_angle / 2));
    const glm::dvec2 away = p - std::max(0.0, glm::dot(p, wall)) * wall;
    const double sign = std::atan2(p.x, p.y) < free_angle / 2 ? 1 : -1;
    distance = sign * glm::length(away);
    const glm::dvec2 d = away / std::max(glm::length(away), 1e-300) * sign;
    g = {side * d.x, 0, d.y};
  }
  if (gradient != nullptr) *gradient = rotation * g;
  return distance;
}

bool AnalyticStatic::meets_cube(const glm::dvec3& center, double half) const {
  const glm::dvec3 c = center - origin_m;
  if (kind == StaticKind::kPlane) {
    return std::abs(glm::dot(rotation[2], c)) <= half * norm1(rotation[2]);
  }
  if (kind == StaticKind::kSphere) {
    const glm::dvec3 a = glm::abs(c);
    return glm::length(glm::max(a - half, glm::dvec3(0))) <= radius_m &&
           glm::length(a + half) >= radius_m;
  }
  if (kind == StaticKind::kBore) {
    const auto [smallest, largest] = distances_from_axis(rotation, c, half);
    return smallest <= radius_m && largest >= radius_m;
  }
  for (const double side : {1.0, -1.0}) {
    const glm::dvec3 along(side * std::sin(free_angle / 2), 0, std::cos(free_angle / 2));
    const glm::dvec3 normal(side * std::cos(free_angle / 2), 0, -std::sin(free_angle / 2));
    if (half_plane_meets(c, half, rotation * normal, rotation * along)) return true;
  }
  return false;
}

namespace {

// How far the centers of the interior's voxels are from the surface with Euclidean layers
// (voxmap_format.md, section 5).
double interior_radius_voxels(int layers) { return layers - 1 + 888.0 / 1024; }

}  // namespace

double zero_force_voxels(VoxelKind kind, int layers, const glm::dvec3& n) {
  if (kind == VoxelKind::kChebyshev) return layers * norm1(n);
  if (kind == VoxelKind::kLean) return interior_radius_voxels(layers) + std::sqrt(3.0) / 2;
  return test::DistanceDefinition(static_cast<std::uint32_t>(layers)).zero_force;
}

namespace {

// The box of voxels around [low, high].
void box_around(const glm::dvec3& low, const glm::dvec3& high, double s, int pad, test::Voxel& min,
                test::Voxel& dims) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    min[i] = static_cast<std::int64_t>(std::floor(low[axis] / s)) - pad;
    dims[i] = static_cast<std::int64_t>(std::floor(high[axis] / s)) + pad + 1 - min[i];
  }
}

test::VoxelScene bake_euclidean(const AnalyticStatic& body, double s, int layers,
                                const glm::dvec3& low, const glm::dvec3& high) {
  test::Voxel min{}, dims{};
  box_around(low, high, s, layers + 3, min, dims);
  test::VoxelScene scene = test::VoxelScene::filled(s, min, dims, [&](test::Voxel v) {
    const glm::dvec3 c = (glm::dvec3(v[0], v[1], v[2]) + 0.5) * s;
    const bool near = body.distance_m(c) < interior_radius_voxels(layers) * s;
    return near ? VoxelValue::kInterior : VoxelValue::kFree;
  });
  scene.layers = static_cast<std::uint32_t>(layers);
  scene.metric = Metric::kEuclidean;
  for (const VoxelValue value : {VoxelValue::kSurface, VoxelValue::kProximity}) {
    const std::vector<std::uint8_t> grown = test::grown(scene.values, dims);
    for (std::size_t i = 0; i < grown.size(); ++i) {
      if (grown[i] && scene.values[i] == 0) scene.values[i] = static_cast<std::uint8_t>(value);
    }
  }
  return scene;
}

}  // namespace

test::VoxelScene bake(VoxelKind kind, const AnalyticStatic& body, double s, int layers,
                      const glm::dvec3& low, const glm::dvec3& high) {
  if (kind == VoxelKind::kChebyshev) return bake(body, s, layers, low, high);
  if (kind == VoxelKind::kLean) return bake_euclidean(body, s, layers, low, high);
  test::Voxel min{}, dims{};
  box_around(low, high, s, layers + 5, min, dims);
  const auto k = static_cast<std::uint32_t>(layers);
  return test::distance_scene(
      s, min, dims, [&](const glm::dvec3& p) { return body.distance_m(p); }, k,
      test::DistanceDefinition(k));
}

test::VoxelScene bake(const AnalyticStatic& body, double s, int layers, const glm::dvec3& low,
                      const glm::dvec3& high) {
  const int pad = layers + 3;
  test::Voxel min{}, dims{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    min[i] = static_cast<std::int64_t>(std::floor(low[axis] / s)) - pad;
    dims[i] = static_cast<std::int64_t>(std::floor(high[axis] / s)) + pad + 1 - min[i];
  }
  constexpr std::uint8_t kFar = 255, kInside = 254;
  std::vector<std::uint8_t> steps;  // Chebyshev distance from the geometric surface
  test::VoxelScene scene = test::VoxelScene::filled(s, min, dims, [&](test::Voxel v) {
    const glm::dvec3 c = (glm::dvec3(v[0], v[1], v[2]) + 0.5) * s;
    const double distance = body.distance_m(c);
    const bool marked = std::abs(distance) < 0.8661 * s && body.meets_cube(c, s / 2);
    steps.push_back(marked ? 0 : distance < 0 ? kInside : kFar);
    return VoxelValue::kFree;
  });
  scene.layers = static_cast<std::uint32_t>(layers);
  for (int reach = 1; reach <= layers + 1; ++reach) {
    std::vector<std::uint8_t> near(steps.size());
    for (std::size_t i = 0; i < steps.size(); ++i) near[i] = steps[i] < reach;
    near = test::grown(near, dims);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      if (near[i] && steps[i] == kFar) steps[i] = static_cast<std::uint8_t>(reach);
    }
  }
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const int c = steps[i];
    const VoxelValue value = c == kInside || c < layers ? VoxelValue::kInterior
                             : c == layers              ? VoxelValue::kSurface
                             : c == layers + 1          ? VoxelValue::kProximity
                                                        : VoxelValue::kFree;
    scene.values[i] = static_cast<std::uint8_t>(value);
  }
  return scene;
}

DenseFields::DenseFields(const AnalyticStatic& body, const test::VoxelScene& values)
    : scene(values) {
  test::VoxelScene::filled(scene.voxel_size_m, scene.min, scene.dims, [&](test::Voxel v) {
    const glm::dvec3 c = (glm::dvec3(v[0], v[1], v[2]) + 0.5) * scene.voxel_size_m;
    distance_m.push_back(static_cast<float>(body.distance_m(c)));
    return VoxelValue::kFree;
  });
}

std::size_t DenseFields::index(glm::ivec3 voxel) const {
  std::int64_t at = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    at = at * scene.dims[i] +
         std::clamp<std::int64_t>(voxel[axis] - scene.min[i], 0, scene.dims[i] - 1);
  }
  return static_cast<std::size_t>(at);
}

float DenseFields::distance_at(const glm::ivec3& voxel) const { return distance_m[index(voxel)]; }

}  // namespace forcelayer::bench
