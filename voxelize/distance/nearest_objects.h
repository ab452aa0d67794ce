// The nearest object of each voxel of a node whose distance is stored.
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
inline constexpr float kEquallyNearVoxels = kKernelErrorVoxels / 2;

// Whether a code stands for a measured distance: it is neither the lowest ("or less") nor the
// highest ("or more").
constexpr bool is_measured(std::uint8_t code) {
  return static_cast<std::uint8_t>(code - 1) < kMaxDistanceCode - 1;
}

// The objects of one 64^3 node.
struct NodeObjects {
  std::array<std::uint16_t, 512> of_brick{};  // the one number of all voxels of a brick; 0: none
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

  // Takes in a cell of 4^3 voxels: the arguments of NearestTriangles::find(), and its result. At
  // least one code of the cell must be measured.
  void add(const std::array<int, 3>& low, TriangleList list,
           const std::array<float, kEighths>& reach, const NearestTriangles& nearest);

  // The node's objects. `codes` are as stored: [bricks][voxels], defined in the bricks of `coded`.
  // A voxel without a measured distance gets the lowest number in its brick, or 0 where the brick
  // has none; outside `kept` it gets 0. `origin` is the node's. Valid until the next begin().
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
