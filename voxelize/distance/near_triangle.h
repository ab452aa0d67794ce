// Triangles as the kernels of voxelize/distance/triangle_distance.h read them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace forcelayer {

// Lattice units from some origin, a whole number of voxels. Only `corner` depends on where that is.
struct NearTriangle {
  std::array<float, 3> corner;          // corner 0
  std::array<float, 3> edge_1, edge_2;  // to corners 1 and 2
  std::array<float, 3> edge_3;          // from corner 1 to corner 2
  std::array<float, 3> normal;          // unit; where there is no area: what is perpendicular to
                                        // `along` and `across`
  // The same in the triangle's plane: coordinates along edge 1 and across it, inwards, from corner
  // 0; where corner 2 lies, and the unit directions and lengths of edges 2 and 3.
  std::array<float, 3> along, across;  // unit
  float length_1;
  std::array<float, 2> direction_2, direction_3;
  float length_2, length_3;
  std::uint32_t source;  // its number in its object
};

// An order in which triangles stay wherever on the lattice they lie.
inline bool lies_before(const NearTriangle& a, const NearTriangle& b) {
  if (a.corner != b.corner) return a.corner < b.corner;
  return a.edge_1 != b.edge_1 ? a.edge_1 < b.edge_1 : a.edge_2 < b.edge_2;
}

// What is less than this inside of a triangle, in lattice units, is taken for outside, where the
// edges are as near: more than the rounding of what that is decided by, which beyond a needle's tip
// passes for inside of all three edges otherwise.
inline constexpr float kInside = 1.0f / 32;

// Some triangles, side by side for vectors; it appends them to a list when it is full, and the last
// when flush() is called.
class TriangleBatch {
 public:
  explicit TriangleBatch(std::vector<NearTriangle>& list) : list_(&list) {}

  // `corners` relative to the origin; their order does not matter.
  void add(const std::array<std::array<double, 3>, 3>& corners, std::uint32_t source) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t d = 0; d < 3; ++d) corners_[k][d][count_] = corners[k][d];
    }
    sources_[count_] = source;
    if (++count_ == kSize) flush();
  }
  void flush();

  static constexpr std::size_t kSize = 8;
  // For three vectors of each triangle: [vectors][axes][triangles].
  using Vectors = std::array<std::array<std::array<double, kSize>, 3>, 3>;
  // What stands before `source`, in the order of the members: [numbers][triangles].
  static constexpr std::size_t kNumbers = offsetof(NearTriangle, source) / sizeof(float);
  using Rows = std::array<std::array<float, kSize>, kNumbers>;

 private:
  std::vector<NearTriangle>* list_;
  std::size_t count_ = 0;
  Vectors corners_{};
  std::array<std::uint32_t, kSize> sources_{};
};

}  // namespace forcelayer
