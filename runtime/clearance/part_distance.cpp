#include "runtime/clearance/part_distance.h"

#include <algorithm>
#include <array>
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

int longest(const glm::dvec3& side) {
  return side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
}

}  // namespace

struct PartDistance::Place {
  glm::dmat3 rotation;
  glm::dvec3 center;  // voxels
  double per_meter;
  double travel;  // voxels
  glm::dvec3 of(const glm::dvec3& offset) const { return rotation * offset + center; }
};

PartDistance::PartDistance(const Voxmap& voxmap, const Pshell& shell, const LeftOut& left_out,
                           double cap_voxels)
    : voxmap_(voxmap), shell_(shell), distances_(voxmap, left_out, cap_voxels) {
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
  const PshellView& v = shell.view();
  order_.resize(v.point_count);
  std::iota(order_.begin(), order_.end(), 0u);
  std::vector<std::uint32_t> blocks(v.point_count == 0 ? 0 : v.block_count);
  std::iota(blocks.begin(), blocks.end(), 0u);
  if (!blocks.empty()) make_nodes(blocks);
}

std::uint32_t PartDistance::add_node() {
  nodes_.emplace_back();
  return static_cast<std::uint32_t>(nodes_.size() - 1);
}

void PartDistance::enclose_halves(std::uint32_t node) {
  const Node &a = nodes_[node + 1], &b = nodes_[nodes_[node].second];
  const glm::dvec3 way = b.center - a.center;
  const double apart = glm::length(way);
  // The sphere around both touches them from within on the line through their centers.
  const double radius = std::max({a.radius, b.radius, (apart + a.radius + b.radius) / 2});
  const double share = apart > 0 ? std::clamp((radius - a.radius) / apart, 0.0, 1.0) : 0;
  nodes_[node].center = a.center + share * way;
  nodes_[node].radius =
      std::max(share * apart + a.radius, (1 - share) * apart + b.radius) * kRadiusRounding +
      kRounding;
}

// Blocks by halving them across the longest side of the box of their centers.
void PartDistance::make_nodes(std::span<std::uint32_t> blocks) {
  const PshellView& v = shell_.view();
  if (blocks.size() == 1) {
    const std::size_t begin = std::min<std::size_t>(blocks[0] * v.block_points, v.point_count);
    std::size_t groups = 1;
    while (groups * kGroupPoints < v.block_points) groups *= 2;
    make_points(begin, std::min<std::size_t>(begin + v.block_points, v.point_count), groups);
    return;
  }
  glm::dvec3 low(kInfinity), high(-kInfinity);
  const auto center = [&](std::uint32_t i) {
    return glm::dvec3(v.blocks[i].x, v.blocks[i].y, v.blocks[i].z);
  };
  for (const std::uint32_t i : blocks)
    low = glm::min(low, center(i)), high = glm::max(high, center(i));
  const int axis = longest(high - low);
  const std::size_t half = (blocks.size() + 1) / 2;
  std::nth_element(blocks.begin(), blocks.begin() + static_cast<std::ptrdiff_t>(half), blocks.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     return std::pair(center(a)[axis], a) < std::pair(center(b)[axis], b);
                   });
  const std::uint32_t node = add_node();
  make_nodes(blocks.first(half));
  nodes_[node].second = static_cast<std::uint32_t>(nodes_.size());
  make_nodes(blocks.subspan(half));
  enclose_halves(node);
}

// The points of a block in the same way, down to a group of them.
void PartDistance::make_points(std::size_t begin, std::size_t end, std::size_t groups) {
  const PshellView& v = shell_.view();
  const auto points = std::span(order_).subspan(begin, end - begin);
  const auto offset = [&](std::uint32_t i) { return glm::dvec3(v.x[i], v.y[i], v.z[i]); };
  glm::dvec3 low(kInfinity), high(-kInfinity);
  for (const std::uint32_t i : points)
    low = glm::min(low, offset(i)), high = glm::max(high, offset(i));
  const std::uint32_t node = add_node();
  if (groups > 1 && points.size() > 1) {
    const int axis = longest(high - low);
    const std::size_t half = (points.size() + 1) / 2;
    std::nth_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(half),
                     points.end(), [&](std::uint32_t a, std::uint32_t b) {
                       return std::pair(offset(a)[axis], a) < std::pair(offset(b)[axis], b);
                     });
    make_points(begin, begin + half, groups / 2);
    nodes_[node].second = static_cast<std::uint32_t>(nodes_.size());
    make_points(begin + half, end, groups / 2);
  }
  nodes_[node].begin = static_cast<std::uint32_t>(begin);
  nodes_[node].end = static_cast<std::uint32_t>(end);
  const glm::dvec3 center = 0.5 * (low + high);
  double radius = 0;
  for (const std::uint32_t i : points) radius = std::max(radius, glm::length(offset(i) - center));
  nodes_[node].center = center / voxmap_.voxel_size_m();
  nodes_[node].radius = radius / voxmap_.voxel_size_m() * kRadiusRounding + kRounding;
}

