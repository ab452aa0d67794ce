#include "voxelize/distance/triangle_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace forcelayer::distance {
namespace {

constexpr double kNodeUnits = 64 * static_cast<double>(lattice::kSnapUnits);
constexpr std::int64_t kWholeUnits = 128 * lattice::kSnapUnits;  // larger triangles are cut

using Point = std::array<double, 3>;

// Cuts a convex polygon at a plane: what stays has coordinate `axis` times `side` at least `bound`.
void cut(std::vector<Point>& polygon, std::size_t axis, double side, double bound) {
  std::vector<Point> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point& a = polygon[i];
    const Point& b = polygon[(i + 1) % polygon.size()];
    const double from = side * a[axis] - bound, to = side * b[axis] - bound;
    if (from >= 0) kept.push_back(a);
    if ((from < 0) == (to < 0)) continue;
    const double t = from / (from - to);
    Point at;
    for (std::size_t d = 0; d < 3; ++d) at[d] = a[d] + t * (b[d] - a[d]);
    at[axis] = side * bound;
    kept.push_back(at);
  }
  polygon = std::move(kept);
}

std::array<Point, 3> relative(const lattice::LatticeTriangle& triangle,
                              const scan::NodeIndex& node) {
  std::array<Point, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t d = 0; d < 3; ++d) {
      corners[k][d] = static_cast<double>(triangle[k][d] - node[d] * 64 * lattice::kSnapUnits);
    }
  }
  return corners;
}

bool is_large(const lattice::LatticeTriangle& triangle) {
  for (std::size_t d = 0; d < 3; ++d) {
    const auto [smallest, largest] = std::minmax({triangle[0][d], triangle[1][d], triangle[2][d]});
    if (largest - smallest > kWholeUnits) return true;
  }
  return false;
}

double squared_length(const Point& a, const Point& b) {
  const Point edge{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  return edge[0] * edge[0] + edge[1] * edge[1] + edge[2] * edge[2];
}

void add_cut(const std::array<Point, 3>& corners, int reach, std::uint32_t source,
             std::uint32_t object, TriangleSide side, TriangleBatch& near) {
  std::vector<Point> polygon(corners.begin(), corners.end());
  const double margin = static_cast<double>(reach + 1) * static_cast<double>(lattice::kSnapUnits);
  for (std::size_t d = 0; d < 3; ++d) {
    cut(polygon, d, 1, -margin);
    cut(polygon, d, -1, -(kNodeUnits + margin));
  }
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    std::array<Point, 3> piece{polygon[0], polygon[i - 1], polygon[i]};
    flatten_if_thin(piece);
    near.add(piece, source, object, side);
  }
}

}  // namespace

void flatten_if_thin(std::array<Point, 3>& piece) {
  constexpr double kThin2 = 1e-16;  // of the sine of its angle, squared: above rounding's
  double longest2 = 0;
  std::size_t longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double length2 = squared_length(piece[k], piece[(k + 1) % 3]);
    if (length2 > longest2) longest2 = length2, longest = k;
  }
  if (longest2 == 0) return;  // a point
  const Point &a = piece[longest], &b = piece[(longest + 1) % 3];
  Point& c = piece[(longest + 2) % 3];
  double along = 0;
  for (std::size_t d = 0; d < 3; ++d) along += (c[d] - a[d]) * (b[d] - a[d]);
  Point foot = a;
  for (std::size_t d = 0; d < 3; ++d) foot[d] += along / longest2 * (b[d] - a[d]);
  if (squared_length(c, foot) <= kThin2 * longest2) c = a;
}

SceneTriangles::SceneTriangles(std::vector<const scan::SnappedObject*> objects, int reach,
                               scan::SpillFile* spill, bool finds_sides)
    : objects_(std::move(objects)), reach_(reach), spill_(spill) {
  struct Place {
    scan::NodeIndex node;
    Bin bin;
  };
  bins_.resize(objects_.size());
  if (finds_sides) sides_.resize(objects_.size());
  tbb::parallel_for(std::size_t{0}, objects_.size(), [&](std::size_t i) {
    bins_[i] = scan::bin_triangles(*objects_[i], reach, spill);
    if (finds_sides) sides_[i] = SurfaceSides(*objects_[i], spill);
  });
  std::vector<Place> places;
  for (std::uint32_t i = 0; i < bins_.size(); ++i) {
    const std::vector<scan::NodeIndex>& nodes = bins_[i].nodes;
    for (std::uint32_t n = 0; n < nodes.size(); ++n) places.push_back({nodes[n], {i, n}});
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.node < b.node; });
  for (const Place& place : places) {
    if (nodes_.empty() || nodes_.back() != place.node) {
      nodes_.push_back(place.node);
      first_.push_back(of_node_.size());
    }
    of_node_.push_back(place.bin);
  }
  first_.push_back(of_node_.size());
  for (std::size_t n = 0; n < nodes_.size(); ++n) max_near_ = std::max(max_near_, count_near(n));
}

std::size_t SceneTriangles::count_near(std::size_t n) const {
  std::size_t count = 0;
  for (std::size_t i = first_[n]; i < first_[n + 1]; ++i) {
    const auto [object, bin] = of_node_[i];
    count += bins_[object].first[bin + 1] - bins_[object].first[bin];
  }
  return count;
}

std::vector<std::uint32_t> SceneTriangles::objects_near(const scan::NodeIndex& node) const {
  std::vector<std::uint32_t> objects;
  const auto found = std::lower_bound(nodes_.begin(), nodes_.end(), node);
  if (found == nodes_.end() || *found != node) return objects;
  const auto at = static_cast<std::size_t>(found - nodes_.begin());
  for (std::size_t i = first_[at]; i < first_[at + 1]; ++i) objects.push_back(of_node_[i].object);
  return objects;
}

void SceneTriangles::gather(const scan::NodeIndex& node,
                            std::vector<PreparedTriangle>& near) const {
  near.clear();
  const auto found = std::lower_bound(nodes_.begin(), nodes_.end(), node);
  if (found == nodes_.end() || *found != node) return;
  const auto at = static_cast<std::size_t>(found - nodes_.begin());
  // With room for fuller nodes, so that memory is not touched for the first time at each.
  const std::size_t count = count_near(at);
  if (near.capacity() < count) near.reserve(std::min(max_near_, count + count / 2));
  TriangleBatch batch(near);
  for (std::size_t i = first_[at]; i < first_[at + 1]; ++i) {
    const auto [object, bin] = of_node_[i];
    const scan::NodeBins& bins = bins_[object];
    for (std::uint64_t t = bins.first[bin]; t < bins.first[bin + 1]; ++t) {
      const std::uint32_t number = bins.triangles[t];
      const lattice::LatticeTriangle triangle = objects_[object]->triangle(number);
      const std::array<Point, 3> corners = relative(triangle, node);
      if (is_large(triangle)) {
        add_cut(corners, reach_, number, object, side_of(object, number), batch);
      } else {
        batch.add(corners, number, object, side_of(object, number));
      }
    }
  }
  batch.flush();
  // A triangle's corners and numbers lie in up to five pages.
  if (spill_ != nullptr) spill_->touched(count * 128);
}

}  // namespace forcelayer::distance
