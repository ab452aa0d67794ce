// Meshes on the lattice of the scene: vertices rounded to 2^-10 voxel.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/result.h"
#include "voxelize/masks/voxel_box.h"
#include "voxelize/scan/spill_file.h"

namespace forcelayer::scan {

// One object with its vertices on the lattice, in units of 2^-10 voxel from the world's origin.
struct SnappedObject {
  std::vector<lattice::LatticePoint> own_vertices;  // empty where they wait on disk
  std::span<const lattice::LatticePoint> vertices;  // [vertices of the mesh]
  std::span<const mesh::Triangle> triangles;        // of the mesh or on disk, not owned
  masks::VoxelBox box;                              // of the voxels that hold corners of triangles
  double snap_error_m = 0;  // bound on how far a point of the surface was moved

  SnappedObject() = default;
  SnappedObject(SnappedObject&&) = default;  // the vertices stay where they are
  SnappedObject& operator=(SnappedObject&&) = default;

  std::size_t bytes() const { return vertices.size_bytes() + triangles.size_bytes(); }

  lattice::LatticeTriangle triangle(std::size_t index) const {
    const mesh::Triangle& corners = triangles[index];
    return {vertices[corners[0]], vertices[corners[1]], vertices[corners[2]]};
  }
};

// Vertices beyond 2^52 voxels from the origin are an error (kSceneInvalid) with the mesh's `name`.
// With a spill file the object lies there, and does not need the mesh.
Result<SnappedObject> snap_object(const mesh::Mesh& mesh, const mesh::Affine& world_from_mesh,
                                  double voxel_size_m, const std::string& name,
                                  SpillFile* spill = nullptr);

// Triangles that have no area on the lattice.
std::uint64_t degenerate_triangles(const SnappedObject& object);

}  // namespace forcelayer::scan
