#include "voxelize/limits/directory_limit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "formats/voxmap_format.h"

namespace forcelayer::limits {
namespace {

constexpr int kLog2Cell = 9;
static_assert(1u << kLog2Cell == kUpperNodeEdge);

// Directory cells per axis that a box of `extent_m` touches at most, wherever it lies on the
// lattice.
bool fits(const std::array<double, 3>& extent_m, double voxel_size_m) {
  double entries = 1;
  for (const double extent : extent_m) {
    const double cells = std::ceil(extent / voxel_size_m / kUpperNodeEdge) + 1;
    if (cells > kMaxDirectoryDim) return false;
    entries *= cells;
  }
  return entries <= static_cast<double>(kMaxDirectoryEntries);
}

// The least voxel size, in steps of a twentieth, at which the box fits.
double fitting_voxel_size(const masks::VoxelBox& box, double voxel_size_m) {
  std::array<double, 3> extent_m;
  for (std::size_t d = 0; d < 3; ++d) {
    extent_m[d] =
        (static_cast<double>(box.high[d]) - static_cast<double>(box.low[d]) + 1) * voxel_size_m;
  }
  double size = voxel_size_m;
  while (!fits(extent_m, size)) size *= 1.05;
  return size;
}

std::string text(const char* format, double a, double b = 0, double c = 0) {
  char line[200];
  std::snprintf(line, sizeof line, format, a, b, c);
  return line;
}

}  // namespace

Result<Directory> fit_directory(const masks::VoxelBox& box, double voxel_size_m) {
  Directory directory;
  std::array<double, 3> dims;
  double entries = 1;
  bool too_long = false;
  for (std::size_t d = 0; d < 3; ++d) {
    const std::int64_t low = box.low[d] >> kLog2Cell, high = box.high[d] >> kLog2Cell;
    directory.origin[d] = low * kUpperNodeEdge;
    dims[d] = static_cast<double>(high - low + 1);
    entries *= dims[d];
    too_long |= high - low >= std::int64_t{kMaxDirectoryDim};
    directory.dims[d] = static_cast<std::uint32_t>(high - low + 1);
  }
  if (too_long || entries > static_cast<double>(kMaxDirectoryEntries)) {
    return Error{
        ErrorCode::kBakeTooLarge, "", "",
        text("the scene needs a directory of %.0f x %.0f x %.0f cells of 512 voxels", dims[0],
             dims[1], dims[2]) +
            text(" (%.3g entries; at most %.0f are allowed, and %.0f on an axis)", entries,
                 static_cast<double>(kMaxDirectoryEntries), kMaxDirectoryDim),
        text("use --voxel-size %.3gm or more", 1.001 * fitting_voxel_size(box, voxel_size_m))};
  }
  return directory;
}

}  // namespace forcelayer::limits
