#include "pointshell/sample/front_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "pointshell/part/parallel.h"
#include "pointshell/part/pieces.h"

namespace forcelayer::sample {
namespace {

// All in spacings.
constexpr double kCubeEdge = 24;
constexpr double kClosest = 0.78;         // no two points are closer
constexpr double kNeighborReach = 1.3;    // what counts as a neighbor in the hexagon
constexpr double kProjectionReach = 0.5;  // a proposed place this far off the surface is dropped
constexpr double kSeedEdge = 1.0;         // seeds are tried at tiles of this edge
// Cosine between the normals of neighbors in one hexagon: others lie round a corner.
constexpr double kSameSideCos = 0.3;

struct CubeIndex {
  std::int64_t i, j, k;
  friend auto operator<=>(const CubeIndex&, const CubeIndex&) = default;
};

struct FrontPoint {
  part::SurfacePoint place;
  part::Vec3 normal;
};

// A cube and its points: the given ones, and once it is finished those of the front.
struct Cube {
  CubeIndex index;
  std::size_t given;
  std::vector<FrontPoint> points;
};

using CubeMap = std::map<CubeIndex, std::size_t>;  // to the number of the cube

CubeIndex cube_of(const part::Vec3& p, double edge) {
  return {part::floor_to_int(p.x / edge), part::floor_to_int(p.y / edge),
          part::floor_to_int(p.z / edge)};
}

// Every cube that may hold a point of the surface.
std::vector<Cube> cubes_of(const part::Part& part, double edge) {
  std::vector<CubeIndex> indices;
  part::for_each_tile_batch(part, edge, [&](std::span<const part::Piece> tiles) {
    for (const part::Piece& tile : tiles) {
      part::Box box;
      for (const part::Vec3& corner : tile) box.grow(corner);
      const CubeIndex low = cube_of(box.low, edge), high = cube_of(box.high, edge);
      for (std::int64_t i = low.i; i <= high.i; ++i) {
        for (std::int64_t j = low.j; j <= high.j; ++j) {
          for (std::int64_t k = low.k; k <= high.k; ++k) indices.push_back({i, j, k});
        }
      }
    }
    std::sort(indices.begin(), indices.end());
    indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
    return true;
  });
  std::vector<Cube> cubes;
  for (const CubeIndex& index : indices) cubes.push_back({index, 0, {}});
  return cubes;
}

// The points of one cube and of a rim around it, in a dense grid of linked lists. A cell is as wide
// as a neighbor is far.
class LocalGrid {
 public:
  LocalGrid(const part::Vec3& low, double edge, double cell)
      : low_{low.x - cell, low.y - cell, low.z - cell},
        cell_(cell),
        side_(static_cast<int>(std::ceil(edge / cell)) + 2),
        head_(static_cast<std::size_t>(side_) * side_ * side_, -1) {}

  // Ignored where it lies beyond the rim.
  void add(const FrontPoint& point) {
    const std::array<int, 3> cell = cell_of(point.place.position);
    for (const int c : cell) {
      if (c < 0 || c >= side_) return;
    }
    int& head = head_[slot(cell[0], cell[1], cell[2])];
    next_.push_back(head);
    head = static_cast<int>(points_.size());
    points_.push_back(point);
  }

  // Calls visit(number, point) for the points within `reach` of `place`, and some farther ones.
  template <typename Visit>
  void visit_near(const part::Vec3& place, double reach, const Visit& visit) const {
    const auto low = cell_of(place - part::Vec3{reach, reach, reach});
    const auto high = cell_of(place + part::Vec3{reach, reach, reach});
    for (int i = std::max(low[0], 0); i <= std::min(high[0], side_ - 1); ++i) {
      for (int j = std::max(low[1], 0); j <= std::min(high[1], side_ - 1); ++j) {
        for (int k = std::max(low[2], 0); k <= std::min(high[2], side_ - 1); ++k) {
          for (int n = head_[slot(i, j, k)]; n >= 0; n = next_[n]) visit(n, points_[n]);
        }
      }
    }
  }

  bool any_within(const part::Vec3& place, double distance) const {
    bool found = false;
    visit_near(place, distance, [&](int, const FrontPoint& point) {
      found |= part::length_squared(point.place.position - place) < distance * distance;
    });
    return found;
  }

  const std::vector<FrontPoint>& points() const { return points_; }

