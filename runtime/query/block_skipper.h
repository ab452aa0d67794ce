// Which blocks of shell points need not be looked at (DESIGN 6, Contact query). Exact: a block that
// is skipped has every point in a known free voxel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/pshell.h"
#include "runtime/query/query_kernel.h"

namespace forcelayer {

// What is skipped; each can be switched off to measure what it saves.
struct SkipOptions {
  bool clearance = true;     // blocks whose points lie in known free space
  bool super_blocks = true;  // the same for whole super-blocks first
  bool coherence = true;     // neither is looked at before it can have moved far enough
};

// A super-block or block that was found free with some slack stays free until the part has moved by
// that slack. The motion of a point at most rho from the centroid is bounded by the centroid's way
// plus rho times the angle (the arc, not the chord), summed over all poses since.
class BlockSkipper {
 public:
  // The shell must outlive this.
  BlockSkipper(const Pshell& shell, double voxel_size_m, const SkipOptions& options);

  // The blocks, ascending, that may have a point in a voxel that is not free or not known.
  // `rounding_voxels` bounds what single precision does to a point, per axis.
  std::span<const std::uint32_t> candidates(const KernelMap& map, const Pose& world_from_center,
                                            const VoxelPose& pose, double rounding_voxels) noexcept;

 private:
  // Runs of points at one level, each in a disc (KernelDiscs), with what is known of it.
  struct Level {
    std::uint32_t count = 0;
    std::vector<float> place, shape;  // of the discs
    std::vector<float> reach_voxels;  // of the farthest point from the centroid
    std::vector<float> free_until;    // spent motion (voxels) up to which the disc is known free
  };

  Level make_level(const PshellView& shell, const BoundingSphere* spheres, std::uint64_t count,
                   std::uint64_t run_points) const;
  void spend_motion(const Pose& world_from_center) noexcept;
  void forget() noexcept;
  bool all_known_free(const Level& level, std::uint32_t begin, std::uint32_t end) const noexcept;
  void survey(const KernelMap& map, const VoxelPose& pose, Level& level, std::uint32_t begin,
              std::uint32_t end) noexcept;
  template <typename Visit>
  void visit_near(const KernelMap& map, const VoxelPose& pose, Level& level, std::uint32_t begin,
                  std::uint32_t end, Visit visit) noexcept;

  double voxel_size_m_;
  SkipOptions options_;
  std::uint32_t super_block_blocks_;
  Level blocks_, super_blocks_;
  double radius_voxels_;
  std::vector<std::uint32_t> candidates_;
  DiscMargin margin_;
  bool has_last_ = false;
  Pose last_;
  double travel_voxels_ = 0;  // of the centroid, since forget()
  double turn_rad_ = 0;       // the same
};

}  // namespace forcelayer
