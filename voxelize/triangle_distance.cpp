#include "voxelize/triangle_distance.h"

// Compiled once for every instruction set that Highway supports, picked at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/triangle_distance.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "voxelize/distance_scale.h"

HWY_BEFORE_NAMESPACE();
namespace forcelayer::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr hn::CappedTag<float, 16> kF{};
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

// Coordinates of a cube's points.
class Points {
 public:
  HWY_INLINE explicit Points(const PointCube& cube) {
    for (std::size_t n = 0; n < kCubePoints; ++n) {
      const std::size_t at[3] = {n >> 4, n >> 2 & 3, n & 3};
      for (std::size_t d = 0; d < 3; ++d) {
        values_[d][n] = cube.first[d] + cube.step * static_cast<float>(at[d]);
      }
    }
  }
  HWY_INLINE V at(int axis, std::size_t n) const { return hn::Load(kF, values_[axis] + n); }

 private:
  HWY_ALIGN float values_[3][kCubePoints];
};

// Of a point (u, v) from an edge that begins at the origin, in the plane: its squared distance, and
// how far inwards of the edge's line it lies (to the left).
template <class Vector>
HWY_INLINE Vector off_planar_edge(const std::array<float, 2>& direction, float length, Vector u,
                                  Vector v, Vector& inwards) {
  const hn::DFromV<Vector> d;
  const Vector x = hn::Set(d, direction[0]), y = hn::Set(d, direction[1]);
  const Vector along = hn::Add(hn::Mul(x, u), hn::Mul(y, v));
  inwards = hn::Sub(hn::Mul(x, v), hn::Mul(y, u));
  const Vector beyond = hn::Sub(along, hn::Min(hn::Max(along, hn::Zero(d)), hn::Set(d, length)));
  return hn::Add(hn::Mul(beyond, beyond), hn::Mul(inwards, inwards));
}

template <class Vector>
HWY_INLINE Vector squared_distance(const NearTriangle& t, Vector px, Vector py, Vector pz) {
  const hn::DFromV<Vector> d;
  const Vector x = hn::Sub(px, hn::Set(d, t.corner[0])), y = hn::Sub(py, hn::Set(d, t.corner[1])),
               z = hn::Sub(pz, hn::Set(d, t.corner[2]));
  const Vector u = dot(t.along, x, y, z), v = dot(t.across, x, y, z),
               height = dot(t.normal, x, y, z);
  const Vector beyond = hn::Sub(u, hn::Min(hn::Max(u, hn::Zero(d)), hn::Set(d, t.length_1)));
  const Vector from_1 = hn::Add(hn::Mul(beyond, beyond), hn::Mul(v, v));
  Vector left_2, left_3;
  const Vector from_2 = off_planar_edge(t.direction_2, t.length_2, u, v, left_2);
  const Vector from_3 =
      off_planar_edge(t.direction_3, t.length_3, hn::Sub(u, hn::Set(d, t.length_1)), v, left_3);
  // Edge 2 leads away from corner 0: the inside is to its right.
  const Vector least = hn::Min(hn::Min(from_1, from_2), from_3);
  const Vector inside =
      hn::Min(hn::Min(v, hn::Neg(left_2)), hn::Add(left_3, hn::Set(d, t.nothing)));
  const Vector planar = hn::IfThenElseZero(hn::Lt(inside, hn::Zero(d)), least);
  return hn::Add(planar, hn::Mul(height, height));
}

void distances(const NearTriangle* const* triangles, std::size_t count, const PointCube& cube,
               CubeValues* squared, CubeValues& least) {
  const Points points(cube);
  for (std::size_t n = 0; n < kCubePoints; n += lanes()) {
    const V x = points.at(0, n), y = points.at(1, n), z = points.at(2, n);
    V best = set(1e30f);
    for (std::size_t i = 0; i < count; ++i) {
      const V d = squared_distance(*triangles[i], x, y, z);
      hn::StoreU(d, kF, squared[i].data() + n);
      best = hn::Min(best, d);
    }
    hn::StoreU(best, kF, least.data() + n);
  }
}

HWY_INLINE std::uint64_t bits_of(hn::Mask<decltype(kF)> mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(kF, mask, bits);
  return std::uint64_t{bits[0]} | std::uint64_t{bits[1]} << 8;
}

