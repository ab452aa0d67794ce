#include "voxelize/memory_limit.h"

#include <sys/resource.h>
#include <sys/sysinfo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace forcelayer {
namespace {

// A brick of 512 bits with its place in the tree takes 96 bytes, and holds 64 voxels of a plane.
constexpr double kBytesPerVoxel = 1.5;

// Area of the triangle's largest projection along an axis, in voxels.
double projected_voxels(const LatticeTriangle& triangle) {
  constexpr double kVoxelUnits = 1 << kSnapBits;
  double edges[2][3];
  for (std::size_t d = 0; d < 3; ++d) {
    edges[0][d] = static_cast<double>(triangle[1][d] - triangle[0][d]) / kVoxelUnits;
    edges[1][d] = static_cast<double>(triangle[2][d] - triangle[0][d]) / kVoxelUnits;
  }
  double largest = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t e = (d + 1) % 3, f = (d + 2) % 3;
    largest = std::max(largest, std::abs(edges[0][e] * edges[1][f] - edges[0][f] * edges[1][e]));
  }
  return largest / 2;
}

// No triangle in the box can be larger.
double largest_side_voxels(const VoxelBox& box) {
  std::array<double, 3> edges;
  for (std::size_t d = 0; d < 3; ++d) edges[d] = static_cast<double>(box.high[d] - box.low[d] + 1);
  std::sort(edges.begin(), edges.end());
  return edges[1] * edges[2] / 2;
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

Status fit_memory(const SnappedObject& object, const std::string& name, double voxel_size_m,
                  double available) {
  const double most_voxels = available / kBytesPerVoxel;
  if (object.box.empty() || largest_side_voxels(object.box) <= most_voxels) return {};
  double voxels = 0;
  std::size_t largest = 0;
  for (std::size_t i = 0; i < object.triangles.size(); ++i) {
    const double area = projected_voxels(object.triangle(i));
    if (area > voxels) largest = i;
    voxels = std::max(voxels, area);
  }
  if (voxels <= most_voxels) return {};
  char what[200], mend[100];
  std::snprintf(what, sizeof what,
                "passes through at least %.3g voxels, which take %.3g GB; this process can have "
                "%.3g GB",
                voxels, voxels * kBytesPerVoxel * 1e-9, available * 1e-9);
  std::snprintf(mend, sizeof mend, "check the units, or use --voxel-size %.3gm or more",
                voxel_size_m * std::sqrt(voxels / most_voxels) * 1.01);
  return Error{ErrorCode::kBakeTooLarge, "", "triangle " + std::to_string(largest) + " of " + name,
               what, mend};
}

}  // namespace forcelayer
