// Reading .vox files: read into memory, checked once, then used without checks.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "formats/file/file_bytes.h"
#include "formats/result.h"
#include "formats/voxmap_format.h"

namespace forcelayer {

// The result of one look-up in a tree.
struct VoxelLookup {
  std::uint32_t code = 0;         // the stored value: a VoxelValue, a distance code, an object
  std::uint32_t clearance = 0;    // of the entry's box, in voxels; 0 = unknown (or in a brick)
  std::uint32_t edge_voxels = 1;  // of the uniform box that holds the voxel: 512, 64, 8 or 1
};

// A tree as bare pointers, for hot paths. Trivially copyable; valid while its Voxmap lives.
// Coordinates are voxel indices relative to `directory_origin`.
template <std::uint32_t kBits>
struct TreeView {
  const std::uint32_t* directory = nullptr;    // [dims x][dims y][dims z]
  const std::uint32_t* upper_nodes = nullptr;  // [count][512]
  const std::uint32_t* lower_nodes = nullptr;  // [count][512]
  const std::uint32_t* bricks = nullptr;       // of values [count][32] words, or packed
  std::array<std::int64_t, 3> directory_origin{};
  std::array<std::int32_t, 3> directory_dims{};  // cells of 512 voxels

  // Whether relative voxel (x, y, z) lies in the directory; outside it all is free.
  bool contains(std::int32_t x, std::int32_t y, std::int32_t z) const {
    return x >= 0 && y >= 0 && z >= 0 && (x >> 9) < directory_dims[0] &&
           (y >> 9) < directory_dims[1] && (z >> 9) < directory_dims[2];
  }

  // The entry of the brick of a relative voxel that the directory contains: a stored brick, or
  // uniform, of the brick or of more.
  std::uint32_t entry(std::int32_t x, std::int32_t y, std::int32_t z) const {
    const auto slot = [&](int shift) {
      return static_cast<std::uint32_t>((((x >> shift) & 7) << 6) | (((y >> shift) & 7) << 3) |
                                        ((z >> shift) & 7));
    };
    std::uint32_t found =
        directory[(std::int64_t{x >> 9} * directory_dims[1] + (y >> 9)) * directory_dims[2] +
                  (z >> 9)];
    if (is_uniform(found)) return found;
    found = upper_nodes[std::uint64_t{found} * kNodeEntries + slot(6)];
    if (is_uniform(found)) return found;
    return lower_nodes[std::uint64_t{found} * kNodeEntries + slot(3)];
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
    if (is_uniform(entry)) return uniform(entry, kUpperNodeEdge);
    entry = upper_nodes[std::uint64_t{entry} * kNodeEntries + slot(x, y, z, 6)];
    if (is_uniform(entry)) return uniform(entry, kLowerNodeEdge);
    entry = lower_nodes[std::uint64_t{entry} * kNodeEntries + slot(x, y, z, 3)];
    if (is_uniform(entry)) return uniform(entry, kBrickEdge);
    return {brick_code(entry, slot(x, y, z, 0)), 0, 1};
  }

  // The stored code of voxel n = x*64 + y*8 + z of a brick.
  std::uint32_t brick_code(std::uint32_t brick, std::uint32_t n) const {
    if constexpr (kBits == kDistanceBits) return packed_distance(brick_at(brick), n);
    if constexpr (kBits == kObjectBits) return packed_object(brick_at(brick), n);
    const std::uint32_t bit = n * kBits;
    const std::uint32_t word = bricks[std::uint64_t{brick} * 16 * kBits + (bit >> 5)];
    return (word >> (bit & 31)) & ((1u << kBits) - 1);
  }

  // A stored brick's first byte.
  const std::uint8_t* brick_at(std::uint32_t brick) const {
    return reinterpret_cast<const std::uint8_t*>(bricks) +
           std::uint64_t{brick} * brick_step_bytes(kBits);
  }

  // All codes of a brick below this entry, uniform or a stored brick: for packed ones in a small
  // part of the time of asking for each.
  std::array<std::uint16_t, kNodeEntries> brick_codes(std::uint32_t entry) const {
    std::array<std::uint16_t, kNodeEntries> codes;
    if (is_uniform(entry)) {
      codes.fill(static_cast<std::uint16_t>(uniform(entry, kBrickEdge).code));
    } else if constexpr (kBits == kDistanceBits) {
      BrickCodes bytes;
      unpack_distances(brick_at(entry), bytes);
      std::copy(bytes.begin(), bytes.end(), codes.begin());
    } else if constexpr (kBits == kObjectBits) {
      unpack_objects(brick_at(entry), codes);
    } else {
      for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
        codes[n] = static_cast<std::uint16_t>(brick_code(entry, n));
      }
    }
    return codes;
  }

  static VoxelLookup uniform(std::uint32_t entry, std::uint32_t edge_voxels) {
    if constexpr (kBits == kValueBits) {
      return {uniform_value(entry), uniform_clearance(entry), edge_voxels};
    } else {
      return {uniform_wide_value(entry), 0, edge_voxels};
    }
  }
};

