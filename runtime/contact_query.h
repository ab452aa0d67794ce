// The contact query: which shell points lie in which voxels (paper 3, 4.3), and nothing about
// force.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/pose.h"

namespace forcelayer {

// The shell points that lie in values 1, 2 and 3, in ascending order of point index, as structure
// of arrays with room for every point. What a force field needs is here; world positions are kept
// split into whole voxels and a fraction, so that precision does not depend on the scene's size.
struct CollectedPoints {
  std::uint32_t count = 0;
  std::vector<std::uint32_t> index;      // of the shell point
  std::vector<std::uint8_t> value;       // VoxelValue: 1, 2 or 3
  std::vector<std::int32_t> vx, vy, vz;  // voxel, relative to the map's directory_origin
  std::vector<float> fx, fy, fz;         // position in the voxel, in voxels, [0, 1)
  std::vector<float> rx, ry, rz;         // m, from the part's centre, world axes
  std::vector<float> nx, ny, nz;         // inward normal, world axes

  std::uint32_t interior_count = 0;   // points in value 1
  std::uint32_t surface_count = 0;    // points in value 2: the paper's N
  std::uint32_t proximity_count = 0;  // points in value 3
  bool outside_map = false;           // a point lay beyond a cropped side: no guarantee this frame

  void reserve(std::uint64_t points);  // set-up only; run() never allocates
};

// Finds the collected points of one shell in one voxmap. Precision: the rotation acts in float on
// offsets from the part's centre; the centre's place is double, split into whole voxels (integer)
// and a fraction (DESIGN 2).
class ContactQuery {
 public:
  // Both files must outlive the query.
  ContactQuery(const Voxmap& voxmap, const Pshell& shell);

  // Collects at `world_from_part` into `out` (reserved for the shell's points). No allocation, lock
  // or system call.
  void run(const Pose& world_from_part, CollectedPoints& out) noexcept;

  const Voxmap& voxmap() const { return voxmap_; }
  const Pshell& shell() const { return shell_; }

 private:
  const Voxmap& voxmap_;
  const Pshell& shell_;
};

}  // namespace forcelayer
