#include "pointshell/part/mass_properties.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "pointshell/part/pieces.h"

namespace forcelayer::part {
namespace {

// Second moments: xx yy zz xy xz yz.
using Moments = std::array<double, 6>;

Moments products(const Vec3& a, const Vec3& b) {
  return {a.x * b.x,
          a.y * b.y,
          a.z * b.z,
          (a.x * b.y + a.y * b.x) / 2,
          (a.x * b.z + a.z * b.x) / 2,
          (a.y * b.z + a.z * b.y) / 2};
}

// Integrals of 1, x and x x^T over simplices.
struct Integrals {
  double measure = 0;
  Vec3 first;
  Moments second{};

  // Adds a simplex of the given measure with these corners. Over a simplex of n corners the mean of
  // x is the corners' mean, that of x x^T is (sum c c^T + (sum c)(sum c)^T) / (n (n + 1)).
  template <std::size_t kCorners>
  void add(double simplex_measure, const std::array<Vec3, kCorners>& corners) {
    Vec3 sum;
    Moments moments{};
    for (const Vec3& corner : corners) {
      sum += corner;
      accumulate(moments, products(corner, corner), 1);
    }
    accumulate(moments, products(sum, sum), 1);
    measure += simplex_measure;
    first += (simplex_measure / kCorners) * sum;
    accumulate(second, moments, simplex_measure / (kCorners * (kCorners + 1)));
  }

  static void accumulate(Moments& into, const Moments& from, double factor) {
    for (std::size_t n = 0; n < into.size(); ++n) into[n] += factor * from[n];
  }
};

// Second moments per unit mass about the centroid, from integrals about an origin.
Moments moments_about_centroid(const Integrals& integrals, const Vec3& centroid) {
  Moments m = integrals.second;
  for (double& moment : m) moment /= integrals.measure;
  Integrals::accumulate(m, products(centroid, centroid), -1);
  return m;
}

std::array<double, 6> inertia_of(const Moments& m) {
  return {m[1] + m[2], m[0] + m[2], m[0] + m[1], -m[3], -m[4], -m[5]};
}

// Whether some distribution of mass has these moments: the matrix has no eigenvalue below zero. A
// surface that crosses itself bounds some volume inside out, which counts as negative mass.
bool are_physical(const Moments& m) {
  const auto [xx, yy, zz, xy, xz, yz] = m;
  const double size = std::abs(xx) + std::abs(yy) + std::abs(zz);
  const double rounding = 1e-12 * size;  // a flat plate's least moment may be that far below zero
  if (!(std::min({xx, yy, zz}) >= -rounding)) return false;
  const double minors[] = {xx * yy - xy * xy, xx * zz - xz * xz, yy * zz - yz * yz};
  if (!(*std::min_element(std::begin(minors), std::end(minors)) >= -rounding * size)) return false;
  const double determinant =
      xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
  return determinant >= -rounding * size * size;
}

bool holds(const Box& box, const Vec3& place) {
  return place.x >= box.low.x && place.y >= box.low.y && place.z >= box.low.z &&
         place.x <= box.high.x && place.y <= box.high.y && place.z <= box.high.z;
}

Box box_of_vertices(const Part& part) {
  Box box;
  for (const Vec3& v : part.vertices) box.grow(v);
  return box;
}

// The triangles that bound a volume: all, or those that are neither without area nor loose; empty
// where none is bounded.
std::vector<bool> bounding_triangles(const Part& part, const std::vector<bool>& loose) {
  const std::size_t count = part.triangles.size();
  if (is_closed(part.triangles)) return std::vector<bool>(count, true);
  std::vector<bool> flat(count);
  for (std::uint32_t t = 0; t < count; ++t) flat[t] = is_flat(triangle_piece(part, t));
  for (const auto& [drops_flat, drops_loose] :
       {std::pair(true, false), {false, true}, {true, true}}) {
    std::vector<bool> bounds(count);
    std::vector<mesh::Triangle> rest;
    for (std::size_t t = 0; t < count; ++t) {
      bounds[t] = !(drops_flat && flat[t]) && !(drops_loose && !loose.empty() && loose[t]);
      if (bounds[t]) rest.push_back(part.triangles[t]);
    }
    if (rest.size() < count && is_closed(rest)) return bounds;
  }
  return {};
}

}  // namespace

bool is_closed(std::span<const mesh::Triangle> triangles) {
  // Every edge as (low vertex, high vertex) with the count of its direction; sorted, each edge must
  // add up to zero.
  std::vector<std::pair<std::uint64_t, int>> edges;
  edges.reserve(3 * triangles.size());
  for (const mesh::Triangle& t : triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint64_t from = t[corner], to = t[(corner + 1) % 3];
      if (from < to) edges.push_back({from << 32 | to, 1});
      if (to < from) edges.push_back({to << 32 | from, -1});
    }
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t n = 0; n < edges.size();) {
    int balance = 0;
    const std::uint64_t edge = edges[n].first;
    for (; n < edges.size() && edges[n].first == edge; ++n) balance += edges[n].second;
    if (balance != 0) return false;
  }
  return true;
}

MassProperties mass_properties(const Part& part, const std::vector<bool>& loose) {
  const Box box = box_of_vertices(part);
  const Vec3 origin = 0.5 * (box.low + box.high);
  const std::vector<bool> bounds = bounding_triangles(part, loose);
  Integrals surface, solid;
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    auto [a, b, c] = triangle_piece(part, t);
    a = a - origin, b = b - origin, c = c - origin;
    surface.add<3>(length(doubled_area_normal(part, t)) / 2, {a, b, c});
    if (!bounds.empty() && bounds[t]) solid.add<4>(dot(a, cross(b, c)) / 6, {Vec3{}, a, b, c});
  }
  MassProperties properties;
  properties.area_m2 = surface.measure;
  // A volume that is only rounding belongs to a sheet folded onto itself.
  const bool solid_enough = solid.measure > 1e-9 * std::pow(surface.measure, 1.5);
  const auto centroid_of = [](const Integrals& integrals) {
    return (1 / integrals.measure) * integrals.first;
  };
  const bool from_volume = solid_enough && holds(box, origin + centroid_of(solid)) &&
                           are_physical(moments_about_centroid(solid, centroid_of(solid)));
  const Integrals& integrals = from_volume ? solid : surface;
  properties.source = from_volume ? MassSource::kVolume : MassSource::kArea;
  properties.volume_m3 = from_volume ? solid.measure : 0;
  if (from_volume) {
    properties.loose_triangles =
        static_cast<std::uint64_t>(std::count(bounds.begin(), bounds.end(), false));
  }
  const Vec3 centroid = centroid_of(integrals);
  properties.centroid = origin + centroid;
  properties.inertia_m2 = inertia_of(moments_about_centroid(integrals, centroid));
  return properties;
}

}  // namespace forcelayer::part