using VoxmapView = TreeView<kValueBits>;       // codes are VoxelValues
using DistanceView = TreeView<kDistanceBits>;  // voxmap_format.md, section 6
using ObjectView = TreeView<kObjectBits>;      // numbers of objects from 1 on, 0 for none

// How many nodes a tree has, and how much its bricks take. Numbers of bricks are below `bricks`: of
// values the number of bricks, of packed ones that of the places where one can begin.
struct TreeCounts {
  std::uint64_t upper_nodes = 0, lower_nodes = 0, bricks = 0, brick_bytes = 0;
};

// How much of a file open() verifies. Structure is always checked: sizes, alignment, reserved bits,
// and every entry's child index or value. With checksums, every byte is looked at.
enum class Verify { kStructure, kStructureAndChecksums };

// A .vox file. Movable; views and spans live as long as it does.
class Voxmap {
 public:
  // Reads and checks `path`. Errors: file codes (1xx) and baked-file codes (4xx) with section and
  // byte or entry.
  static Result<Voxmap> open(const std::filesystem::path& path, Verify verify = Verify::kStructure);

  // The same from a file that has been read. `name` is for errors.
  static Result<Voxmap> from_file(FileBytes file, std::string_view name,
                                  Verify verify = Verify::kStructure);

  // The same from bytes that are someone else's: they must stay, unchanged, and be 64-byte aligned.
  static Result<Voxmap> from_bytes(std::span<const std::byte> bytes, std::string_view name,
                                   Verify verify = Verify::kStructure);

  const VoxmapHeader& header() const { return *header_; }
  const VoxmapView& view() const { return view_; }

  // Distances and objects; null where the map stores none.
  const DistanceView* distances() const { return has_distances(*header_) ? &distances_ : nullptr; }
  const ObjectView* objects() const { return header_->object_count > 0 ? &objects_ : nullptr; }
  // The name of object 1 to object_count; empty for any other number.
  std::string_view object_name(std::uint32_t object) const;
  // The number of the object nearest to the center of world voxel (i, j, k); 0 where none is known.
  // Where the code of its distance is 0 or 255, none was measured, and the number is a hint.
  std::uint32_t nearest_object(std::int64_t i, std::int64_t j, std::int64_t k) const;
  // The least distance from the static mesh that the center of world voxel (i, j, k) can have, by
  // its stored code, m: -infinity for the lowest code, the reach of the codes beyond it.
  double min_distance_m(std::int64_t i, std::int64_t j, std::int64_t k) const;
  // The most that it can be: infinity for the highest code and beyond.
  double max_distance_m(std::int64_t i, std::int64_t j, std::int64_t k) const;

  // The position of a world voxel relative to the directory; nothing outside of it.
  std::optional<std::array<std::int32_t, 3>> in_directory(std::int64_t i, std::int64_t j,
                                                          std::int64_t k) const;

  double voxel_size_m() const { return header_->voxel_size_m; }

  // Value of world voxel (i, j, k), any index: free outside the directory.
  VoxelValue value(std::int64_t i, std::int64_t j, std::int64_t k) const;

  std::uint64_t upper_node_count() const { return value_counts_.upper_nodes; }
  std::uint64_t lower_node_count() const { return value_counts_.lower_nodes; }
  std::uint64_t brick_count() const { return value_counts_.bricks; }
  const TreeCounts& distance_counts() const { return distance_counts_; }
  const TreeCounts& object_counts() const { return object_counts_; }
  // Force of one contact point, N, at depths of 0, 1, 2, ... times distance_quantum_m
  // (voxmap_format.md, section 6). May be empty; else it starts at 0, never decreases, and ends
  // above 0.
  std::span<const float> compliance() const { return compliance_; }
  std::string_view provenance() const { return provenance_; }  // JSON text
  std::span<const std::byte> bytes() const { return bytes_; }  // the whole file

 private:
  Voxmap() = default;
  Status read_trees(std::span<const std::span<const std::byte>> sections, std::string_view name);
  Status read_names(std::span<const std::byte> names, std::string_view name);
  // The code of a distance; the highest outside of the directory. The map stores distances.
  std::uint32_t distance_code(std::int64_t i, std::int64_t j, std::int64_t k) const;

  FileBytes file_;
  std::span<const std::byte> bytes_;
  const VoxmapHeader* header_ = nullptr;
  VoxmapView view_;
  DistanceView distances_;
  ObjectView objects_;
  TreeCounts value_counts_, distance_counts_, object_counts_;
  std::vector<std::string_view> object_names_;  // [object - 1]
  std::span<const float> compliance_;
  std::string_view provenance_;
};

// The steepest slope of the map's compliance table, Pa/m; 0 where it has none.
double steepest_pa_per_m(const Voxmap& map);

}  // namespace forcelayer
