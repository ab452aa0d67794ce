#include "voxelize/distance/near_path.h"

#include <algorithm>
#include <bit>

namespace forcelayer::distance {
namespace {

constexpr auto kVoxel = static_cast<double>(lattice::kSnapUnits);

// The bounding box of a triangle, rounded in single precision by less than kBoxRounding.
struct Box {
  explicit Box(const PreparedTriangle& t) {
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = t.corner[d] + std::min({0.0f, t.edge_1[d], t.edge_2[d]});
      high[d] = t.corner[d] + std::max({0.0f, t.edge_1[d], t.edge_2[d]});
    }
  }
  std::array<float, 3> low, high;
};
constexpr double kBoxRounding = 1;

double box_distance(const PreparedTriangle& t, const std::array<double, 3>& point) {
  const Box box(t);
  std::array<double, 3> gap;
  for (std::size_t d = 0; d < 3; ++d) {
    gap[d] = std::max({box.low[d] - point[d], point[d] - box.high[d], 0.0});
  }
  return length_of(gap);
}

}  // namespace

void NearPath::Cell::pick(TriangleList from, const std::array<int, 3>& cell, int edge) {
  constexpr auto kAround = static_cast<float>(NearPath::kNear + kBoxRounding - kVoxel / 2);
  low = cell;
  std::array<float, 3> least, most;
  for (std::size_t d = 0; d < 3; ++d) {
    least[d] = static_cast<float>(cell[d] * kVoxel) - kAround;
    most[d] = static_cast<float>((cell[d] + edge) * kVoxel) + kAround;
  }
  triangles.clear();
  for (const PreparedTriangle* const triangle : from) {
    const Box box(*triangle);
    bool close = true;
    for (std::size_t d = 0; d < 3; ++d) close &= box.high[d] >= least[d] && box.low[d] <= most[d];
    if (close) triangles.push_back(triangle);
  }
}

void NearPath::begin(const std::array<int, 3>& low, TriangleList around) {
  last_ = nullptr;
  ++path_;
  const std::array<int, 3> low_8{low[0] & ~7, low[1] & ~7, low[2] & ~7};
  if (of_8_.low != low_8) {
    of_8_.pick(around, low_8, 8);
    of_4_.low = kNoCell;
  }
  if (of_4_.low == low) return;
  of_4_.pick(of_8_.triangles, low, 4);
  measured_.resize(std::max(measured_.size(), of_4_.triangles.size()));
  block_.fill(-1);
  used_ = 0;
}

void NearPath::SphereList::clear() {
  triangles.clear();
  number.clear();
  for (std::vector<float>* column : {&x, &y, &z, &radius}) column->clear();
}

void NearPath::SphereList::add(const PreparedTriangle* triangle, std::size_t in_cell) {
  const Box box(*triangle);
  std::array<double, 3> half;
  for (std::size_t d = 0; d < 3; ++d) half[d] = 0.5 * (double{box.high[d]} - box.low[d]);
  triangles.push_back(triangle);
  number.push_back(static_cast<std::uint32_t>(in_cell));
  x.push_back(0.5f * (box.low[0] + box.high[0]));
  y.push_back(0.5f * (box.low[1] + box.high[1]));
  z.push_back(0.5f * (box.low[2] + box.high[2]));
  radius.push_back(static_cast<float>(length_of(half) + 2 * kBoxRounding));
}

// Fills the lists of the 2^3 voxels at `low`.
void NearPath::list_block(const std::array<int, 3>& low, std::array<SphereList, kEighths>& lists) {
  for (SphereList& list : lists) list.clear();
  EightCells cells;
  cells.step = static_cast<float>(kVoxel);
  for (std::size_t d = 0; d < 3; ++d) cells.first[d] = static_cast<float>((low[d] + 0.5) * kVoxel);
  // Every place in the voxel, not its center alone.
  cells.around = (half_diagonal(2) + kDistanceErrorVoxels) * static_cast<float>(kVoxel);
  cells.reach.fill(static_cast<float>(2 * kNear));
  near_.find(of_4_.triangles, cells);
  for (std::size_t i = 0; i < of_4_.triangles.size(); ++i) {
    for (unsigned bits = near_.eighths(i); bits != 0; bits &= bits - 1) {
      lists[static_cast<std::size_t>(std::countr_zero(bits))].add(of_4_.triangles[i], i);
    }
  }
}

