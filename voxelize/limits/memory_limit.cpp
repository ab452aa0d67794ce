#include "voxelize/limits/memory_limit.h"

#include <sys/resource.h>
#include <sys/sysinfo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "voxelize/masks/mask_tree.h"

namespace forcelayer::limits {
namespace {

// A brick of 512 bits with its place in the tree takes 96 bytes, and holds 64 voxels of a plane.
constexpr double kBrickBytes = 96;
constexpr double kBytesPerVoxelOfAPlane = kBrickBytes / 64;
// Along a line a brick holds 8 voxels, and a node of the tree, with room for 512 bricks, 64.
constexpr double kBytesPerVoxelOfALine = kBrickBytes / 8 + sizeof(masks::LowerMaskNode) / 64.0;

// A lower bound of the voxels that a triangle touches: the area of its largest projection along an
// axis, and its length along an axis.
struct Extent {
  double area_voxels = 0, length_voxels = 0;

  double bytes() const {
    return std::max(kBytesPerVoxelOfAPlane * area_voxels, kBytesPerVoxelOfALine * length_voxels);
  }
  double voxels() const { return std::max(area_voxels, length_voxels); }
  // By how much larger voxels must be for `available` bytes.
  double excess(double available) const {
    return std::max(std::sqrt(kBytesPerVoxelOfAPlane * area_voxels / available),
                    kBytesPerVoxelOfALine * length_voxels / available);
  }
};

Extent extent_of(const lattice::LatticeTriangle& triangle) {
  constexpr double kVoxelUnits = 1 << lattice::kSnapBits;
  Extent extent;
  double edges[2][3];
  for (std::size_t d = 0; d < 3; ++d) {
    edges[0][d] = static_cast<double>(triangle[1][d] - triangle[0][d]) / kVoxelUnits;
    edges[1][d] = static_cast<double>(triangle[2][d] - triangle[0][d]) / kVoxelUnits;
    const auto [least, most] = std::minmax({0.0, edges[0][d], edges[1][d]});
    extent.length_voxels = std::max(extent.length_voxels, most - least);
  }
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t e = (d + 1) % 3, f = (d + 2) % 3;
    const double area = std::abs(edges[0][e] * edges[1][f] - edges[0][f] * edges[1][e]) / 2;
    extent.area_voxels = std::max(extent.area_voxels, area);
  }
  return extent;
}

// No triangle in the box can be larger.
Extent largest_extent(const masks::VoxelBox& box) {
  std::array<double, 3> edges;
  for (std::size_t d = 0; d < 3; ++d) edges[d] = static_cast<double>(box.high[d] - box.low[d] + 1);
  std::sort(edges.begin(), edges.end());
  return {edges[1] * edges[2] / 2, edges[2]};
}

}  // namespace

double available_bytes() {
  struct sysinfo machine {};
  ::sysinfo(&machine);
  double bytes = (static_cast<double>(machine.totalram) + static_cast<double>(machine.totalswap)) *
                 machine.mem_unit;
  rlimit own{};
  if (::getrlimit(RLIMIT_AS, &own) == 0 && own.rlim_cur != RLIM_INFINITY) {
    bytes = std::min(bytes, static_cast<double>(own.rlim_cur));
  }
  return bytes;
}

Status fit_memory(const scan::SnappedObject& object, const std::string& name, double voxel_size_m,
                  double available) {
  if (object.box.empty() || largest_extent(object.box).bytes() <= available) return {};
  Extent most;
  std::size_t largest = 0;
  for (std::size_t i = 0; i < object.triangles.size(); ++i) {
    const Extent extent = extent_of(object.triangle(i));
    if (extent.bytes() <= most.bytes()) continue;
    most = extent;
    largest = i;
  }
  if (most.bytes() <= available) return {};
  char what[200], mend[120];
  std::snprintf(what, sizeof what,
                "passes through at least %.3g voxels, which take %.3g GB; this process can have "
                "%.3g GB",
                most.voxels(), most.bytes() * 1e-9, available * 1e-9);
  std::snprintf(mend, sizeof mend,
                "look for a stray vertex, check the units, or use --voxel-size %.3gm or more",
                voxel_size_m * most.excess(available) * 1.01);
  return Error{ErrorCode::kBakeTooLarge, "", "triangle " + std::to_string(largest) + " of " + name,
               what, mend};
}

}  // namespace forcelayer::limits
