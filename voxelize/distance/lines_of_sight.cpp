#include "voxelize/distance/lines_of_sight.h"

// Compiled once for every instruction set that Highway supports, picked at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/distance/lines_of_sight.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include <algorithm>
#include <cstdlib>

#include "voxelize/distance/triangle_coordinates-inl.h"

HWY_BEFORE_NAMESPACE();
namespace forcelayer::distance::HWY_NAMESPACE {
namespace {

// A line this near to a triangle counts as crossing it.
constexpr float kTouching = kKernelErrorVoxels * static_cast<float>(lattice::kSnapUnits);

// As bits, the lines that cross none of the triangles, nor touch one.
//
// Along a line the height over the triangle's plane and the place in the plane are linear. So the
// line touches the plane, if at all, where the height is least, and there it touches the triangle
// if the place in the plane is near it: the flatter the line, the longer it touches the plane.
std::uint32_t free_of(const PreparedTriangle* const* triangles, std::size_t count,
                      const EightLines& lines) {
  std::uint32_t free = 0;
  for (std::size_t n = 0; n < 8; n += lanes()) {
    const V x = hn::Load(kF, lines.to_end[0] + n), y = hn::Load(kF, lines.to_end[1] + n),
            z = hn::Load(kF, lines.to_end[2] + n);
    const V touching = set(kTouching), one = set(1), zero = hn::Zero(kF);
    auto crosses = hn::Lt(one, zero);
    for (std::size_t i = 0; i < count; ++i) {
      const PreparedTriangle& t = *triangles[i];
      const TriangleCoordinates at =
          from_triangle(t, set(lines.from[0]), set(lines.from[1]), set(lines.from[2]));
      const V du = dot(t.along, x, y, z), dv = dot(t.across, x, y, z), dh = dot(t.normal, x, y, z);
      const V h0 = at.height, h1 = hn::Add(h0, dh);
      const auto is_above = hn::Gt(hn::Min(h0, h1), touching);
      const auto is_below = hn::Lt(hn::Max(h0, h1), hn::Neg(touching));
      const auto beside = hn::Or(is_above, is_below);
      if (hn::AllTrue(kF, beside)) continue;
      // Where the line meets the plane, or is nearest to it; how long it may touch the plane.
      const V fall = hn::Max(hn::Abs(dh), set(kTouching / 4));
      const V meets = hn::Min(hn::Max(hn::Div(hn::Abs(h0), fall), zero), one);
      const auto leads_away = hn::Gt(hn::Mul(h0, dh), zero);
      const V fraction = hn::IfThenElse(leads_away, zero, meets);
      const V length = hn::Sqrt(hn::Add(hn::Mul(du, du), hn::Mul(dv, dv)));
      const V touches =
          hn::Add(touching, hn::Mul(length, hn::Min(hn::Div(set(2 * kTouching), fall), one)));
      TriangleCoordinates met;
      met.u = hn::Add(at.u, hn::Mul(fraction, du));
      met.v = hn::Add(at.v, hn::Mul(fraction, dv));
      set_along_edges(t, hn::Sub(met.u, set(t.length_1)), met);
      const auto near = hn::Le(planar_distances(t, met).planar, hn::Mul(touches, touches));
      crosses = hn::Or(crosses, hn::AndNot(beside, near));
      if (hn::AllTrue(kF, crosses)) break;
    }
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(kF, hn::Not(crosses), bits);
    free |= std::uint32_t{bits[0]} << n;
  }
  return free;
}

}  // namespace
}  // namespace forcelayer::distance::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::distance {
namespace {

HWY_EXPORT(free_of);

constexpr auto kVoxel = static_cast<float>(lattice::kSnapUnits);
constexpr float kRounding = 1;  // of a bounding box in single precision, at most, and of kTouching

struct Box {
  explicit Box(const PreparedTriangle& t) {
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = t.corner[d] + std::min({0.0f, t.edge_1[d], t.edge_2[d]});
      high[d] = t.corner[d] + std::max({0.0f, t.edge_1[d], t.edge_2[d]});
    }
  }
  std::array<float, 3> low, high;
};

// The centers of a cell of `edge` voxels along an axis, and `around` voxels around them.
struct Range {
  Range(int low_voxel, int edge, int around)
      : smallest((static_cast<float>(low_voxel - around) + 0.5f) * kVoxel - 2 * kRounding),
        largest((static_cast<float>(low_voxel + edge + around) - 0.5f) * kVoxel + 2 * kRounding) {}
  float smallest, largest;
};

}  // namespace

