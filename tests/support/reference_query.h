// Slow twins of the contact query. `float_twin` follows the query's arithmetic word by word,
// without its tree; `double_twin` does what the design means, in double precision.
#pragma once

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "forcelayer/pose.h"
#include "tests/support/point_part.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::test {

struct TwinPoint {
  std::uint32_t index;
  VoxelValue value;
  Voxel voxel;                    // world index
  std::array<float, 3> fraction;  // of float_twin
  std::array<float, 3> offset_m;  // of float_twin: from the center, world axes
  std::array<float, 3> normal;    // of float_twin: world axes
  glm::dvec3 exact_fraction;      // of double_twin
  glm::dvec3 exact_offset_m;      // of double_twin
  glm::dvec3 exact_normal;        // of double_twin
};

// Every point in values 1, 2 and 3, in single precision about the center.
inline std::vector<TwinPoint> float_twin(const VoxelScene& scene, const PointPart& part,
                                         const Pose& world_from_center) {
  const glm::dmat3 r = glm::mat3_cast(world_from_center.orientation);
  const double s = scene.voxel_size_m;
  std::vector<TwinPoint> found;
  for (std::uint32_t i = 0; i < part.points.size(); ++i) {
    TwinPoint twin{};
    twin.index = i;
    const auto& p = part.points[i];
    const auto& n = part.normals[i];
    for (int axis = 0; axis < 3; ++axis) {
      const float row[3] = {static_cast<float>(r[0][axis]), static_cast<float>(r[1][axis]),
                            static_cast<float>(r[2][axis])};
      const float turn[3] = {static_cast<float>(r[0][axis] / s), static_cast<float>(r[1][axis] / s),
                             static_cast<float>(r[2][axis] / s)};
      const double center = world_from_center.position_m[axis] / s;
      const float offset = turn[0] * p[0] + turn[1] * p[1] + turn[2] * p[2];
      const float position = offset + static_cast<float>(center - std::floor(center));
      twin.voxel[axis] = static_cast<std::int64_t>(std::floor(center)) +
                         static_cast<std::int64_t>(std::floor(position));
      twin.fraction[axis] = std::min(position - std::floor(position), std::nextafter(1.0f, 0.0f));
      twin.offset_m[axis] = offset * static_cast<float>(s);
      twin.normal[axis] = row[0] * n[0] + row[1] * n[1] + row[2] * n[2];
    }
    twin.value = scene.at(twin.voxel);
    if (twin.value != VoxelValue::kFree) found.push_back(twin);
  }
  return found;
}

// Every point, whatever its value, in double precision.
inline std::vector<TwinPoint> double_twin(const VoxelScene& scene, const PointPart& part,
                                          const Pose& world_from_center) {
  std::vector<TwinPoint> all;
  for (std::uint32_t i = 0; i < part.points.size(); ++i) {
    TwinPoint twin{};
    twin.index = i;
    const auto& p = part.points[i];
    const auto& n = part.normals[i];
    twin.exact_offset_m = world_from_center.orientation * glm::dvec3(p[0], p[1], p[2]);
    twin.exact_normal = world_from_center.orientation * glm::dvec3(n[0], n[1], n[2]);
    const glm::dvec3 position =
        (world_from_center.position_m + twin.exact_offset_m) / scene.voxel_size_m;
    for (int axis = 0; axis < 3; ++axis) {
      twin.voxel[axis] = static_cast<std::int64_t>(std::floor(position[axis]));
      twin.exact_fraction[axis] = position[axis] - std::floor(position[axis]);
    }
    twin.value = scene.at(twin.voxel);
    all.push_back(twin);
  }
  return all;
}

}  // namespace forcelayer::test