 private:
  std::array<int, 3> cell_of(const part::Vec3& p) const {
    const part::Vec3 offset = (1 / cell_) * (p - low_);
    const auto clamped = [](double x) {
      return static_cast<int>(part::floor_to_int(std::clamp(x, -1.0, 1e6)));
    };
    return std::array<int, 3>{clamped(offset.x), clamped(offset.y), clamped(offset.z)};
  }
  std::size_t slot(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * side_ + j) * side_ + k;
  }

  part::Vec3 low_;
  double cell_;
  int side_;
  std::vector<int> head_, next_;
  std::vector<FrontPoint> points_;
};

// Grows the front through one cube.
class CubeFront {
 public:
  CubeFront(const part::TriangleTree& tree, double spacing, const CubeIndex& index)
      : tree_(tree),
        spacing_(spacing),
        index_(index),
        low_(kCubeEdge * spacing *
             part::Vec3{static_cast<double>(index.i), static_cast<double>(index.j),
                        static_cast<double>(index.k)}),
        grid_(low_, kCubeEdge * spacing, kNeighborReach * spacing) {}

  // Points of this cube and of those around: the front starts from them.
  void take_from(const Cube& cube) {
    for (const FrontPoint& point : cube.points) grid_.add(point);
  }

  // Appends the points of the front.
  void grow(std::vector<FrontPoint>& points) {
    const std::size_t given = grid_.points().size();
    advance();
    visit_seeds();
    const auto& all = grid_.points();
    points.insert(points.end(), all.begin() + static_cast<std::ptrdiff_t>(given), all.end());
  }

 private:
  // Completes the hexagons of all points that have not been looked at.
  void advance() {
    for (; looked_at_ < grid_.points().size(); ++looked_at_) complete_hexagon(looked_at_);
  }

  void complete_hexagon(std::size_t number) {
    const FrontPoint center = grid_.points()[number];
    const part::Vec3 along_x = part::any_perpendicular(center.normal),
                     along_y = part::cross(center.normal, along_x);
    find_neighbor_angles(number, center, along_x, along_y);
    const auto propose = [&](double angle) {
      const part::Vec3 direction = std::cos(angle) * along_x + std::sin(angle) * along_y;
      try_place(center.place.position + spacing_ * direction, center.place.triangle);
    };
    if (angles_.empty()) {
      angles_.push_back(0);
      propose(0);
    }
    for (std::size_t n = 0; n < angles_.size(); ++n) {
      const double from = angles_[n];
      const double to = n + 1 < angles_.size() ? angles_[n + 1] : angles_[0] + 2 * std::numbers::pi;
      const int steps = static_cast<int>(std::lround((to - from) / (std::numbers::pi / 3)));
      for (int step = 1; step < steps; ++step) propose(from + (to - from) * step / steps);
    }
  }

  void find_neighbor_angles(std::size_t number, const FrontPoint& center, const part::Vec3& along_x,
                            const part::Vec3& along_y) {
    angles_.clear();
    const double reach = kNeighborReach * spacing_;
    grid_.visit_near(center.place.position, reach, [&](int other, const FrontPoint& point) {
      const part::Vec3 offset = point.place.position - center.place.position;
      if (static_cast<std::size_t>(other) == number ||
          part::length_squared(offset) > reach * reach ||
          part::dot(point.normal, center.normal) < kSameSideCos) {
        return;
      }
      angles_.push_back(std::atan2(part::dot(offset, along_y), part::dot(offset, along_x)));
    });
    std::sort(angles_.begin(), angles_.end());
  }

  // Adds the surface point nearest to `target`, unless it is far off, in another cube or too close
  // to a point. The search is short because it is no farther than triangle `known`.
  void try_place(const part::Vec3& target, std::uint32_t known) {
    const part::Piece corners = part::triangle_piece(tree_.part(), known);
    const part::Vec3 foot = part::nearest_on_triangle(target, corners[0], corners[1], corners[2]);
    constexpr double kRoundedUp = 1 + 1e-12;
    const double reach =
        std::min(kRoundedUp * part::length(foot - target), kProjectionReach * spacing_);
    const part::TriangleTree::Nearest nearest = tree_.nearest(target, reach);
    if (!nearest.found || cube_of(nearest.point.position, kCubeEdge * spacing_) != index_ ||
        grid_.any_within(nearest.point.position, kClosest * spacing_)) {
      return;
    }
    const part::Vec3 normal =
        part::normalized(part::doubled_area_normal(tree_.part(), nearest.point.triangle));
    grid_.add({nearest.point, normal});
  }

