#include "voxelize/distance/claims.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

namespace forcelayer::distance {
namespace {

constexpr std::uint32_t kNone = UINT32_MAX;
constexpr float kUnits = static_cast<float>(lattice::kSnapUnits);
constexpr float kStep = kClaimStepVoxels * kUnits;
constexpr float kLeastCosine =
    0.92388f;  // of a normal around a corner from their mean: 22.5 degrees
constexpr float kLeastEdgeCosine =
    0.70711f;  // of the normals on either side of an edge: 45 degrees

using Vec = std::array<float, 3>;

float dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
float length(const Vec& a) { return std::sqrt(dot(a, a)); }
float tangent_of(float cosine) { return std::sqrt(std::max(0.0f, 1 - cosine * cosine)) / cosine; }

template <class Step>
void for_each(std::size_t count, const Step& step) {
  constexpr std::size_t kGrain = 4096;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i) step(i);
                    });
}

// The surface of one object: which triangles meet at which edges and corners. Half-edge 3t + k
// leads from corner k of triangle t to the next one.
class Surface {
 public:
  explicit Surface(const scan::SnappedObject& object) : object_(object) {
    weld();
    shape_.resize(object.triangles.size());
    for_each(object.triangles.size(), [&](std::size_t t) { shape_[t] = shape_of(t); });
    list_edges();
    twin_.resize(3 * object.triangles.size());
    for_each(twin_.size(), [&](std::size_t h) { twin_[h] = find_twin(h); });
    corners_.resize(object.vertices.size());
    for_each(corners_.size(), [&](std::size_t v) { corners_[v] = corner_at(v); });
  }

  Claim claim(std::size_t t) const;

 private:
  struct Shape {
    Vec normal{};     // unit; of a triangle without area, zero
    float area2 = 0;  // twice the area
  };
  struct Corner {
    bool smooth = false;
    float slope = 0;   // of the triangles around over any one of them
    float radius = 0;  // of a disc around the corner that they cover, over any one of them
  };