void within(const CubeValues* values, std::size_t count, const CubeValues& limits,
            std::uint64_t* bits) {
  for (std::size_t i = 0; i < count; ++i) {
    bits[i] = 0;
    for (std::size_t n = 0; n < kCubePoints; n += lanes()) {
      const V value = hn::LoadU(kF, values[i].data() + n);
      bits[i] |= bits_of(hn::Le(value, hn::LoadU(kF, limits.data() + n))) << n;
    }
  }
}

// Eighths are looked at two and two, one behind the other along z, where that fills a vector.
constexpr std::size_t kTogether = hn::MaxLanes(kF) >= 2 * kEighths ? 2 : 1;

// 2 x 2 x 2 points `step` apart from `first` on, by x*4 + y*2 + z, and another such eight `further`
// steps on along z.
class SixteenPoints {
 public:
  HWY_INLINE SixteenPoints(const std::array<float, 3>& first, float step, float further)
      : first_(first), step_(step), further_(further) {}
  HWY_INLINE V x(std::size_t n) const { return at(0, n); }
  HWY_INLINE V y(std::size_t n) const { return at(1, n); }
  HWY_INLINE V z(std::size_t n) const {
    HWY_ALIGN static constexpr float kSecond[16] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1};
    const V second = hn::Mul(set(further_), hn::Load(kF, kSecond + n));
    return hn::Add(set(first_[2]), hn::Mul(set(step_), hn::Add(steps(2, n), second)));
  }

 private:
  static HWY_INLINE V steps(int axis, std::size_t n) {
    HWY_ALIGN static constexpr float kSteps[3][16] = {
        {0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1},
        {0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1},
        {0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1}};
    return hn::Load(kF, kSteps[axis] + n);
  }
  HWY_INLINE V at(int axis, std::size_t n) const {
    return hn::Add(set(first_[static_cast<std::size_t>(axis)]),
                   hn::Mul(set(step_), steps(axis, n)));
  }

  std::array<float, 3> first_;
  float step_, further_;
};

// Squared distances from the middles of the two cubes' eighths, [triangles][2][eighths], and the
// least of each.
HWY_INLINE void from_middles(const NearTriangle* const* triangles, std::size_t count,
                             const PointCube& cube, float* squared, float* least) {
  const float half = cube.step / 2;
  const SixteenPoints middles({cube.first[0] + half, cube.first[1] + half, cube.first[2] + half},
                              2 * cube.step, 2);
  for (std::size_t n = 0; n < 2 * kEighths; n += lanes()) {
    const V x = middles.x(n), y = middles.y(n), z = middles.z(n);
    V best = set(1e30f);
    for (std::size_t i = 0; i < count; ++i) {
      const V d = squared_distance(*triangles[i], x, y, z);
      hn::StoreU(d, kF, squared + 2 * kEighths * i + n);
      best = hn::Min(best, d);
    }
    hn::StoreU(best, kF, least + n);
  }
}

// Per triangle and cube a byte: bits of the eighths in whose limits it lies.
HWY_INLINE void eighths_within(const float* squared, std::size_t count, const float* limits,
                               std::uint8_t* first, std::uint8_t* second) {
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t bits = 0;
    for (std::size_t n = 0; n < 2 * kEighths; n += lanes()) {
      const V value = hn::LoadU(kF, squared + 2 * kEighths * i + n);
      bits |= bits_of(hn::Le(value, hn::LoadU(kF, limits + n))) << n;
    }
    first[i] = static_cast<std::uint8_t>(bits);
    second[i] = static_cast<std::uint8_t>(bits >> 8);
  }
}

