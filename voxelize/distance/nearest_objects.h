// Which object the voxels of a node are nearest to, of those whose distance is stored.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/lattice/brick_bits.h"
#include "formats/voxmap_format.h"
#include "voxelize/distance/code_scale.h"
#include "voxelize/distance/distance_kernel.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/masks/voxel_box.h"

namespace forcelayer::distance {

inline constexpr std::size_t kBrickVoxels = 512;

// Objects whose distances differ by less than this, in voxels, count as equally near, and the voxel
// gets the lowest of their numbers. It is above the error of the kernels' distances, so that
// surfaces that touch are not speckled, and below the margin of the search's lists.
inline constexpr float kEquallyNearVoxels = kDistanceErrorVoxels / 2;

// Whether a code is a distance that was measured: neither the lowest, "or less", nor the highest,
// "or more".
constexpr bool is_measured(std::uint8_t code) {
  return static_cast<std::uint8_t>(code - 1) < kMostDistanceCode - 1;
}

// The objects of one 64^3 node.
struct NodeObjects {
  std::array<std::uint16_t, 512> of_brick{};  // all of the brick's voxels have it; 0: none
  lattice::BrickMask several;                 // bricks whose voxels have numbers of their own
  std::vector<std::uint16_t> numbers;         // [bricks][voxels]; undefined elsewhere

  const std::uint16_t* brick(unsigned n) const { return numbers.data() + n * kBrickVoxels; }
};

// Chooses the objects of one node after another.
class ObjectChoice {
 public:
  // Begins a node. `numbers` are those of the objects that the triangles name, ascending; they must
  // live until finish().
  void begin(std::span<const std::uint16_t> numbers, const std::vector<PreparedTriangle>& near);

  // A cell of 4^3 voxels: the triangles and the reach of NearestTriangles::find(), and what it
  // found. Some of the codes must be measured.
  void add(const std::array<int, 3>& low, TriangleList list,
           const std::array<float, kEighths>& reach, const NearestTriangles& nearest);

  // The node's objects, of the codes as stored: [bricks][voxels], defined in the bricks of `coded`.
  // A voxel without a measured distance has the lowest number that stands in its brick, or none; it
  // has none outside of `kept`. Valid until the next begin(). `origin` is the node's.
  const NodeObjects& finish(const lattice::BrickMask& coded, const std::uint8_t* codes,
                            const masks::KeptBox& kept, const masks::Coord& origin);

 private:
  // A brick has eight cells: [bricks][x][y][z].
  static constexpr std::size_t kCells = 8;
  static constexpr std::uint32_t kSeveral = UINT32_MAX;

  void choose(const std::array<int, 3>& low, TriangleList list, unsigned several,
              const std::array<float, kEighths>& reach, const NearestTriangles& nearest,
              std::array<std::uint16_t, kCubePoints>& chosen);
  void spread(unsigned n, const std::uint8_t* codes, const masks::KeptBox& kept,
              const masks::Coord& brick);

  std::span<const std::uint16_t> numbers_;
  bool one_object_ = false;                            // in all of the node
  std::array<std::uint32_t, 512 * kCells> of_cell_{};  // a number, kSeveral, or 0 without codes
  std::vector<const PreparedTriangle*> sorted_;        // by object
  NearestTriangles of_one_;
  NodeObjects node_;
};

}  // namespace forcelayer::distance
