// The fronts of a scene: voxels at one distance B from the static mesh, give or take half a voxel's
// diagonal. Their stored distances tell how far the mesh is from centers beyond the stored reach.
//
// Let x be a center beyond reach and outside all solids, m the mesh's point nearest to it, and
// L = |x - m|. Let z be the point of the segment from x to m that is B voxels from m, and w the
// center of the voxel that holds z. Each point of the segment has m as its nearest point, so the
// distance of z is B. |w - z| is at most h = sqrt(3)/2, so the distance of w lies in the window
// [B - h, B + h]. With A = L - B,
//   |x - w| + D(w)  <=  |x - w| + |w - m|  <=  L sqrt(1 + h^2 / (A B))  <=  L + h^2/2 (1/A + 1/B)
// The second bound is the largest sum of the distances from x and m that a point within h of z has.
// So the least |x - w| + D(w) of all voxels in the window, less h^2/2 (1/A + 1/B), is at most L.
//
// The voxel of w has a code. Codes may end inside a solid, but w is not there: the segment from x
// to z would pass through a voxel of the mesh, and so come within 2 h of the mesh, but it stays at
// least B away, and B is more than 2 h.
//
// Objects can be left out of a scene. Then a front holds only voxels whose nearest object counts,
// and B is one voxel: only close to an object are its voxels nearest to it. If z lies in a pocket
// that the voxels of the mesh close, the voxel through which the segment enters the pocket takes
// the place of z, and B is up to 2 h. An object within three voxels of one that is left out can be
// hidden by it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "formats/voxmap.h"

namespace forcelayer::clearance {

using BrickIndex = std::array<std::int32_t, 3>;  // of voxels 8 b to 8 b + 7 from the directory on

// Numbers of objects that are left out, as a table.
using LeftOut = std::vector<std::uint8_t>;
// The table with more objects; 0 names none.
LeftOut with_objects(LeftOut left_out, std::span<const std::uint32_t> objects);

// Voxels of one brick in structure of arrays, padded with voxels that are far away. In voxels.
struct Front {
  static constexpr float kFar = 1e9f;
  std::vector<float> x, y, z;            // centers, from the brick's lowest corner
  std::vector<float> smallest, largest;  // distance from the mesh
  std::vector<std::uint16_t> object;     // nearest to each; 0: none named
};

class Fronts {
 public:
  // The distance B of the fronts: just within the stored reach, or one voxel from the mesh.
  enum class Window { kReach, kMesh };

  // The map stores distances and outlives this, as does `left_out`.
  Fronts(const Voxmap& voxmap, const LeftOut& left_out, Window window);

  // The front of a brick; null where it has none. Valid until forget().
  const Front* of(const BrickIndex& brick);
  void forget() { fronts_.clear(); }

  // No voxel of a front is nearer to the mesh than this.
  double min_voxels() const { return low_; }

  // A lower bound of L, voxels, from the least |x - w| + D(w) and from another lower bound of L.
  double distance_voxels(double min_sum, double known_voxels) const;

 private:
  const Voxmap& voxmap_;
  const LeftOut& left_out_;
  double quantum_;      // voxels
  bool counts_lowest_;  // voxels of the lowest code make a front, too
  double low_, high_;   // the window
  double from_mesh_;    // B
  std::unordered_map<std::uint64_t, std::unique_ptr<Front>> fronts_;
};

// The stored reach, voxels: the least distance that the highest code stands for.
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
  return tree.entry(b[0] * 8, b[1] * 8, b[2] * 8);
}

}  // namespace forcelayer::clearance
