#include "pointshell/sample/voxel_centers.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "formats/lattice/voxel_overlap.h"
#include "formats/pshell_format.h"
#include "pointshell/part/parallel.h"
#include "pointshell/sample/stored_position.h"

namespace forcelayer::sample {
namespace {

constexpr std::size_t kTrianglesPerTask = 2048;
// From the origin along an axis; the overlap test is exact far beyond.
constexpr double kMaxVoxels = 1e9;

using BrickMap = std::map<lattice::VoxelIndex, lattice::BrickMask>;  // by lowest voxel

lattice::LatticeTriangle snapped(const part::Part& part, std::size_t t, double voxel_size_m) {
  lattice::LatticeTriangle corners;
  for (int n = 0; n < 3; ++n) {
    const part::Vec3& v = part.vertices[part.triangles[t][n]];
    corners[n] = lattice::snap({v.x, v.y, v.z}, voxel_size_m);
  }
  return corners;
}

void merge(const lattice::BrickMask& mask, lattice::BrickMask& into) {
  for (std::size_t x = 0; x < 8; ++x) into.words[x] |= mask.words[x];
}

BrickMap surface_bricks(const part::Part& part, double voxel_size_m) {
  const std::size_t tasks = (part.triangles.size() + kTrianglesPerTask - 1) / kTrianglesPerTask;
  std::vector<BrickMap> of_task(tasks);
  part::parallel_for_each_index(tasks, 1, [&](std::size_t task) {
    const std::size_t end = std::min((task + 1) * kTrianglesPerTask, part.triangles.size());
    for (std::size_t t = task * kTrianglesPerTask; t < end; ++t) {
      const lattice::TriangleOverlap triangle(snapped(part, t, voxel_size_m));
      lattice::for_each_group(
          triangle, 0, [&](const lattice::VoxelIndex& corner, const lattice::BrickMask& mask) {
            merge(mask, of_task[task][corner]);
          });
    }
  });
  BrickMap bricks;
  for (BrickMap& some : of_task) {
    for (const auto& [corner, mask] : some) merge(mask, bricks[corner]);
    some.clear();
  }
  return bricks;
}

part::Vec3 center_of(const lattice::VoxelIndex& voxel, double voxel_size_m,
                     const part::Vec3& center) {
  const auto coordinate = [&](std::int64_t index, double origin) {
    return (static_cast<double>(index) + 0.5) * voxel_size_m - origin;
  };
  return as_stored({coordinate(voxel[0], center.x), coordinate(voxel[1], center.y),
                    coordinate(voxel[2], center.z)});
}

}  // namespace

Result<std::vector<part::Vec3>> voxel_centers(const part::Part& part, double voxel_size_m,
                                              const part::Vec3& center) {
  const Error too_large{ErrorCode::kBakeTooLarge, "", "",
                        "the part has too many surface voxels for a shell",
                        "use a larger voxel size"};
  if (part.largest_coordinate / voxel_size_m > kMaxVoxels) return too_large;
  std::vector<part::Vec3> centers;
  for (const auto& brick : surface_bricks(part, voxel_size_m)) {
    const auto& corner = brick.first;
    lattice::for_each_cell(brick.second, [&](std::int64_t x, std::int64_t y, std::int64_t z) {
      centers.push_back(
          center_of({corner[0] + x, corner[1] + y, corner[2] + z}, voxel_size_m, center));
    });
    if (centers.size() > kMaxShellPoints) return too_large;
  }
  return centers;
}

part::Vec3 voxel_center_at(const part::Vec3& place, double voxel_size_m, const part::Vec3& center) {
  const auto index = [&](double coordinate) {
    return static_cast<std::int64_t>(std::floor(coordinate / voxel_size_m));
  };
  const part::Vec3 p = place + center;
  return center_of({index(p.x), index(p.y), index(p.z)}, voxel_size_m, center);
}

}  // namespace forcelayer::sample
