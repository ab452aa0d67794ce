#include "voxelize/distance/distance_kernel.h"

// Compiled once for every instruction set that Highway supports, picked at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/distance/distance_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "formats/lattice/voxel_overlap.h"
#include "formats/voxmap_format.h"
#include "voxelize/distance/code_scale.h"

HWY_BEFORE_NAMESPACE();
namespace forcelayer::distance::HWY_NAMESPACE {
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

// Coordinates of a cube's first 16 points, those of its lowest x.
constexpr std::size_t kPlane = 16;
class PlanePoints {
 public:
  HWY_INLINE explicit PlanePoints(const PointCube& cube) {
    for (std::size_t n = 0; n < kPlane; ++n) {
      const std::size_t at[3] = {0, n >> 2, n & 3};
      for (std::size_t d = 0; d < 3; ++d) {
        values_[d][n] = cube.first[d] + cube.step * static_cast<float>(at[d]);
      }
    }
  }
  HWY_INLINE V at(int axis, std::size_t n) const { return hn::Load(kF, values_[axis] + n); }

 private:
  HWY_ALIGN float values_[3][kPlane];
};

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

// The change of the coordinates by a step along an axis.
HWY_INLINE TriangleCoordinates step_along(const PreparedTriangle& t, std::size_t axis, float step) {
  const V length = set(step);
  TriangleCoordinates by;
  by.u = hn::Mul(set(t.along[axis]), length);
  by.v = hn::Mul(set(t.across[axis]), length);
  by.height = hn::Mul(set(t.normal[axis]), length);
  set_along_edges(t, by.u, by);
  return by;
}

HWY_INLINE void advance(TriangleCoordinates& at, const TriangleCoordinates& by) {
  at.u = hn::Add(at.u, by.u);
  at.v = hn::Add(at.v, by.v);
  at.height = hn::Add(at.height, by.height);
  at.along_2 = hn::Add(at.along_2, by.along_2);
  at.left_2 = hn::Add(at.left_2, by.left_2);
  at.along_3 = hn::Add(at.along_3, by.along_3);
  at.left_3 = hn::Add(at.left_3, by.left_3);
}

// Squared distance in the plane from an edge.
HWY_INLINE V off_edge(V along, V left, float length) {
  const V beyond = hn::Sub(along, hn::Min(hn::Max(along, hn::Zero(kF)), set(length)));
  return hn::Add(hn::Mul(beyond, beyond), hn::Mul(left, left));
}

HWY_INLINE V squared_distance(const PreparedTriangle& t, const TriangleCoordinates& at) {
  const V from_1 = off_edge(at.u, at.v, t.length_1);
  const V from_2 = off_edge(at.along_2, at.left_2, t.length_2);
  const V from_3 = off_edge(at.along_3, at.left_3, t.length_3);
  const V least = hn::Min(hn::Min(from_1, from_2), from_3);
  // The sign of `inside` is set where one of the three is negative. Edge 2 leads away from corner
  // 0, so the inside is to its right.
  const V margin = set(kInsideTolerance);
  const V inside = hn::Or(hn::Or(hn::Sub(at.v, margin), hn::Neg(hn::Add(at.left_2, margin))),
                          hn::Sub(at.left_3, margin));
  const auto outside =
      hn::BroadcastSignBit(hn::BitCast(hn::RebindToSigned<decltype(kF)>(), inside));
  const V planar = hn::And(hn::BitCast(kF, outside), least);
  return hn::Add(planar, hn::Mul(at.height, at.height));
}

// Steps along x: faster than each point from scratch, and rounded differently.
void distances(const PreparedTriangle* const* triangles, std::size_t count, const PointCube& cube,
               CubeValues* squared, CubeValues& least) {
  const PlanePoints points(cube);
  HWY_ALIGN float best[kCubePoints];
  for (std::size_t n = 0; n < kCubePoints; n += lanes()) hn::Store(set(1e30f), kF, best + n);
  for (std::size_t i = 0; i < count; ++i) {
    const PreparedTriangle& t = *triangles[i];
    const TriangleCoordinates by = step_along(t, 0, cube.step);
    for (std::size_t first = 0; first < kPlane; first += lanes()) {
      TriangleCoordinates at =
          from_triangle(t, points.at(0, first), points.at(1, first), points.at(2, first));
      for (std::size_t n = first;;) {
        const V d = squared_distance(t, at);
        hn::StoreU(d, kF, squared[i].data() + n);
        hn::Store(hn::Min(hn::Load(kF, best + n), d), kF, best + n);
        n += kPlane;
        if (n >= kCubePoints) break;
        advance(at, by);
      }
    }
  }
  for (std::size_t n = 0; n < kCubePoints; n += lanes()) {
    hn::StoreU(hn::Load(kF, best + n), kF, least.data() + n);
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

// Two eighths, one behind the other along z, are computed together where they fill a vector.
constexpr std::size_t kTogether = hn::MaxLanes(kF) >= 2 * kEighths ? 2 : 1;

// 2 x 2 x 2 points `step` apart, point x*4 + y*2 + z, the lowest at `first`; and another such eight
// `further` steps on along z.
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

// Squared distances of the middles of the two cubes' eighths, [triangles][2][eighths], and the
// least of each middle.
HWY_INLINE void from_middles(const PreparedTriangle* const* triangles, std::size_t count,
                             const PointCube& cube, float* squared, float* least) {
  const float half = cube.step / 2;
  const SixteenPoints middles({cube.first[0] + half, cube.first[1] + half, cube.first[2] + half},
                              2 * cube.step, 2);
  // Where a vector holds one cube's eighths, a step of four points leads to the second cube.
  constexpr bool kOneByOne = hn::MaxLanes(kF) == kEighths;
  constexpr std::size_t kFirst = kOneByOne ? kEighths : 2 * kEighths;
  for (std::size_t n = 0; n < kFirst; n += lanes()) {
    const V x = middles.x(n), y = middles.y(n), z = middles.z(n);
    V best = set(1e30f), best_second = best;
    for (std::size_t i = 0; i < count; ++i) {
      const PreparedTriangle& t = *triangles[i];
      TriangleCoordinates at = from_triangle(t, x, y, z);
      const V d = squared_distance(t, at);
      hn::StoreU(d, kF, squared + 2 * kEighths * i + n);
      best = hn::Min(best, d);
      if constexpr (kOneByOne) {
        advance(at, step_along(t, 2, 4 * cube.step));
        const V second = squared_distance(t, at);
        hn::StoreU(second, kF, squared + 2 * kEighths * i + kEighths + n);
        best_second = hn::Min(best_second, second);
      }
    }
    hn::StoreU(best, kF, least + n);
    if constexpr (kOneByOne) hn::StoreU(best_second, kF, least + kEighths + n);
  }
}

// For each triangle and cube a byte: bit n is set where the triangle is within the limit of eighth
// n.
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

// Takes the bytes of eight triangles. Bit i of the result is set where triangle i is within the
// limit of `eighth`, or of the next where two are computed together.
HWY_INLINE std::uint64_t near_of(const std::uint8_t* eighths, std::size_t eighth) {
  std::uint64_t bytes;
  hwy::CopyBytes<8>(eighths, &bytes);
  bytes >>= eighth;
  if (kTogether == 2) bytes |= bytes >> 1;
  return (bytes & 0x0101010101010101u) * 0x0102040810204080u >> 56;
}

// The nearest triangle of each point of `kTogether` eighths, from number `eighth` on, among the
// triangles within their limits: its squared distance and its number, with the highest bit set
// where several are equally near. Eight zero bytes must follow the bytes in `eighths`.
HWY_INLINE void nearest_of(const PreparedTriangle* const* triangles, const std::uint8_t* eighths,
                           std::size_t count, std::size_t eighth, const SixteenPoints& points,
                           float* least, std::uint32_t* which) {
  for (std::size_t n = 0; n < kTogether * kEighths; n += lanes()) {
    const V x = points.x(n), y = points.y(n), z = points.z(n);
    V best = set(1e30f);
    auto best_at = hn::Zero(kU);
    auto tied = hn::Lt(best, best);
    for (std::size_t first = 0; first < count; first += 64) {
      std::uint64_t near = 0;
      const std::size_t end = std::min<std::size_t>(count - first, 64);
      for (std::size_t i = 0; i < end; i += 8) near |= near_of(eighths + first + i, eighth) << i;
      for (; near != 0; near &= near - 1) {
        const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(near));
        const PreparedTriangle& t = *triangles[i];
        const V d = squared_distance(t, from_triangle(t, x, y, z));
        const auto better = hn::Lt(d, best);
        tied = hn::Or(hn::AndNot(better, tied), hn::Eq(d, best));
        best = hn::IfThenElse(better, d, best);
        best_at = hn::IfThenElse(hn::RebindMask(kU, better),
                                 hn::Set(kU, static_cast<std::uint32_t>(i)), best_at);
      }
    }
    hn::StoreU(best, kF, least + n);
    const auto flag = hn::Set(kU, std::uint32_t{1} << 31);
    best_at = hn::IfThenElse(hn::RebindMask(kU, tied), hn::Or(best_at, flag), best_at);
    hn::StoreU(best_at, kU, which + n);
  }
}

// The first, by lies_before(), of the triangles at distance `squared` from a point of `eighth`.
std::uint32_t first_at(const PreparedTriangle* const* triangles, const std::uint8_t* eighths,
                       std::size_t count, std::size_t eighth, const std::array<float, 3>& point,
                       float squared) {
  const V x = set(point[0]), y = set(point[1]), z = set(point[2]);
  const PreparedTriangle* first = nullptr;
  std::uint32_t number = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    if ((eighths[i] >> eighth & 1) == 0) continue;
    const PreparedTriangle& t = *triangles[i];
    if (hn::GetLane(squared_distance(t, from_triangle(t, x, y, z))) != squared) continue;
    if (first == nullptr || lies_before(t, *first)) first = &t, number = i;
  }
  return number;
}

HWY_INLINE void nearest_in_cube(const PreparedTriangle* const* triangles,
                                const std::uint8_t* eighths, std::size_t count,
                                const PointCube& cube, float* least, std::uint32_t* which) {
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

// Scratch space: `squared` holds sixteen numbers a triangle, `eighths` two bytes a triangle and
// sixteen more.
void nearest(const PreparedTriangle* const* triangles, std::size_t count, const PointCube& cube,
             const float* reach, float* squared, std::uint8_t* eighths, CubeValues* least,
             std::array<std::uint32_t, kCubePoints>* which) {
  constexpr auto kUnits = static_cast<float>(lattice::kSnapUnits);
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

void codes(const CubeValues& squared, std::uint64_t negative, const CodeScale& scale,
           std::uint8_t* out) {
  constexpr hn::RebindToSigned<decltype(kF)> kI{};
  constexpr hn::Rebind<std::uint8_t, decltype(kI)> kBytes{};
  // Greater distances have the code of the nearest end too.
  const V most =
      set(static_cast<float>(std::max(scale.least_of(kMostDistanceCode), -scale.least_of(0)) + 1));
  for (std::size_t n = 0; n < kCubePoints; n += lanes()) {
    const V root = hn::Sqrt(hn::LoadU(kF, squared.data() + n));
    const V length =
        hn::Min(hn::Mul(root, set(1.0f / static_cast<float>(lattice::kSnapUnits))), most);
    const std::uint8_t bits[8] = {static_cast<std::uint8_t>(negative >> n),
                                  static_cast<std::uint8_t>(n + 8 < 64 ? negative >> (n + 8) : 0)};
    const V d = hn::IfThenElse(hn::LoadMaskBits(kF, bits), hn::Neg(length), length);
    // Rounded down, and before that less what the arithmetic may be off.
    const V steps =
        hn::Mul(hn::Sub(d, set(kDistanceErrorVoxels)), set(static_cast<float>(1 / scale.quantum)));
    const auto code = hn::Add(hn::ConvertTo(kI, hn::Floor(steps)), hn::Set(kI, scale.zero_code));
    const auto stored = hn::Min(hn::Max(code, hn::Zero(kI)), hn::Set(kI, 255));
    hn::StoreU(hn::DemoteTo(kBytes, stored), kBytes, out + n);
  }
}

}  // namespace
}  // namespace forcelayer::distance::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::distance {
namespace {

HWY_EXPORT(distances);
HWY_EXPORT(within);
HWY_EXPORT(nearest);
HWY_EXPORT(first_at);
HWY_EXPORT(codes);

using Vec = std::array<double, 3>;

Vec minus(const Vec& a, const Vec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec widened(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

}  // namespace

void squared_distances(TriangleList triangles, const PointCube& points, CubeValues* squared,
                       CubeValues& least) {
  HWY_DYNAMIC_DISPATCH(distances)(triangles.data(), triangles.size(), points, squared, least);
}

void bits_within(const CubeValues* values, std::size_t count, const CubeValues& limits,
                 std::uint64_t* bits) {
  HWY_DYNAMIC_DISPATCH(within)(values, count, limits, bits);
}

void NearestTriangles::find(TriangleList triangles, const PointCube& first,
                            const std::array<float, 2 * kEighths>& reach) {
  const std::size_t count = triangles.size();
  triangles_ = triangles;
  first_ = first;
  if (squared_.size() < 2 * kEighths * count) {
    squared_.resize(2 * kEighths * count);
    eighths_.resize(2 * (count + 8));
  }
  HWY_DYNAMIC_DISPATCH(nearest)
  (triangles.data(), count, first, reach.data(), squared_.data(), eighths_.data(), least_.data(),
   which_.data());
}

std::uint32_t NearestTriangles::first_tied(std::size_t cube, std::size_t point) const {
  const std::size_t at[3] = {point >> 4, point >> 2 & 3, (point & 3) + 4 * cube};
  std::array<float, 3> place;
  for (std::size_t d = 0; d < 3; ++d) {
    place[d] = first_.first[d] + first_.step * static_cast<float>(at[d]);
  }
  const std::size_t eighth = at[0] / 2 * 4 + at[1] / 2 * 2 + (point & 3) / 2;
  const std::size_t count = triangles_.size();
  return HWY_DYNAMIC_DISPATCH(first_at)(triangles_.data(), eighths_.data() + cube * (count + 8),
                                        count, eighth, place, least_[cube][point]);
}

std::array<double, 3> way_from(const PreparedTriangle& t, const std::array<double, 3>& point) {
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
  // So far inside that no edge is nearer, however the numbers are rounded.
  constexpr double kSurely = 4;
  if (inside > kSurely && std::abs(height) < 4 * double{lattice::kSnapUnits}) {
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
  if (inside >= double{kInsideTolerance}) take(across);
  return best;
}

void codes_of_distances(const CubeValues& squared, std::uint64_t negative, const CodeScale& scale,
                        std::uint8_t* codes) {
  HWY_DYNAMIC_DISPATCH(codes)(squared, negative, scale, codes);
}

}  // namespace forcelayer::distance
#endif
