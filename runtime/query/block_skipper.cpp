#include "runtime/query/block_skipper.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "runtime/query/contact_query.h"

namespace forcelayer::query {
namespace {

constexpr std::uint32_t kGroup = 16;        // discs looked at together: a vector
constexpr double kMostMotionVoxels = 4096;  // then all slack is forgotten, so that floats stay fine
constexpr float kMotionRounding = RowSkipper::kMotionRounding;
constexpr double kUnitTolerance = 1e-9;  // of an orientation's length, squared; else no skipping
constexpr double kRadiusRounding = 1 + 1e-6;  // of a float radius in voxels
constexpr float kNever = RowSkipper::kNever;

bool is_unit(const glm::dquat& q) { return std::abs(glm::dot(q, q) - 1) < kUnitTolerance; }

}  // namespace

[[gnu::cold]] BlockSkipper::BlockSkipper(const Voxmap& voxmap, const Pshell& shell,
                                         const SkipOptions& options)
    : voxel_size_m_(voxmap.voxel_size_m()),
      options_(options),
      super_block_blocks_(shell.view().super_block_blocks),
      block_rows_(shell.view().block_points / kRowPoints),
      row_count_(
          static_cast<std::uint32_t>((shell.view().point_count + kRowPoints - 1) / kRowPoints)),
      blocks_(make_level(shell.view(), shell.view().blocks, shell.view().block_count,
                         shell.view().block_points)),
      super_blocks_(make_level(shell.view(), shell.view().super_blocks,
                               shell.view().super_block_count,
                               std::uint64_t{shell.view().block_points} * super_block_blocks_)),
      radius_voxels_(shell.header().bounding_radius_m / voxel_size_m_),
      candidates_(row_count_) {
  if (options.clearance && options.walls) row_skipper_.emplace(voxmap, shell, options.coherence);
}

[[gnu::cold]] BlockSkipper::Level BlockSkipper::make_level(const PshellView& shell,
                                                           const BoundingSphere* spheres,
                                                           std::uint64_t count,
                                                           std::uint64_t run_points) const {
  Level level;
  if (!options_.clearance) return level;
  level.count = static_cast<std::uint32_t>(count);
  level.free_until.assign(count, kNever);
  for (std::uint64_t i = 0; i < count; ++i) {
    const BoundingSphere& s = spheres[i];
    const double reach_m =
        std::sqrt(double{s.x} * s.x + double{s.y} * s.y + double{s.z} * s.z) + s.radius;
    level.reach_voxels.push_back(static_cast<float>(reach_m / voxel_size_m_ * kRadiusRounding));
    const PartDisc disc = disc_of(
        shell, i * run_points, std::min(shell.point_count, (i + 1) * run_points), {s.x, s.y, s.z});
    level.place.insert(level.place.end(), {s.x, s.y, s.z, disc.radius});
    level.shape.insert(level.shape.end(),
                       {disc.axis[0], disc.axis[1], disc.axis[2], disc.half_height});
  }
  return level;
}

void BlockSkipper::forget_slack() noexcept {
  for (Level* level : {&blocks_, &super_blocks_}) {
    std::fill(level->free_until.begin(), level->free_until.end(), kNever);
  }
  if (row_skipper_) row_skipper_->forget();
  travel_voxels_ = turn_rad_ = 0;
}

void BlockSkipper::spend_motion(const Pose& pose) noexcept {
  if (has_last_) {
    const glm::dquat turn = pose.orientation * glm::conjugate(last_.orientation);
    const double sine = glm::length(glm::dvec3(turn.x, turn.y, turn.z));
    last_turn_rad_ = 2 * std::atan2(sine, std::abs(turn.w));
    last_travel_voxels_ = glm::length(pose.position_m - last_.position_m) / voxel_size_m_;
    turn_rad_ += last_turn_rad_;
    travel_voxels_ += last_travel_voxels_;
  }
  has_last_ = true;
  last_ = pose;
  if (!(travel_voxels_ + radius_voxels_ * turn_rad_ < kMostMotionVoxels)) forget_slack();
}

std::uint32_t BlockSkipper::not_known_free(const Level& level, std::uint32_t begin,
                                           std::uint32_t end) const noexcept {
  const auto travel = static_cast<float>(travel_voxels_), turn = static_cast<float>(turn_rad_);
  std::uint32_t spent = 0;
  for (std::uint32_t i = begin; i < end; ++i) {
    const bool is_spent = travel + level.reach_voxels[i] * turn >= level.free_until[i];
    spent |= static_cast<std::uint32_t>(is_spent) << (i - begin);
  }
  return spent;
}

// Surveys the group's discs anew. With coherence, earlier slack that reaches further is kept.
void BlockSkipper::survey(const KernelMap& map, const VoxelPose& pose, Level& level,
                          std::uint32_t begin, std::uint32_t end) noexcept {
  float slack[kGroup];
  survey_discs(map, pose, margin_, {level.place.data(), level.shape.data()}, begin, end, slack);
  const auto travel = static_cast<float>(travel_voxels_), turn = static_cast<float>(turn_rad_);
  for (std::uint32_t i = begin; i < end; ++i) {
    const float here = travel + level.reach_voxels[i] * turn;
    const float by = std::min(slack[i - begin], static_cast<float>(kMostMotionVoxels));
    const float until = by > kMotionRounding ? here + by - kMotionRounding : kNever;
    level.free_until[i] = options_.coherence ? std::max(level.free_until[i], until) : until;
  }
}

// Calls visit(i) for the discs of [begin, end) that are not known to be free. They are surveyed
// first, unless let_be(i) says of all of them that this is in vain.
template <typename LetBe, typename Visit>
void BlockSkipper::visit_near(const KernelMap& map, const VoxelPose& pose, Level& level,
                              std::uint32_t begin, std::uint32_t end, LetBe let_be,
                              Visit visit) noexcept {
  for (std::uint32_t first = begin; first < end; first += kGroup) {
    const std::uint32_t last = std::min(end, first + kGroup);
    std::uint32_t near = not_known_free(level, first, last);
    bool worth = !options_.coherence;
    for (std::uint32_t left = near; left != 0 && !worth; left &= left - 1) {
      worth = !let_be(first + static_cast<std::uint32_t>(std::countr_zero(left)));
    }
    if (worth) {
      survey(map, pose, level, first, last);
      near = not_known_free(level, first, last);
    }
    for (; near != 0; near &= near - 1) {
      visit(first + static_cast<std::uint32_t>(std::countr_zero(near)));
    }
  }
}

// Takes the rows of a block that is not known to be free.
void BlockSkipper::take_rows(const KernelMap& map, const VoxelPose& pose,
                             std::uint32_t block) noexcept {
  const std::uint32_t begin = block * block_rows_, end = std::min(begin + block_rows_, row_count_);
  if (!row_skipper_) {
    for (std::uint32_t row = begin; row < end; ++row) candidates_[candidate_count_++] = row;
    return;
  }
  const float reach = blocks_.reach_voxels[block];
  const SpentMotion motion = {
      static_cast<float>(travel_voxels_) + reach * static_cast<float>(turn_rad_),
      static_cast<float>(last_travel_voxels_) + reach * static_cast<float>(last_turn_rad_)};
  const float until = row_skipper_->take_near(map, pose, margin_, block, motion, candidates_.data(),
                                              candidate_count_);
  blocks_.free_until[block] = std::max(blocks_.free_until[block], until);
}

std::span<const std::uint32_t> BlockSkipper::candidates(const KernelMap& map,
                                                        const Pose& world_from_center,
                                                        const VoxelPose& pose,
                                                        double rounding_voxels) noexcept {
  candidate_count_ = 0;
  if (!options_.clearance || !is_unit(world_from_center.orientation)) {
    for (std::uint32_t row = 0; row < row_count_; ++row) candidates_[row] = row;
    return candidates_;
  }
  spend_motion(world_from_center);
  margin_.scale = static_cast<float>(kRadiusRounding / voxel_size_m_);
  // The center's own rounding, a point's, and what kUnitTolerance leaves of the radius.
  margin_.voxels = static_cast<float>(2 * rounding_voxels + 2 * kUnitTolerance * radius_voxels_);
  const auto take = [&](std::uint32_t block) { take_rows(map, pose, block); };
  const auto let_be = [&](std::uint32_t block) {
    return row_skipper_ && row_skipper_->lets_be(block);
  };
  if (!options_.super_blocks) {
    visit_near(map, pose, blocks_, 0, blocks_.count, let_be, take);
    return {candidates_.data(), candidate_count_};
  }
  visit_near(
      map, pose, super_blocks_, 0, super_blocks_.count, [](std::uint32_t) { return false; },
      [&](std::uint32_t super) {
        const std::uint32_t first = super * super_block_blocks_;
        visit_near(map, pose, blocks_, first, std::min(blocks_.count, first + super_block_blocks_),
                   let_be, take);
      });
  return {candidates_.data(), candidate_count_};
}

}  // namespace forcelayer::query
