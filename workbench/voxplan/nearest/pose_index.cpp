#include "workbench/voxplan/nearest/pose_index.h"

#include <algorithm>
#include <glm/common.hpp>
#include <limits>
#include <numeric>

#include "runtime/query/vector_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "workbench/voxplan/nearest/pose_index.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway requires.
#include <hwy/highway.h>

#ifndef FORCELAYER_POSE_SEARCH
#define FORCELAYER_POSE_SEARCH
namespace forcelayer::voxplan {

// The data of a search that the kernel of each instruction set uses.
struct PoseSearch {
  using Node = PoseIndex::Node;
  using Leaf = PoseIndex::Leaf;
  using Branch = PoseIndex::Branch;
  static constexpr std::uint32_t kLeafPoses = PoseIndex::kLeafPoses;

  const PoseIndex& index;
  const Pose& pose;
  PoseCoordinates at;
  float margin_m;  // exceeds the rounding of a float distance
  PoseIndex::Best best;

  const std::vector<Node>& nodes() const { return index.nodes_; }
  const Leaf& leaf(const Node& node) const { return index.leaves_[node.leaf]; }
  std::vector<Branch>& open() const { return index.open_; }
  void compare(std::uint32_t number) { index.compare(pose, number, best); }
  // The distance in single precision up to which a pose may be as near as the best one.
  float limit_m() const {
    constexpr float kRoundUp = 1 + 0x1p-22f;
    return static_cast<float>(best.distance_m) * kRoundUp + margin_m;
  }
};

}  // namespace forcelayer::voxplan
#endif

