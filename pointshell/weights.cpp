#include "pointshell/weights.h"

#include <atomic>
#include <cstdint>

#include "pointshell/parallel.h"
#include "pointshell/pieces.h"
#include "pointshell/point_grid.h"

namespace forcelayer {
namespace {

constexpr double kTileEdge = 1.0;  // radii

// A convex polygon in space: a triangle cut by some planes.
using Polygon = std::vector<Vec3>;

double area_of(const Polygon& polygon) {
  Vec3 doubled;
  for (std::size_t n = 2; n < polygon.size(); ++n) {
    doubled += cross(polygon[n - 1] - polygon[0], polygon[n] - polygon[0]);
  }
  return length(doubled) / 2;
}

// Keeps what is nearer to `p` than to `q` of `polygon`.
void clip_to_nearer(const Vec3& p, const Vec3& q, Polygon& polygon, Polygon& scratch) {
  const Vec3 normal = q - p, middle = 0.5 * (p + q);
  scratch.clear();
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    const Vec3 &a = polygon[n], &b = polygon[(n + 1) % polygon.size()];
    const double at_a = dot(a - middle, normal), at_b = dot(b - middle, normal);
    if (at_a <= 0) scratch.push_back(a);
    if ((at_a < 0 && at_b > 0) || (at_a > 0 && at_b < 0)) {
      scratch.push_back(a + (at_a / (at_a - at_b)) * (b - a));
    }
  }
  polygon.swap(scratch);
}

struct Candidate {
  std::uint32_t index;
  Vec3 position;
};

// Shares out the area of single tiles; one for every task, as it keeps scratch memory. Sums are
// kept in integers, which do not depend on the order of tasks.
class TileSharer {
 public:
  TileSharer(const PointGrid& grid, double radius, double units_per_area,
             std::vector<std::atomic<std::uint64_t>>& units)
      : grid_(grid), radius_(radius), units_per_area_(units_per_area), units_(units) {}

  void share(const Piece& tile) {
    find_candidates(tile);
    if (candidates_.size() == 1) return give(candidates_.front().index, area(tile));
    for (std::size_t n = 0; n < candidates_.size(); ++n) {
      polygon_.assign(tile.begin(), tile.end());
      for (std::size_t m = 0; m < candidates_.size() && polygon_.size() > 2; ++m) {
        if (m == n) continue;
        clip_to_nearer(candidates_[n].position, candidates_[m].position, polygon_, scratch_);
      }
      if (polygon_.size() > 2) give(candidates_[n].index, area_of(polygon_));
    }
  }

 private:
  // The points that can be nearest to some place of the tile: those not farther from its middle
  // than the nearest one is, by more than the tile's diameter. Equal positions are one candidate.
  void find_candidates(const Piece& tile) {
    const Vec3 middle = centroid(tile);
    const double reach = reach_from(middle, tile);
    const double nearest = grid_.nearest_distance(middle, radius_ + reach);
    const double limit = nearest + 2 * reach;
    candidates_.clear();
    grid_.visit_near(middle, limit, [&](std::uint32_t index, const Vec3& position) {
      if (length_squared(position - middle) > limit * limit) return;
      for (const Candidate& other : candidates_) {
        if (other.position == position) return;
      }
      candidates_.push_back({index, position});
    });
  }

  void give(std::uint32_t index, double area) {
    units_[index] += static_cast<std::uint64_t>(area * units_per_area_);
  }

  const PointGrid& grid_;
  const double radius_, units_per_area_;
  std::vector<std::atomic<std::uint64_t>>& units_;
  std::vector<Candidate> candidates_;
  Polygon polygon_, scratch_;
};

}  // namespace

std::vector<double> area_weights(const Part& part, std::span<const Vec3> points, double radius) {
  double total_area = 0;
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    total_area += area(triangle_piece(part, t));
  }
  const double units_per_area = 0x1p60 / total_area;
  std::vector<std::atomic<std::uint64_t>> units(points.size());
  const PointGrid grid(points, (1 + kTileEdge) * radius);
  for_each_tile_batch(part, kTileEdge * radius, [&](std::span<const Piece> tiles) {
    parallel_ranges(tiles.size(), 256, [&](std::size_t begin, std::size_t end) {
      TileSharer sharer(grid, radius, units_per_area, units);
      for (std::size_t n = begin; n < end; ++n) sharer.share(tiles[n]);
    });
  });
  std::vector<double> areas(points.size());
  for (std::size_t n = 0; n < areas.size(); ++n) {
    areas[n] = static_cast<double>(units[n].load()) / units_per_area;
  }
  return areas;
}

}  // namespace forcelayer
