#include "pointshell/sample/restricted_cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pointshell/part/parallel.h"

namespace forcelayer::sample {
RestrictedCells::Cutter::Cutter(std::uint32_t point, std::span<const part::Vec3> positions,
                                std::span<const std::uint32_t> neighbors, double cell_radius)
    : center(positions[point]), radius(cell_radius) {
  // Two points that share a plane compute its normal and offset with opposite signs and the same
  // bits. So no piece goes to both of them, or to neither.
  for (const std::uint32_t other : neighbors.first(std::min(neighbors.size(), kMaxNeighbors))) {
    const part::Vec3& q = positions[other];
    const part::Vec3 normal = q - center;
    const double squared = part::length_squared(normal);
    if (squared > 4 * kReach * kReach * radius * radius || (squared == 0 && other > point))
      continue;
    bisectors[bisector_count++] = {normal, part::dot(normal, 0.5 * (center + q)), squared,
                                   point < other};
  }
}

void RestrictedCells::Cutter::cut() {
  double reach = polygon.farthest_squared(center);
  for (std::size_t n = 0; n < bisector_count && !polygon.empty(); ++n) {
    const Bisector& bisector = bisectors[n];
    if (bisector.distance_squared > 4 * reach) continue;
    if (polygon.clip(bisector.normal, bisector.offset, bisector.keep_in_plane)) {
      reach = polygon.farthest_squared(center);
    }
  }
  if (reach > 3 * kReach * kReach * radius * radius) cut_to_cube();
}

void RestrictedCells::Cutter::cut_to_cube() {
  const double half = kReach * radius;
  const part::Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const part::Vec3& axis : axes) {
    polygon.clip(axis, part::dot(axis, center) + half, true);
    polygon.clip(-axis, half - part::dot(axis, center), true);
  }
}

void RestrictedCells::find_lists(std::span<const part::Vec3> positions) {
  std::vector<std::uint32_t> all(positions.size());
  std::iota(all.begin(), all.end(), 0u);
  find_lists(positions, grid_of(positions, 0), all, 0);
}

// Makes the lists of one chunk. What lies near a cube is gathered once for all of its points.
class RestrictedCells::ListMaker {
 public:
  ListMaker(const part::TriangleTree& tree, const certificate::PointGrid& grid,
            std::span<const part::Vec3> positions, double neighbor_reach, double triangle_reach)
      : tree_(tree),
        grid_(grid),
        positions_(positions),
        neighbor_reach_(neighbor_reach),
        triangle_reach_(triangle_reach) {}

  void make(std::span<const std::uint32_t> chosen, Lists& lists) {
    lists.center.assign(chosen.begin(), chosen.end());
    lists.neighbors_at.resize(chosen.size());
    lists.triangles_at.resize(chosen.size());
    order_by_cube(chosen);
    for (std::size_t n = 0; n < order_.size(); ++n) {
      if (n == 0 || order_[n].cube != order_[n - 1].cube) gather(order_[n].cube);
      list_neighbors(order_[n].at, lists);
      list_triangles(order_[n].at, lists);
    }
  }

 private:
  struct CubeMember {
    part::Cube cube;
    std::size_t at;  // in the chunk
  };
  struct NearPoint {
    std::uint32_t index;
    part::Vec3 position;
  };
  struct NearTriangle {
    std::uint32_t index;
    part::Box box;
  };

  double cube_edge() const { return neighbor_reach_; }

  void order_by_cube(std::span<const std::uint32_t> chosen) {
    order_.clear();
    for (std::size_t at = 0; at < chosen.size(); ++at) {
      order_.push_back({part::cube_at(positions_[chosen[at]], cube_edge()), at});
    }
    std::sort(order_.begin(), order_.end(), [](const CubeMember& a, const CubeMember& b) {
      return a.cube != b.cube ? a.cube < b.cube : a.at < b.at;
    });
  }

  void gather(const part::Cube& cube) {
    const double half = cube_edge() / 2;
    const part::Vec3 middle{(static_cast<double>(cube[0]) + 0.5) * cube_edge(),
                            (static_cast<double>(cube[1]) + 0.5) * cube_edge(),
                            (static_cast<double>(cube[2]) + 0.5) * cube_edge()};
    points_.clear();
    grid_.visit_near(middle, half + neighbor_reach_, [&](std::uint32_t index, const part::Vec3& p) {
      points_.push_back({index, p});
    });
    triangles_.clear();
    tree_.visit_near_box(middle, half + triangle_reach_, [&](std::uint32_t t) {
      triangles_.push_back({t, part::box_of(tree_.part(), {&t, 1})});
    });
  }

  void list_neighbors(std::size_t at, Lists& lists) {
    const std::uint32_t point = lists.center[at];
    const part::Vec3& place = positions_[point];
    near_.clear();
    for (const NearPoint& other : points_) {
      const double squared = part::length_squared(other.position - place);
      if (squared <= neighbor_reach_ * neighbor_reach_ && other.index != point) {
        near_.push_back({squared, other.index});
      }
    }
    std::sort(near_.begin(), near_.end());
    lists.neighbors_at[at].first = static_cast<std::uint32_t>(lists.neighbors.size());
    lists.neighbors_at[at].count = static_cast<std::uint32_t>(near_.size());
    for (const auto& [squared, other] : near_) lists.neighbors.push_back(other);
  }

  void list_triangles(std::size_t at, Lists& lists) {
    const part::Vec3& place = positions_[lists.center[at]];
    const double reach_squared = triangle_reach_ * triangle_reach_;
    lists.triangles_at[at].first = static_cast<std::uint32_t>(lists.triangles.size());
    for (const NearTriangle& triangle : triangles_) {
      if (triangle.box.distance_squared(place) > reach_squared) continue;
      const auto [a, b, c] = part::triangle_piece(tree_.part(), triangle.index);
      const part::Vec3 nearest = part::nearest_on_triangle(place, a, b, c);
      if (part::length_squared(nearest - place) <= reach_squared) {
        lists.triangles.push_back(triangle.index);
      }
    }
    lists.triangles_at[at].count =
        static_cast<std::uint32_t>(lists.triangles.size()) - lists.triangles_at[at].first;
  }

  const part::TriangleTree& tree_;
  const certificate::PointGrid& grid_;
  const std::span<const part::Vec3> positions_;
  const double neighbor_reach_, triangle_reach_;
  std::vector<CubeMember> order_;
  std::vector<NearPoint> points_;                       // near the present cube
  std::vector<NearTriangle> triangles_;                 // near the present cube
  std::vector<std::pair<double, std::uint32_t>> near_;  // squared distance and index
};

certificate::PointGrid RestrictedCells::grid_of(std::span<const part::Vec3> positions,
                                                double slack) const {
  return {positions, neighbor_reach(slack)};
}

void RestrictedCells::find_lists(std::span<const part::Vec3> positions,
                                 const certificate::PointGrid& grid,
                                 std::span<const std::uint32_t> chosen, double slack) {
  const double triangle_reach = kReach * radius_ + slack;
  chunks_.assign((chosen.size() + kChunk - 1) / kChunk, {});
  part::parallel_for_each_index(chunks_.size(), 1, [&](std::size_t chunk) {
    const std::size_t first = chunk * kChunk;
    ListMaker(tree_, grid, positions, neighbor_reach(slack), triangle_reach)
        .make(chosen.subspan(first, std::min(kChunk, chosen.size() - first)), chunks_[chunk]);
  });
}

}  // namespace forcelayer::sample
