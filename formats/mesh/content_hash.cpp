#include "formats/mesh/content_hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstdio>

namespace forcelayer::mesh {

Hash128 hash_of(std::span<const std::byte> bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return {hash.low64, hash.high64};
}

std::string content_hash(const Hash128& vertices, const Hash128& triangles,
                         const Affine& world_from_mesh) {
  const Hash128 pieces[] = {vertices, triangles,
                            hash_of(std::as_bytes(std::span(world_from_mesh.linear))),
                            hash_of(std::as_bytes(std::span(world_from_mesh.translation)))};
  const Hash128 all = hash_of(std::as_bytes(std::span(pieces)));
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(all.high),
                static_cast<unsigned long long>(all.low));
  return text;
}

std::string content_hash(const Mesh& mesh, const Affine& world_from_mesh) {
  return content_hash(hash_of(std::as_bytes(std::span(mesh.vertices))),
                      hash_of(std::as_bytes(std::span(mesh.triangles))), world_from_mesh);
}

}  // namespace forcelayer::mesh