  // Starts a front on every bare patch, by trying a seed at every tile.
  void visit_seeds() {
    const double half_diagonal = std::sqrt(0.75) * kCubeEdge * spacing_;
    const double half = kCubeEdge * spacing_ / 2;
    std::vector<std::uint32_t> triangles;
    tree_.visit_near(low_ + part::Vec3{half, half, half}, half_diagonal,
                     [&](std::uint32_t t) { triangles.push_back(t); });
    std::sort(triangles.begin(), triangles.end());
    for (const std::uint32_t t : triangles)
      visit_seeds_of(part::triangle_piece(tree_.part(), t), t);
  }

  void visit_seeds_of(const part::Piece& piece, std::uint32_t triangle) {
    part::Box box;
    for (const part::Vec3& corner : piece) box.grow(corner);
    const double edge = kCubeEdge * spacing_;
    if (box.high.x < low_.x || box.low.x >= low_.x + edge || box.high.y < low_.y ||
        box.low.y >= low_.y + edge || box.high.z < low_.z || box.low.z >= low_.z + edge) {
      return;
    }
    if (const auto needle = part::Needle::of(piece, kSeedEdge * spacing_)) {
      const auto [first, last] = needle->slices_near({low_, low_ + part::Vec3{edge, edge, edge}});
      for (std::size_t n = first; n < last; ++n) {
        needle->visit_slice(n, [&](const part::Piece& slice) { visit_seeds_of(slice, triangle); });
      }
      return;
    }
    const part::LongestEdge longest = part::longest_edge(piece);
    if (longest.length_squared > kSeedEdge * kSeedEdge * spacing_ * spacing_) {
      for (const part::Piece& half : part::bisected(piece, longest.from))
        visit_seeds_of(half, triangle);
      return;
    }
    const part::Vec3 middle = part::centroid(piece);
    if (grid_.any_within(middle, kClosest * spacing_)) return;
    try_place(middle, triangle);
    advance();
  }

  const part::TriangleTree& tree_;
  const double spacing_;
  const CubeIndex index_;
  const part::Vec3 low_;
  LocalGrid grid_;
  std::size_t looked_at_ = 0;
  std::vector<double> angles_;
};

void grow_cube(const part::TriangleTree& tree, double spacing, const CubeMap& numbers,
               std::vector<Cube>& cubes, std::size_t number) {
  Cube& cube = cubes[number];
  CubeFront front(tree, spacing, cube.index);
  for (int di = -1; di <= 1; ++di) {
    for (int dj = -1; dj <= 1; ++dj) {
      for (int dk = -1; dk <= 1; ++dk) {
        const auto found = numbers.find({cube.index.i + di, cube.index.j + dj, cube.index.k + dk});
        if (found != numbers.end()) front.take_from(cubes[found->second]);
      }
    }
  }
  front.grow(cube.points);
}

}  // namespace

std::vector<part::SurfacePoint> hexagonal_front(const part::TriangleTree& tree, double spacing,
                                                std::span<const part::SurfacePoint> given) {
  std::vector<Cube> cubes = cubes_of(tree.part(), kCubeEdge * spacing);
  CubeMap numbers;
  std::array<std::vector<std::size_t>, 8> turns;
  for (std::size_t n = 0; n < cubes.size(); ++n) {
    const CubeIndex& index = cubes[n].index;
    numbers[index] = n;
    turns[(index.i & 1) << 2 | (index.j & 1) << 1 | (index.k & 1)].push_back(n);
  }
  for (const part::SurfacePoint& point : given) {
    const auto found = numbers.find(cube_of(point.position, kCubeEdge * spacing));
    if (found == numbers.end()) continue;  // beside its triangle by rounding
    Cube& cube = cubes[found->second];
    cube.points.push_back(
        {point, part::normalized(part::doubled_area_normal(tree.part(), point.triangle))});
    cube.given = cube.points.size();
  }
  for (const std::vector<std::size_t>& turn : turns) {
    part::parallel_for_each_index(
        turn.size(), 1, [&](std::size_t n) { grow_cube(tree, spacing, numbers, cubes, turn[n]); });
  }
  std::vector<part::SurfacePoint> points;
  for (const Cube& cube : cubes) {
    for (std::size_t n = cube.given; n < cube.points.size(); ++n) {
      points.push_back(cube.points[n].place);
    }
  }
  return points;
}

}  // namespace forcelayer::sample
