#include "formats/mesh/readers/plane_points.h"

#include <algorithm>
#include <numeric>

namespace forcelayer::mesh {

void PlanePoints::assign(std::span<const Point> points) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t j) { return points[i] < points[j]; });
  places_.clear();
  std::vector<std::size_t> sorted_place(points.size());
  for (const std::size_t point : order) {
    if (places_.empty() || places_.back().at != points[point]) {
      places_.push_back({points[point], 0, places_.size()});  // its number, until the tree stands
    }
    ++places_.back().points;
    sorted_place[point] = places_.size() - 1;
  }
  nodes_.clear();
  if (!places_.empty()) build(0, places_.size(), kNone);
  std::vector<std::size_t> moved_to(places_.size());
  for (std::size_t i = 0; i < places_.size(); ++i) moved_to[places_[i].leaf] = i;
  place_of_.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) place_of_[i] = moved_to[sorted_place[i]];
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    if (nodes_[n].left != kNone) continue;
    for (std::size_t i = nodes_[n].first; i < nodes_[n].last; ++i) places_[i].leaf = n;
  }
}

std::size_t PlanePoints::build(std::size_t first, std::size_t last, std::size_t parent) {
  constexpr std::size_t kFew = 8;
  const auto begin = places_.begin() + static_cast<std::ptrdiff_t>(first),
             end = places_.begin() + static_cast<std::ptrdiff_t>(last);
  const std::size_t number = nodes_.size();
  Node& node = nodes_.emplace_back();
  node = {begin->at, begin->at, first, last, parent, kNone, kNone, last - first};
  for (auto place = begin; place != end; ++place) {
    node.low = {std::min(node.low.x, place->at.x), std::min(node.low.y, place->at.y)};
    node.high = {std::max(node.high.x, place->at.x), std::max(node.high.y, place->at.y)};
  }
  if (last - first <= kFew) return number;
  const bool by_x = node.high.x - node.low.x > node.high.y - node.low.y;
  const std::size_t middle = first + (last - first) / 2;
  std::nth_element(
      begin, places_.begin() + static_cast<std::ptrdiff_t>(middle), end,
      [&](const Place& p, const Place& q) { return by_x ? p.at < q.at : p.at.y < q.at.y; });
  const std::size_t left = build(first, middle, number), right = build(middle, last, number);
  nodes_[number].left = left;
  nodes_[number].right = right;
  return number;
}

bool PlanePoints::remove(std::size_t point) {
  Place& place = places_[place_of_[point]];
  if (--place.points > 0) return false;
  for (std::size_t n = place.leaf; n != kNone; n = nodes_[n].parent) --nodes_[n].places;
  return true;
}

std::size_t PlanePoints::find_in(std::size_t a, std::size_t b, std::size_t c) const {
  const std::array<std::size_t, 3> corners{place_of_[a], place_of_[b], place_of_[c]};
  const std::array<Point, 3> at{places_[corners[0]].at, places_[corners[1]].at,
                                places_[corners[2]].at};
  const auto is_left_of_edge = [&](std::size_t k, const Point& p) {
    return turn(at[k], at[(k + 1) % 3], p) >= 0;
  };
  // The corner of the box that is farthest to the left of an edge: rounded as it is, turn() is
  // monotonic in both coordinates, so no point of the box passes where this one does not.
  const auto may_hold = [&](const Node& node) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Point &p = at[k], &q = at[(k + 1) % 3];
      const Point farthest{q.y - p.y >= 0 ? node.low.x : node.high.x,
                           q.x - p.x >= 0 ? node.high.y : node.low.y};
      if (!is_left_of_edge(k, farthest)) return false;
    }
    return true;
  };
  std::array<std::size_t, 64> stack{0};  // as deep as halving can go
  for (std::size_t waiting = nodes_.empty() ? 0 : 1; waiting > 0;) {
    const Node& node = nodes_[stack[--waiting]];
    if (node.places == 0 || !may_hold(node)) continue;
    if (node.left != kNone) {
      stack[waiting++] = node.left;
      stack[waiting++] = node.right;
      continue;
    }
    for (std::size_t i = node.first; i < node.last; ++i) {
      if (places_[i].points == 0 || std::find(corners.begin(), corners.end(), i) != corners.end()) {
        continue;
      }
      const Point& p = places_[i].at;
      if (is_left_of_edge(0, p) && is_left_of_edge(1, p) && is_left_of_edge(2, p)) return i;
    }
  }
  return kNone;
}

}  // namespace forcelayer::mesh