  std::uint32_t start(std::size_t h) const { return vertex_[object_.triangles[h / 3][h % 3]]; }
  std::uint32_t end(std::size_t h) const { return start(next(h)); }
  static std::size_t next(std::size_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::size_t previous(std::size_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  // From the start of half-edge h to its end.
  Vec way(std::size_t h) const {
    const lattice::LatticePoint& from = object_.vertices[start(h)];
    const lattice::LatticePoint& to = object_.vertices[end(h)];
    Vec way;
    for (std::size_t d = 0; d < 3; ++d) way[d] = static_cast<float>(to[d] - from[d]);
    return way;
  }

  void weld();
  Shape shape_of(std::size_t t) const;
  void list_edges();
  std::uint32_t find_twin(std::size_t h) const;
  Corner corner_at(std::size_t v) const;
  bool edge_is_smooth(std::size_t h) const;
  bool has_room(std::size_t h, float cosine) const;

  const scan::SnappedObject& object_;
  std::vector<std::uint32_t> vertex_;   // [vertices] the first at the same place
  std::vector<Shape> shape_;            // [triangles]
  std::vector<std::uint32_t> first_;    // [vertices + 1] into leaving_
  std::vector<std::uint32_t> leaving_;  // half-edges of triangles with area, by their start
  std::vector<std::uint32_t> twin_;     // [half-edges] the only one that leads back, or kNone
  std::vector<Corner> corners_;         // [vertices]
};

void Surface::weld() {
  const std::vector<lattice::LatticePoint>& points = object_.vertices;
  vertex_.resize(points.size());
  const std::size_t size = std::bit_ceil(2 * points.size() + 1);
  std::vector<std::uint32_t> table(size, kNone);
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    std::uint64_t hash = 0;
    for (const std::int64_t x : points[v]) {
      hash = (hash ^ static_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    }
    std::size_t at = hash & (size - 1);
    while (table[at] != kNone && points[table[at]] != points[v]) at = (at + 1) & (size - 1);
    if (table[at] == kNone) table[at] = v;
    vertex_[v] = table[at];
  }
}

Surface::Shape Surface::shape_of(std::size_t t) const {
  const lattice::LatticeTriangle corners = object_.triangle(t);
  std::array<std::array<double, 3>, 2> edges;
  for (std::size_t d = 0; d < 3; ++d) {
    edges[0][d] = static_cast<double>(corners[1][d] - corners[0][d]);
    edges[1][d] = static_cast<double>(corners[2][d] - corners[0][d]);
  }
  const auto& [a, b] = edges;
  const std::array<double, 3> cross{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                                    a[0] * b[1] - a[1] * b[0]};
  const double area2 = std::sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
  Shape shape;
  shape.area2 = static_cast<float>(area2);
  if (area2 == 0) return shape;
  for (std::size_t d = 0; d < 3; ++d) shape.normal[d] = static_cast<float>(cross[d] / area2);
  return shape;
}

void Surface::list_edges() {
  first_.assign(object_.vertices.size() + 1, 0);
  const std::size_t count = 3 * object_.triangles.size();
  const auto has_area = [&](std::size_t h) { return shape_[h / 3].area2 > 0; };
  for (std::size_t h = 0; h < count; ++h) {
    if (has_area(h)) ++first_[start(h) + 1];
  }
  for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
  leaving_.resize(first_.back());
  std::vector<std::uint32_t> next_place(first_.begin(), first_.end() - 1);
  for (std::size_t h = 0; h < count; ++h) {
    if (has_area(h)) leaving_[next_place[start(h)]++] = static_cast<std::uint32_t>(h);
  }
}

// None where an edge is not that of two triangles that are turned alike.
std::uint32_t Surface::find_twin(std::size_t h) const {
  const std::uint32_t from = start(h), to = end(h);
  std::uint32_t twin = kNone;
  for (std::uint32_t i = first_[to]; i < first_[to + 1]; ++i) {
    if (end(leaving_[i]) != from) continue;
    if (twin != kNone) return kNone;
    twin = leaving_[i];
  }
  for (std::uint32_t i = first_[from]; i < first_[from + 1]; ++i) {
    if (leaving_[i] != h && end(leaving_[i]) == to) return kNone;
  }
  return twin;
}

// The triangles around a vertex lie in rings, each closed: every edge at the vertex is that of two.
// Their normals lie in a cone, so over the plane of each of them each ring covers a disc.
Surface::Corner Surface::corner_at(std::size_t v) const {
  Corner corner;
  Vec sum{};
  float least_height = 1e30f;
  const std::span around(leaving_.data() + first_[v], leaving_.data() + first_[v + 1]);
  for (const std::size_t h : around) {
    if (twin_[h] == kNone || twin_[previous(h)] == kNone) return corner;
    const Shape& shape = shape_[h / 3];
    for (std::size_t d = 0; d < 3; ++d) sum[d] += shape.normal[d];
    least_height = std::min(least_height, shape.area2 / length(way(next(h))));
  }
  const float sum_length = length(sum);
  if (!(sum_length > 0)) return corner;
  float cosine = 1;
  for (const std::size_t h : around) {
    cosine = std::min(cosine, dot(sum, shape_[h / 3].normal) / sum_length);
  }
  if (cosine < kLeastCosine) return corner;
  const float between = 2 * cosine * cosine - 1;  // of any two of them
  corner.slope = tangent_of(between);
  corner.radius = least_height * between;
  corner.smooth = corner.radius >= 2 * kStep;
  return corner;
}

// Whether the triangle of half-edge h leaves room for the step beside h, but where a disc around
// its start does, or an open corner is too near.
bool Surface::has_room(std::size_t h, float cosine) const {
  const Corner& corner = corners_[start(h)];
  const float from = corner.smooth ? corner.radius - kStep : kOpenRadiusVoxels * kUnits;
  Vec back = way(previous(h));
  for (float& x : back) x = -x;
  const float along = dot(way(h), back);
  // The tangent of the angle at the corner is the area over `along`.
  return along <= 0 || from * shape_[h / 3].area2 * cosine >= kStep * along;
}

bool Surface::edge_is_smooth(std::size_t h) const {
  const std::uint32_t twin = twin_[h];
  if (twin == kNone) return false;
  const float cosine = dot(shape_[h / 3].normal, shape_[twin / 3].normal);
  if (cosine < kLeastEdgeCosine || !has_room(twin, cosine)) return false;
  // The same at its end: the angle there is that of the next half-edge's start.
  const Corner& corner = corners_[end(twin)];
  const float from = corner.smooth ? corner.radius - kStep : kOpenRadiusVoxels * kUnits;
  Vec back = way(twin);
  for (float& x : back) x = -x;
  const float along = dot(way(next(twin)), back);
  return along <= 0 || from * shape_[twin / 3].area2 * cosine >= kStep * along;
}

Claim Surface::claim(std::size_t t) const {
  Claim claim;
  if (shape_[t].area2 == 0) return claim;
  // The places of the corners by x, y and z.
  const lattice::LatticeTriangle corners = object_.triangle(t);
  std::array<std::size_t, 3> place{0, 1, 2};
  std::sort(place.begin(), place.end(),
            [&](std::size_t a, std::size_t b) { return corners[a] < corners[b]; });
  std::array<std::size_t, 3> rank;
  for (std::size_t i = 0; i < 3; ++i) rank[place[i]] = i;
  float slope = 0;
  unsigned open = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t h = 3 * t + k;
    const Corner& corner = corners_[start(h)];
    if (corner.smooth) {
      slope = std::max(slope, corner.slope);
    } else {
      open |= 8u << rank[k];
    }
    if (edge_is_smooth(h)) {
      slope = std::max(slope, tangent_of(dot(shape_[t].normal, shape_[twin_[h] / 3].normal)));
    } else {
      open |= 1u << (rank[k] + rank[(k + 1) % 3] - 1);
    }
  }
  // Rounded up, and what rounding leaves of flat normals.
  claim.slope = static_cast<std::uint8_t>(std::min(255.0f, std::ceil(slope * 128) + 1));
  claim.open = static_cast<std::uint8_t>(open);
  return claim;
}

}  // namespace

std::vector<Claim> claims_of(const scan::SnappedObject& object) {
  std::vector<Claim> claims(object.triangles.size());
  if (3 * object.triangles.size() >= kNone) return claims;
  const Surface surface(object);
  for_each(claims.size(), [&](std::size_t t) { claims[t] = surface.claim(t); });
  return claims;
}

}  // namespace forcelayer::distance
