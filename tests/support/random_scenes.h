// Seeded random scenes, parts, poses and motions for property tests.
#pragma once

#include "forcelayer/step.h"
#include "tests/support/point_part.h"
#include "tests/support/random_numbers.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::test {

// Boxes, planks and single voxels in a box of up to 48 voxels a side, offset by two layers. Its
// place in the world lies up to `far` voxels away.
inline VoxelScene random_scene(Random& random, std::int64_t far = 0) {
  const double s = std::exp(uniform(random, std::log(0.0005), std::log(0.02)));
  Voxel min{}, dims{};
  for (int axis = 0; axis < 3; ++axis) {
    min[axis] = integer(random, -far - 20, far + 20);
    dims[axis] = integer(random, 12, 48);
  }
  std::vector<std::array<Voxel, 2>> boxes;
  const auto count = integer(random, 1, 6);
  for (std::int64_t i = 0; i < count; ++i) {
    std::array<Voxel, 2> box{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = integer(random, 0, dims[axis] - 1), b = integer(random, 0, dims[axis] - 1);
      box[0][axis] = min[axis] + std::min(a, b);
      box[1][axis] = random() % 2 ? box[0][axis] : min[axis] + std::max(a, b);
    }
    boxes.push_back(box);
  }
  return offset_scene(s, min, dims, 2, [&](Voxel v) {
    return std::any_of(boxes.begin(), boxes.end(), [&](const auto& box) {
      return v[0] >= box[0][0] && v[0] <= box[1][0] && v[1] >= box[0][1] && v[1] <= box[1][1] &&
             v[2] >= box[0][2] && v[2] <= box[1][2];
    });
  });
}

// A sphere, or a cloud with random normals, of 1 to 600 points; up to 40 voxels across.
inline PointPart random_part(Random& random, double voxel_size_m) {
  const double radius_m = voxel_size_m * uniform(random, 0.1, 20);
  const auto count = static_cast<std::size_t>(integer(random, 1, 600));
  if (random() % 2) return sphere_part(radius_m, count, voxel_size_m);
  PointPart part;
  part.voxel_size_m = voxel_size_m;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 p = random_direction(random) * uniform(random, 0, radius_m);
    const glm::dvec3 n = random_direction(random);
    part.add({p.x, p.y, p.z}, {n.x, n.y, n.z});
  }
  return part;
}

// A pose with the center in or near the scene's box.
inline Pose random_pose(Random& random, const VoxelScene& scene) {
  Pose pose;
  for (int axis = 0; axis < 3; ++axis) {
    pose.position_m[axis] =
        scene.voxel_size_m * (static_cast<double>(scene.min[axis]) +
                              static_cast<double>(scene.dims[axis]) * uniform(random, -0.3, 1.3));
  }
  pose.orientation = random_orientation(random);
  return pose;
}

}  // namespace forcelayer::test
