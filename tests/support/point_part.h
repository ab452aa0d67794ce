// Small parts for tests: points with inward normals, and the .pshell file of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "formats/pshell.h"
#include "formats/pshell_writer.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::test {

// Points (m, from the centroid, part frame) and inward unit normals.
struct PointPart {
  double voxel_size_m = 0.005;
  double covering_radius_m = 0.004;
  std::array<double, 3> center_m{};
  std::array<double, 6> inertia_m2{1e-4, 1e-4, 1e-4, 0, 0, 0};
  std::uint32_t block_points = kDefaultBlockPoints;
  std::uint32_t super_block_blocks = kDefaultSuperBlockBlocks;
  bool two_sided = false;  // whether all points are without an inside
  std::vector<std::array<float, 3>> points, normals;
  std::vector<float> areas_m2;  // of none: 1e-5 each
  std::vector<float> cone_cos;  // of none: a file without normal cones

  void add(const std::array<double, 3>& point, std::array<double, 3> normal) {
    const double length =
        std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (double& component : normal) component /= length;
    points.push_back(
        {static_cast<float>(point[0]), static_cast<float>(point[1]), static_cast<float>(point[2])});
    normals.push_back({static_cast<float>(normal[0]), static_cast<float>(normal[1]),
                       static_cast<float>(normal[2])});
  }
};

// Gives each point the cone of the normals within the covering radius of it, as points tell them.
inline void add_cones(PointPart& part) {
  const double radius2 = part.covering_radius_m * part.covering_radius_m;
  for (std::size_t i = 0; i < part.points.size(); ++i) {
    float cone_cos = 1;
    for (std::size_t k = 0; k < part.points.size(); ++k) {
      double distance2 = 0;
      float alike = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const double d = double{part.points[i][axis]} - part.points[k][axis];
        distance2 += d * d;
        alike += part.normals[i][axis] * part.normals[k][axis];
      }
      if (distance2 <= radius2) cone_cos = std::min(cone_cos, alike);
    }
    part.cone_cos.push_back(std::clamp(cone_cos, -1.0f, 1.0f));
  }
}

// A sphere of `count` points along a Fibonacci spiral, so that blocks are neighbors.
inline PointPart sphere_part(double radius_m, std::size_t count, double voxel_size_m) {
  PointPart part;
  part.voxel_size_m = voxel_size_m;
  part.covering_radius_m = 0.866 * voxel_size_m;
  const double golden = M_PI * (3 - std::sqrt(5.0));
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - 2 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double r = std::sqrt(1 - z * z), a = golden * static_cast<double>(i);
    const std::array<double, 3> d{r * std::cos(a), r * std::sin(a), z};
    part.add({radius_m * d[0], radius_m * d[1], radius_m * d[2]}, {-d[0], -d[1], -d[2]});
  }
  const double inertia = 0.4 * radius_m * radius_m;
  part.inertia_m2 = {inertia, inertia, inertia, 0, 0, 0};
  return part;
}

// A sphere that holds points [begin, end), whatever the rounding.
inline BoundingSphere bounding_sphere(const PointPart& part, std::size_t begin, std::size_t end) {
  std::array<float, 3> low = part.points[begin], high = low;
  for (std::size_t i = begin; i < end; ++i)
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], part.points[i][axis]);
      high[axis] = std::max(high[axis], part.points[i][axis]);
    }
  BoundingSphere sphere{(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2, 0};
  double radius2 = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const double x = part.points[i][0] - double{sphere.x}, y = part.points[i][1] - double{sphere.y},
                 z = part.points[i][2] - double{sphere.z};
    radius2 = std::max(radius2, x * x + y * y + z * z);
  }
  sphere.radius = std::nextafter(static_cast<float>(std::sqrt(radius2) * (1 + 1e-6)), 1e30f);
  return sphere;
}

inline void save_pshell(const std::filesystem::path& path, const PointPart& part) {
  std::array<std::vector<float>, 7> columns;
  double bounding_radius_m = 0, area_m2 = 0;
  for (std::size_t i = 0; i < part.points.size(); ++i) {
    const auto& p = part.points[i];
    bounding_radius_m =
        std::max(bounding_radius_m,
                 std::sqrt(double{p[0]} * p[0] + double{p[1]} * p[1] + double{p[2]} * p[2]));
    for (int axis = 0; axis < 3; ++axis) {
      columns[axis].push_back(p[axis]);
      columns[3 + axis].push_back(part.normals[i][axis]);
    }
    columns[6].push_back(part.areas_m2.empty() ? 1e-5f : part.areas_m2[i]);
    area_m2 += part.areas_m2.empty() ? 0 : double{part.areas_m2[i]};
  }
  const std::size_t count = part.points.size();
  std::vector<BoundingSphere> blocks, super_blocks;
  const std::size_t block = part.block_points, super = block * part.super_block_blocks;
  for (std::size_t i = 0; i < count; i += block)
    blocks.push_back(bounding_sphere(part, i, std::min(count, i + block)));
  for (std::size_t i = 0; i < count; i += super)
    super_blocks.push_back(bounding_sphere(part, i, std::min(count, i + super)));

  PshellContent content;
  PshellHeader& h = content.header;
  h.point_count = count;
  h.block_points = part.block_points;
  h.super_block_blocks = part.super_block_blocks;
  h.block_count = blocks.size();
  h.super_block_count = super_blocks.size();
  h.covering_radius_m = part.covering_radius_m;
  h.convex_gap_m = part.covering_radius_m;  // the nearest point alone
  h.voxel_size_m = part.voxel_size_m;
  h.bounding_radius_m = bounding_radius_m * (1 + 1e-12);
  h.center_m = part.center_m;
  h.area_m2 = part.areas_m2.empty() ? 1e-5 * static_cast<double>(count) : area_m2;
  h.volume_m3 = 1e-4;
  h.inertia_m2 = part.inertia_m2;
  h.method = static_cast<std::uint32_t>(ShellMethod::kSurface);
  content.x = columns[0], content.y = columns[1], content.z = columns[2];
  content.nx = columns[3], content.ny = columns[4], content.nz = columns[5];
  content.weight_m2 = columns[6];
  content.blocks = blocks;
  content.super_blocks = super_blocks;
  const std::vector<std::uint8_t> two_sided(part.two_sided ? count : 0, 1);
  content.two_sided = two_sided;
  content.cone_cos = part.cone_cos;

  save_bytes(path, pshell_bytes(content));
}

inline Pshell make_pshell(const PointPart& part) {
  const ScratchFolder folder;  // the bytes outlive the file
  save_pshell(folder / "part.pshell", part);
  auto shell = Pshell::open(folder / "part.pshell", Verify::kStructureAndChecksums);
  if (!shell) throw std::runtime_error(to_line(shell.error()));
  return std::move(*shell);
}

}  // namespace forcelayer::test
