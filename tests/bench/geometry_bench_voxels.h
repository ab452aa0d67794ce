// The voxels that a mesh touches, as various programs find them.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/lattice/voxel_overlap.h"
#include "formats/mesh/mesh.h"

namespace forcelayer::bench {

struct VoxelRun {
  double wall_s = 0, cpu_s = 0;
  std::uint64_t peak_rss_bytes = 0;
  std::vector<lattice::VoxelIndex> voxels;  // after the clock was stopped
};

// openvdb::tools::meshToVolume, unsigned, as narrow a band as holds `threshold` (voxels), on all
// threads; kept are the voxels whose center it says to be that near. `mesh` in voxels.
VoxelRun mesh_to_volume_voxels(const mesh::Mesh& mesh, double threshold);

// vtkVoxelModeller over the mesh's box: kept are the voxels that hold the point of a triangle
// nearest to their center. `mesh` in voxels.
VoxelRun vtk_voxels(const mesh::Mesh& mesh);

// Distances from points to the mesh's surface, by VTK's cell locator, in the mesh's unit.
std::vector<double> vtk_distances(const mesh::Mesh& mesh, const std::vector<mesh::Vec3d>& points);

}  // namespace forcelayer::bench
