#include "runtime/clearance/part_distance.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

namespace forcelayer::clearance {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-6;  // voxels: exceeds that of a bound here
constexpr double kRadiusRounding = 1 + 1e-9;
constexpr std::size_t kGroupPoints = 8;

}  // namespace

struct PartDistance::Place {
  glm::dmat3 rotation;
  glm::dvec3 center;  // voxels
  double per_meter;
  double travel;  // voxels
  glm::dvec3 of(const glm::dvec3& offset) const { return rotation * offset + center; }
};

PartDistance::Level PartDistance::make_level(const BoundingSphere* spheres, std::uint64_t count,
                                             double voxel_size_m) {
  Level level;
  for (std::uint64_t i = 0; i < count; ++i) {
    const BoundingSphere& s = spheres[i];
    level.center.push_back(glm::dvec3(s.x, s.y, s.z) / voxel_size_m);
    level.radius.push_back(double{s.radius} / voxel_size_m * kRadiusRounding + kRounding);
  }
  level.smallest.assign(count, -kInfinity);
  level.travel.assign(count, 0);
  level.question.assign(count, 0);
  return level;
}

PartDistance::PartDistance(const Voxmap& voxmap, const Pshell& shell, const LeftOut& left_out,
                           double cap_voxels)
    : voxmap_(voxmap),
      shell_(shell),
      distances_(voxmap, left_out, cap_voxels),
      blocks_(make_level(shell.view().blocks, shell.view().block_count, voxmap.voxel_size_m())),
      super_blocks_(make_level(shell.view().super_blocks, shell.view().super_block_count,
                               voxmap.voxel_size_m())) {
  radius_ = shell.header().bounding_radius_m / voxmap.voxel_size_m() * kRadiusRounding + kRounding;
  double far = radius_;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    directory_[axis] = static_cast<double>(voxmap.header().directory_origin[i]);
    far = std::max({far, std::abs(directory_[axis]),
                    std::abs(directory_[axis] + 512.0 * voxmap.header().directory_dims[i])});
  }
  // Beside what is rounded under the roots: a place of that size in doubles, over some operations.
  rounding_m_ = (2 * kRounding + std::ldexp(far, -47)) * voxmap.voxel_size_m();
  make_groups();
}

// By halving the points of each block across their longest side.
void PartDistance::make_groups() {
  const PshellView& v = shell_.view();
  groups_a_block_ = 1;
  while (groups_a_block_ * kGroupPoints < v.block_points) groups_a_block_ *= 2;
  order_.resize(v.point_count);
  std::iota(order_.begin(), order_.end(), 0u);
  const auto of = [&](std::uint32_t i, int axis) {
    return (axis == 0 ? v.x : axis == 1 ? v.y : v.z)[i];
  };
  const auto box_of = [&](std::span<const std::uint32_t> points, glm::dvec3& low,
                          glm::dvec3& high) {
    low = glm::dvec3(kInfinity), high = -low;
    for (const std::uint32_t i : points) {
      low = glm::min(low, glm::dvec3(v.x[i], v.y[i], v.z[i]));
      high = glm::max(high, glm::dvec3(v.x[i], v.y[i], v.z[i]));
    }
  };
  const auto halve = [&](const auto& self, std::size_t begin, std::size_t end,
                         std::size_t groups) -> void {
    const auto points = std::span(order_).subspan(begin, end - begin);
    glm::dvec3 low, high;
    box_of(points, low, high);
    const glm::dvec3 side = high - low;
    if (groups > 1) {
      const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
      const std::size_t half = (points.size() + 1) / 2;
      std::nth_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(half),
                       points.end(), [&](std::uint32_t a, std::uint32_t b) {
                         return of(a, axis) != of(b, axis) ? of(a, axis) < of(b, axis) : a < b;
                       });
      self(self, begin, begin + half, groups / 2);
      self(self, begin + half, end, groups / 2);
      return;
    }
    group_first_.push_back(static_cast<std::uint32_t>(begin));
    const glm::dvec3 center = points.empty() ? glm::dvec3(0) : 0.5 * (low + high);
    double radius = 0;
    for (const std::uint32_t i : points) {
      radius = std::max(radius, glm::length(glm::dvec3(v.x[i], v.y[i], v.z[i]) - center));
    }
    groups_.center.push_back(center / voxmap_.voxel_size_m());
    groups_.radius.push_back(radius / voxmap_.voxel_size_m() * kRadiusRounding + kRounding);
  };
  for (std::size_t block = 0; block < v.block_count; ++block) {
    const std::size_t begin = std::min<std::size_t>(block * v.block_points, v.point_count);
    const std::size_t end = std::min<std::size_t>(begin + v.block_points, v.point_count);
    halve(halve, begin, end, groups_a_block_);
  }
  group_first_.push_back(static_cast<std::uint32_t>(v.point_count));
  groups_.smallest.assign(groups_.center.size(), -kInfinity);
  groups_.travel.assign(groups_.center.size(), 0);
}

void PartDistance::forget() {
  std::fill(super_blocks_.smallest.begin(), super_blocks_.smallest.end(), -kInfinity);
  ++question_;
  last_block_ = 0;
}

// Forgets the blocks of a super-block, or the groups of a block, that were looked at before.
void PartDistance::forget_below(Level& level, std::size_t i, Level& below, std::size_t first,
                                std::size_t end) {
  if (std::exchange(level.question[i], question_) == question_) return;
  std::fill(below.smallest.begin() + static_cast<std::ptrdiff_t>(first),
            below.smallest.begin() + static_cast<std::ptrdiff_t>(end), -kInfinity);
}

