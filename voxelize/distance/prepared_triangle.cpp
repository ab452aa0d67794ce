#include "voxelize/distance/prepared_triangle.h"

// Compiled once for every instruction set that Highway supports, picked at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/distance/prepared_triangle.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace forcelayer::distance::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using TriangleVectors = TriangleBatch::Vectors;
using TriangleVector = TriangleVectors::value_type;
using TriangleRows = TriangleBatch::Rows;

constexpr hn::CappedTag<double, TriangleBatch::kSize> kD{};
constexpr hn::Rebind<float, decltype(kD)> kF{};
using V = hn::Vec<decltype(kD)>;

struct Vec {
  V x, y, z;
};

HWY_INLINE Vec load(const TriangleVector& from, std::size_t at) {
  return {hn::LoadU(kD, from[0].data() + at), hn::LoadU(kD, from[1].data() + at),
          hn::LoadU(kD, from[2].data() + at)};
}
HWY_INLINE void store(const Vec& v, TriangleVector& to, std::size_t at) {
  hn::StoreU(v.x, kD, to[0].data() + at);
  hn::StoreU(v.y, kD, to[1].data() + at);
  hn::StoreU(v.z, kD, to[2].data() + at);
}

HWY_INLINE Vec minus(const Vec& a, const Vec& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE V dot(const Vec& a, const Vec& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vec cross(const Vec& a, const Vec& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE Vec over(const Vec& v, V length) {
  return {hn::Div(v.x, length), hn::Div(v.y, length), hn::Div(v.z, length)};
}

// Swaps a and b in the lanes where a comes after b, compared by x, then y, then z.
HWY_INLINE void sort(Vec& a, Vec& b) {
  const auto z_first = hn::Lt(b.z, a.z);
  const auto y_first = hn::Or(hn::Lt(b.y, a.y), hn::And(hn::Eq(b.y, a.y), z_first));
  const auto swapped = hn::Or(hn::Lt(b.x, a.x), hn::And(hn::Eq(b.x, a.x), y_first));
  const Vec low{hn::IfThenElse(swapped, b.x, a.x), hn::IfThenElse(swapped, b.y, a.y),
                hn::IfThenElse(swapped, b.z, a.z)};
  b = {hn::IfThenElse(swapped, a.x, b.x), hn::IfThenElse(swapped, a.y, b.y),
       hn::IfThenElse(swapped, a.z, b.z)};
  a = low;
}

// Writes the lanes from `at` on, row after row.
class Rows {
 public:
  HWY_INLINE Rows(TriangleRows& rows, std::size_t at) : rows_(&rows), at_(at) {}
  HWY_INLINE void put(V v) { hn::StoreU(hn::DemoteTo(kF, v), kF, (*rows_)[row_++].data() + at_); }
  HWY_INLINE void put(const Vec& v) {
    put(v.x);
    put(v.y);
    put(v.z);
  }

 private:
  TriangleRows* rows_;
  std::size_t at_, row_ = 0;
};

// An edge in its triangle's plane.
struct PlanarEdge {
  V u, v, length;
};
HWY_INLINE PlanarEdge planar_edge(const Vec& edge, const Vec& along, const Vec& across) {
  const V u = dot(edge, along), v = dot(edge, across);
  const V length = hn::Sqrt(hn::Add(hn::Mul(u, u), hn::Mul(v, v)));
  const auto extends = hn::Gt(length, hn::Zero(kD));
  return {hn::IfThenElse(extends, hn::Div(u, length), hn::Set(kD, 1.0)),
          hn::IfThenElseZero(extends, hn::Div(v, length)), length};
}

// The axes of triangle i, which has no area: along its longest edge, across it, and perpendicular
// to both.
HWY_INLINE void axes_without_area(const TriangleVectors& edges, TriangleVectors& axes,
                                  std::size_t i) {
  using Point = std::array<double, 3>;
  Point longest{};
  double length2 = 0;
  for (const TriangleVector& edge : edges) {
    const Point e{edge[0][i], edge[1][i], edge[2][i]};
    const double e2 = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
    if (e2 > length2) longest = e, length2 = e2;
  }
  Point along{1, 0, 0}, across{0, 1, 0}, height{0, 0, 1};
  const auto cross = [](const Point& a, const Point& b) {
    return Point{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const auto unit = [](const Point& v) {
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return Point{v[0] / length, v[1] / length, v[2] / length};
  };
  if (length2 > 0) {
    along = unit(longest);
    const auto smallest = std::min_element(
        along.begin(), along.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    Point axis{};
    axis[static_cast<std::size_t>(smallest - along.begin())] = 1;
    across = unit(cross(along, axis));
    height = cross(along, across);
  }
  for (std::size_t d = 0; d < 3; ++d) {
    axes[0][d][i] = along[d];
    axes[1][d][i] = across[d];
    axes[2][d][i] = height[d];
  }
}

// Replaces the axes in the lanes of triangles without area.
HWY_NOINLINE void set_axes_without_area(hn::Mask<decltype(kD)> flat, const Vec (&edges)[3],
                                        Vec (&axes)[3]) {
  TriangleVectors edge, axis;
  for (std::size_t k = 0; k < 3; ++k) {
    store(edges[k], edge[k], 0);
    store(axes[k], axis[k], 0);
  }
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(kD, flat, bits);
  for (std::size_t i = 0; i < hn::Lanes(kD); ++i) {
    if ((bits[0] >> i & 1) != 0) axes_without_area(edge, axis, i);
  }
  for (std::size_t k = 0; k < 3; ++k) axes[k] = load(axis[k], 0);
}

void prepare(const TriangleVectors& corners, TriangleRows& numbers) {
  for (std::size_t at = 0; at < TriangleBatch::kSize; at += hn::Lanes(kD)) {
    // Sorted, so that rounding does not depend on the order of the corners.
    Vec a = load(corners[0], at), b = load(corners[1], at), c = load(corners[2], at);
    sort(a, b);
    sort(b, c);
    sort(a, b);
    const Vec edges[3] = {minus(b, a), minus(c, a), minus(c, b)};
    const Vec product = cross(edges[0], edges[1]);
    const V area2 = dot(product, product);
    Vec axes[3];  // along, across, normal
    axes[0] = over(edges[0], hn::Sqrt(dot(edges[0], edges[0])));
    axes[2] = over(product, hn::Sqrt(area2));
    axes[1] = cross(axes[2], axes[0]);
    const auto flat = hn::Eq(area2, hn::Zero(kD));
    if (HWY_UNLIKELY(!hn::AllFalse(kD, flat))) set_axes_without_area(flat, edges, axes);
    const PlanarEdge planar_1 = planar_edge(edges[0], axes[0], axes[1]),
                     planar_2 = planar_edge(edges[1], axes[0], axes[1]),
                     planar_3 = planar_edge(edges[2], axes[0], axes[1]);
    // In the order of PreparedTriangle's members.
    Rows rows(numbers, at);
    rows.put(a);
    for (const Vec& edge : edges) rows.put(edge);
    rows.put(axes[2]);
    rows.put(axes[0]);
    rows.put(axes[1]);
    rows.put(planar_1.length);
    rows.put(planar_2.u);
    rows.put(planar_2.v);
    rows.put(planar_3.u);
    rows.put(planar_3.v);
    rows.put(planar_2.length);
    rows.put(planar_3.length);
  }
}

}  // namespace
}  // namespace forcelayer::distance::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::distance {
namespace {

HWY_EXPORT(prepare);

}  // namespace

// As many rows as prepare() writes.
static_assert(TriangleBatch::kNumbers == 28 && std::is_trivially_copyable_v<PreparedTriangle>);

void TriangleBatch::flush() {
  // Above the sine of an angle that is 0 but for rounding, and below that between edges of up to
  // 200 voxels, or of a piece that flatten_if_thin() leaves.
  constexpr float kNoArea = 1e-13f;
  if (count_ == 0) return;
  Rows rows;
  HWY_DYNAMIC_DISPATCH(prepare)(corners_, rows);
  for (std::size_t i = 0; i < count_; ++i) {
    std::array<float, kNumbers> numbers;
    for (std::size_t row = 0; row < kNumbers; ++row) numbers[row] = rows[row][i];
    PreparedTriangle& triangle = list_->emplace_back();
    std::memcpy(static_cast<void*>(&triangle), numbers.data(), sizeof numbers);
    triangle.source = sources_[i];
    triangle.object = objects_[i];
    if (triangle.direction_2[1] > kNoArea) triangle.side = sides_[i];
  }
  count_ = 0;
}

}  // namespace forcelayer::distance
#endif