HWY_BEFORE_NAMESPACE();
namespace forcelayer::voxplan {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A lower bound of the distance to the poses in a node's box, for both signs of the quaternion.
float BoxDistance(const PoseCoordinates& at, const PoseSearch::Node& node) {
  const hn::CappedTag<float, 4> f;
  const auto zero = hn::Zero(f);
  auto shift = zero, turn = zero, back = zero;
  for (std::size_t i = 0; i < 4; i += hn::Lanes(f)) {
    const auto gap = [&](auto x, std::size_t n) {
      const auto below = hn::Sub(hn::LoadU(f, node.low.data() + n), x);
      const auto above = hn::Sub(x, hn::LoadU(f, node.high.data() + n));
      const auto apart = hn::Max(hn::Max(below, above), zero);
      return hn::Mul(apart, apart);
    };
    const auto q = hn::LoadU(f, at.data() + 4 + i);
    shift = hn::Add(shift, gap(hn::LoadU(f, at.data() + i), i));
    turn = hn::Add(turn, gap(q, 4 + i));
    back = hn::Add(back, gap(hn::Neg(q), 4 + i));
  }
  const float turns =
      std::min(hn::GetLane(hn::SumOfLanes(f, turn)), hn::GetLane(hn::SumOfLanes(f, back)));
  return std::sqrt(hn::GetLane(hn::SumOfLanes(f, shift))) + std::sqrt(turns);
}

void LookAtLeaf(PoseSearch& search, const PoseSearch::Leaf& leaf) {
  const hn::CappedTag<float, 16> f;
  alignas(64) float distances_m[PoseSearch::kLeafPoses];
  const PoseCoordinates& at = search.at;
  auto smallest = hn::Set(f, std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < leaf.count; i += hn::Lanes(f)) {
    auto shift = hn::Zero(f), turn = hn::Zero(f), back = hn::Zero(f);
    for (std::size_t n = 0; n < 3; ++n) {
      const auto apart = hn::Sub(hn::LoadU(f, leaf.columns[n].data() + i), hn::Set(f, at[n]));
      shift = hn::MulAdd(apart, apart, shift);
    }
    for (std::size_t n = 3; n < 7; ++n) {
      const auto there = hn::LoadU(f, leaf.columns[n].data() + i), q = hn::Set(f, at[n + 1]);
      const auto apart = hn::Sub(there, q), sum = hn::Add(there, q);
      turn = hn::MulAdd(apart, apart, turn);
      back = hn::MulAdd(sum, sum, back);
    }
    const auto distance = hn::Add(hn::Sqrt(shift), hn::Sqrt(hn::Min(turn, back)));
    hn::StoreU(distance, f, distances_m + i);
    smallest = hn::Min(smallest, distance);
  }
  // The nearest of this leaf may be the nearest of all if it is within twice the rounding.
  const float min_m = hn::GetLane(hn::MinOfLanes(f, smallest));
  const float limit_m = std::min(search.limit_m(), min_m + 2 * search.margin_m);
  if (min_m > limit_m) return;
  for (std::uint32_t i = 0; i < leaf.count; ++i) {
    if (distances_m[i] <= limit_m) search.compare(leaf.numbers[i]);
  }
}

void Search(PoseSearch& search) {
  const std::vector<PoseSearch::Node>& nodes = search.nodes();
  std::vector<PoseSearch::Branch>& open = search.open();
  open.assign(1, {0, 0});
  while (!open.empty()) {
    PoseSearch::Branch branch = open.back();
    open.pop_back();
    if (branch.min_m > search.limit_m()) continue;
    while (nodes[branch.node].first_child != 0) {
      const std::uint32_t child = nodes[branch.node].first_child;
      PoseSearch::Branch near{BoxDistance(search.at, nodes[child]), child};
      PoseSearch::Branch far{BoxDistance(search.at, nodes[child + 1]), child + 1};
      if (far.min_m < near.min_m) std::swap(near, far);
      if (far.min_m <= search.limit_m()) open.push_back(far);
      branch = near;
    }
    if (branch.min_m <= search.limit_m()) LookAtLeaf(search, search.leaf(nodes[branch.node]));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace forcelayer::voxplan
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::voxplan {
namespace {

HWY_EXPORT(Search);

constexpr float kFar = 1e15f;          // a coordinate that no pose has; its square is finite
constexpr std::size_t kFewPoses = 32;  // or fewer are compared one by one
// A coordinate is rounded twice by 2^-24 of itself, and a difference of two by 2^-23. Seven such
// differences, with their squares and roots, are off by less than this fraction of the largest
// coordinate of either kind.
constexpr double kRounding = 0x1p-19;

double largest_of(const glm::dvec3& p) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

}  // namespace

PoseCoordinates PoseIndex::coordinates(const Pose& pose) const {
  const glm::dvec3& p = pose.position_m;
  const glm::dquat q = pose.orientation * (pose.orientation.w < 0 ? -turn_m_ : turn_m_);
  const auto to_float = [](double x) { return static_cast<float>(x); };
  return {to_float(p.x), to_float(p.y), to_float(p.z), 0,
          to_float(q.w), to_float(q.x), to_float(q.y), to_float(q.z)};
}

void PoseIndex::compare(const Pose& pose, std::uint32_t number, Best& best) const {
  const double distance_m = pose_distance_m(poses_[number], pose, turn_m_);
  if (distance_m > best.distance_m) return;
  if (distance_m == best.distance_m && number > best.number) return;
  best = {distance_m, number};
}

std::uint32_t PoseIndex::nearest(const Pose& pose) const {
  const auto count = static_cast<std::uint32_t>(poses_.size());
  const bool is_last = last_size_ != 0 && pose.position_m == last_.position_m &&
                       pose.orientation == last_.orientation;
  PoseSearch search{*this, pose, coordinates(pose), 0, {}};
  search.best = is_last ? last_best_ : Best{std::numeric_limits<double>::infinity(), 0};
  if (is_last && count - last_size_ <= kFewPoses) {
    for (auto n = static_cast<std::uint32_t>(last_size_); n < count; ++n) search.compare(n);
  } else {
    const double largest_m = std::max(largest_m_, largest_of(pose.position_m)) + turn_m_;
    search.margin_m = static_cast<float>(kRounding * largest_m);
    HWY_DYNAMIC_DISPATCH(Search)(search);
  }
  last_ = pose;
  last_best_ = search.best;
  last_size_ = count;
  return search.best.number;
}

void PoseIndex::clear() {
  poses_.clear();
  nodes_.clear();
  leaves_.clear();
  largest_m_ = 0;
  last_size_ = 0;
}

std::uint32_t PoseIndex::make_node(std::uint32_t leaf) {
  Node node;
  node.low.fill(kFar);
  node.high.fill(-kFar);
  node.leaf = leaf;
  nodes_.push_back(node);
  return static_cast<std::uint32_t>(nodes_.size() - 1);
}

void PoseIndex::add(const Pose& pose) {
  const auto number = static_cast<std::uint32_t>(poses_.size());
  poses_.push_back(pose);
  largest_m_ = std::max(largest_m_, largest_of(pose.position_m));
  if (nodes_.empty()) {
    leaves_.emplace_back();
    make_node(0);
  }
  put(0, number);
}

// Puts a pose into the leaf below `node` to which it belongs.
void PoseIndex::put(std::uint32_t at, std::uint32_t number) {
  const PoseCoordinates x = coordinates(poses_[number]);
  for (;;) {
    Node& node = nodes_[at];
    for (std::size_t n = 0; n < x.size(); ++n) {
      node.low[n] = std::min(node.low[n], x[n]);
      node.high[n] = std::max(node.high[n], x[n]);
    }
    if (node.first_child == 0) break;
    at = node.first_child + (x[node.axis] < node.cut ? 0 : 1);
  }
  Leaf& leaf = leaves_[nodes_[at].leaf];
  if (leaf.count == 0) {
    for (auto& column : leaf.columns) column.fill(kFar);
  }
  for (std::size_t n = 0; n < kColumns; ++n) leaf.columns[n][leaf.count] = x[n < 3 ? n : n + 1];
  leaf.numbers[leaf.count] = number;
  if (++leaf.count == kLeafPoses) split(at);
}

// Halves a full leaf across the longest side of its box. Poses at the cut may be in either half,
// because the boxes decide what is searched.
void PoseIndex::split(std::uint32_t at) {
  std::size_t axis = 0;
  for (std::size_t n = 1; n < nodes_[at].low.size(); ++n) {
    const auto side = [&](std::size_t i) { return nodes_[at].high[i] - nodes_[at].low[i]; };
    if (side(n) > side(axis)) axis = n;
  }
  const Leaf full = leaves_[nodes_[at].leaf];
  const std::array<float, kLeafPoses>& column = full.columns[axis < 3 ? axis : axis - 1];
  std::array<std::uint32_t, kLeafPoses> order;
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return column[a] != column[b] ? column[a] < column[b] : a < b;
  });
  leaves_[nodes_[at].leaf].count = 0;
  const std::uint32_t first = make_node(nodes_[at].leaf);
  leaves_.emplace_back();
  make_node(static_cast<std::uint32_t>(leaves_.size() - 1));
  nodes_[at].axis = static_cast<std::uint32_t>(axis);
  nodes_[at].cut = column[order[kLeafPoses / 2]];
  nodes_[at].first_child = first;
  for (std::uint32_t i = 0; i < kLeafPoses; ++i) {
    put(first + (i < kLeafPoses / 2 ? 0 : 1), full.numbers[order[i]]);
  }
}

}  // namespace forcelayer::voxplan
#endif
