#include "pointshell/certificate/flat_patches.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

#include "pointshell/certificate/convex_polygon.h"
#include "pointshell/part/parallel.h"

namespace forcelayer::certificate {
namespace {

// Tiles in a cube, from which on patches stand for them.
constexpr std::size_t kMany = 256;
constexpr std::size_t kTilesPerTask = 2048;

using Matrix = std::array<std::array<double, 3>, 3>;

// Second moments of points about their mean.
Matrix moments_of(std::span<const part::Vec3> points) {
  part::Vec3 mean;
  for (const part::Vec3& p : points) mean += p;
  mean = (1.0 / static_cast<double>(points.size())) * mean;
  Matrix m{};
  for (const part::Vec3& p : points) {
    const part::Vec3 d = p - mean;
    const double x[] = {d.x, d.y, d.z};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) m[i][j] += x[i] * x[j];
    }
  }
  return m;
}

// Turns axes i and j of `m` so that m[i][j] vanishes, and `axes` with them (Jacobi).
void rotate(Matrix& m, std::array<part::Vec3, 3>& axes, int i, int j) {
  if (m[i][j] == 0) return;
  const double turn = (m[j][j] - m[i][i]) / (2 * m[i][j]);
  const double t = std::copysign(1, turn) / (std::abs(turn) + std::hypot(turn, 1));
  const double c = 1 / std::hypot(t, 1), s = t * c;
  for (int k = 0; k < 3; ++k) {
    const double a = m[k][i], b = m[k][j];
    m[k][i] = c * a - s * b, m[k][j] = s * a + c * b;
  }
  for (int k = 0; k < 3; ++k) {
    const double a = m[i][k], b = m[j][k];
    m[i][k] = c * a - s * b, m[j][k] = s * a + c * b;
  }
  const part::Vec3 a = axes[i], b = axes[j];
  axes[i] = c * a - s * b, axes[j] = s * a + c * b;
}

// The directions along which points extend, at right angles.
std::array<part::Vec3, 3> axes_of(std::span<const part::Vec3> points) {
  Matrix m = moments_of(points);
  std::array<part::Vec3, 3> axes{part::Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  constexpr int kSweeps = 6;  // each squares what is off the diagonal
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    rotate(m, axes, 0, 1), rotate(m, axes, 0, 2), rotate(m, axes, 1, 2);
  }
  axes[0] = part::normalized(axes[0]);
  axes[1] = part::normalized(axes[1] - part::dot(axes[1], axes[0]) * axes[0]);
  axes[2] = part::cross(axes[0], axes[1]);
  return axes;
}

}  // namespace

void SurfacePieces::add(std::span<const part::Vec3> polygon) {
  corners_.insert(corners_.end(), polygon.begin(), polygon.end());
  ends_.push_back(corners_.size());
}

std::array<SurfacePieces, 2> SurfacePieces::split(const part::Vec3& normal, double offset) const {
  std::array<SurfacePieces, 2> sides;
  ConvexPolygon rest;
  for (std::size_t n = 0; n < size(); ++n) {
    ConvexPolygon own((*this)[n]);
    own.split(normal, offset, rest);
    if (!own.empty()) sides[0].add(own.corners());
    if (!rest.empty()) sides[1].add(rest.corners());
  }
  return sides;
}

double OrientedBox::radius() const {
  return std::sqrt(part::length_squared(half[0]) + part::length_squared(half[1]) +
                   part::length_squared(half[2]));
}

std::array<part::Vec3, 8> OrientedBox::corners() const {
  std::array<part::Vec3, 8> corners;
  for (std::size_t n = 0; n < corners.size(); ++n) {
    const auto sign = [n](int axis) { return (n >> axis & 1) != 0 ? 1.0 : -1.0; };
    corners[n] = middle + sign(0) * half[0] + sign(1) * half[1] + sign(2) * half[2];
  }
  return corners;
}

FlatPatch OrientedBox::patch() const {
  return {{middle - half[0] - half[1], middle + half[0] - half[1], middle + half[0] + half[1],
           middle - half[0] + half[1]},
          part::length(half[2])};
}

OrientedBox box_around(const SurfacePieces& pieces) {
  const std::array<part::Vec3, 3> axes = axes_of(pieces.corners());
  // Relative to a corner, so that little is lost to rounding.
  const part::Vec3 from = pieces.corners().front();
  part::Box along;
  for (const part::Vec3& p : pieces.corners()) {
    const part::Vec3 d = p - from;
    along.grow({part::dot(d, axes[0]), part::dot(d, axes[1]), part::dot(d, axes[2])});
  }
  const part::Vec3 middle = 0.5 * (along.low + along.high), half = 0.5 * (along.high - along.low);
  OrientedBox box{from + middle.x * axes[0] + middle.y * axes[1] + middle.z * axes[2],
                  {half.x * axes[0], half.y * axes[1], half.z * axes[2]}};
  std::sort(box.half.begin(), box.half.end(), [](const part::Vec3& a, const part::Vec3& b) {
    return part::length_squared(a) > part::length_squared(b);
  });
  return box;
}

TileGroups group_tiles(std::span<const part::Piece> tiles, double cube_edge) {
  const auto cube_of = [&](std::size_t n) {
    return part::cube_at(part::centroid(tiles[n]), cube_edge);
  };
  // A cube shares its bucket with few others: where that holds few tiles, so does the cube.
  const std::size_t buckets = std::bit_ceil(tiles.size() + 1);
  std::vector<std::uint32_t> bucket(tiles.size()), in_bucket(buckets);
  part::parallel_for_each_index(tiles.size(), kTilesPerTask, [&](std::size_t n) {
    bucket[n] = static_cast<std::uint32_t>(part::CubeHash()(cube_of(n)) & (buckets - 1));
  });
  for (const std::uint32_t b : bucket) ++in_bucket[b];
  TileGroups groups;
  std::vector<std::pair<part::Cube, std::uint32_t>> placed;
  for (std::uint32_t n = 0; n < tiles.size(); ++n) {
    if (in_bucket[bucket[n]] > kMany) {
      placed.push_back({cube_of(n), n});
    } else {
      groups.sparse.push_back(n);
    }
  }
  std::sort(placed.begin(), placed.end());
  for (std::size_t first = 0; first < placed.size();) {
    std::size_t end = first + 1;
    while (end < placed.size() && placed[end].first == placed[first].first) ++end;
    if (end - first > kMany) {
      SurfacePieces& dense = groups.dense.emplace_back();
      for (std::size_t n = first; n < end; ++n) dense.add(tiles[placed[n].second]);
    } else {
      for (std::size_t n = first; n < end; ++n) groups.sparse.push_back(placed[n].second);
    }
    first = end;
  }
  std::sort(groups.sparse.begin(), groups.sparse.end());
  return groups;
}

}  // namespace forcelayer::certificate
