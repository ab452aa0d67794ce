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

constexpr Vec3d kOblique{0.48, 0.6, 0.64};  // of length 1: few points have one place along it

// Takes out edges that have another beside them, each end within the tolerance and a quarter of its
// length: the widest of the slits between them.
double close_slits(std::vector<Segment>& edges, double tolerance) {
  const auto place = [](const Segment& edge) {
    return 0.5 * (dot(edge.first, kOblique) + dot(edge.second, kOblique));
  };
  std::sort(edges.begin(), edges.end(),
            [&](const Segment& a, const Segment& b) { return place(a) < place(b); });
  std::vector<bool> is_met(edges.size());
  double widest = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (is_met[i]) continue;
    const auto& [from, to] = edges[i];
    double smallest = std::min(tolerance, 0.25 * length_of(minus(to, from)));
    std::size_t nearest = i;
    for (std::size_t n = i + 1; n < edges.size(); ++n) {
      if (place(edges[n]) > place(edges[i]) + tolerance) break;
      if (is_met[n]) continue;
      const auto& [a, b] = edges[n];
      const double width = std::min(std::max(length_of(minus(a, from)), length_of(minus(b, to))),
                                    std::max(length_of(minus(b, from)), length_of(minus(a, to))));
      if (width <= smallest) smallest = width, nearest = n;
    }
    if (nearest == i) continue;
    is_met[i] = is_met[nearest] = true;
    widest = std::max(widest, smallest);
  }
  std::size_t n = 0;
  std::erase_if(edges, [&](const Segment&) { return is_met[n++]; });
  return widest;
}

// The root of `i` among `parents`.
std::size_t root_of(std::size_t i, std::vector<std::size_t>& parents) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

// The points of edges that hang together: by points that are within the tolerance of each other.
std::vector<std::vector<Vec3d>> outlines_of(const std::vector<Segment>& edges, double tolerance) {
  struct End {
    Vec3d point;
    double place;
    std::size_t edge;
  };
  std::vector<End> ends;
  std::vector<std::size_t> parents(edges.size());
  for (std::size_t n = 0; n < edges.size(); ++n) {
    parents[n] = n;
    for (const Vec3d& point : {edges[n].first, edges[n].second}) {
      ends.push_back({point, dot(point, kOblique), n});
    }
  }
  std::sort(ends.begin(), ends.end(), [](const End& a, const End& b) { return a.place < b.place; });
  for (std::size_t i = 0; i < ends.size(); ++i) {
    for (std::size_t n = i + 1; n < ends.size(); ++n) {
      if (ends[n].place > ends[i].place + tolerance) break;
      if (length_of(minus(ends[n].point, ends[i].point)) > tolerance) continue;
      parents[root_of(ends[n].edge, parents)] = root_of(ends[i].edge, parents);
    }
  }
  std::map<std::size_t, std::vector<Vec3d>> outlines;
  for (const End& end : ends) outlines[root_of(end.edge, parents)].push_back(end.point);
  std::vector<std::vector<Vec3d>> all;
  for (auto& [root, points] : outlines) all.push_back(std::move(points));
  return all;
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

double widest_hole(const Mesh& mesh, double tolerance) {
  if (mesh_facts(mesh).closed) return 0;
  std::vector<Segment> edges = open_edges(mesh);
  double widest = close_slits(edges, tolerance);
  for (const std::vector<Vec3d>& outline : outlines_of(edges, tolerance)) {
    widest = std::max(widest, reach_across(outline));
  }
  return widest;
}

}  // namespace forcelayer::mesh
