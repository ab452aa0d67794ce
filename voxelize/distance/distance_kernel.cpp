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
#include "voxelize/distance/triangle_coordinates-inl.h"

HWY_BEFORE_NAMESPACE();
namespace forcelayer::distance::HWY_NAMESPACE {
namespace {

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

HWY_INLINE V squared_distance(const PreparedTriangle& t, const TriangleCoordinates& at) {
  return hn::Add(planar_distances(t, at).planar, hn::Mul(at.height, at.height));
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
  return bits[0];
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

// 2 x 2 x 2 points `step` apart, point x*4 + y*2 + z, the lowest at `first`.
class EightPoints {
 public:
  HWY_INLINE EightPoints(const std::array<float, 3>& first, float step)
      : first_(first), step_(step) {}
  HWY_INLINE V x(std::size_t n) const { return at(0, n); }
  HWY_INLINE V y(std::size_t n) const { return at(1, n); }
  HWY_INLINE V z(std::size_t n) const { return at(2, n); }

 private:
  HWY_INLINE V at(int axis, std::size_t n) const {
    HWY_ALIGN static constexpr float kSteps[3][8] = {
        {0, 0, 0, 0, 1, 1, 1, 1}, {0, 0, 1, 1, 0, 0, 1, 1}, {0, 1, 0, 1, 0, 1, 0, 1}};
    return hn::Add(set(first_[static_cast<std::size_t>(axis)]),
                   hn::Mul(set(step_), hn::Load(kF, kSteps[axis] + n)));
  }

  std::array<float, 3> first_;
  float step_;
};

// The least of an open feature's squared distances; of the others they are out of the way.
constexpr float kFarAway = 1e30f;
HWY_INLINE V if_open(const PreparedTriangle& t, unsigned bit, V squared) {
  return hn::Max(squared, set((t.open >> bit & 1) != 0 ? 0.0f : kFarAway));
}

// Where the points' surroundings, `around` lattice units to every side, lie so far beside the
// triangle that others are nearer there (claims.h).
HWY_INLINE hn::Mask<decltype(kF)> is_beside(const PreparedTriangle& t,
                                            const TriangleCoordinates& at, const PlanarDistances& d,
                                            float around, float margin) {
  constexpr float kOpenRadius = kOpenRadiusVoxels * static_cast<float>(lattice::kSnapUnits);
  const V beside = hn::Sqrt(d.planar);
  const V most = hn::Add(hn::Mul(set(t.slope), hn::Add(hn::Abs(at.height), set(around))),
                         set(margin + around));
  auto result = hn::Gt(beside, most);
  if (t.open == 0) return result;
  // The nearest points of the surroundings are within `around` of the point's own.
  const auto square = [](V v) HWY_ATTR { return hn::Mul(v, v); };
  const V edges =
      hn::Min(hn::Min(if_open(t, 0, d.from_1), if_open(t, 1, d.from_2)), if_open(t, 2, d.from_3));
  const V off_edges = hn::Add(beside, set(around + margin));
  result = hn::And(result, hn::Gt(edges, square(off_edges)));
  const V v2 = square(at.v);
  const V corner_0 = hn::Add(square(at.u), v2),
          corner_1 = hn::Add(square(hn::Sub(at.u, set(t.length_1))), v2),
          corner_2 = hn::Add(square(hn::Sub(at.along_2, set(t.length_2))), square(at.left_2));
  const V corners =
      hn::Min(hn::Min(if_open(t, 3, corner_0), if_open(t, 4, corner_1)), if_open(t, 5, corner_2));
  return hn::And(result, hn::Gt(corners, square(hn::Add(off_edges, set(kOpenRadius)))));
}

// For each triangle the cells that it may be the nearest to, as bits. `squared` is scratch space of
// eight numbers a triangle.
void near_eighths(const PreparedTriangle* const* triangles, std::size_t count,
                  const EightCells& cells, float margin, float* squared, std::uint8_t* bits) {
  const EightPoints middles(cells.first, cells.step);
  std::fill_n(bits, count, std::uint8_t{0});
  for (std::size_t n = 0; n < kEighths; n += lanes()) {
    const V x = middles.x(n), y = middles.y(n), z = middles.z(n);
    V least = set(kFarAway);
    for (std::size_t i = 0; i < count; ++i) {
      const PreparedTriangle& t = *triangles[i];
      const TriangleCoordinates at = from_triangle(t, x, y, z);
      const PlanarDistances planar = planar_distances(t, at);
      V d = hn::Add(planar.planar, hn::Mul(at.height, at.height));
      least = hn::Min(least, d);
      if (t.open != Claim::kAllOpen) {
        d = hn::IfThenElse(is_beside(t, at, planar, cells.around, margin), set(kFarAway), d);
      }
      hn::StoreU(d, kF, squared + kEighths * i + n);
    }
    const V reach = hn::LoadU(kF, cells.reach.data() + n), around = set(cells.around);
    V limit = hn::Add(hn::Min(reach, hn::Add(hn::Sqrt(least), around)), around);
    limit = hn::IfThenElse(hn::Lt(reach, hn::Zero(kF)), set(-1), hn::Mul(limit, limit));
    for (std::size_t i = 0; i < count; ++i) {
      const auto near = hn::Le(hn::LoadU(kF, squared + kEighths * i + n), limit);
      bits[i] = static_cast<std::uint8_t>(bits[i] | bits_of(near) << n);
    }
  }
}

// Takes the bytes of eight triangles. Bit i of the result is set where triangle i is near `eighth`.
HWY_INLINE std::uint64_t near_of(const std::uint8_t* eighths, std::size_t eighth) {
  std::uint64_t bytes;
  hwy::CopyBytes<8>(eighths, &bytes);
  bytes >>= eighth;
  return (bytes & 0x0101010101010101u) * 0x0102040810204080u >> 56;
}

// The nearest triangle of each point of an eighth, among the triangles near it: its squared
// distance and its number, with the highest bit set where several are equally near. Eight zero
// bytes must follow the bytes in `eighths`.
HWY_INLINE void nearest_of(const PreparedTriangle* const* triangles, const std::uint8_t* eighths,
                           std::size_t count, std::size_t eighth, const EightPoints& points,
                           float* least, std::uint32_t* which) {
  for (std::size_t n = 0; n < kEighths; n += lanes()) {
    const V x = points.x(n), y = points.y(n), z = points.z(n);
    V best = set(kFarAway);
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

void nearest(const PreparedTriangle* const* triangles, const std::uint8_t* eighths,
             std::size_t count, const PointCube& cube, float* least, std::uint32_t* which) {
  for (std::size_t n = 0; n < kEighths; ++n) {
    const std::size_t low[3] = {2 * (n >> 2), 2 * (n >> 1 & 1), 2 * (n & 1)};
    std::array<float, 3> first;
    for (std::size_t d = 0; d < 3; ++d) {
      first[d] = cube.first[d] + cube.step * static_cast<float>(low[d]);
    }
    float near[kEighths];
    std::uint32_t number[kEighths];
    nearest_of(triangles, eighths, count, n, EightPoints(first, cube.step), near, number);
    for (std::size_t pair = 0; pair < kEighths / 2; ++pair) {
      const std::size_t to = (low[0] + (pair >> 1)) * 16 + (low[1] + (pair & 1)) * 4 + low[2];
      hwy::CopyBytes<8>(near + 2 * pair, least + to);
      hwy::CopyBytes<8>(number + 2 * pair, which + to);
    }
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
    const std::uint8_t bits[8] = {static_cast<std::uint8_t>(negative >> n)};
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
HWY_EXPORT(near_eighths);
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

void NearEighths::find(TriangleList triangles, const std::array<int, 3>& low, int edge,
                       const std::array<float, kEighths>& reach) {
  constexpr auto kUnits = static_cast<float>(lattice::kSnapUnits);
  EightCells cells;
  cells.step = static_cast<float>(edge) * kUnits;
  for (std::size_t d = 0; d < 3; ++d) {
    cells.first[d] = static_cast<float>(low[d]) * kUnits + cells.step / 2;
  }
  cells.around = (half_diagonal(edge) + kDistanceErrorVoxels) * kUnits;
  cells.reach = reach;
  find(triangles, cells);
}

void NearEighths::find(TriangleList triangles, const EightCells& cells) {
  constexpr auto kUnits = static_cast<float>(lattice::kSnapUnits);
  const std::size_t count = triangles.size();
  if (squared_.size() < kEighths * count) squared_.resize(2 * kEighths * count);
  bits_.resize(std::max(bits_.size(), count + 8));
  const float most = *std::max_element(cells.reach.begin(), cells.reach.end()) / kUnits;
  const float margin = (claim_margin_voxels(most) + kDistanceErrorVoxels) * kUnits;
  HWY_DYNAMIC_DISPATCH(near_eighths)
  (triangles.data(), count, cells, margin, squared_.data(), bits_.data());
  std::fill_n(bits_.data() + count, 8, std::uint8_t{0});
}

void NearestTriangles::find(TriangleList triangles, const std::array<int, 3>& low,
                            const std::array<float, kEighths>& reach) {
  constexpr auto kUnits = static_cast<float>(lattice::kSnapUnits);
  triangles_ = triangles;
  cube_.step = kUnits;
  for (std::size_t d = 0; d < 3; ++d) {
    cube_.first[d] = static_cast<float>(low[d]) * kUnits + kUnits / 2;
  }
  near_.find(triangles, low, 2, reach);
  HWY_DYNAMIC_DISPATCH(nearest)
  (triangles.data(), near_.bits(), triangles.size(), cube_, least_.data(), which_.data());
}

std::uint32_t NearestTriangles::first_tied(std::size_t point) const {
  const std::size_t at[3] = {point >> 4, point >> 2 & 3, point & 3};
  std::array<float, 3> place;
  for (std::size_t d = 0; d < 3; ++d) {
    place[d] = cube_.first[d] + cube_.step * static_cast<float>(at[d]);
  }
  const std::size_t eighth = at[0] / 2 * 4 + at[1] / 2 * 2 + at[2] / 2;
  return HWY_DYNAMIC_DISPATCH(first_at)(triangles_.data(), near_.bits(), triangles_.size(), eighth,
                                        place, least_[point]);
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
  // A foot so far inside the triangle is nearer than every edge, whatever the rounding.
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
