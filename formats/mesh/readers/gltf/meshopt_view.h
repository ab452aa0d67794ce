// Decompressing buffer views of glTF that EXT_meshopt_compression packed, by meshoptimizer's
// library.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace forcelayer::mesh {

// One compressed view, as its extension describes it.
struct MeshoptView {
  std::string_view packed;
  std::string mode;    // "ATTRIBUTES", "TRIANGLES" or "INDICES"
  std::string filter;  // "NONE", "OCTAHEDRAL", "QUATERNION" or "EXPONENTIAL"
  std::uint64_t count = 0;
  std::uint64_t stride = 0;  // bytes
};

// Whether this build has the library.
bool reads_meshopt();

// `count` elements of `stride` bytes; nothing where the stream is damaged, or its mode, filter and
// stride do not go together. The caller bounds count * stride.
std::optional<std::string> decode_meshopt(const MeshoptView& view);

}  // namespace forcelayer::mesh