void LinesOfSight::Cell::pick(TriangleList from, const std::array<int, 3>& cell, int edge) {
  low = cell;
  const Range x(cell[0], edge, kFar), y(cell[1], edge, kFar), z(cell[2], edge, kFar);
  triangles.clear();
  for (const PreparedTriangle* const triangle : from) {
    const Box box(*triangle);
    const bool is_close = box.high[0] >= x.smallest && box.low[0] <= x.largest &&
                          box.high[1] >= y.smallest && box.low[1] <= y.largest &&
                          box.high[2] >= z.smallest && box.low[2] <= z.largest;
    if (is_close) triangles.push_back(triangle);
  }
}

void LinesOfSight::begin(const std::array<int, 3>& low, TriangleList around,
                         const std::array<int, 3>& voxel) {
  voxel_ = voxel;
  is_listed_ = {};
  const std::array<int, 3> low_8{low[0] & ~7, low[1] & ~7, low[2] & ~7};
  if (of_8_.low != low_8) {
    of_8_.pick(around, low_8, 8);
    of_4_.low = kNoCell;
  }
  if (of_4_.low == low) return;
  of_4_.pick(of_8_.triangles, low, 4);
  for (std::vector<float>& column : boxes_) column.resize(of_4_.triangles.size());
  for (std::size_t i = 0; i < of_4_.triangles.size(); ++i) {
    const Box box(*of_4_.triangles[i]);
    for (std::size_t d = 0; d < 3; ++d) boxes_[d][i] = box.low[d], boxes_[3 + d][i] = box.high[d];
  }
}

const LinesOfSight::List& LinesOfSight::within(int voxels) {
  const auto n = static_cast<std::size_t>(voxels - 1);
  List& list = near_[n];
  if (is_listed_[n]) return list;
  is_listed_[n] = true;
  list.clear();
  const std::size_t count = of_4_.triangles.size();
  marked_.resize(std::max(marked_.size(), count));
  const Range x(voxel_[0], 1, voxels), y(voxel_[1], 1, voxels), z(voxel_[2], 1, voxels);
  const float *low_x = boxes_[0].data(), *low_y = boxes_[1].data(), *low_z = boxes_[2].data(),
              *high_x = boxes_[3].data(), *high_y = boxes_[4].data(), *high_z = boxes_[5].data();
  std::uint8_t* const marks = marked_.data();
  for (std::size_t i = 0; i < count; ++i) {  // without branches: vectors hold several
    marks[i] = (high_x[i] >= x.smallest) & (low_x[i] <= x.largest) & (high_y[i] >= y.smallest) &
               (low_y[i] <= y.largest) & (high_z[i] >= z.smallest) & (low_z[i] <= z.largest);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (marks[i] != 0) list.push_back(of_4_.triangles[i]);
  }
  return list;
}

std::uint32_t LinesOfSight::free(std::span<const Offset> offsets) {
  int farthest = 1;
  for (const Offset& offset : offsets) {
    for (const std::int8_t step : offset) farthest = std::max(farthest, std::abs(int{step}));
  }
  return free_lines(within(farthest), voxel_, offsets);
}

std::uint32_t free_lines(TriangleList triangles, const std::array<int, 3>& voxel,
                         std::span<const LinesOfSight::Offset> offsets) {
  EightLines lines;
  for (std::size_t d = 0; d < 3; ++d)
    lines.from[d] = (static_cast<float>(voxel[d]) + 0.5f) * kVoxel;
  std::uint32_t free = 0;
  for (std::size_t first = 0; first < offsets.size(); first += 8) {
    const std::size_t count = std::min<std::size_t>(8, offsets.size() - first);
    for (std::size_t n = 0; n < 8; ++n) {
      const LinesOfSight::Offset& offset = offsets[first + std::min(n, count - 1)];
      for (std::size_t d = 0; d < 3; ++d)
        lines.to_end[d][n] = static_cast<float>(offset[d]) * kVoxel;
    }
    const std::uint32_t bits =
        HWY_DYNAMIC_DISPATCH(free_of)(triangles.data(), triangles.size(), lines);
    free |= (bits & ((1u << count) - 1)) << first;
  }
  return free;
}

}  // namespace forcelayer::distance
#endif