// The least from the points of `kTogether` eighths from number `eighth` on, of the triangles whose
// byte has a bit of theirs. Behind the bytes stand eight that are zero.
HWY_INLINE void nearest_of(const NearTriangle* const* triangles, const std::uint8_t* eighths,
                           std::size_t count, std::size_t eighth, const SixteenPoints& points,
                           float* least, std::uint32_t* which) {
  for (std::size_t n = 0; n < kTogether * kEighths; n += lanes()) {
    const V x = points.x(n), y = points.y(n), z = points.z(n);
    V best = set(1e30f);
    auto best_at = hn::Zero(kU);
    for (std::size_t first = 0; first < count; first += 8) {
      std::uint64_t bytes;
      hwy::CopyBytes<8>(eighths + first, &bytes);
      bytes >>= eighth;
      if (kTogether == 2) bytes |= bytes >> 1;
      bytes &= 0x0101010101010101u;
      for (unsigned left = static_cast<unsigned>(bytes * 0x0102040810204080u >> 56); left != 0;
           left &= left - 1) {
        const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(left));
        const V d = squared_distance(*triangles[i], x, y, z);
        const auto better = hn::Lt(d, best);
        best = hn::IfThenElse(better, d, best);
        best_at = hn::IfThenElse(hn::RebindMask(kU, better),
                                 hn::Set(kU, static_cast<std::uint32_t>(i)), best_at);
      }
    }
    hn::StoreU(best, kF, least + n);
    hn::StoreU(best_at, kU, which + n);
  }
}

// One of the two cubes.
HWY_INLINE void nearest_in_cube(const NearTriangle* const* triangles, const std::uint8_t* eighths,
                                std::size_t count, const PointCube& cube, float* least,
                                std::uint32_t* which) {
  for (std::size_t n = 0; n < kEighths; n += kTogether) {
    const std::size_t low[3] = {2 * (n >> 2), 2 * (n >> 1 & 1), 2 * (n & 1)};
    std::array<float, 3> first;
    for (std::size_t d = 0; d < 3; ++d) {
      first[d] = cube.first[d] + cube.step * static_cast<float>(low[d]);
    }
    float near[kTogether * kEighths];
    std::uint32_t number[kTogether * kEighths];
    nearest_of(triangles, eighths, count, n, SixteenPoints(first, cube.step, 2), near, number);
    for (std::size_t pair = 0; pair < kTogether * kEighths / 2; ++pair) {
      const std::size_t to =
          (low[0] + (pair >> 1 & 1)) * 16 + (low[1] + (pair & 1)) * 4 + low[2] + 2 * (pair >> 2);
      hwy::CopyBytes<8>(near + 2 * pair, least + to);
      hwy::CopyBytes<8>(number + 2 * pair, which + to);
    }
  }
}

// `squared` has room for sixteen numbers a triangle, `eighths` for two bytes a triangle and sixteen
// more.
void nearest(const NearTriangle* const* triangles, std::size_t count, const PointCube& cube,
             const float* reach, float* squared, std::uint8_t* eighths, CubeValues* least,
             std::array<std::uint32_t, kCubePoints>* which) {
  constexpr auto kUnits = static_cast<float>(kSnapUnits);
  constexpr float kAround = (half_diagonal(2) + kDistanceErrorVoxels) * kUnits;
  float limits[2 * kEighths];
  from_middles(triangles, count, cube, squared, limits);
  for (std::size_t n = 0; n < 2 * kEighths; ++n) {
    const float limit = std::min(reach[n], std::sqrt(limits[n]) + kAround) + kAround;
    limits[n] = reach[n] < 0 ? -1.0f : limit * limit;
  }
  std::uint8_t* of_cube[2] = {eighths, eighths + count + 8};
  eighths_within(squared, count, limits, of_cube[0], of_cube[1]);
  PointCube one = cube;
  for (std::size_t k = 0; k < 2; ++k) {
    const std::uint64_t none = 0;
    hwy::CopyBytes<8>(&none, of_cube[k] + count);
    nearest_in_cube(triangles, of_cube[k], count, one, least[k].data(), which[k].data());
    one.first[2] += 4 * cube.step;
  }
}

