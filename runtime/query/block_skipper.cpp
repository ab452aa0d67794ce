#include "runtime/query/block_skipper.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "runtime/query/contact_query.h"

namespace forcelayer::query {
namespace {

constexpr std::uint32_t kGroup = 16;        // discs looked at together: a vector
constexpr double kMostMotionVoxels = 4096;  // then all slack is forgotten, so that floats stay fine
constexpr float kMotionRounding = 0.01f;    // voxels: float sums of up to 2 * 4096 err by 0.002
constexpr double kUnitTolerance = 1e-9;     // of an orientation's length, squared; else no skipping
constexpr double kRadiusRounding = 1 + 1e-6;  // of a float radius in voxels
constexpr float kNever = -1;

bool is_unit(const glm::dquat& q) { return std::abs(glm::dot(q, q) - 1) < kUnitTolerance; }

constexpr double kDiscRounding = 1 + 1e-6;  // of extents along an axis that is not quite unit

// Appends the disc that holds points [begin, end): about `center`, its axis along their mean
// normal.
void append_disc(const PshellView& shell, std::uint64_t begin, std::uint64_t end,
                 const BoundingSphere& center, std::vector<float>& place,
                 std::vector<float>& shape) {
  glm::dvec3 sum(0);
  for (std::uint64_t i = begin; i < end; ++i) {
    sum += glm::dvec3(shell.nx[i], shell.ny[i], shell.nz[i]);
  }
  const double length = glm::length(sum);
  const glm::vec3 axis = length > 1e-6 ? glm::vec3(sum / length) : glm::vec3(0, 0, 1);
  const glm::dvec3 unit = glm::normalize(glm::dvec3(axis));
  double radius2_m2 = 0, half_height_m = 0;
  for (std::uint64_t i = begin; i < end; ++i) {
    const glm::dvec3 from_center(double{shell.x[i]} - center.x, double{shell.y[i]} - center.y,
                                 double{shell.z[i]} - center.z);
    const double along = glm::dot(from_center, unit);
    const glm::dvec3 across = from_center - along * unit;
    half_height_m = std::max(half_height_m, std::abs(along));
    radius2_m2 = std::max(radius2_m2, glm::dot(across, across));
  }
  place.insert(place.end(), {center.x, center.y, center.z,
                             static_cast<float>(std::sqrt(radius2_m2) * kDiscRounding)});
  shape.insert(shape.end(),
               {axis.x, axis.y, axis.z, static_cast<float>(half_height_m * kDiscRounding)});
}

}  // namespace

[[gnu::cold]] BlockSkipper::BlockSkipper(const Pshell& shell, double voxel_size_m,
                                         const SkipOptions& options)
    : voxel_size_m_(voxel_size_m),
      options_(options),
      super_block_blocks_(shell.view().super_block_blocks),
      blocks_(make_level(shell.view(), shell.view().blocks, shell.view().block_count,
                         shell.view().block_points)),
      super_blocks_(make_level(shell.view(), shell.view().super_blocks,
                               shell.view().super_block_count,
                               std::uint64_t{shell.view().block_points} * super_block_blocks_)),
      radius_voxels_(shell.header().bounding_radius_m / voxel_size_m),
      candidates_(shell.view().block_count) {}

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
    append_disc(shell, i * run_points, std::min(shell.point_count, (i + 1) * run_points), s,
                level.place, level.shape);
  }
  return level;
}

void BlockSkipper::forget_slack() noexcept {
  for (Level* level : {&blocks_, &super_blocks_}) {
    std::fill(level->free_until.begin(), level->free_until.end(), kNever);
  }
  travel_voxels_ = turn_rad_ = 0;
}

void BlockSkipper::spend_motion(const Pose& pose) noexcept {
  if (has_last_) {
    const glm::dquat turn = pose.orientation * glm::conjugate(last_.orientation);
    const double sine = glm::length(glm::dvec3(turn.x, turn.y, turn.z));
    turn_rad_ += 2 * std::atan2(sine, std::abs(turn.w));
    travel_voxels_ += glm::length(pose.position_m - last_.position_m) / voxel_size_m_;
  }
  has_last_ = true;
  last_ = pose;
  if (!(travel_voxels_ + radius_voxels_ * turn_rad_ < kMostMotionVoxels)) forget_slack();
}

bool BlockSkipper::all_known_free(const Level& level, std::uint32_t begin,
                                  std::uint32_t end) const noexcept {
  if (!options_.coherence) return false;
  const auto travel = static_cast<float>(travel_voxels_), turn = static_cast<float>(turn_rad_);
  unsigned spent = 0;
  for (std::uint32_t i = begin; i < end; ++i) {
    spent |= travel + level.reach_voxels[i] * turn >= level.free_until[i];
  }
  return spent == 0;
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

// Calls visit(i) for the discs of [begin, end) that are not known to be free.
template <typename Visit>
void BlockSkipper::visit_near(const KernelMap& map, const VoxelPose& pose, Level& level,
                              std::uint32_t begin, std::uint32_t end, Visit visit) noexcept {
  const auto travel = static_cast<float>(travel_voxels_), turn = static_cast<float>(turn_rad_);
  for (std::uint32_t first = begin; first < end; first += kGroup) {
    const std::uint32_t last = std::min(end, first + kGroup);
    if (all_known_free(level, first, last)) continue;
    survey(map, pose, level, first, last);
    for (std::uint32_t i = first; i < last; ++i) {
      if (travel + level.reach_voxels[i] * turn >= level.free_until[i]) visit(i);
    }
  }
}

std::span<const std::uint32_t> BlockSkipper::candidates(const KernelMap& map,
                                                        const Pose& world_from_center,
                                                        const VoxelPose& pose,
                                                        double rounding_voxels) noexcept {
  std::uint32_t count = 0;
  const auto take = [&](std::uint32_t block) { candidates_[count++] = block; };
  if (!options_.clearance || !is_unit(world_from_center.orientation)) {
    for (std::uint32_t block = 0; block < candidates_.size(); ++block) take(block);
    return {candidates_.data(), count};
  }
  spend_motion(world_from_center);
  margin_.scale = static_cast<float>(kRadiusRounding / voxel_size_m_);
  // The center's own rounding, a point's, and what kUnitTolerance leaves of the radius.
  margin_.voxels = static_cast<float>(2 * rounding_voxels + 2 * kUnitTolerance * radius_voxels_);
  if (!options_.super_blocks) {
    visit_near(map, pose, blocks_, 0, blocks_.count, take);
    return {candidates_.data(), count};
  }
  visit_near(map, pose, super_blocks_, 0, super_blocks_.count, [&](std::uint32_t super) {
    const std::uint32_t first = super * super_block_blocks_;
    visit_near(map, pose, blocks_, first, std::min(blocks_.count, first + super_block_blocks_),
               take);
  });
  return {candidates_.data(), count};
}

}  // namespace forcelayer::query
