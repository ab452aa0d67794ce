// The machine's limits, checked before a bake takes any memory.
#pragma once

#include <span>
#include <string>

#include "formats/result.h"
#include "voxelize/scan/snap.h"

namespace forcelayer::limits {

// The most bytes that this process can have: memory and swap that are free or can be freed, or the
// limit of the process or of its control group where that is less.
double available_bytes();

// Error kBakeTooLarge, with the numbers and a voxel size that might do, where the voxels of the
// largest triangle alone take more than `available` bytes. It catches a stray vertex, which makes
// slivers that are millions of voxels long. A scene that passes may still be too large.
Status fit_memory(const scan::SnappedObject& object, const std::string& name, double voxel_size_m,
                  double available);

struct NamedObject {
  const scan::SnappedObject* object;
  std::string name;
};

// Bytes that a bake takes at least for each node of 64^3 voxels: one that the surface passes
// through, and one that lies within reach of it (the former ones, too).
struct NodeBytes {
  double touched = 0, reached = 0;
};

// Error kBakeTooLarge where the nodes of all objects take more than `available` bytes. `reach`, at
// most 63: the voxels around the surface that have a value or a distance of their own. It counts
// nodes, each once, and stops where they take too much; what it counts is never more than a bake
// makes. A scene of many millions of large triangles may pass and still be too large.
Status fit_nodes(std::span<const NamedObject> objects, int reach, const NodeBytes& bytes,
                 double voxel_size_m, double available);

}  // namespace forcelayer::limits
