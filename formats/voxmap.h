// Reading .vox files: mapped into memory, checked once, then read without checks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "formats/file/mapped_file.h"
#include "formats/result.h"
#include "formats/voxmap_format.h"

namespace forcelayer {

// The result of one look-up in the tree.
struct VoxelLookup {
  std::uint32_t code = 0;       // the stored value: a VoxelValue at two bits, else a distance code
  std::uint32_t clearance = 0;  // of the entry's box, in voxels; 0 = unknown (or in a brick)
  std::uint32_t edge_voxels = 1;  // of the uniform box that holds the voxel: 512, 64, 8 or 1
};

// The tree as bare pointers, for hot paths. Trivially copyable; valid while its Voxmap lives.
// Coordinates are voxel indices relative to `directory_origin`.
struct VoxmapView {
  const std::uint32_t* directory = nullptr;    // [dims x][dims y][dims z]
  const std::uint32_t* upper_nodes = nullptr;  // [count][512]
  const std::uint32_t* lower_nodes = nullptr;  // [count][512]
  const std::uint32_t* bricks = nullptr;       // [count][16 * bits_per_voxel] words
  std::array<std::int64_t, 3> directory_origin{};
  std::array<std::int32_t, 3> directory_dims{};  // cells of 512 voxels
  std::uint32_t bits_per_voxel = 2;

  // Whether relative voxel (x, y, z) lies in the directory; outside it all is free.
  bool contains(std::int32_t x, std::int32_t y, std::int32_t z) const {
    return x >= 0 && y >= 0 && z >= 0 && (x >> 9) < directory_dims[0] &&
           (y >> 9) < directory_dims[1] && (z >> 9) < directory_dims[2];
  }

  // Look-up of a relative voxel that the directory contains: the three steps of paper 4.3.
  VoxelLookup lookup(std::int32_t x, std::int32_t y, std::int32_t z) const {
    const auto slot = [](std::int32_t i, std::int32_t j, std::int32_t k, int shift) {
      return static_cast<std::uint32_t>((((i >> shift) & 7) << 6) | (((j >> shift) & 7) << 3) |
                                        ((k >> shift) & 7));
    };
    std::uint32_t entry =
        directory[(std::int64_t{x >> 9} * directory_dims[1] + (y >> 9)) * directory_dims[2] +
                  (z >> 9)];
    if (is_uniform(entry)) return {uniform_value(entry), uniform_clearance(entry), kUpperNodeEdge};
    entry = upper_nodes[std::uint64_t{entry} * kNodeEntries + slot(x, y, z, 6)];
    if (is_uniform(entry)) return {uniform_value(entry), uniform_clearance(entry), kLowerNodeEdge};
    entry = lower_nodes[std::uint64_t{entry} * kNodeEntries + slot(x, y, z, 3)];
    if (is_uniform(entry)) return {uniform_value(entry), uniform_clearance(entry), kBrickEdge};
    const std::uint32_t bit = slot(x, y, z, 0) * bits_per_voxel;
    const std::uint32_t word = bricks[std::uint64_t{entry} * 16 * bits_per_voxel + (bit >> 5)];
    return {(word >> (bit & 31)) & ((1u << bits_per_voxel) - 1), 0, 1};
  }
};

// How much of a file open() verifies. Structure is always checked: sizes, alignment, reserved bits,
// and every entry's child index or value. With checksums, every byte of the file is read once, in
// small pieces, so that the process's memory does not grow.
enum class Verify { kStructure, kStructureAndChecksums };

// A mapped .vox file. Movable; views and spans live as long as it does.
class Voxmap {
 public:
  // Maps and checks `path`. Errors: file codes (1xx) and baked-file codes (4xx) with section and
  // byte or entry.
  static Result<Voxmap> open(const std::filesystem::path& path, Verify verify = Verify::kStructure);

  // The same from a file that is kept open. `name` is for errors.
  static Result<Voxmap> from_file(MappedFile file, std::string_view name,
                                  Verify verify = Verify::kStructure);

  // The same from bytes in memory, which must stay and be 64-byte aligned.
  static Result<Voxmap> from_bytes(std::span<const std::byte> bytes, std::string_view name,
                                   Verify verify = Verify::kStructure);

  const VoxmapHeader& header() const { return *header_; }
  const VoxmapView& view() const { return view_; }
  double voxel_size_m() const { return header_->voxel_size_m; }

  // Value of world voxel (i, j, k), any index: free outside the directory.
  VoxelValue value(std::int64_t i, std::int64_t j, std::int64_t k) const;

  std::uint64_t upper_node_count() const { return upper_node_count_; }
  std::uint64_t lower_node_count() const { return lower_node_count_; }
  std::uint64_t brick_count() const { return brick_count_; }
  // Force of one contact point, N, at depths of 0, 1, 2, ... times quantum_m (voxmap_format.md,
  // section 6). May be empty; else it starts at 0, never decreases, and ends above 0.
  std::span<const float> compliance() const { return compliance_; }
  std::string_view provenance() const { return provenance_; }  // JSON text
  std::span<const std::byte> bytes() const { return bytes_; }  // the whole file
  const FileStamp& stamp() const { return file_.stamp(); }     // never changes for bytes in memory

 private:
  Voxmap() = default;
  static Result<Voxmap> read(std::span<const std::byte> bytes, std::string_view name, Verify verify,
                             const MappedFile* file);
  Status check_tree(std::span<const std::uint32_t> directory,
                    std::span<const std::uint32_t> upper_nodes,
                    std::span<const std::uint32_t> lower_nodes, std::string_view name) const;

  MappedFile file_;
  std::span<const std::byte> bytes_;
  const VoxmapHeader* header_ = nullptr;
  VoxmapView view_;
  std::uint64_t upper_node_count_ = 0, lower_node_count_ = 0, brick_count_ = 0;
  std::span<const float> compliance_;
  std::string_view provenance_;
};

// The steepest slope of the map's compliance table, N/m; 0 where it has none.
double steepest_n_per_m(const Voxmap& map);

}  // namespace forcelayer
