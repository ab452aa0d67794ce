#include "pointshell/certificate/winding_number.h"

#include <array>
#include <cmath>
#include <numbers>

namespace forcelayer::certificate {
namespace {

// Below this fraction of the product of the distances the triangle is seen edge-on.
constexpr double kEdgeOn = 1e-12;

part::Vec3 farthest_offset(const part::TriangleTree::Node& box, const part::Vec3& from) {
  return {std::max(box.high[0] - from.x, from.x - box.low[0]),
          std::max(box.high[1] - from.y, from.y - box.low[1]),
          std::max(box.high[2] - from.z, from.z - box.low[2])};
}

}  // namespace

double triangle_winding(const part::Vec3& place, const part::Vec3& a, const part::Vec3& b,
                        const part::Vec3& c) {
  const part::Vec3 pa = a - place, pb = b - place, pc = c - place;
  const double la = part::length(pa), lb = part::length(pb), lc = part::length(pc);
  const double volume = part::dot(pa, part::cross(pb, pc));
  if (std::abs(volume) <= kEdgeOn * la * lb * lc) return 0;
  const double base =
      la * lb * lc + part::dot(pa, pb) * lc + part::dot(pb, pc) * la + part::dot(pc, pa) * lb;
  return 2 * std::atan2(volume, base) / (4 * std::numbers::pi);
}

WindingNumber::WindingNumber(const part::TriangleTree& tree)
    : tree_(tree), dipoles_(tree.nodes().size()), areas_(tree.nodes().size()) {
  // Children have higher numbers than their parent.
  for (std::size_t node = dipoles_.size(); node-- > 0;) fill(static_cast<std::uint32_t>(node));
}

void WindingNumber::fill(std::uint32_t at) {
  const part::TriangleTree::Node& node = tree_.nodes()[at];
  Dipole& dipole = dipoles_[at];
  part::Vec3 weighted;
  for (std::uint32_t n = 0; n < node.count; ++n) {
    const std::uint32_t t = tree_.ordered_triangles()[node.first + n];
    const mesh::Triangle& corners = tree_.part().triangles[t];
    const part::Vec3 area_normal = 0.5 * part::doubled_area_normal(tree_.part(), t);
    const double area = part::length(area_normal);
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
  dipole.center = areas_[at] > 0 ? (1 / areas_[at]) * weighted
                                 : part::Vec3{node.low[0], node.low[1], node.low[2]};
  dipole.radius = part::length(farthest_offset(node, dipole.center));
}

double WindingNumber::at_leaf(const part::TriangleTree::Node& node, const part::Vec3& place) const {
  double sum = 0;
  for (std::uint32_t n = 0; n < node.count; ++n) {
    const auto [a, b, c] =
        part::triangle_piece(tree_.part(), tree_.ordered_triangles()[node.first + n]);
    sum += triangle_winding(place, a, b, c);
  }
  return sum;
}

double WindingNumber::at(const part::Vec3& place, double far) const {
  double sum = 0;
  std::array<std::uint32_t, 96> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t at = stack[--depth];
    const part::TriangleTree::Node& node = tree_.nodes()[at];
    const Dipole& dipole = dipoles_[at];
    const part::Vec3 offset = dipole.center - place;
    const double squared = part::length_squared(offset);
    if (squared > far * far * dipole.radius * dipole.radius) {
      if (squared == 0) continue;  // a node of no extent, where `place` is: seen edge-on
      sum +=
          part::dot(offset, dipole.moment) / (4 * std::numbers::pi * squared * std::sqrt(squared));
    } else if (node.count > 0) {
      sum += at_leaf(node, place);
    } else {
      stack[depth++] = node.first;
      stack[depth++] = at + 1;
    }
  }
  return sum;
}

}  // namespace forcelayer::certificate