glm::dvec3 PartDistance::to_voxels(const glm::dvec3& place_m) const {
  return place_m / voxmap_.voxel_size_m() - directory_;
}

glm::dvec3 PartDistance::place_m(const Pose& world_from_center, std::uint32_t point) const {
  const PshellView& v = shell_.view();
  return world_from_center.orientation * glm::dvec3(v.x[point], v.y[point], v.z[point]) +
         world_from_center.position_m;
}

CenterDistances::Nearest PartDistance::nearest(const glm::dvec3& place_m) {
  return distances_.nearest(to_voxels(place_m));
}

bool PartDistance::is_of_side(const glm::dvec3& place_m, double voxels) const {
  return distances_.is_of_side(to_voxels(place_m), voxels);
}

// Whether no point in the sphere can be below the limit. `closely`: by distances too.
bool PartDistance::is_far(const Place& place, Level& level, std::size_t i, bool closely) {
  const double known = level.now(i, place.travel);
  // The bound of a large sphere is refined until it is all that is wished for: a part that is far
  // away can then be skipped for long.
  if (known >= (closely ? limit() : std::max(limit(), wished_))) {
    rest_ = std::min(rest_, known);
    return true;
  }
  const glm::dvec3 center = place.of(level.center[i]);
  const double radius = level.radius[i];
  double smallest = distances_.free_around(center) - radius;
  const double wanted = limit() + radius;
  if (closely && smallest < limit() && wanted < distances_.cap_voxels()) {
    smallest = std::max(smallest, distances_.at(center) - radius);
  }
  if (smallest > known) {
    level.smallest[i] = smallest;
    level.travel[i] = place.travel;
  }
  if (smallest < limit()) return false;
  rest_ = std::min(rest_, smallest);
  return true;
}

double PartDistance::distance(const Place& place, std::size_t point) {
  const PshellView& v = shell_.view();
  const glm::dvec3 at = place.of(glm::dvec3(v.x[point], v.y[point], v.z[point]) * place.per_meter);
  const double distance = distances_.at(at);
  if (distance <= reach_voxels(voxmap_.header())) return distance;
  return std::max(distance, distances_.free_around(at));
}

// Whether all of its points were looked at.
bool PartDistance::look_at_group(const Place& place, std::size_t group) {
  double smallest = kInfinity;
  for (std::size_t n = group_first_[group]; n < group_first_[group + 1]; ++n) {
    const double there = distance(place, order_[n]);
    ++points_looked_at_;
    smallest = std::min(smallest, there);
    if (there >= best_.voxels) continue;
    best_ = {there, order_[n]};
    if (stops()) return false;
  }
  groups_.smallest[group] = smallest;
  groups_.travel[group] = place.travel;
  return true;
}

void PartDistance::look_at_block(const Place& place, std::size_t block) {
  double smallest = kInfinity;
  const double before = best_.voxels;
  forget_below(blocks_, block, groups_, first_group(block), first_group(block + 1));
  for (std::size_t group = first_group(block); group < first_group(block + 1); ++group) {
    if (group_first_[group] == group_first_[group + 1]) continue;
    if (!is_far(place, groups_, group, true) && !look_at_group(place, group)) return;
    smallest = std::min(smallest, groups_.now(group, place.travel));
  }
  if (best_.voxels < before) last_block_ = block;
  blocks_.smallest[block] = smallest;
  blocks_.travel[block] = place.travel;
}

void PartDistance::look_at_blocks(const Place& place, std::size_t super_block) {
  const PshellView& v = shell_.view();
  const std::size_t begin = super_block * v.super_block_blocks;
  const std::size_t end = std::min<std::size_t>(begin + v.super_block_blocks, v.block_count);
  double smallest = kInfinity;
  forget_below(super_blocks_, super_block, blocks_, begin, end);
  for (std::size_t block = begin; block < end; ++block) {
    if (!is_far(place, blocks_, block, true)) look_at_block(place, block);
    if (stops()) return;
    smallest = std::min(smallest, blocks_.now(block, place.travel));
  }
  super_blocks_.smallest[super_block] = smallest;
  super_blocks_.travel[super_block] = place.travel;
}

MinDistance PartDistance::at(const Pose& world_from_center, double travel_m, double enough_voxels,
                             double stop_voxels) {
  const double s = voxmap_.voxel_size_m();
  const Place place{glm::mat3_cast(world_from_center.orientation),
                    to_voxels(world_from_center.position_m), 1 / s, travel_m / s};
  const double whole = distances_.free_around(place.center) - radius_;
  if (whole >= enough_voxels) return {whole, MinDistance::kNone};
  best_ = {kInfinity, MinDistance::kNone};
  rest_ = kInfinity;
  wished_ = enough_voxels;
  enough_ = std::min(enough_voxels, distances_.cap_voxels());
  stop_ = stop_voxels;
  if (last_stop_ != MinDistance::kNone && stop_ > 0) {
    const double there = distance(place, last_stop_);
    if (there < stop_) return {there, last_stop_};
  }
  const std::size_t last_super_block = last_block_ / shell_.view().super_block_blocks;
  if (super_blocks_.question[last_super_block] == question_ &&
      blocks_.smallest[last_block_] > -kInfinity) {
    look_at_block(place, last_block_);
  }
  for (std::size_t i = 0; i < super_blocks_.smallest.size() && !stops(); ++i) {
    if (!is_far(place, super_blocks_, i, false)) look_at_blocks(place, i);
  }
  if (stops()) last_stop_ = best_.point;
  if (best_.voxels < enough_) return best_;
  return {std::min(best_.voxels, rest_), MinDistance::kNone};
}

}  // namespace forcelayer::clearance
