// Decides which blocks of shell points are skipped. Exact: every point of a skipped block lies in a
// known free voxel.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/query/query_kernel.h"
#include "runtime/query/row_skipper.h"

namespace forcelayer::query {

// Each way of skipping can be switched off, to measure what it saves.
struct SkipOptions {
  bool clearance = true;     // skip blocks whose disc lies in known free space
  bool super_blocks = true;  // try whole super-blocks first
  bool coherence = true;     // look at neither before it can have moved far enough
  bool walls = true;         // skip rows that lie beside what the bricks around them hold
};

// A super-block or block that was found free with some slack stays free until the part has moved by
// that slack. A point at the distance r from the centroid moves at most by the centroid's way plus
// r times the angle (along the arc), summed over all poses since.
class BlockSkipper {
 public:
  // Both files must outlive this.
  BlockSkipper(const Voxmap& voxmap, const Pshell& shell, const SkipOptions& options);
  ~BlockSkipper();
  BlockSkipper(const BlockSkipper&) = delete;
  BlockSkipper& operator=(const BlockSkipper&) = delete;

  // Begins a run: finds the super-blocks that are not known to be free, and returns their number.
  // `rounding_voxels` bounds how far single precision misplaces a point, per axis. `map` and `pose`
  // must outlive the run.
  std::uint32_t start(const KernelMap& map, const Pose& world_from_center, const VoxelPose& pose,
                      double rounding_voxels) noexcept;

  // The rows of super-blocks begin to end - 1 of these that may have a point in a voxel that is not
  // free or not known, ascending. Threads may share a run's super-blocks, each taken once: it
  // changes no row.
  std::span<const std::uint32_t> candidates(std::uint32_t begin, std::uint32_t end) noexcept;

  // Where they begin among the rows of the shell, all of which have room there.
  std::uint32_t first_row(std::uint32_t begin) const noexcept { return near_[begin] * super_rows_; }

 private:
  // The blocks or the super-blocks, each in a disc (KernelDiscs).
  struct Level {
    std::uint32_t count = 0;
    std::vector<Four> place, shape;    // of the discs
    std::vector<float> reach_voxels;   // of the farthest point from the centroid
    std::vector<float> free_until;     // spent motion (voxels) up to which the disc is known free
    std::vector<std::uint8_t> let_be;  // looks until it is surveyed again
  };

  Level make_level(const PshellView& shell, const BoundingSphere* spheres, std::uint64_t count,
                   std::uint64_t run_points) const;
  void spend_motion(const Pose& world_from_center) noexcept;
  void forget_slack() noexcept;
  // Bit i: disc begin + i has no slack left.
  std::uint32_t not_known_free(const Level& level, std::uint32_t begin,
                               std::uint32_t end) const noexcept;
  void survey(Level& level, std::uint32_t begin, std::uint32_t end) noexcept;
  // How far a block's points can have moved since slack was last forgotten, voxels.
  float spent(std::uint32_t block) const noexcept;
  template <typename KnownFree, typename Visit>
  void visit_near(Level& level, std::uint32_t begin, std::uint32_t end, KnownFree known_free,
                  Visit visit) noexcept;
  void remember_blocks(std::uint32_t super, std::uint32_t begin, std::uint32_t end) noexcept;
  void take_rows(std::uint32_t super, std::uint32_t* rows, std::uint32_t& count) noexcept;

  double voxel_size_m_;
  SkipOptions options_;
  std::uint32_t super_block_blocks_, block_rows_, super_rows_, row_count_;
  Level blocks_, super_blocks_;
  double radius_voxels_;
  std::optional<RowSkipper> row_skipper_;
  std::vector<std::uint32_t> candidates_;  // rows, with room for all
  std::vector<std::uint32_t> near_;        // super-blocks, with room for all
  // The run at hand.
  const KernelMap* map_ = nullptr;
  const VoxelPose* pose_ = nullptr;
  DiscMargin margin_;
  bool skips_ = false;  // else every row is a candidate
  bool has_last_ = false;
  Pose last_;
  double travel_voxels_ = 0;  // of the centroid, since forget_slack()
  double turn_rad_ = 0;       // since then
  LastMotion last_motion_{};
};

}  // namespace forcelayer::query
