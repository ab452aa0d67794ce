#include "runtime/query/row_skipper.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "runtime/query/contact_query.h"

namespace forcelayer::query {
namespace {

constexpr double kDiscRounding = 1 + 1e-6;  // of extents along an axis that is not quite unit
constexpr float kAxes = 1.7320509f;         // a bound per axis is this much along any direction
constexpr float kAxisRounding = 1e-4f;      // voxels: of a disc's height along an axis of floats
// Leeway is sought for a number of runs like the last one, within bounds in voxels. More lasts
// longer, and takes more bricks to find. Beside a wall a part slides and turns farther than it
// presses.
constexpr float kMostRuns = 40, kLeastLeeway = 0.5f;
constexpr Leeway kMostBlockLeeway = {3, 8}, kMostRowLeeway = {2, 6};
// Runs that leeway must last, else looking up is cheaper than trying again.
constexpr float kLeastRuns = 2;
// A piece that is not free most likely has points in contact, now and in the next runs; trying a
// row costs about as much as looking it up.
constexpr std::uint8_t kLooksBetweenTries = 24;

[[gnu::cold]] std::array<float, 3> middle_of(const PshellView& shell, std::uint64_t begin,
                                             std::uint64_t end) {
  std::array<float, 3> middle{};
  for (int axis = 0; const float* column : {shell.x, shell.y, shell.z}) {
    const auto [low, high] = std::minmax_element(column + begin, column + end);
    middle[axis++] = (*low + *high) / 2;
  }
  return middle;
}

float dot(const std::array<float, 3>& row, const std::array<float, 3>& v) {
  return row[0] * v[0] + row[1] * v[1] + row[2] * v[2];
}

PlacedDisc place(const PartDisc& disc, const VoxelPose& pose, const DiscMargin& margin) {
  PlacedDisc placed{};
  for (int axis = 0; axis < 3; ++axis) {
    placed.center[axis] = dot(pose.turn[axis], disc.center) + pose.fraction[axis];
    placed.axis[axis] = dot(pose.rotation[axis], disc.axis);
  }
  placed.whole = pose.whole;
  placed.radius = disc.radius * margin.scale;
  placed.half_height = disc.half_height * margin.scale;
  placed.margin = kAxes * margin.voxels + kAxisRounding;
  return placed;
}

// By how much the last run's motion moved a disc's points along and across its axis, about.
Leeway last_motion(const PlacedDisc& disc, const VoxelPose& pose, const SpentMotion& motion) {
  const glm::vec3 arm(disc.center[0] - pose.fraction[0], disc.center[1] - pose.fraction[1],
                      disc.center[2] - pose.fraction[2]);
  const glm::vec3 axis(disc.axis[0], disc.axis[1], disc.axis[2]);
  const glm::vec3 moved = motion.last.travel_voxels + glm::cross(motion.last.turn_rad, arm);
  const float tilt = glm::length(motion.last.turn_rad) * disc.radius;
  return {std::abs(glm::dot(axis, moved)) + tilt, glm::length(moved) + tilt};
}

}  // namespace

[[gnu::cold]] PartDisc disc_of(const PshellView& shell, std::uint64_t begin, std::uint64_t end,
                               const std::array<float, 3>& center) {
  glm::dvec3 sum(0);
  for (std::uint64_t i = begin; i < end; ++i) {
    sum += glm::dvec3(shell.nx[i], shell.ny[i], shell.nz[i]);
  }
  const double length = glm::length(sum);
  const glm::vec3 axis = length > 1e-6 ? glm::vec3(sum / length) : glm::vec3(0, 0, 1);
  const glm::dvec3 unit = glm::normalize(glm::dvec3(axis));
  double radius2_m2 = 0, half_height_m = 0;
  for (std::uint64_t i = begin; i < end; ++i) {
    const glm::dvec3 from_center(double{shell.x[i]} - center[0], double{shell.y[i]} - center[1],
                                 double{shell.z[i]} - center[2]);
    const double along = glm::dot(from_center, unit);
    const glm::dvec3 across = from_center - along * unit;
    half_height_m = std::max(half_height_m, std::abs(along));
    radius2_m2 = std::max(radius2_m2, glm::dot(across, across));
  }
  return {center,
          {axis.x, axis.y, axis.z},
          static_cast<float>(std::sqrt(radius2_m2) * kDiscRounding),
          static_cast<float>(half_height_m * kDiscRounding)};
}

[[gnu::cold]] RowSkipper::Pieces RowSkipper::cut(const PshellView& shell,
                                                 std::uint64_t piece_points) {
  Pieces pieces;
  for (std::uint64_t begin = 0; begin < shell.point_count; begin += piece_points) {
    const std::uint64_t end = std::min(begin + piece_points, shell.point_count);
    pieces.discs.push_back(disc_of(shell, begin, end, middle_of(shell, begin, end)));
  }
  pieces.found.resize(pieces.discs.size());
  pieces.free_until.assign(pieces.discs.size(), kNever);
  pieces.let_be.assign(pieces.discs.size(), 0);
  return pieces;
}

[[gnu::cold]] RowSkipper::RowSkipper(const Voxmap& voxmap, const Pshell& shell, bool coherence)
    : coherence_(coherence),
      bounds_(voxmap),
      block_rows_(shell.view().block_points / kRowPoints),
      blocks_(cut(shell.view(), shell.view().block_points)),
      rows_(cut(shell.view(), kRowPoints)) {
  row_count_ = static_cast<std::uint32_t>(rows_.discs.size());
}

void RowSkipper::forget() noexcept {
  for (Pieces* pieces : {&blocks_, &rows_}) {
    std::fill(pieces->free_until.begin(), pieces->free_until.end(), kNever);
    for (FoundFree& found : pieces->found) found.leeway = {};
  }
  has_base_ = false;
}

std::array<float, 3> RowSkipper::from_base(const PlacedDisc& disc) const noexcept {
  std::array<float, 3> center{};
  for (int axis = 0; axis < 3; ++axis) {
    center[axis] = disc.center[axis] + float(disc.whole[axis] - base_[axis]);
  }
  return center;
}

// How far, in voxels, each point of a disc may move from where it is now, since it was found free.
// A disc that tilted is compared with itself tilted back about its center, which moves no point of
// it by more than the change of its unit axis times its reach. At most 0 where it has left.
float RowSkipper::leeway_left(const FoundFree& found, const PlacedDisc& now) const noexcept {
  const std::array<float, 3> center = from_base(now);
  float along = 0, all2 = 0, tilt2 = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float moved = center[axis] - found.center[axis];
    const float tilted = now.axis[axis] - found.axis[axis];
    along += moved * found.axis[axis];
    all2 += moved * moved;
    tilt2 += tilted * tilted;
  }
  const float more =
      std::sqrt(tilt2) * (now.radius + now.half_height) + 2 * now.margin + kMotionRounding;
  return std::min(found.leeway.along - std::abs(along), found.leeway.across - std::sqrt(all2)) -
         more;
}

