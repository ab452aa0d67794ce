// Reading a voxmap at points.
#pragma once

#include <istream>
#include <ostream>

#include "formats/voxmap.h"

namespace forcelayer::voxinfo {

// Reads lines `x y z` (meters, world frame, spaces or commas between) and writes a line for each
// point's voxel, with tabs between: its VoxelValue, 0 to 3; where the map stores distances, the
// least and the most that its center can be from the mesh, m, infinite where there is no bound;
// where it stores objects, the nearest one's name, or nothing. Where no distance was measured the
// name is a hint, and a further column says `hint`. Blank lines are skipped. `outside_points`
// receives the number of points beyond a cropped side, where nothing is known and the value is 0.
// Errors: kUsage with the line's number.
Status sample_voxmap(const Voxmap& map, std::istream& points, std::ostream& lines,
                     std::uint64_t& outside_points);

}  // namespace forcelayer::voxinfo
