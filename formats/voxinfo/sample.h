// Reading the values of a voxmap at points.
#pragma once

#include <istream>
#include <ostream>

#include "formats/voxmap.h"

namespace forcelayer::voxinfo {

// Reads lines `x y z` (meters, world frame, spaces or commas between) and writes the VoxelValue of
// each point's voxel, 0 to 3, a line each. Blank lines are skipped. `outside_points` receives the
// number of points beyond a cropped side, where nothing is known and 0 is written. Errors: kUsage
// with the line's number.
Status sample_voxmap(const Voxmap& map, std::istream& points, std::ostream& values,
                     std::uint64_t& outside_points);

}  // namespace forcelayer::voxinfo
