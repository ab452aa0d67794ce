#include "runtime/query/block_skipper.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "runtime/query/contact_query.h"

namespace forcelayer::query {
namespace {

constexpr std::uint32_t kGroup = 16;       // discs looked at together: a vector
constexpr double kMaxMotionVoxels = 4096;  // then all slack is forgotten, so that floats stay fine
constexpr float kMotionRounding = RowSkipper::kMotionRounding;
constexpr double kUnitTolerance = 1e-9;  // of an orientation's length, squared; else no skipping
constexpr double kRadiusRounding = 1 + 1e-6;  // of a float radius in voxels
constexpr float kNever = RowSkipper::kNever;

// How often a disc for which a survey was in vain is let be, by the first disc of its group: groups
// are not all surveyed in one run.
std::uint8_t looks_until_surveyed(std::uint32_t first) {
  return static_cast<std::uint8_t>(16 + (first * 2654435761u >> 28));
}

bool is_unit(const glm::dquat& q) { return std::abs(glm::dot(q, q) - 1) < kUnitTolerance; }

}  // namespace

BlockSkipper::BlockSkipper(const Voxmap& voxmap, const Pshell& shell, const SkipOptions& options)
    : voxel_size_m_(voxmap.voxel_size_m()),
      options_(options),
      super_block_blocks_(shell.view().super_block_blocks),
      block_rows_(shell.view().block_points / kRowPoints),
      super_rows_(super_block_blocks_ * block_rows_),
      row_count_(
          static_cast<std::uint32_t>((shell.view().point_count + kRowPoints - 1) / kRowPoints)),
      blocks_(make_level(shell.view(), shell.view().blocks, shell.view().block_count,
                         shell.view().block_points)),
      super_blocks_(make_level(shell.view(), shell.view().super_blocks,
                               shell.view().super_block_count,
                               std::uint64_t{shell.view().block_points} * super_block_blocks_)),
      radius_voxels_(shell.header().bounding_radius_m / voxel_size_m_),
      candidates_(row_count_),
      near_(shell.view().super_block_count) {
  if (options.clearance && options.walls) row_skipper_.emplace(voxmap, shell, options.coherence);
}

BlockSkipper::~BlockSkipper() = default;

BlockSkipper::Level BlockSkipper::make_level(const PshellView& shell, const BoundingSphere* spheres,
                                             std::uint64_t count, std::uint64_t run_points) const {
  Level level;
  if (!options_.clearance) return level;
  level.count = static_cast<std::uint32_t>(count);
  level.free_until.assign(count, kNever);
  level.let_be.assign(count, 0);
  for (std::uint64_t i = 0; i < count; ++i) {
    const BoundingSphere& s = spheres[i];
    const double reach_m =
        std::sqrt(double{s.x} * s.x + double{s.y} * s.y + double{s.z} * s.z) + s.radius;
    level.reach_voxels.push_back(static_cast<float>(reach_m / voxel_size_m_ * kRadiusRounding));
    const PartDisc disc = disc_of(
        shell, i * run_points, std::min(shell.point_count, (i + 1) * run_points), {s.x, s.y, s.z});
    level.place.push_back(disc.place);
    level.shape.push_back(disc.shape);
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
    const glm::dvec3 sine(turn.x, turn.y, turn.z);
    const double angle = 2 * std::atan2(glm::length(sine), std::abs(turn.w));
    const glm::dvec3 travel = (pose.position_m - last_.position_m) / voxel_size_m_;
    last_motion_ = {travel, (turn.w < 0 ? -2.0 : 2.0) * sine};  // right for small turns
    turn_rad_ += angle;
    travel_voxels_ += glm::length(travel);
  }
  has_last_ = true;
  last_ = pose;
  if (!(travel_voxels_ + radius_voxels_ * turn_rad_ < kMaxMotionVoxels)) forget_slack();
}

std::uint32_t BlockSkipper::not_known_free(const Level& level, std::uint32_t begin,
                                           std::uint32_t end) const noexcept {
  const auto travel = static_cast<float>(travel_voxels_), turn = static_cast<float>(turn_rad_);
  const float *reach = &level.reach_voxels[begin], *until = &level.free_until[begin];
  if (end - begin < kGroup) {  // behind it another thread may be writing
    std::uint32_t bits = 0;
    for (std::uint32_t i = 0; i < end - begin; ++i) {
      bits |= std::uint32_t{travel + reach[i] * turn >= until[i]} << i;
    }
    return bits;
  }
  FourBits spent = {}, bits = {1, 2, 4, 8};
  for (std::uint32_t i = 0; i < kGroup; i += 4, bits <<= 4) {
    spent |= (travel + load_four(reach + i) * turn >= load_four(until + i)) & bits;
  }
  return static_cast<std::uint32_t>(spent[0] | spent[1] | spent[2] | spent[3]);
}

// A super-block is known free while all of its blocks are.
void BlockSkipper::remember_blocks(std::uint32_t super, std::uint32_t begin,
                                   std::uint32_t end) noexcept {
  const auto travel = static_cast<float>(travel_voxels_), turn = static_cast<float>(turn_rad_);
  float left = kMaxMotionVoxels;
  for (std::uint32_t i = begin; i < end; ++i) {
    left = std::min(left, blocks_.free_until[i] - (travel + blocks_.reach_voxels[i] * turn));
  }
  super_blocks_.free_until[super] =
      travel + super_blocks_.reach_voxels[super] * turn + left - kMotionRounding;
}

// Surveys the group's discs anew. With coherence, earlier slack that reaches further is kept.
void BlockSkipper::survey(Level& level, std::uint32_t begin, std::uint32_t end) noexcept {
  float slack[kGroup];
  const KernelDiscs discs = {reinterpret_cast<const float*>(level.place.data()),
                             reinterpret_cast<const float*>(level.shape.data())};
  survey_discs(*map_, *pose_, margin_, discs, begin, end, slack);
  const auto travel = static_cast<float>(travel_voxels_), turn = static_cast<float>(turn_rad_);
  for (std::uint32_t i = begin; i < end; ++i) {
    const float here = travel + level.reach_voxels[i] * turn;
    const float by = std::min(slack[i - begin], static_cast<float>(kMaxMotionVoxels));
    const float until = by > kMotionRounding ? here + by - kMotionRounding : kNever;
    if (until == kNever) level.let_be[i] = looks_until_surveyed(begin);
    level.free_until[i] = options_.coherence ? std::max(level.free_until[i], until) : until;
  }
}

// Calls visit(i) for the discs of [begin, end) that are not known to be free, by known_free(i)
// either. They are surveyed first, unless that was in vain for each of them not long ago.
template <typename KnownFree, typename Visit>
void BlockSkipper::visit_near(Level& level, std::uint32_t begin, std::uint32_t end,
                              KnownFree known_free, Visit visit) noexcept {
  for (std::uint32_t first = begin; first < end; first += kGroup) {
    const std::uint32_t last = std::min(end, first + kGroup);
    std::uint32_t near = not_known_free(level, first, last);
    bool worth = !options_.coherence;
    for (std::uint32_t left = near; left != 0; left &= left - 1) {
      const std::uint32_t i = first + static_cast<std::uint32_t>(std::countr_zero(left));
      if (known_free(i)) {
        near &= ~(left & -left);
      } else if (level.let_be[i] > 0) {
        --level.let_be[i];
      } else {
        worth = true;
      }
    }
    if (worth) {
      survey(level, first, last);
      near = not_known_free(level, first, last);
    }
    for (; near != 0; near &= near - 1) {
      visit(first + static_cast<std::uint32_t>(std::countr_zero(near)));
    }
  }
}

float BlockSkipper::spent(std::uint32_t block) const noexcept {
  return static_cast<float>(travel_voxels_) +
         blocks_.reach_voxels[block] * static_cast<float>(turn_rad_);
}

// Takes the rows of a super-block that is not known to be free.
void BlockSkipper::take_rows(std::uint32_t super, std::uint32_t* rows,
                             std::uint32_t& count) noexcept {
  const std::uint32_t first = super * super_block_blocks_,
                      last = std::min(blocks_.count, first + super_block_blocks_), before = count;
  std::uint32_t tries = RowSkipper::kTriesInVain;
  const auto known_free = [&](std::uint32_t block) {
    if (!row_skipper_) return false;
    const float until = row_skipper_->known_free_until(block, spent(block));
    blocks_.free_until[block] = std::max(blocks_.free_until[block], until);
    return until > 0;
  };
  visit_near(blocks_, first, last, known_free, [&](std::uint32_t block) {
    if (row_skipper_) {
      const float until = row_skipper_->take_near(block, spent(block), tries, rows, count);
      blocks_.free_until[block] = std::max(blocks_.free_until[block], until);
      return;
    }
    const std::uint32_t begin = block * block_rows_;
    const std::uint32_t end = std::min(begin + block_rows_, row_count_);
    for (std::uint32_t row = begin; row < end; ++row) rows[count++] = row;
  });
  if (options_.super_blocks && options_.coherence && count == before) {
    remember_blocks(super, first, last);
  }
}

std::uint32_t BlockSkipper::start(const KernelMap& map, const Pose& world_from_center,
                                  const VoxelPose& pose, double rounding_voxels) noexcept {
  map_ = &map;
  pose_ = &pose;
  std::uint32_t near = 0;
  skips_ = options_.clearance && is_unit(world_from_center.orientation);
  if (skips_) {
    spend_motion(world_from_center);
    margin_.scale = static_cast<float>(kRadiusRounding / voxel_size_m_);
    // The center's own rounding, a point's, and what kUnitTolerance leaves of the radius.
    margin_.voxels = static_cast<float>(2 * rounding_voxels + 2 * kUnitTolerance * radius_voxels_);
    if (row_skipper_) row_skipper_->start(map, pose, margin_, last_motion_);
  }
  const auto take = [&](std::uint32_t super) { near_[near++] = super; };
  if (skips_ && options_.super_blocks) {
    const auto no = [](std::uint32_t) { return false; };
    visit_near(super_blocks_, 0, super_blocks_.count, no, take);
  } else {
    for (std::uint32_t super = 0; super < near_.size(); ++super) take(super);
  }
  return near;
}

std::span<const std::uint32_t> BlockSkipper::candidates(std::uint32_t begin,
                                                        std::uint32_t end) noexcept {
  if (begin == end) return {};
  std::uint32_t* const rows = &candidates_[first_row(begin)];
  std::uint32_t count = 0;
  for (std::uint32_t i = begin; i < end; ++i) {
    if (skips_) {
      take_rows(near_[i], rows, count);
      continue;
    }
    const std::uint32_t first = near_[i] * super_rows_;
    const std::uint32_t last = std::min(first + super_rows_, row_count_);
    for (std::uint32_t row = first; row < last; ++row) rows[count++] = row;
  }
  return {rows, count};
}

}  // namespace forcelayer::query
