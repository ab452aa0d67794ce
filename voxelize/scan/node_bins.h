// Triangles sorted into the 64^3-voxel nodes that they may touch, so that each node can be drawn by
// one task that nobody else writes to.
#pragma once

#include <cstdint>
#include <vector>

#include "voxelize/scan/snap.h"

namespace forcelayer {

using NodeIndex = std::array<std::int64_t, 3>;  // world voxel index / 64, rounded down

struct NodeBins {
  std::vector<NodeIndex> nodes;          // [n] in ascending order
  std::vector<std::uint64_t> first;      // [n + 1] offsets into `triangles`
  std::vector<std::uint32_t> triangles;  // triangle numbers, ascending within a node
};

// A triangle is listed in every node that it hits or comes nearer to than `reach` voxels (at most
// 64) and, where its box spans few nodes, in some that it misses.
NodeBins bin_triangles(const SnappedObject& object, int reach = 0);

}  // namespace forcelayer
