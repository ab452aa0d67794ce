#include "voxelize/scan/snap.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "formats/voxmap_format.h"

namespace forcelayer::scan {
namespace {

constexpr std::size_t kGrain = 4096;  // elements a task

// Largest |coordinate| of the world position that led to a lattice point, in meters.
double largest_coordinate(const masks::VoxelBox& box, double voxel_size_m) {
  double largest = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    largest = std::max({largest, std::abs(static_cast<double>(box.low[d])),
                        std::abs(static_cast<double>(box.high[d]) + 1)});
  }
  return largest * voxel_size_m;
}

// Half a lattice step per axis, and the rounding of placing and dividing: at most eight roundings
// of the largest number on the way per axis.
double snap_error(double largest_m, double voxel_size_m) {
  const double step_m = voxel_size_m / static_cast<double>(lattice::kSnapUnits);
  const double rounding_m = 8 * std::numeric_limits<double>::epsilon() * largest_m;
  return std::sqrt(3.0) * (step_m / 2 + rounding_m);
}

// Facts of the vertices of a mesh.
struct Extent {
  bool inside = true;            // placed, all are within the lattice
  mesh::Vec3d largest{0, 0, 0};  // largest |coordinate| in each axis, not placed
};

Extent both(Extent a, const Extent& b) {
  a.inside &= b.inside;
  for (std::size_t d = 0; d < 3; ++d) a.largest[d] = std::max(a.largest[d], b.largest[d]);
  return a;
}

__extension__ typedef __int128 Int128;

bool has_no_area(const lattice::LatticeTriangle& triangle) {
  const lattice::LatticePoint &a = triangle[0], &b = triangle[1], &c = triangle[2];
  for (std::size_t u = 0; u < 3; ++u) {
    const std::size_t w = (u + 1) % 3;
    if (Int128{b[u] - a[u]} * (c[w] - a[w]) != Int128{b[w] - a[w]} * (c[u] - a[u])) return false;
  }
  return true;
}

masks::VoxelBox corner_box(const SnappedObject& object) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, object.triangles.size(), kGrain), masks::VoxelBox{},
      [&](const tbb::blocked_range<std::size_t>& range, masks::VoxelBox box) {
        // In locals: the compiler keeps these in registers.
        auto [x0, y0, z0] = std::array<std::int64_t, 3>{INT64_MAX, INT64_MAX, INT64_MAX};
        auto [x1, y1, z1] = std::array<std::int64_t, 3>{INT64_MIN, INT64_MIN, INT64_MIN};
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const auto [a, b, c] = object.triangle(i);
          x0 = std::min(x0, std::min(a[0], std::min(b[0], c[0])));
          y0 = std::min(y0, std::min(a[1], std::min(b[1], c[1])));
          z0 = std::min(z0, std::min(a[2], std::min(b[2], c[2])));
          x1 = std::max(x1, std::max(a[0], std::max(b[0], c[0])));
          y1 = std::max(y1, std::max(a[1], std::max(b[1], c[1])));
          z1 = std::max(z1, std::max(a[2], std::max(b[2], c[2])));
        }
        box.include(
            {{x0 >> lattice::kSnapBits, y0 >> lattice::kSnapBits, z0 >> lattice::kSnapBits},
             {x1 >> lattice::kSnapBits, y1 >> lattice::kSnapBits, z1 >> lattice::kSnapBits}});
        return box;
      },
      [](masks::VoxelBox a, const masks::VoxelBox& b) {
        a.include(b);
        return a;
      });
}

}  // namespace

Result<SnappedObject> snap_object(const mesh::Mesh& mesh, const mesh::Affine& world_from_mesh,
                                  double voxel_size_m, const std::string& name, SpillFile* spill) {
  SnappedObject object;
  std::span<lattice::LatticePoint> vertices;
  if (spill == nullptr) {
    object.own_vertices.resize(mesh.vertices.size());
    vertices = object.own_vertices;
    object.triangles = mesh.triangles;
  } else {
    vertices = spill->array<lattice::LatticePoint>(mesh.vertices.size());
    const auto triangles = spill->array<mesh::Triangle>(mesh.triangles.size());
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), triangles.begin());
    object.triangles = triangles;
  }
  object.vertices = vertices;
  if (spill != nullptr) spill->touched(object.bytes());
  const double limit_m = static_cast<double>(kMaxVoxelIndex) * voxel_size_m;
  const Extent extent = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.vertices.size(), kGrain), Extent{},
      [&](const tbb::blocked_range<std::size_t>& range, Extent seen) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const mesh::Vec3d vertex = mesh.vertices[i];
          const mesh::Vec3d world = mesh::apply(world_from_mesh, vertex);
          for (std::size_t d = 0; d < 3; ++d) {
            seen.largest[d] = std::max(seen.largest[d], std::abs(vertex[d]));
          }
          const bool fits = std::abs(world[0]) < limit_m && std::abs(world[1]) < limit_m &&
                            std::abs(world[2]) < limit_m;  // false for NaN too
          seen.inside &= fits;
          if (fits) vertices[i] = lattice::snap(world, voxel_size_m);
        }
        return seen;
      },
      both);
  if (!extent.inside) {
    return Error{ErrorCode::kSceneInvalid, "", name,
                 "a vertex lies more than 2^52 voxels from the origin, or its transform overflows",
                 "check units and transforms, or use a larger voxel size"};
  }
  object.box = corner_box(object);
  if (!object.box.empty()) {
    const double largest_m = std::max(largest_coordinate(object.box, voxel_size_m),
                                      mesh::largest_sum(world_from_mesh, extent.largest));
    object.snap_error_m = snap_error(largest_m, voxel_size_m);
  }
  return object;
}

std::uint64_t degenerate_triangles(const SnappedObject& object) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, object.triangles.size(), kGrain), std::uint64_t{0},
      [&](const tbb::blocked_range<std::size_t>& range, std::uint64_t sum) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          sum += has_no_area(object.triangle(i)) ? 1 : 0;
        }
        return sum;
      },
      std::plus<>());
}

}  // namespace forcelayer::scan
