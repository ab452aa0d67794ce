#include "tests/bench/query_bench_setting.h"

#include <cmath>
#include <functional>
#include <glm/gtc/quaternion.hpp>
#include <random>
#include <stdexcept>

#include "pointshell/sample/order.h"
#include "tests/stress/shapes.h"
#include "tests/support/point_part.h"

namespace forcelayer::bench {
namespace {

using stress::append;
using stress::box;

constexpr double kS = kVoxelSizeM;
constexpr double kPointsPerVoxelArea = 0.63;
constexpr double kWallTop = 0.5 * kS;  // the middle of a voxel: its layer is [2, 3) voxels
constexpr double kLayerMiddle = 2.5 * kS;
constexpr double kGrowth = 2 * kS;  // from a mesh to the middle of its force layer
constexpr double kMeshDeviation = 0.1 * kS;
constexpr double kRoom = 60 * kS;  // of a wall beyond the part
constexpr double kThick = 8 * kS;

Pshell sphere_shell(std::size_t points, double radius_m) {
  const test::PointPart spiral = test::sphere_part(radius_m, points, kS);
  std::vector<part::Vec3> places;
  for (const auto& p : spiral.points) places.push_back({p[0], p[1], p[2]});
  const auto order = sample::block_order(places, kDefaultBlockPoints, kDefaultSuperBlockBlocks);
  test::PointPart part = spiral;
  for (std::size_t i = 0; i < points; ++i) {
    part.points[i] = spiral.points[order[i]];
    part.normals[i] = spiral.normals[order[i]];
  }
  return test::make_pshell(part);
}

// Segments of a circle whose chords stay within kMeshDeviation.
int segments_of(double radius_m) {
  const double angle = 2 * std::acos(1 - std::min(0.5, kMeshDeviation / radius_m));
  return std::max(12, static_cast<int>(std::ceil(2 * M_PI / angle)));
}

mesh::Mesh boxed(const glm::dvec3& low, const glm::dvec3& high) {
  mesh::Mesh mesh;
  append(mesh, box((high - low) / 2.0), Pose{(high + low) / 2.0, {1, 0, 0, 0}});
  return mesh;
}

// The walls of which the part touches up to three, their faces at `face`.
mesh::Mesh walls(int count, double radius_m, double face) {
  const double far = 2 * radius_m + kRoom, low = face - kThick;
  mesh::Mesh mesh;
  if (count == 1) return boxed({-far / 2, -far / 2, low}, {far / 2, far / 2, face});
  append(mesh, boxed({low, low, low}, {far, far, face}));
  append(mesh, boxed({low, low, low}, {far, face, far}));
  append(mesh, boxed({low, low, low}, {face, far, far}));
  return mesh;
}

mesh::Mesh post(double face) {
  return boxed({-16 * kS, -16 * kS, face - 64 * kS}, {16 * kS, 16 * kS, face});
}

mesh::Mesh bore(double radius_m) {
  return stress::tube(radius_m, radius_m + kThick, 0.3 * radius_m + kRoom, segments_of(radius_m));
}

// A hollow sphere.
mesh::Mesh cavity(double radius_m) {
  mesh::Mesh mesh = stress::sphere(radius_m + kThick, segments_of(radius_m));
  mesh::Mesh inner = stress::sphere(radius_m, segments_of(radius_m));
  for (mesh::Triangle& t : inner.triangles) std::swap(t[1], t[2]);
  append(mesh, inner);
  return mesh;
}

glm::dquat turning(double frame) {
  return glm::angleAxis(0.0005 * frame, glm::normalize(glm::dvec3(0.3, 1, 0.2)));
}

// To and fro over `reach` at 50 mm/s.
double to_and_fro(double frame, double reach) {
  const double phase = std::fmod(0.00005 * frame, 4 * reach);
  return std::abs(phase - 2 * reach) - reach;
}

// Up to half a voxel about the middle of the force layer.
double breathing(double frame) { return 0.5 * kS * std::sin(0.01 * frame); }

}  // namespace

SpherePart::SpherePart(std::size_t points)
    : radius_m(kS * std::sqrt(double(points) / (4 * M_PI * kPointsPerVoxelArea))),
      shell(sphere_shell(points, radius_m)) {}

mesh::Mesh sphere_mesh(double radius_m) { return stress::sphere(radius_m, segments_of(radius_m)); }

Setting make_setting(const std::string& name, double radius_m, std::size_t frames) {
  Setting setting;
  setting.name = name;
  const double held = kLayerMiddle + radius_m;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  // The part's place at a frame; the turning is common to all but one.
  std::function<glm::dvec3(double)> place;
  if (name == "free space") {
    setting.scene = walls(1, radius_m, kWallTop);
    setting.grown = walls(1, radius_m, kWallTop + kGrowth);
    place = [=](double f) {
      return glm::dvec3(to_and_fro(f, 25 * kS), 3 * kS, held + 50 * kS + breathing(f));
    };
  } else if (name == "wall") {
    setting.scene = walls(1, radius_m, kWallTop);
    setting.grown = walls(1, radius_m, kWallTop + kGrowth);
    place = [=](double f) {
      return glm::dvec3(to_and_fro(f, 25 * kS), 3 * kS, held + breathing(f));
    };
  } else if (name == "corner") {
    setting.scene = walls(3, radius_m, kWallTop);
    setting.grown = walls(3, radius_m, kWallTop + kGrowth);
    place = [=](double f) {
      return glm::dvec3(held + breathing(f), held + breathing(1.3 * f), held + breathing(0.7 * f));
    };
  } else if (name == "tight fit") {
    setting.scene = bore(radius_m + 2.6 * kS);
    setting.grown = bore(radius_m + 0.6 * kS);
    place = [=](double f) {
      return glm::dvec3(0.5 * breathing(f), 0.5 * breathing(1.3 * f), to_and_fro(f, 25 * kS));
    };
  } else if (name == "everything" || name == "tumbling") {
    setting.scene = cavity(radius_m + 3 * kS);
    setting.grown = cavity(radius_m + 1 * kS);
    place = [=](double f) { return 0.5 * glm::dvec3(breathing(f), breathing(1.3 * f), 0); };
  } else if (name == "post") {
    setting.scene = post(kWallTop);
    setting.grown = post(kWallTop + kGrowth);
    place = [=](double f) {
      return glm::dvec3(to_and_fro(f, 8 * kS), 3 * kS, held + breathing(f));
    };
  } else {
    throw std::runtime_error("no setting '" + name + "'");
  }
  for (std::size_t i = 0; i < frames; ++i) {
    const auto frame = static_cast<double>(i);
    Pose pose{place(frame), turning(frame)};
    if (name == "tumbling") {
      pose.orientation = glm::normalize(
          glm::dquat(normal(random), normal(random), normal(random), normal(random)));
    }
    setting.poses.push_back(pose);
  }
  return setting;
}

}  // namespace forcelayer::bench
