// The point shell of the 1999 paper (section 4.1): the centers of the surface voxels.
#pragma once

#include <vector>

#include "formats/result.h"
#include "pointshell/part/part.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::sample {

// The centers, relative to `center`, of all half-open voxels of size `voxel_size_m` that contain a
// point of the part; the lattice is anchored in the part frame's origin. `part` is in the part
// frame. Vertices are snapped to 2^-10 voxel. kBakeTooLarge where the lattice or the shell would be
// larger than the format holds.
Result<std::vector<part::Vec3>> voxel_centers(const part::Part& part, double voxel_size_m,
                                              const part::Vec3& center);

// The same for the single voxel that holds `place`, which is relative to `center`.
part::Vec3 voxel_center_at(const part::Vec3& place, double voxel_size_m, const part::Vec3& center);

}  // namespace forcelayer::sample