bool RowSkipper::is_free(const KernelMap& map, const VoxelPose& pose, const DiscMargin& margin,
                         Pieces& pieces, std::uint32_t i, const Leeway& most,
                         const SpentMotion& motion) noexcept {
  if (coherence_ && motion.spent < pieces.free_until[i]) return true;
  if (coherence_ && pieces.let_be[i] > 0) {
    --pieces.let_be[i];
    return false;
  }
  FoundFree& found = pieces.found[i];
  const PlacedDisc disc = place(pieces.discs[i], pose, margin);
  if (coherence_ && found.leeway.along > 0) {
    const float left = leeway_left(found, disc);
    if (left > 0) {
      pieces.free_until[i] = motion.spent + left;
      return true;
    }
  }
  const Leeway last = last_motion(disc, pose, motion);
  const Leeway wanted = {std::clamp(kMostRuns * last.along, kLeastLeeway, most.along),
                         std::clamp(kMostRuns * last.across, kLeastLeeway, most.across)};
  const float share = bounds_.share(map, disc, wanted);
  const Leeway leeway = {share * wanted.along, share * wanted.across};
  const float left = std::min(leeway.along, leeway.across) - kMotionRounding;
  if (left > 0 && leeway.along > kMotionRounding + kLeastRuns * last.along &&
      leeway.across > kMotionRounding + kLeastRuns * last.across) {
    if (!has_base_) base_ = disc.whole;
    has_base_ = true;
    found = {from_base(disc), disc.axis, leeway};
    pieces.free_until[i] = motion.spent + left;
    return true;
  }
  found.leeway = {};
  pieces.free_until[i] = kNever;
  pieces.let_be[i] = coherence_ ? kLooksBetweenTries : 0;
  return false;
}

float RowSkipper::known_free_until(const VoxelPose& pose, const DiscMargin& margin,
                                   std::uint32_t block, const SpentMotion& motion) noexcept {
  const FoundFree& found = blocks_.found[block];
  if (!coherence_ || !(found.leeway.along > 0)) return kNever;
  const float left = leeway_left(found, place(blocks_.discs[block], pose, margin));
  if (!(left > 0)) return kNever;
  return blocks_.free_until[block] = motion.spent + left;
}

float RowSkipper::take_near(const KernelMap& map, const VoxelPose& pose, const DiscMargin& margin,
                            std::uint32_t block, const SpentMotion& motion, std::uint32_t* rows,
                            std::uint32_t& count) noexcept {
  if (is_free(map, pose, margin, blocks_, block, kMostBlockLeeway, motion)) {
    return blocks_.free_until[block];
  }
  const std::uint32_t before = count, begin = block * block_rows_;
  float until = std::numeric_limits<float>::max();
  for (std::uint32_t row = begin; row < std::min(begin + block_rows_, row_count_); ++row) {
    if (!is_free(map, pose, margin, rows_, row, kMostRowLeeway, motion)) rows[count++] = row;
    until = std::min(until, rows_.free_until[row]);
  }
  return count == before ? until : kNever;
}

}  // namespace forcelayer::query