void PartDistance::forget() {
  ++path_;
  last_points_ = 0;
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

bool PartDistance::is_unknown(const glm::dvec3& place_m) const {
  return distances_.is_unknown(to_voxels(place_m));
}

double PartDistance::known(const Node& node, const Place& place) const {
  return node.path == path_ ? node.least - std::abs(place.travel - node.travel) : -kInfinity;
}

// A lower bound of the distance of a sphere's points; at least the limit where they are that far.
double PartDistance::bound(const Place& place, Node& node) {
  const double before = known(node, place);
  // The bound of a large sphere is refined until it is all that is wished for: a part that is far
  // away can then be skipped for long.
  const bool closely = limit() + node.radius < distances_.cap_voxels();
  if (before >= (closely ? limit() : std::max(limit(), wished_))) return before;
  const glm::dvec3 center = place.of(node.center);
  double least = distances_.free_around(center) - node.radius;
  if (closely && least < limit()) least = std::max(least, distances_.at(center) - node.radius);
  if (least <= before) return before;
  node.least = least;
  node.travel = place.travel;
  node.path = path_;
  return least;
}

double PartDistance::distance(const Place& place, std::size_t point) {
  const PshellView& v = shell_.view();
  const glm::dvec3 at = place.of(glm::dvec3(v.x[point], v.y[point], v.z[point]) * place.per_meter);
  const double distance = distances_.at(at);
  if (distance <= reach_voxels(voxmap_.header())) return distance;
  return std::max(distance, distances_.free_around(at));
}

// Whether all of its points were looked at.
bool PartDistance::look_at_points(const Place& place, Node& node) {
  double least = kInfinity;
  for (std::size_t n = node.begin; n < node.end; ++n) {
    const double there = distance(place, order_[n]);
    least = std::min(least, there);
    if (there >= best_.voxels) continue;
    best_ = {there, order_[n]};
    last_points_ = static_cast<std::uint32_t>(&node - nodes_.data());
    if (stops()) return false;
  }
  node.least = least;
  node.travel = place.travel;
  node.path = path_;
  return true;
}

// The same of what is not too far.
bool PartDistance::look_at(const Place& place, std::uint32_t at) {
  Node& node = nodes_[at];
  if (node.second == 0) return look_at_points(place, node);
  std::array<std::uint32_t, 2> halves{at + 1, node.second};
  std::array<double, 2> bounds{bound(place, nodes_[halves[0]]), bound(place, nodes_[halves[1]])};
  const std::size_t nearer = bounds[1] < bounds[0] ? 1 : 0;
  for (const std::size_t i : {nearer, 1 - nearer}) {
    if (bounds[i] < limit()) {
      if (!look_at(place, halves[i])) return false;
    } else {
      rest_ = std::min(rest_, bounds[i]);
    }
  }
  const double least = std::min(known(nodes_[halves[0]], place), known(nodes_[halves[1]], place));
  if (least <= known(node, place)) return true;
  node.least = least;
  node.travel = place.travel;
  node.path = path_;
  return true;
}

LeastDistance PartDistance::at(const Pose& world_from_center, double travel_m, double enough_voxels,
                               double stop_voxels) {
  const double s = voxmap_.voxel_size_m();
  const Place place{glm::mat3_cast(world_from_center.orientation),
                    to_voxels(world_from_center.position_m), 1 / s, travel_m / s};
  const double whole = distances_.free_around(place.center) - radius_;
  if (whole >= enough_voxels) return {whole, LeastDistance::kNone};
  best_ = {kInfinity, LeastDistance::kNone};
  rest_ = kInfinity;
  wished_ = enough_voxels;
  enough_ = std::min(enough_voxels, distances_.cap_voxels());
  stop_ = stop_voxels;
  if (last_stop_ != LeastDistance::kNone && stop_ > 0) {
    const double there = distance(place, last_stop_);
    if (there < stop_) return {there, last_stop_};
  }
  if (last_points_ != 0) look_at_points(place, nodes_[last_points_]);
  if (!stops() && !nodes_.empty()) look_at(place, 0);
  if (stops()) last_stop_ = best_.point;
  if (best_.voxels < enough_) return best_;
  return {std::min(best_.voxels, rest_), LeastDistance::kNone};
}

}  // namespace forcelayer::clearance
