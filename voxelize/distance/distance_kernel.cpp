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
               CubeValues* squared, CubeValues& smallest) {
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
    hn::StoreU(hn::Load(kF, best + n), kF, smallest.data() + n);
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

// Numbers that near_eighths() keeps of a triangle for each eighth: the squared distance of the
// eighth's middle, and the offset there from the foot along x, y and z.
constexpr std::size_t kNumbers = 4;

// Rounding may move the foot of a place at distance d within the triangle by sqrt(2 e d), where e,
// kRounding, is the error of the distance. That turns the offset there by sqrt(2 e / d), which is
// at most e / (kTurn d) + kTurn / 2.
constexpr float kRounding = 1e-4f * static_cast<float>(lattice::kSnapUnits), kTurn = 0.01f;

// A triangle that is nearer by this surely counts as nearer.
constexpr float kNearerBy = 2 * kKernelErrorVoxels * static_cast<float>(lattice::kSnapUnits);

// The offset to points from their feet, their nearest points in a triangle, and its squared length.
// Not rounded as NearestTriangles does.
struct OffsetFromFoot {
  V x, y, z;
  V squared;
};

HWY_INLINE V fused_dot(const std::array<float, 3>& a, V x, V y, V z) {
  return hn::MulAdd(set(a[0]), x, hn::MulAdd(set(a[1]), y, hn::Mul(set(a[2]), z)));
}
HWY_INLINE OffsetFromFoot offset_from_foot(const PreparedTriangle& t, V px, V py, V pz) {
  const V x = hn::Sub(px, set(t.corner[0])), y = hn::Sub(py, set(t.corner[1])),
          z = hn::Sub(pz, set(t.corner[2]));
  const V u = fused_dot(t.along, x, y, z), v = fused_dot(t.across, x, y, z),
          height = fused_dot(t.normal, x, y, z);
  const V x2 = set(t.direction_2[0]), y2 = set(t.direction_2[1]), x3 = set(t.direction_3[0]),
          y3 = set(t.direction_3[1]), u3 = hn::Sub(u, set(t.length_1));
  // In the plane: to the left of each edge, and beyond its ends.
  const V left_2 = hn::MulSub(x2, v, hn::Mul(y2, u)), left_3 = hn::MulSub(x3, v, hn::Mul(y3, u3));
  const auto beyond = [](V along, float length) HWY_ATTR {
    return hn::Sub(along, hn::Min(hn::Max(along, hn::Zero(kF)), set(length)));
  };
  const V off_1 = beyond(u, t.length_1),
          off_2 = beyond(hn::MulAdd(x2, u, hn::Mul(y2, v)), t.length_2),
          off_3 = beyond(hn::MulAdd(x3, u3, hn::Mul(y3, v)), t.length_3);
  const V from_1 = hn::MulAdd(off_1, off_1, hn::Mul(v, v)),
          from_2 = hn::MulAdd(off_2, off_2, hn::Mul(left_2, left_2)),
          from_3 = hn::MulAdd(off_3, off_3, hn::Mul(left_3, left_3));
  const auto second = hn::Lt(from_2, from_1);
  const V of_two = hn::Min(from_1, from_2);
  const auto third = hn::Lt(from_3, of_two);
  const auto outside = hn::Lt(hn::Min(hn::Min(v, hn::Neg(left_2)), left_3), set(kInsideTolerance));
  // From the nearest edge.
  const auto choose = [&](V at_1, V at_2, V at_3) HWY_ATTR {
    return hn::IfThenElse(third, at_3, hn::IfThenElse(second, at_2, at_1));
  };
  const V off = hn::IfThenElseZero(outside, choose(off_1, off_2, off_3)),
          left = hn::IfThenElseZero(outside, choose(v, left_2, left_3)),
          dx = choose(set(1), x2, x3), dy = choose(hn::Zero(kF), y2, y3);
  const V along = hn::MulSub(off, dx, hn::Mul(left, dy)),
          across = hn::MulAdd(off, dy, hn::Mul(left, dx));
  const auto axis = [&](std::size_t k) HWY_ATTR {
    return hn::MulAdd(along, set(t.along[k]),
                      hn::MulAdd(across, set(t.across[k]), hn::Mul(height, set(t.normal[k]))));
  };
  OffsetFromFoot offset;
  offset.x = axis(0);
  offset.y = axis(1);
  offset.z = axis(2);
  offset.squared = hn::MulAdd(height, height, hn::IfThenElseZero(outside, hn::Min(of_two, from_3)));
  return offset;
}

constexpr float kFarAway = 1e30f;

// Calls at(k, value) for the eight corners of a cube, corner k = x*4 + y*2 + z, with the values of
// a linear function that is `middle` at the cube's middle and grows by x, y and z to its faces.
template <class At>
HWY_INLINE void at_corners(V middle, V x, V y, V z, const At& at) {
  const V high = hn::Add(middle, z), low = hn::Sub(middle, z), sum = hn::Add(x, y),
          difference = hn::Sub(x, y);
  at(0, hn::Sub(low, sum));
  at(1, hn::Sub(high, sum));
  at(2, hn::Sub(low, difference));
  at(3, hn::Sub(high, difference));
  at(4, hn::Add(low, difference));
  at(5, hn::Add(high, difference));
  at(6, hn::Add(low, sum));
  at(7, hn::Add(high, sum));
}

// For each triangle the cells that it may be the nearest to, as bits. `at_corner` becomes the
// squared distances of the cells' corners from the triangles nearest to their middles: [cells][8].
// In `scratch` is room for kNumbers numbers a triangle and eighth.
//
// A triangle is convex: it lies beyond the plane through the foot of the middle that stands across
// the offset there. So its distance from a place is at least that from the plane, which is linear.
// The distance from the triangle nearest to the middle is a convex function. So where it is less at
// the corners, it is less in all of the cell.
void near_eighths(const PreparedTriangle* const* triangles, std::size_t count,
                  const EightCells& cells, float* scratch, std::uint8_t* bits,
                  std::uint32_t* nearest, float* at_corner) {
  const EightPoints middles(cells.first, cells.step);
  std::fill_n(bits, count, std::uint8_t{0});
  HWY_ALIGN float limits[kEighths];
  for (std::size_t n = 0; n < kEighths; n += lanes()) {
    const V x = middles.x(n), y = middles.y(n), z = middles.z(n);
    V smallest = set(kFarAway);
    auto min_at = hn::Zero(kU);
    for (std::size_t i = 0; i < count; ++i) {
      const OffsetFromFoot offset = offset_from_foot(*triangles[i], x, y, z);
      const auto nearer = hn::RebindMask(kU, hn::Lt(offset.squared, smallest));
      min_at = hn::IfThenElse(nearer, hn::Set(kU, static_cast<std::uint32_t>(i)), min_at);
      smallest = hn::Min(offset.squared, smallest);
      float* out = scratch + kNumbers * kEighths * i + n;
      hn::StoreU(offset.squared, kF, out);
      hn::StoreU(offset.x, kF, out + kEighths);
      hn::StoreU(offset.y, kF, out + 2 * kEighths);
      hn::StoreU(offset.z, kF, out + 3 * kEighths);
    }
    hn::StoreU(min_at, kU, nearest + n);
    const V reach = hn::LoadU(kF, cells.reach.data() + n), around = set(cells.around);
    const V limit = hn::Add(hn::Min(reach, hn::Add(hn::Sqrt(smallest), around)), around);
    hn::Store(hn::IfThenElse(hn::Lt(reach, hn::Zero(kF)), set(-1), hn::Mul(limit, limit)), kF,
              limits + n);
  }
  // The most that a triangle's distance may be at a corner.
  HWY_ALIGN float largest[8][kEighths];
  const EightPoints corners({-cells.span, -cells.span, -cells.span}, 2 * cells.span);
  for (std::size_t e = 0; e < kEighths; ++e) {
    const PreparedTriangle& t = *triangles[nearest[e]];
    const EightPoints places({cells.first[0] - cells.span + ((e & 4) != 0 ? cells.step : 0),
                              cells.first[1] - cells.span + ((e & 2) != 0 ? cells.step : 0),
                              cells.first[2] - cells.span + ((e & 1) != 0 ? cells.step : 0)},
                             2 * cells.span);
    HWY_ALIGN float roots[8];
    for (std::size_t n = 0; n < 8; n += lanes()) {
      const V d = squared_distance(t, from_triangle(t, places.x(n), places.y(n), places.z(n)));
      hn::StoreU(d, kF, at_corner + 8 * e + n);
      hn::Store(hn::Add(hn::Sqrt(d), set(kNearerBy)), kF, roots + n);
    }
    for (std::size_t k = 0; k < 8; ++k) largest[k][e] = roots[k];
  }
  for (std::size_t n = 0; n < kEighths; n += lanes()) {
    const V limit = hn::Load(kF, limits + n),
            reach = hn::Add(hn::LoadU(kF, cells.reach.data() + n), set(kNearerBy));
    const V turned = set(kTurn / 2 * cells.around),
            turned_near = set(kRounding / kTurn * cells.around);
    for (std::size_t i = 0; i < count; ++i) {
      const float* in = scratch + kNumbers * kEighths * i + n;
      const V squared = hn::LoadU(kF, in);
      auto near = hn::Le(squared, limit);
      if (hn::AllFalse(kF, near)) continue;
      const V inverse = hn::Div(set(1), hn::Max(hn::Sqrt(squared), set(1)));
      const V fraction = hn::Mul(inverse, set(cells.span));
      const V by_x = hn::Mul(hn::LoadU(kF, in + kEighths), fraction),
              by_y = hn::Mul(hn::LoadU(kF, in + 2 * kEighths), fraction),
              by_z = hn::Mul(hn::LoadU(kF, in + 3 * kEighths), fraction),
              middle = hn::MulSub(hn::Sub(squared, turned_near), inverse, turned);
      const V lowest =
          hn::Sub(middle, hn::Add(hn::Abs(by_x), hn::Add(hn::Abs(by_y), hn::Abs(by_z))));
      near = hn::And(near, hn::Le(lowest, reach));
      if (hn::AllFalse(kF, near)) continue;
      V gap = set(kFarAway);
      at_corners(middle, by_x, by_y, by_z, [&](std::size_t k, V distance) HWY_ATTR {
        gap = hn::Min(gap, hn::Sub(distance, hn::Load(kF, largest[k] + n)));
      });
      near = hn::And(near, hn::Le(gap, hn::Zero(kF)));
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
// distance and its number, with the highest bit set where several are equally near. Begins with
// triangle `begin`, at the squared distances `smallest`. Eight zero bytes must follow the bytes in
// `eighths`.
HWY_INLINE void nearest_of(const PreparedTriangle* const* triangles, const std::uint8_t* eighths,
                           std::size_t count, std::size_t eighth, const EightPoints& points,
                           std::size_t begin, const float* at_begin, float* smallest,
                           std::uint32_t* which) {
  const auto flag = hn::Set(kU, std::uint32_t{1} << 31);
  for (std::size_t n = 0; n < kEighths; n += lanes()) {
    const V x = points.x(n), y = points.y(n), z = points.z(n);
    V best = hn::LoadU(kF, at_begin + n);
    auto best_at = hn::Set(kU, static_cast<std::uint32_t>(begin));
    for (std::size_t first = 0; first < count; first += 64) {
      std::uint64_t near = 0;
      const std::size_t end = std::min<std::size_t>(count - first, 64);
      for (std::size_t i = 0; i < end; i += 8) near |= near_of(eighths + first + i, eighth) << i;
      if (begin - first < 64) near &= ~(std::uint64_t{1} << (begin - first));
      for (; near != 0; near &= near - 1) {
        const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(near));
        const PreparedTriangle& t = *triangles[i];
        const V d = squared_distance(t, from_triangle(t, x, y, z));
        const auto better = hn::RebindMask(kU, hn::Lt(d, best));
        const auto tied = hn::IfThenElseZero(hn::RebindMask(kU, hn::Eq(d, best)), flag);
        best_at = hn::IfThenElse(better, hn::Set(kU, static_cast<std::uint32_t>(i)),
                                 hn::Or(best_at, tied));
        best = hn::Min(d, best);
      }
    }
    hn::StoreU(best, kF, smallest + n);
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
             std::size_t count, const PointCube& cube, const std::uint32_t* begin,
             const float* at_begin, float* smallest, std::uint32_t* which) {
  for (std::size_t n = 0; n < kEighths; ++n) {
    const std::size_t low[3] = {2 * (n >> 2), 2 * (n >> 1 & 1), 2 * (n & 1)};
    std::array<float, 3> first;
    for (std::size_t d = 0; d < 3; ++d) {
      first[d] = cube.first[d] + cube.step * static_cast<float>(low[d]);
    }
    float near[kEighths];
    std::uint32_t number[kEighths];
    nearest_of(triangles, eighths, count, n, EightPoints(first, cube.step), begin[n],
               at_begin + 8 * n, near, number);
    for (std::size_t pair = 0; pair < kEighths / 2; ++pair) {
      const std::size_t to = (low[0] + (pair >> 1)) * 16 + (low[1] + (pair & 1)) * 4 + low[2];
      hwy::CopyBytes<8>(near + 2 * pair, smallest + to);
      hwy::CopyBytes<8>(number + 2 * pair, which + to);
    }
  }
}

void codes(const CubeValues& squared, std::uint64_t negative, const CodeScale& scale,
           std::uint8_t* out) {
  constexpr hn::RebindToSigned<decltype(kF)> kI{};
  constexpr hn::Rebind<std::uint8_t, decltype(kI)> kBytes{};
  // Greater distances have the code of the nearest end too.
  const V largest =
      set(static_cast<float>(std::max(scale.min_of(kMaxDistanceCode), -scale.min_of(0)) + 1));
  for (std::size_t n = 0; n < kCubePoints; n += lanes()) {
    const V root = hn::Sqrt(hn::LoadU(kF, squared.data() + n));
    const V length =
        hn::Min(hn::Mul(root, set(1.0f / static_cast<float>(lattice::kSnapUnits))), largest);
    const std::uint8_t bits[8] = {static_cast<std::uint8_t>(negative >> n)};
    const V d = hn::IfThenElse(hn::LoadMaskBits(kF, bits), hn::Neg(length), length);
    // Rounded down, and before that less what the arithmetic may be off.
    const V steps =
        hn::Mul(hn::Sub(d, set(kKernelErrorVoxels)), set(static_cast<float>(1 / scale.quantum)));
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

constexpr auto kUnits = static_cast<float>(lattice::kSnapUnits);

}  // namespace

void squared_distances(TriangleList triangles, const PointCube& points, CubeValues* squared,
                       CubeValues& smallest) {
  HWY_DYNAMIC_DISPATCH(distances)(triangles.data(), triangles.size(), points, squared, smallest);
}

void bits_within(const CubeValues* values, std::size_t count, const CubeValues& limits,
                 std::uint64_t* bits) {
  HWY_DYNAMIC_DISPATCH(within)(values, count, limits, bits);
}

void NearEighths::find(TriangleList triangles, const std::array<int, 3>& low, int edge,
                       const std::array<float, kEighths>& reach) {
  constexpr std::size_t kNumbers = 4;  // a triangle and eighth
  EightCells cells;
  cells.step = static_cast<float>(edge) * kUnits;
  for (std::size_t d = 0; d < 3; ++d) {
    cells.first[d] = static_cast<float>(low[d]) * kUnits + cells.step / 2;
  }
  cells.around = (half_diagonal(edge) + kKernelErrorVoxels) * kUnits;
  cells.span = static_cast<float>(edge - 1) / 2 * kUnits;
  cells.reach = reach;
  const std::size_t count = triangles.size(), numbers = kNumbers * kEighths * count;
  if (scratch_.size() < numbers) scratch_.resize(2 * numbers);
  bits_.resize(std::max(bits_.size(), count + 8));
  HWY_DYNAMIC_DISPATCH(near_eighths)
  (triangles.data(), count, cells, scratch_.data(), bits_.data(), nearest_.data(),
   at_corner_.data());
  std::fill_n(bits_.data() + count, 8, std::uint8_t{0});
}

void NearestTriangles::find(TriangleList triangles, const std::array<int, 3>& low,
                            const std::array<float, kEighths>& reach) {
  triangles_ = triangles;
  cube_.step = kUnits;
  for (std::size_t d = 0; d < 3; ++d) {
    cube_.first[d] = static_cast<float>(low[d]) * kUnits + kUnits / 2;
  }
  near_.find(triangles, low, 2, reach);
  HWY_DYNAMIC_DISPATCH(nearest)
  (triangles.data(), near_.bits(), triangles.size(), cube_, near_.nearest(), near_.at_corners(),
   min_.data(), which_.data());
}

std::uint32_t NearestTriangles::first_tied(std::size_t point) const {
  const std::size_t at[3] = {point >> 4, point >> 2 & 3, point & 3};
  std::array<float, 3> place;
  for (std::size_t d = 0; d < 3; ++d) {
    place[d] = cube_.first[d] + cube_.step * static_cast<float>(at[d]);
  }
  const std::size_t eighth = at[0] / 2 * 4 + at[1] / 2 * 2 + at[2] / 2;
  return HWY_DYNAMIC_DISPATCH(first_at)(triangles_.data(), near_.bits(), triangles_.size(), eighth,
                                        place, min_[point]);
}

std::array<double, 3> offset_from(const PreparedTriangle& t, const std::array<double, 3>& point) {
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
  double smallest = 1e300;
  const auto take = [&](const Vec& away) {
    if (dot(away, away) < smallest) smallest = dot(away, away), best = away;
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