void codes(const CubeValues& squared, std::uint64_t negative, const DistanceScale& scale,
           std::uint8_t* out) {
  constexpr hn::RebindToSigned<decltype(kF)> kI{};
  constexpr hn::Rebind<std::uint8_t, decltype(kI)> kBytes{};
  const auto code = [&](std::uint32_t c) HWY_ATTR { return hn::Set(kI, static_cast<int>(c)); };
  // Distances that are taken for no more than this have the highest code anyway.
  const V most = set(4 * static_cast<float>(kMostRangeVoxels));
  for (std::size_t n = 0; n < kCubePoints; n += lanes()) {
    const V root = hn::Sqrt(hn::LoadU(kF, squared.data() + n));
    const V length = hn::Min(hn::Mul(root, set(1.0f / static_cast<float>(kSnapUnits))), most);
    const std::uint8_t bits[8] = {static_cast<std::uint8_t>(negative >> n),
                                  static_cast<std::uint8_t>(n + 8 < 64 ? negative >> (n + 8) : 0)};
    const V d = hn::IfThenElse(hn::LoadMaskBits(kF, bits), hn::Neg(length), length);
    const V steps = hn::Mul(hn::Sub(d, set(static_cast<float>(scale.zero))),
                            set(static_cast<float>(1 / scale.quantum)));
    auto nearest = hn::Add(hn::NearestInt(steps), code(scale.zero_code));
    // The nearest code of the value that the distance has.
    const auto below = [&](double bound) HWY_ATTR {
      return hn::RebindMask(kI, hn::Lt(d, set(static_cast<float>(bound))));
    };
    const auto interior = below(scale.interior_below), surface = below(scale.surface_below),
               proximity = below(scale.proximity_below);
    const auto pick = [&](std::uint32_t in_interior, std::uint32_t in_surface,
                          std::uint32_t in_proximity, std::uint32_t in_free) HWY_ATTR {
      const auto outer = hn::IfThenElse(proximity, code(in_proximity), code(in_free));
      return hn::IfThenElse(interior, code(in_interior),
                            hn::IfThenElse(surface, code(in_surface), outer));
    };
    nearest = hn::Max(nearest, pick(0, scale.surface_code, scale.proximity_code, scale.free_code));
    nearest = hn::Min(nearest, pick(scale.surface_code - 1, scale.proximity_code - 1,
                                    scale.free_code - 1, scale.free_code));
    hn::StoreU(hn::DemoteTo(kBytes, nearest), kBytes, out + n);
  }
}

}  // namespace
}  // namespace forcelayer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer {
namespace {

HWY_EXPORT(distances);
HWY_EXPORT(within);
HWY_EXPORT(nearest);
HWY_EXPORT(codes);

using Vec = std::array<double, 3>;

Vec minus(const Vec& a, const Vec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec cross(const Vec& a, const Vec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
std::array<float, 3> rounded(const Vec& v, double scale = 1) {
  return {static_cast<float>(v[0] * scale), static_cast<float>(v[1] * scale),
          static_cast<float>(v[2] * scale)};
}

Vec widened(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

Vec unit(const Vec& v) {
  const double length = std::sqrt(dot(v, v));
  return {v[0] / length, v[1] / length, v[2] / length};
}

// The coordinates of the plane. Without area they are any around the longest edge.
void set_planar(NearTriangle& t, const Vec (&edges)[3], const Vec& normal) {
  Vec along{1, 0, 0}, across{0, 1, 0}, height{0, 0, 1};
  const double area2 = dot(normal, normal);
  if (area2 > 0) {
    along = unit(edges[0]);
    height = unit(normal);
    across = cross(height, along);
  } else {
    const Vec* longest = &edges[0];
    for (const Vec& edge : edges) {
      if (dot(edge, edge) > dot(*longest, *longest)) longest = &edge;
    }
    if (dot(*longest, *longest) > 0) {
      along = unit(*longest);
      const std::size_t least =
          std::min_element(along.begin(), along.end(),
                           [](double a, double b) { return std::abs(a) < std::abs(b); }) -
          along.begin();
      Vec axis{};
      axis[least] = 1;
      across = unit(cross(along, axis));
      height = cross(along, across);
    }
  }
  t.along = rounded(along);
  t.across = rounded(across);
  if (area2 == 0) t.normal = rounded(height);
  const auto planar = [&](const Vec& edge, std::array<float, 2>& direction, float& length) {
    const double u = dot(edge, along), v = dot(edge, across), l = std::sqrt(u * u + v * v);
    length = static_cast<float>(l);
    direction = l > 0 ? std::array<float, 2>{static_cast<float>(u / l), static_cast<float>(v / l)}
                      : std::array<float, 2>{1, 0};
  };
  std::array<float, 2> direction_1;
  planar(edges[0], direction_1, t.length_1);
  planar(edges[1], t.direction_2, t.length_2);
  planar(edges[2], t.direction_3, t.length_3);
}

}  // namespace

NearTriangle near_triangle(std::array<Vec, 3> corners, std::uint32_t source) {
  // Sorted, so that rounding does not depend on their order.
  if (corners[1] < corners[0]) std::swap(corners[0], corners[1]);
  if (corners[2] < corners[1]) std::swap(corners[1], corners[2]);
  if (corners[1] < corners[0]) std::swap(corners[0], corners[1]);
  const Vec edges[3] = {minus(corners[1], corners[0]), minus(corners[2], corners[0]),
                        minus(corners[2], corners[1])};
  const Vec normal = cross(edges[0], edges[1]);
  const double area2 = dot(normal, normal);
  NearTriangle t{};
  t.corner = rounded(corners[0]);
  t.edge_1 = rounded(edges[0]);
  t.edge_2 = rounded(edges[1]);
  t.edge_3 = rounded(edges[2]);
  t.source = source;
  t.nothing = area2 > 0 ? 0.0f : -1.0f;
  if (area2 > 0) t.normal = rounded(normal, 1 / std::sqrt(area2));
  set_planar(t, edges, normal);
  return t;
}

void squared_distances(NearList triangles, const PointCube& points, CubeValues* squared,
                       CubeValues& least) {
  HWY_DYNAMIC_DISPATCH(distances)(triangles.data(), triangles.size(), points, squared, least);
}

void bits_within(const CubeValues* values, std::size_t count, const CubeValues& limits,
                 std::uint64_t* bits) {
  HWY_DYNAMIC_DISPATCH(within)(values, count, limits, bits);
}

void NearestTriangles::find(NearList triangles, const PointCube& first,
                            const std::array<float, 2 * kEighths>& reach) {
  const std::size_t count = triangles.size();
  if (squared_.size() < 2 * kEighths * count) {
    squared_.resize(2 * kEighths * count);
    eighths_.resize(2 * (count + 8));
  }
  HWY_DYNAMIC_DISPATCH(nearest)
  (triangles.data(), count, first, reach.data(), squared_.data(), eighths_.data(), least_.data(),
   which_.data());
}

std::array<double, 3> way_from(const NearTriangle& t, const std::array<double, 3>& point) {
  const Vec w = minus(point, widened(t.corner));
  const double u = dot(w, widened(t.along)), v = dot(w, widened(t.across)),
               height = dot(w, widened(t.normal));
  const auto left_of = [](const std::array<float, 2>& direction, double along, double across) {
    return direction[0] * across - direction[1] * along;
  };
  const double inside = std::min(
      {v, -left_of(t.direction_2, u, v), left_of(t.direction_3, u - double{t.length_1}, v)});
  const Vec across{height * double{t.normal[0]}, height * double{t.normal[1]},
                   height * double{t.normal[2]}};
  // So far inside that no edge is as near, however the numbers are rounded.
  constexpr double kSurely = 4;
  if (t.nothing == 0 && inside > kSurely && std::abs(height) < 4 * double{kSnapUnits}) {
    return across;
  }
  Vec best{};
  double least = 1e300;
  const auto take = [&](const Vec& away) {
    if (dot(away, away) < least) least = dot(away, away), best = away;
  };
  const auto off_edge = [&](const Vec& from, const Vec& edge) {
    const double length2 = dot(edge, edge);
    const double at = length2 > 0 ? std::clamp(dot(from, edge) / length2, 0.0, 1.0) : 0;
    take({from[0] - at * edge[0], from[1] - at * edge[1], from[2] - at * edge[2]});
  };
  off_edge(w, widened(t.edge_1));
  off_edge(w, widened(t.edge_2));
  off_edge(minus(w, widened(t.edge_1)), widened(t.edge_3));
  if (t.nothing == 0 && inside >= 0) take(across);
  return best;
}

void codes_of_distances(const CubeValues& squared, std::uint64_t negative,
                        const DistanceScale& scale, std::uint8_t* codes) {
  HWY_DYNAMIC_DISPATCH(codes)(squared, negative, scale, codes);
}

}  // namespace forcelayer
#endif
