// Triangles sorted into the 64^3-voxel nodes that they may touch, so that one task draws each node.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voxelize/scan/snap.h"

namespace forcelayer::scan {

using NodeIndex = std::array<std::int64_t, 3>;  // world voxel index / 64, rounded down

struct NodeBins {
  std::vector<NodeIndex> nodes;              // [n] in ascending order
  std::vector<std::uint64_t> first;          // [n + 1] offsets into `triangles`
  std::vector<std::uint32_t> own_triangles;  // empty where they wait on disk
  std::span<std::uint32_t> triangles;        // triangle numbers, ascending within a node

  NodeBins() = default;
  NodeBins(NodeBins&&) = default;  // the numbers stay where they are
  NodeBins& operator=(NodeBins&&) = default;
};

// Lists a triangle in every node that it hits or comes nearer to than `reach` voxels (at most 64),
// and possibly in others.
NodeBins bin_triangles(const SnappedObject& object, int reach = 0, SpillFile* spill = nullptr);

}  // namespace forcelayer::scan
