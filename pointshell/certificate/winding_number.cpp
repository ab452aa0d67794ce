#include "pointshell/certificate/winding_number.h"

#include <array>
#include <cmath>
#include <numbers>

namespace forcelayer {
namespace {

// A node is one dipole from this many of its radii on.
constexpr double kFar = 5;
// Below this share of the product of the distances the triangle is seen edge-on.
constexpr double kEdgeOn = 1e-12;

Vec3 farthest_offset(const TriangleTree::Node& box, const Vec3& from) {
  return {std::max(box.high[0] - from.x, from.x - box.low[0]),
          std::max(box.high[1] - from.y, from.y - box.low[1]),
          std::max(box.high[2] - from.z, from.z - box.low[2])};
}

}  // namespace

double triangle_winding(const Vec3& place, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 pa = a - place, pb = b - place, pc = c - place;
  const double la = length(pa), lb = length(pb), lc = length(pc);
  const double volume = dot(pa, cross(pb, pc));
  if (std::abs(volume) <= kEdgeOn * la * lb * lc) return 0;
  const double base = la * lb * lc + dot(pa, pb) * lc + dot(pb, pc) * la + dot(pc, pa) * lb;
  return 2 * std::atan2(volume, base) / (4 * std::numbers::pi);
}

WindingNumber::WindingNumber(const TriangleTree& tree)
    : tree_(tree), dipoles_(tree.nodes().size()), areas_(tree.nodes().size()) {
  // Children have higher numbers than their parent.
  for (std::size_t node = dipoles_.size(); node-- > 0;) fill(static_cast<std::uint32_t>(node));
}

void WindingNumber::fill(std::uint32_t at) {
  const TriangleTree::Node& node = tree_.nodes()[at];
  Dipole& dipole = dipoles_[at];
  Vec3 weighted;
  for (std::uint32_t n = 0; n < node.count; ++n) {
    const std::uint32_t t = tree_.ordered_triangles()[node.first + n];
    const Triangle& corners = tree_.part().triangles[t];
    const Vec3 area_normal = 0.5 * doubled_area_normal(tree_.part(), t);
    const double area = length(area_normal);
    for (const std::uint32_t corner : corners) {
      weighted += (area / 3) * tree_.part().vertices[corner];
    }
    areas_[at] += area;
    dipole.moment += area_normal;
  }
  if (node.count == 0) {
    for (const std::uint32_t child : {at + 1, node.first}) {
      weighted += areas_[child] * dipoles_[child].center;
      areas_[at] += areas_[child];
      dipole.moment += dipoles_[child].moment;
    }
  }
  dipole.center =
      areas_[at] > 0 ? (1 / areas_[at]) * weighted : Vec3{node.low[0], node.low[1], node.low[2]};
  dipole.radius = length(farthest_offset(node, dipole.center));
}

double WindingNumber::at_leaf(const TriangleTree::Node& node, const Vec3& place) const {
  double sum = 0;
  for (std::uint32_t n = 0; n < node.count; ++n) {
    const auto [a, b, c] = triangle_piece(tree_.part(), tree_.ordered_triangles()[node.first + n]);
    sum += triangle_winding(place, a, b, c);
  }
  return sum;
}

double WindingNumber::at(const Vec3& place) const {
  double sum = 0;
  std::array<std::uint32_t, 96> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t at = stack[--depth];
    const TriangleTree::Node& node = tree_.nodes()[at];
    const Dipole& dipole = dipoles_[at];
    const Vec3 offset = dipole.center - place;
    const double squared = length_squared(offset);
    if (squared > kFar * kFar * dipole.radius * dipole.radius) {
      if (squared == 0) continue;  // a node of no extent, where `place` is: seen edge-on
      sum += dot(offset, dipole.moment) / (4 * std::numbers::pi * squared * std::sqrt(squared));
    } else if (node.count > 0) {
      sum += at_leaf(node, place);
    } else {
      stack[depth++] = node.first;
      stack[depth++] = at + 1;
    }
  }
  return sum;
}

}  // namespace forcelayer
