// A triangle with its edges, directions and lengths worked out, ready for the distance kernels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "voxelize/distance/surface_sides.h"

namespace forcelayer::distance {

// In lattice units, from an origin that lies a whole number of voxels from the world's. Only
// `corner` depends on the origin.
struct PreparedTriangle {
  std::array<float, 3> corner;          // corner 0
  std::array<float, 3> edge_1, edge_2;  // to corners 1 and 2
  std::array<float, 3> edge_3;          // from corner 1 to corner 2
  std::array<float, 3> normal;          // unit, perpendicular to `along` and `across`
  // The plane's two axes, unit vectors: `along` edge 1, and `across` it towards corner 2. In a
  // triangle without area, `along` points along the longest edge.
  std::array<float, 3> along, across;
  // In coordinates (along, across) from corner 0: unit directions and lengths of the edges.
  float length_1;
  std::array<float, 2> direction_2, direction_3;
  float length_2, length_3;
  std::uint32_t source;  // the triangle's number in its object
  std::uint32_t object;  // its object's number in SceneTriangles, from 0 on
  TriangleSide side;     // reversed: `normal` points inside; open where there is no area
};

// An order of triangles that a shift of the whole scene by whole voxels does not change.
inline bool lies_before(const PreparedTriangle& a, const PreparedTriangle& b) {
  if (a.corner != b.corner) return a.corner < b.corner;
  return a.edge_1 != b.edge_1 ? a.edge_1 < b.edge_1 : a.edge_2 < b.edge_2;
}

// Inside tolerance, in lattice units. A point closer than this to an edge counts as outside; the
// edge's distance is then equally near. It exceeds the rounding of the edge tests, which can report
// 'inside' beyond a needle's tip.
inline constexpr float kInsideTolerance = 1.0f / 32;

// Prepares eight triangles at a time, one in each vector lane. A full batch goes to the list at
// once; flush() sends the rest.
class TriangleBatch {
 public:
  explicit TriangleBatch(std::vector<PreparedTriangle>& list) : list_(&list) {}

  // Corners, counted from the origin of PreparedTriangle. Their order matters to the side alone,
  // which is that of the triangle as it is wound.
  void add(const std::array<std::array<double, 3>, 3>& corners, std::uint32_t source,
           std::uint32_t object, TriangleSide side = {}) {
    const auto& [a, b, c] = corners;
    const bool is_turned = is_before(b, a) ^ is_before(c, b) ^ is_before(c, a);
    sides_[count_] = is_turned ? side.turned() : side;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t d = 0; d < 3; ++d) corners_[k][d][count_] = corners[k][d];
    }
    sources_[count_] = source;
    objects_[count_] = object;
    if (++count_ == kSize) flush();
  }
  void flush();

  static constexpr std::size_t kSize = 8;
  // Three vectors of each triangle: [vectors][axes][triangles].
  using Vectors = std::array<std::array<std::array<double, kSize>, 3>, 3>;
  // The members of PreparedTriangle before `source`, in their order: [numbers][triangles].
  static constexpr std::size_t kNumbers = offsetof(PreparedTriangle, source) / sizeof(float);
  using Rows = std::array<std::array<float, kSize>, kNumbers>;

 private:
  static bool is_before(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    if (a[0] != b[0]) return a[0] < b[0];
    return a[1] != b[1] ? a[1] < b[1] : a[2] < b[2];
  }

  std::vector<PreparedTriangle>* list_;
  std::size_t count_ = 0;
  Vectors corners_{};
  std::array<std::uint32_t, kSize> sources_{}, objects_{};
  std::array<TriangleSide, kSize> sides_{};
};

}  // namespace forcelayer::distance
