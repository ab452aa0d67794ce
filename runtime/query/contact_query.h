// The contact query: which shell points lie in which voxels (paper 3, 4.3). It knows nothing of
// forces.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/query/block_skipper.h"
#include "runtime/query/query_kernel.h"
#include "runtime/query/query_workers.h"

namespace forcelayer::query {

// The shell points that lie in values 1, 2 and 3, in ascending order of point index, as structure
// of arrays with room for every point. A position is split into whole voxels and a fraction, so its
// precision does not depend on the scene's size.
struct CollectedPoints {
  std::uint32_t count = 0;
  std::vector<std::uint32_t> index;      // of the shell point
  std::vector<std::uint8_t> value;       // VoxelValue: 1, 2 or 3
  std::vector<std::int32_t> vx, vy, vz;  // voxel, relative to the map's directory_origin
  std::vector<float> fx, fy, fz;         // position in the voxel, in voxels, [0, 1)
  std::vector<float> rx, ry, rz;         // m, from the part's center, world axes
  std::vector<float> nx, ny, nz;         // inward normal, world axes

  std::uint32_t interior_count = 0;   // points in value 1
  std::uint32_t surface_count = 0;    // points in value 2: the paper's N
  std::uint32_t proximity_count = 0;  // points in value 3
  bool outside_map = false;           // a point lay beyond a cropped side: no guarantee this frame;
                                      // of a part out of the map's reach, its bounding sphere

  void reserve(std::uint64_t points);  // set-up only; run() never allocates
  void clear() noexcept;               // counts and flags
};

// A pose as the query computes with it. The voxel of a shell point p (m, from the center) is
// whole + floor(turn * p + fraction), all but `whole` in single precision.
struct VoxelPose {
  std::array<std::array<float, 3>, 3> rotation;  // row-major
  std::array<std::array<float, 3>, 3> turn;      // rotation / s: meters to voxels
  std::array<float, 3> fraction;                 // of the center in its voxel, voxels
  std::array<std::int32_t, 3> whole;             // the center's voxel, relative to the directory
  bool within_reach = false;                     // false: no point can be in the directory
};

// Threads share a run after one that looked at so many points, some 40 us of one thread.
inline constexpr std::uint64_t kPointsWorthSharing = 16384;

// How the query works. No choice here changes the result.
struct QueryOptions {
  SkipOptions skip;
  bool vector = true;    // the vectorised kernel, where the map's size allows it
  unsigned threads = 1;  // share the work of one run; the caller's is one of them
  std::uint64_t points_worth_sharing = kPointsWorthSharing;
};

// Finds the collected points of one shell in one voxmap. The rotation acts in single precision on
// offsets from the part's center; the center's position is in double precision, split into whole
// voxels (integers) and a fraction.
class ContactQuery {
 public:
  // Errors: kFilesDoNotMatch where the shell's radius is kMaxRadiusVoxels voxels or more.
  static Status check_size(const Voxmap& voxmap, const Pshell& shell);

  // Both files must outlive the query, and pass check_size().
  ContactQuery(const Voxmap& voxmap, const Pshell& shell, const QueryOptions& options = {});

  // Fills `out`, which has room for the shell's points, with the part's centroid frame at
  // `world_from_center`. A pose that is not finite collects nothing. No allocation, lock or system
  // call.
  void run(const Pose& world_from_center, CollectedPoints& out) noexcept;

  // e_pose of the separation guarantee: how far the query's arithmetic can misplace a point, m, at
  // poses within the map's reach.
  double rounding_bound_m() const;

  VoxelPose voxel_pose(const Pose& world_from_center) const noexcept;

  // Around a run() in which the helper threads, if any, take part. Both call the system. Helpers
  // that are not awake leave all work to the caller's thread.
  void wake() noexcept;
  void rest() noexcept;

  // Real-time priority for them, a step below the loop's; returns warnings.
  std::vector<std::string> give_helpers_real_time_priority();

  // Points of the rows that the last run did not skip.
  std::uint64_t points_looked_at() const { return points_looked_at_; }

  const Voxmap& voxmap() const { return voxmap_; }
  const Pshell& shell() const { return shell_; }

  static constexpr double kMaxRadiusVoxels = 1 << 20;  // float leaves 1/16 voxel there

 private:
  // Consecutive super-blocks of a run that threads share.
  struct Chunk {
    std::span<const std::uint32_t> rows;  // that are looked up
    PointColumns points;
    std::size_t first = 0;  // point of its super-blocks
    std::uint32_t end = 0;  // of its points among all that are collected
    bool in_place = false;  // these are in their place
  };

  double rounding_voxels() const;
  void collect_point(const VoxelPose& pose, std::uint32_t point, PointColumns& out) const noexcept;
  void collect(const VoxelPose& pose, std::span<const std::uint32_t> rows,
               PointColumns& out) const noexcept;
  void look_up(const VoxelPose& pose, std::uint32_t super_blocks, std::size_t chunk,
               CollectedPoints& out) noexcept;
  void append(const VoxelPose& pose, Chunk& chunk) noexcept;
  void collect_shared(const VoxelPose& pose, std::uint32_t super_blocks,
                      CollectedPoints& out) noexcept;
  bool beyond_cropped_side(std::int32_t x, std::int32_t y, std::int32_t z) const noexcept;
  bool sphere_beyond_cropped_side(const glm::dvec3& center_m) const noexcept;

  const Voxmap& voxmap_;
  const Pshell& shell_;
  double radius_voxels_;
  float voxel_size_m_;
  // Box of the voxels that are known, relative to the directory; unbounded where nothing was cut.
  KnownBox known_;
  KernelMap kernel_map_;
  KernelShell kernel_shell_;
  bool use_kernel_;
  bool all_free_;
  BlockSkipper skipper_;
  std::unique_ptr<QueryWorkers> workers_;
  std::uint64_t points_worth_sharing_;
  std::vector<Chunk> chunks_;         // of collect_shared()
  std::uint32_t chunk_count_ = 0;     // of the run at hand
  std::vector<std::uint8_t> values_;  // of all points, for chunks
  std::uint64_t points_looked_at_ = 0;
  bool found_all_ = false;  // points of the shell, in the last run
};

}  // namespace forcelayer::query