// The list of the voxel that a place lies in.
const NearPath::SphereList& NearPath::may_be_nearest(const std::array<double, 3>& at) {
  std::array<int, 3> voxel, low;
  for (std::size_t d = 0; d < 3; ++d) {
    voxel[d] = static_cast<int>(std::floor(at[d] / kVoxel)) - of_4_.low[d] + kBeyond;
    low[d] = of_4_.low[d] - kBeyond + (voxel[d] & ~1);
  }
  int& block =
      block_[static_cast<std::size_t>((voxel[0] / 2) * 16 + (voxel[1] / 2) * 4 + voxel[2] / 2)];
  if (block < 0) {
    block = used_++;
    if (blocks_.size() < static_cast<std::size_t>(used_)) blocks_.emplace_back();
    list_block(low, blocks_[static_cast<std::size_t>(block)]);
  }
  return blocks_[static_cast<std::size_t>(block)][static_cast<std::size_t>(
      (voxel[0] & 1) * 4 + (voxel[1] & 1) * 2 + (voxel[2] & 1))];
}

// Marks the spheres that may come within the distance of a place.
void NearPath::mark_spheres(const SphereList& list, const std::array<double, 3>& at,
                            double distance) {
  const std::size_t count = list.triangles.size();
  marked_.resize(std::max(marked_.size(), count));
  const auto x = static_cast<float>(at[0]), y = static_cast<float>(at[1]),
             z = static_cast<float>(at[2]), most = static_cast<float>(distance);
  const float *xs = list.x.data(), *ys = list.y.data(), *zs = list.z.data(),
              *radii = list.radius.data();
  std::uint8_t* marks = marked_.data();
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = xs[i] - x, dy = ys[i] - y, dz = zs[i] - z, within = radii[i] + most;
    marks[i] = dx * dx + dy * dy + dz * dz <= within * within;
  }
}

double NearPath::nearest(const std::array<double, 3>& at, const std::array<double, 3>& center,
                         std::array<double, 3>& away) {
  const SphereList& list = may_be_nearest(at);
  double most = last_ == nullptr ? 2 * kNear : length_of(way_from(*last_, at));
  mark_spheres(list, at, most);
  double least = 1e300;
  for (std::size_t i = 0; i < list.triangles.size(); ++i) {
    if (marked_[i] == 0) continue;
    const PreparedTriangle& triangle = *list.triangles[i];
    const std::array<double, 3> to{list.x[i] - at[0], list.y[i] - at[1], list.z[i] - at[2]};
    if (length_of(to) - list.radius[i] > most) continue;
    Measured& measured = measured_[list.number[i]];
    if (measured.path == path_) {
      const std::array<double, 3> moved{at[0] - measured.at[0], at[1] - measured.at[1],
                                        at[2] - measured.at[2]};
      if (measured.distance - length_of(moved) - kBoxRounding > most) continue;
    }
    const std::array<double, 3> way = way_from(triangle, at);
    const double length = length_of(way);
    measured = {path_, at, length};
    if (length < least) least = length, away = way, last_ = &triangle;
    most = std::min(most, least);
  }
  // So the nearest of all is less than kNear from the center.
  const double from_center = length_of({at[0] - center[0], at[1] - center[1], at[2] - center[2]});
  if (least + from_center + kBoxRounding < kNear) return least;
  least = 1e300;
  for (const PreparedTriangle* const triangle : of_4_.triangles) {
    if (box_distance(*triangle, at) - kBoxRounding > least) continue;
    const std::array<double, 3> way = way_from(*triangle, at);
    const double length = length_of(way);
    if (length < least && length_of(way_from(*triangle, center)) < kNear) {
      least = length;
      away = way;
    }
  }
  return least;
}

}  // namespace forcelayer::distance
