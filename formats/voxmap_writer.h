// Writing .vox files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/result.h"
#include "formats/voxmap_format.h"

namespace forcelayer {

// A finished tree in memory. Its bricks are not packed; all else is in the file's own layout. The
// caller owns the arrays.
struct TreeContent {
  std::span<const std::uint32_t> directory;    // [dims x][dims y][dims z] entries
  std::span<const std::uint32_t> upper_nodes;  // [count][512] entries
  std::span<const std::uint32_t> lower_nodes;  // [count][512] entries
  std::span<const std::uint32_t> bricks;       // [count][16 * bits] words
};

// A finished map. Distances are written where the header has a quantum for them, objects where it
// counts some.
struct VoxmapContent {
  VoxmapHeader header{};              // all but `header.file`, which the writer fills in
  TreeContent values;                 // of two bits
  TreeContent distances;              // of eight
  TreeContent objects;                // of sixteen
  std::string_view object_names;      // each ended by a zero byte
  std::span<const float> compliance;  // Pa; may be empty
  std::string_view provenance;        // JSON, may be empty
};

// Adds a name to VoxmapContent::object_names. What is no UTF-8, and bytes that are zero, become
// U+FFFD.
void add_object_name(std::string_view name, std::string& object_names);

// Writes `content` to `path` atomically; returns the file's size in bytes. The content is trusted
// to be valid (Voxmap::open is the validator). Same content, same bytes.
Result<std::uint64_t> write_voxmap(const std::filesystem::path& path, const VoxmapContent& content);

// The bytes that write_voxmap() would write.
std::vector<std::byte> voxmap_bytes(const VoxmapContent& content);

}  // namespace forcelayer
