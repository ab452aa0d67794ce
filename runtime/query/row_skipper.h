// The last look before points are looked up: which rows, of kRowPoints consecutive shell points
// each, lie beside what the bricks around them hold.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/query/brick_bounds.h"
#include "runtime/query/four.h"
#include "runtime/query/query_kernel.h"

namespace forcelayer::query {

struct VoxelPose;

// A disc that holds points [begin, end) of a shell: about `center`, its axis along their mean
// normal. Part frame, m.
struct PartDisc {
  Four place;  // center, radius
  Four shape;  // unit axis, half the height
};
PartDisc disc_of(const PshellView& shell, std::uint64_t begin, std::uint64_t end,
                 const std::array<float, 3>& center);

// How the part moved since the last run, for forecasts. World axes.
struct LastMotion {
  glm::vec3 travel_voxels, turn_rad;  // of the centroid; as a rotation vector
};

class RowSkipper {
 public:
  // Both files must outlive this. Without coherence nothing is remembered from run to run.
  RowSkipper(const Voxmap& voxmap, const Pshell& shell, bool coherence);

  // Begins a run. The map must outlive it.
  void start(const KernelMap& map, const VoxelPose& pose, const DiscMargin& margin,
             const LastMotion& last) noexcept;

  // `spent` is how far the block's points can have moved by now, voxels, as BlockSkipper sums it.
  // Returns the spent motion up to which the block is known free by where it was last found free,
  // kNever if it is not.
  float known_free_until(std::uint32_t block, float spent) noexcept;

  // Appends the rows of a block that may have a point in a voxel that is not free or not known, and
  // returns the spent motion up to which all of them are known free, kNever if one is not. Each
  // piece tried in vain takes one off `tries`; with none left, no piece that may touch is tried.
  float take_near(std::uint32_t block, float spent, std::uint32_t& tries, std::uint32_t* rows,
                  std::uint32_t& count) noexcept;

  // As if nothing had ever been looked at.
  void forget() noexcept;

  // Where a part comes into contact all over, all of its pieces stop being free in one run. So a
  // run tries no more of a super-block in vain. A bound for all super-blocks together would make
  // one depend on another, and threads share them.
  static constexpr std::uint32_t kTriesInVain = 4;
  static constexpr float kNever = -1;
  static constexpr float kMotionRounding = 0.01f;  // voxels: float sums of 2 * 4096 err by 0.002

 private:
  // Voxels, from the center's voxel of this run or, where a disc was found free, from base_.
  struct Placed {
    Four center, axis;
  };
  // Where a disc was found free, and how far its points may move from there.
  struct FoundFree {
    Placed at;
    Leeway leeway{};
  };
  // The blocks or the rows.
  struct Pieces {
    std::vector<PartDisc> discs;
    std::vector<FoundFree> found;
    std::vector<float> free_until;        // spent motion (voxels) up to which each is known free
    std::vector<std::uint8_t> let_be;     // looks until it is tried again
    std::vector<std::uint8_t> doublings;  // of these, at its next try in vain
  };
  static Pieces cut(const PshellView& shell, std::uint64_t piece_points);
  Placed place(const PartDisc& disc) const noexcept;
  Leeway last_motion(const Placed& disc, float radius) const noexcept;
  float leeway_left(const FoundFree& found, const Placed& now, const PartDisc& disc) const noexcept;
  bool look_around(Pieces& pieces, std::uint32_t i, const Leeway& largest, float spent,
                   std::uint32_t& tries) noexcept;
  bool is_free(Pieces& pieces, std::uint32_t i, const Leeway& largest, float spent,
               std::uint32_t& tries) noexcept;

  bool coherence_;
  BrickBounds bounds_;
  std::uint32_t block_rows_;
  std::uint32_t row_count_;
  Pieces blocks_, rows_;
  std::array<std::int32_t, 3> base_{};  // a voxel near the part since forget(): floats stay fine
  bool has_base_ = false;
  // The run at hand.
  const KernelMap* map_ = nullptr;
  std::array<Four, 3> turn_{}, rotation_{};  // columns
  Four fraction_{}, from_base_{};            // of the center; of its voxel
  std::array<std::int32_t, 3> whole_{};
  float scale_ = 1, margin_ = 0;
  LastMotion last_{};
};

}  // namespace forcelayer::query
