// Writing .pshell files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "formats/pshell_format.h"
#include "formats/result.h"

namespace forcelayer {

// A finished shell in memory: point_count points in file order (the writer pads the last block),
// their block and super-block spheres. The caller owns the arrays.
struct PshellContent {
  PshellHeader header{};                         // all but `header.file`, which the writer fills in
  std::span<const float> x, y, z;                // [point_count] m, part frame, less center_m
  std::span<const float> nx, ny, nz;             // [point_count] unit, inward
  std::span<const float> weight_m2;              // [point_count]
  std::span<const BoundingSphere> blocks;        // [block_count]
  std::span<const BoundingSphere> super_blocks;  // [super_block_count]
  std::span<const float> cone_cos;               // [point_count] or empty
  std::string_view provenance;                   // JSON, may be empty
  std::span<const DistanceLoss> losses;          // ascending, may be empty
  std::span<const std::uint8_t> two_sided;       // [point_count] 1 without an inside, or empty
};

// Writes `content` to `path` atomically; returns the file's size in bytes. Same content, same
// bytes.
Result<std::uint64_t> write_pshell(const std::filesystem::path& path, const PshellContent& content);

// The bytes that write_pshell() would write.
std::vector<std::byte> pshell_bytes(const PshellContent& content);

}  // namespace forcelayer
