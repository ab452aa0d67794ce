// The hash by which a .vox file knows the meshes that it was baked from (voxmap_format.md,
// `parts`). It finds accidents, not forgeries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "formats/mesh/mesh.h"

namespace forcelayer::mesh {

struct Hash128 {
  std::uint64_t low = 0, high = 0;
};
Hash128 hash_of(std::span<const std::byte> bytes);  // XXH3

// The hash of a mesh in its pose: 32 hexadecimal digits. The hashes are those of the bytes of
// Mesh::vertices and Mesh::triangles.
std::string content_hash(const Hash128& vertices, const Hash128& triangles,
                         const Affine& world_from_mesh);
std::string content_hash(const Mesh& mesh, const Affine& world_from_mesh);

}  // namespace forcelayer::mesh
