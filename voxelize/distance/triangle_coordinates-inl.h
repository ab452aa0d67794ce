// Places in the coordinates of a triangle, in vector lanes. Included once per instruction set (see
// Highway).
#if defined(FORCELAYER_TRIANGLE_COORDINATES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FORCELAYER_TRIANGLE_COORDINATES_INL_H
#undef FORCELAYER_TRIANGLE_COORDINATES_INL_H
#else
#define FORCELAYER_TRIANGLE_COORDINATES_INL_H
#endif

#include <hwy/highway.h>

#include <array>

#include "formats/lattice/voxel_overlap.h"
#include "voxelize/distance/prepared_triangle.h"

HWY_BEFORE_NAMESPACE();
namespace forcelayer::distance::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr hn::CappedTag<float, 8> kF{};
constexpr hn::RebindToUnsigned<decltype(kF)> kU{};
using V = hn::Vec<decltype(kF)>;

HWY_INLINE std::size_t lanes() { return hn::Lanes(kF); }
HWY_INLINE V set(float value) { return hn::Set(kF, value); }

template <class Vector>
HWY_INLINE Vector dot(const std::array<float, 3>& a, Vector x, Vector y, Vector z) {
  const hn::DFromV<Vector> d;
  return hn::Add(hn::Add(hn::Mul(hn::Set(d, a[0]), x), hn::Mul(hn::Set(d, a[1]), y)),
                 hn::Mul(hn::Set(d, a[2]), z));
}

// Coordinates of points from a triangle: in its plane, above it, along its edges 2 and 3, and to
// the left of those. All are linear in the points.
struct TriangleCoordinates {
  V u, v, height;
  V along_2, left_2;
  V along_3, left_3;
};

HWY_INLINE void set_along_edges(const PreparedTriangle& t, V u_from_3, TriangleCoordinates& at) {
  const V x2 = set(t.direction_2[0]), y2 = set(t.direction_2[1]);
  at.along_2 = hn::Add(hn::Mul(x2, at.u), hn::Mul(y2, at.v));
  at.left_2 = hn::Sub(hn::Mul(x2, at.v), hn::Mul(y2, at.u));
  const V x3 = set(t.direction_3[0]), y3 = set(t.direction_3[1]);
  at.along_3 = hn::Add(hn::Mul(x3, u_from_3), hn::Mul(y3, at.v));
  at.left_3 = hn::Sub(hn::Mul(x3, at.v), hn::Mul(y3, u_from_3));
}

HWY_INLINE TriangleCoordinates from_triangle(const PreparedTriangle& t, V px, V py, V pz) {
  const V x = hn::Sub(px, set(t.corner[0])), y = hn::Sub(py, set(t.corner[1])),
          z = hn::Sub(pz, set(t.corner[2]));
  TriangleCoordinates at;
  at.u = dot(t.along, x, y, z);
  at.v = dot(t.across, x, y, z);
  at.height = dot(t.normal, x, y, z);
  set_along_edges(t, hn::Sub(at.u, set(t.length_1)), at);
  return at;
}

// Squared distance in the plane from an edge.
HWY_INLINE V off_edge(V along, V left, float length) {
  const V beyond = hn::Sub(along, hn::Min(hn::Max(along, hn::Zero(kF)), set(length)));
  return hn::Add(hn::Mul(beyond, beyond), hn::Mul(left, left));
}

// Squared distances in the plane from the edges, and from the triangle: 0 above and below it.
struct PlanarDistances {
  V from_1, from_2, from_3;
  V planar;
};

HWY_INLINE PlanarDistances planar_distances(const PreparedTriangle& t,
                                            const TriangleCoordinates& at) {
  PlanarDistances d;
  d.from_1 = off_edge(at.u, at.v, t.length_1);
  d.from_2 = off_edge(at.along_2, at.left_2, t.length_2);
  d.from_3 = off_edge(at.along_3, at.left_3, t.length_3);
  const V smallest = hn::Min(hn::Min(d.from_1, d.from_2), d.from_3);
  // The sign of `inside` is set where one of the three is negative. Edge 2 leads away from corner
  // 0, so the inside is to its right.
  const V margin = set(kInsideTolerance);
  const V inside = hn::Or(hn::Or(hn::Sub(at.v, margin), hn::Neg(hn::Add(at.left_2, margin))),
                          hn::Sub(at.left_3, margin));
  const auto outside =
      hn::BroadcastSignBit(hn::BitCast(hn::RebindToSigned<decltype(kF)>(), inside));
  d.planar = hn::And(hn::BitCast(kF, outside), smallest);
  return d;
}

}  // namespace
}  // namespace forcelayer::distance::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
