// Scan conversion alone: ours, and what people use today, on triangles in voxel units.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/mesh/mesh.h"

namespace forcelayer::bench {

struct PeerRun {
  double wall_s = 0, cpu_s = 0;
  std::uint64_t voxels = 0;  // active in the result
};

// Ours, from vertices in doubles to the finished mask tree.
PeerRun run_scan_conversion(const mesh::Mesh& mesh, int threads);

// openvdb::tools::meshToVolume with bands of so many voxels, on all threads.
PeerRun run_mesh_to_volume(const mesh::Mesh& mesh, float exterior, float interior);

// The straightforward way, with the same voxels as ours: vertices snapped to the same lattice, the
// test of Schwarz and Seidel (2010) set up per triangle in integers, and every voxel of the
// triangle's box that passes written into a 512-tree mask, on one thread.
PeerRun run_straightforward(const mesh::Mesh& mesh);

}  // namespace forcelayer::bench
