// Reading .pshell files: read into memory, checked once, then used without checks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

#include "formats/file/file_bytes.h"
#include "formats/pshell_format.h"
#include "formats/result.h"
#include "formats/surface_distance.h"
#include "formats/voxmap.h"

namespace forcelayer {

// The shell as bare pointers, for hot paths. Valid while its Pshell lives. Sections are 64-byte
// aligned and hold block_count * block_points elements.
struct PshellView {
  std::uint64_t point_count = 0;
  std::uint32_t block_points = 0;
  std::uint32_t super_block_blocks = 0;
  std::uint64_t block_count = 0;
  std::uint64_t super_block_count = 0;
  const float *x = nullptr, *y = nullptr, *z = nullptr;     // m, relative to center_m
  const float *nx = nullptr, *ny = nullptr, *nz = nullptr;  // unit, inward
  const float* weight_m2 = nullptr;
  const BoundingSphere* blocks = nullptr;
  const BoundingSphere* super_blocks = nullptr;
  const float* cone_cos = nullptr;  // nullptr where the file has none
  // 1 where a point has no inside, and its normal may be turned round; nullptr where all have one.
  const std::uint8_t* two_sided = nullptr;
};

// A .pshell file. Movable; views and spans live as long as it does.
class Pshell {
 public:
  static Result<Pshell> open(const std::filesystem::path& path, Verify verify = Verify::kStructure);
  static Result<Pshell> from_file(FileBytes file, std::string_view name,
                                  Verify verify = Verify::kStructure);
  static Result<Pshell> from_bytes(std::span<const std::byte> bytes, std::string_view name,
                                   Verify verify = Verify::kStructure);

  const PshellHeader& header() const { return *header_; }
  const PshellView& view() const { return view_; }
  std::string_view provenance() const { return provenance_; }
  SurfaceDistanceTerms surface_distance_terms() const;  // valid while this lives
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  Pshell() = default;

  FileBytes file_;
  std::span<const std::byte> bytes_;
  const PshellHeader* header_ = nullptr;
  PshellView view_;
  std::string_view provenance_;
  std::span<const DistanceLoss> losses_;
};

}  // namespace forcelayer
