// The last look before points are looked up: which rows, of kRowPoints consecutive shell points
// each, lie beside what the bricks around them hold.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/query/brick_bounds.h"
#include "runtime/query/query_kernel.h"

namespace forcelayer::query {

struct VoxelPose;

// A disc that holds points [begin, end) of a shell: about `center`, its axis along their mean
// normal. Part frame, m.
struct PartDisc {
  std::array<float, 3> center, axis;
  float radius, half_height;
};
PartDisc disc_of(const PshellView& shell, std::uint64_t begin, std::uint64_t end,
                 const std::array<float, 3>& center);

// How the part moved since the last run, for forecasts. World axes.
struct LastMotion {
  glm::vec3 travel_voxels, turn_rad;  // of the centroid; as a rotation vector
};

struct SpentMotion {
  float spent;  // how far a block's points can have moved, voxels, as BlockSkipper sums it
  LastMotion last;
};

class RowSkipper {
 public:
  // Both files must outlive this. Without coherence nothing is remembered from run to run.
  RowSkipper(const Voxmap& voxmap, const Pshell& shell, bool coherence);

  // The spent motion up to which the block is known free by where it was last found free, kNever if
  // it is not.
  float known_free_until(const VoxelPose& pose, const DiscMargin& margin, std::uint32_t block,
                         const SpentMotion& motion) noexcept;

  // Appends the rows of a block that may have a point in a voxel that is not free or not known, and
  // returns the spent motion up to which all of them are known free, kNever if one is not.
  float take_near(const KernelMap& map, const VoxelPose& pose, const DiscMargin& margin,
                  std::uint32_t block, const SpentMotion& motion, std::uint32_t* rows,
                  std::uint32_t& count) noexcept;

  // As if nothing had ever been looked at.
  void forget() noexcept;

  static constexpr float kNever = -1;
  static constexpr float kMotionRounding = 0.01f;  // voxels: float sums of 2 * 4096 err by 0.002

 private:
  // Where a disc was found free, and how far its points may move from there.
  struct FoundFree {
    std::array<float, 3> center, axis;  // voxels from base_; unit
    Leeway leeway;
  };
  // The blocks or the rows.
  struct Pieces {
    std::vector<PartDisc> discs;
    std::vector<FoundFree> found;
    std::vector<float> free_until;     // spent motion (voxels) up to which each is known free
    std::vector<std::uint8_t> let_be;  // looks until it is tried again
  };
  static Pieces cut(const PshellView& shell, std::uint64_t piece_points);
  std::array<float, 3> from_base(const PlacedDisc& disc) const noexcept;
  float leeway_left(const FoundFree& found, const PlacedDisc& now) const noexcept;
  bool is_free(const KernelMap& map, const VoxelPose& pose, const DiscMargin& margin,
               Pieces& pieces, std::uint32_t i, const Leeway& most,
               const SpentMotion& motion) noexcept;

  bool coherence_;
  std::array<std::int32_t, 3> base_{};  // a voxel near the part since forget(): floats stay fine
  bool has_base_ = false;
  BrickBounds bounds_;
  std::uint32_t block_rows_;
  std::uint32_t row_count_;
  Pieces blocks_, rows_;
};

}  // namespace forcelayer::query
