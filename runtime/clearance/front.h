// The fronts of a scene: voxels near the static mesh, whose stored distances say how far the mesh
// is from places that are beyond the reach of what is stored.
//
// Let x be a center whose code says no more than that it is beyond reach, m the nearest point of
// the mesh, and z the point of the segment from x to m that is B voxels from m. Every point of that
// segment has m as its nearest point, so z's distance is B. The voxel w that holds z has its center
// within h = sqrt(3)/2 of z, so its distance lies in [B - h, B + h], and
//   |x - w| + D(w)  <=  |x - w| + |w - m|  <=  L sqrt(1 + h^2 / (A B))  <=  L + h^2/2 (1/A + 1/B)
// with L = |x - m| and A = L - B: the largest sum of the distances of a point within h of z from
// both ends. So the least |x - w| + D(w) of all voxels with distances in that window, less that
// loss, is no more than L.
//
// No such voxel is inside of a solid, where codes may end: x is not, so the segment would go
// through a voxel of the mesh, no more than 2 h from it, and B is more.
//
// Objects can be left out of a scene. Then only voxels that are nearest to others count, and B is
// one voxel, because only close to an object its voxels are nearest to it. Where z is in a pocket
// that the voxels of the mesh close, the one through which the segment enters takes its place: B is
// then up to 2 h. An object that lies within three voxels of one that is left out can be hidden by
// it.
#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "formats/voxmap.h"

namespace forcelayer::clearance {

using BrickIndex = std::array<std::int32_t, 3>;  // of voxels 8 b to 8 b + 7 from the directory on

// Numbers of objects that are left out, as a table.
using LeftOut = std::vector<std::uint8_t>;

// Voxels of one brick in structure of arrays, padded with voxels that are far away. In voxels.
struct Front {
  static constexpr float kFar = 1e9f;
  std::vector<float> x, y, z;         // centers, from the brick's lowest corner
  std::vector<float> least, most;     // distance from the mesh
  std::vector<std::uint16_t> object;  // nearest to each; 0: none named
};

class Fronts {
 public:
  // Which voxels make a front: those for searches from beyond reach, or those next to the mesh.
  enum class Window { kReach, kMesh };

  // The map stores distances and outlives this, as does `left_out`.
  Fronts(const Voxmap& voxmap, const LeftOut& left_out, Window window);

  // The front of a brick; null where it has none. Valid until forget().
  const Front* of(const BrickIndex& brick);
  void forget() { fronts_.clear(); }

  // No voxel of a front is nearer to the mesh than this.
  double least_voxels() const { return low_; }

  // L from the least |x - w| + D(w), in voxels; a center that is `known_voxels` away at least.
  double distance_voxels(double least_sum, double known_voxels) const;

 private:
  const Voxmap& voxmap_;
  const LeftOut& left_out_;
  double quantum_;      // voxels
  bool counts_lowest_;  // voxels of the lowest code make a front, too
  double low_, high_;   // the window
  double from_mesh_;    // B
  std::unordered_map<std::uint64_t, std::unique_ptr<Front>> fronts_;
};

// The lower end of the highest code: what is beyond reach is at least this far away, in voxels.
double reach_voxels(const VoxmapHeader& header);

// A number of its own for every brick.
inline std::uint64_t key_of(const BrickIndex& brick) {
  std::uint64_t key = 0;
  for (const std::int32_t b : brick) key = key << 21 | (static_cast<std::uint32_t>(b) & 0x1fffffu);
  return key;
}

// A brick's entry in a tree: a uniform one, or a stored brick's number. `outside` beyond the
// directory.
template <std::uint32_t kBits>
std::uint32_t entry_of(const TreeView<kBits>& tree, const BrickIndex& b, std::uint32_t outside) {
  if (!tree.contains(b[0] * 8, b[1] * 8, b[2] * 8)) return outside;
  const auto slot = [](const BrickIndex& at, int shift) {
    return static_cast<std::uint32_t>((at[0] >> shift & 7) << 6 | (at[1] >> shift & 7) << 3 |
                                      (at[2] >> shift & 7));
  };
  std::uint32_t entry =
      tree.directory[(std::int64_t{b[0] >> 6} * tree.directory_dims[1] + (b[1] >> 6)) *
                         tree.directory_dims[2] +
                     (b[2] >> 6)];
  if (is_uniform(entry)) return entry;
  entry = tree.upper_nodes[std::uint64_t{entry} * kNodeEntries + slot(b, 3)];
  if (is_uniform(entry)) return entry;
  return tree.lower_nodes[std::uint64_t{entry} * kNodeEntries + slot(b, 0)];
}

// The code of voxel n of a brick with that entry.
template <std::uint32_t kBits>
std::uint32_t code_in(const TreeView<kBits>& tree, std::uint32_t entry, std::uint32_t n) {
  return is_uniform(entry) ? TreeView<kBits>::uniform(entry, kBrickEdge).code
                           : tree.brick_code(entry, n);
}

}  // namespace forcelayer::clearance
