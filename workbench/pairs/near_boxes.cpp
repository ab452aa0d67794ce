#include "workbench/pairs/near_boxes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace forcelayer::pairs {
namespace {

// The axis along which the middles of the boxes are spread most.
std::size_t sweep_axis(std::span<const mesh::Box> boxes_m) {
  std::array<double, 3> sum{}, squares{};
  for (const mesh::Box& box : boxes_m) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double middle = (box.low[axis] + box.high[axis]) / 2;
      sum[axis] += middle, squares[axis] += middle * middle;
    }
  }
  const auto spread = [&](std::size_t axis) {
    return squares[axis] - sum[axis] * sum[axis] / static_cast<double>(boxes_m.size());
  };
  std::size_t widest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (spread(axis) > spread(widest)) widest = axis;
  }
  return widest;
}

}  // namespace

double distance_of(const mesh::Box& a, const mesh::Box& b) {
  double squared = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double gap = std::max({a.low[axis] - b.high[axis], b.low[axis] - a.high[axis], 0.0});
    squared += gap * gap;
  }
  return std::sqrt(squared);
}

bool contains(const mesh::Box& outer, const mesh::Box& inner) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (inner.low[axis] < outer.low[axis] || inner.high[axis] > outer.high[axis]) return false;
  }
  return true;
}

std::vector<Pair> near_boxes(std::span<const mesh::Box> boxes_m, double reach_m,
                             const std::function<bool(const Pair&)>& is_asked) {
  std::vector<Pair> pairs;
  if (boxes_m.empty()) return pairs;
  const std::size_t axis = sweep_axis(boxes_m);
  std::vector<std::uint32_t> order(boxes_m.size()), active;
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return boxes_m[a].low[axis] < boxes_m[b].low[axis];
  });
  for (const std::uint32_t now : order) {
    std::erase_if(active, [&](std::uint32_t other) {
      return boxes_m[other].high[axis] + reach_m < boxes_m[now].low[axis];
    });
    for (const std::uint32_t other : active) {
      const Pair pair{std::min(now, other), std::max(now, other)};
      if (distance_of(boxes_m[now], boxes_m[other]) <= reach_m && is_asked(pair)) {
        pairs.push_back(pair);
      }
    }
    active.push_back(now);
  }
  return pairs;
}

}  // namespace forcelayer::pairs
