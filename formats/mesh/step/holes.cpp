#include "formats/mesh/step/holes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "formats/mesh/mesh_facts.h"

namespace forcelayer::mesh {
namespace {

using Segment = std::pair<Vec3d, Vec3d>;

Vec3d minus(const Vec3d& a, const Vec3d& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

double dot(const Vec3d& a, const Vec3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

double length_of(const Vec3d& a) { return std::sqrt(dot(a, a)); }

Vec3d without_part_along(const Vec3d& a, const Vec3d& unit) {
  const double along = dot(a, unit);
  return {a[0] - along * unit[0], a[1] - along * unit[1], a[2] - along * unit[2]};
}

Vec3d unit_of(const Vec3d& a) {
  const double length = length_of(a);
  return length > 0 ? Vec3d{a[0] / length, a[1] / length, a[2] / length} : Vec3d{};
}

// Edges that one triangle has.
std::vector<Segment> open_edges(const Mesh& mesh) {
  std::map<Segment, int> uses;
  for (const Triangle& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3d& from = mesh.vertices[triangle[i]];
      const Vec3d& to = mesh.vertices[triangle[(i + 1) % 3]];
      if (from != to) ++uses[std::minmax(from, to)];
    }
  }
  std::vector<Segment> open;
  for (const auto& [edge, count] : uses) {
    if (count % 2 == 1) open.push_back(edge);
  }
  return open;
}

// The points of edges that hang together.
std::vector<std::vector<Vec3d>> outlines_of(const std::vector<Segment>& edges) {
  std::map<Vec3d, std::vector<Vec3d>> beside;
  for (const auto& [a, b] : edges) beside[a].push_back(b), beside[b].push_back(a);
  std::vector<std::vector<Vec3d>> outlines;
  while (!beside.empty()) {
    std::vector<Vec3d> outline{beside.begin()->first};
    for (std::size_t n = 0; n < outline.size(); ++n) {
      const auto next = beside.extract(outline[n]);
      if (next) outline.insert(outline.end(), next.mapped().begin(), next.mapped().end());
    }
    outlines.push_back(std::move(outline));
  }
  return outlines;
}

// The vector between points, each less its part along `axis`, that is longest from `from`.
Vec3d farthest(const std::vector<Vec3d>& points, const Vec3d& from, const Vec3d& axis) {
  Vec3d longest{};
  for (const Vec3d& point : points) {
    const Vec3d vector = without_part_along(minus(point, from), axis);
    if (length_of(vector) > length_of(longest)) longest = vector;
  }
  return longest;
}

// In a plane a region between two parallel lines has no point farther from its outline than half
// of the lines' distance; how far the outline leaves that plane comes on top.
double reach_across(const std::vector<Vec3d>& outline) {
  const Vec3d& from = outline.front();
  const Vec3d axis = unit_of(farthest(outline, from, {}));
  const Vec3d across = unit_of(farthest(outline, from, axis));
  double low = 0, high = 0, out = 0;
  for (const Vec3d& point : outline) {
    const Vec3d vector = without_part_along(minus(point, from), axis);
    low = std::min(low, dot(vector, across));
    high = std::max(high, dot(vector, across));
    out = std::max(out, length_of(without_part_along(vector, across)));
  }
  return 0.5 * (high - low) + out;
}

}  // namespace

double widest_hole(const Mesh& mesh) {
  if (mesh_facts(mesh).closed) return 0;
  double widest = 0;
  for (const std::vector<Vec3d>& outline : outlines_of(open_edges(mesh))) {
    widest = std::max(widest, reach_across(outline));
  }
  return widest;
}

}  // namespace forcelayer::mesh
