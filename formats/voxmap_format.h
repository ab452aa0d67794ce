// The .vox file: the static scene as voxels in a fixed-depth 512-tree (paper 4.3), byte by byte.
// The normative text is voxmap_format.md.
//
//   header | section table | directory | upper nodes | lower nodes | bricks | [compliance] | [json]
//
// A directory entry stands for a directory cell of 512^3 voxels, an entry of an upper node for
// 64^3, one of a lower node for 8^3; a brick holds 8^3 voxels. Inside nodes and bricks, entry n =
// x*64 + y*8 + z (z runs fastest).
#pragma once

#include <limits>

#include "formats/file_format.h"

namespace forcelayer {

// Table 1 of the paper, after offsetting (4.2).
enum class VoxelValue : std::uint8_t { kFree = 0, kInterior = 1, kSurface = 2, kProximity = 3 };

enum class Metric : std::uint32_t { kChebyshev = 0, kEuclidean = 1 };

inline constexpr std::uint32_t kBrickEdge = 8;        // voxels
inline constexpr std::uint32_t kLowerNodeEdge = 64;   // voxels
inline constexpr std::uint32_t kUpperNodeEdge = 512;  // voxels: a directory cell
inline constexpr std::uint32_t kNodeEntries = 512;    // of a node, or voxels of a brick
inline constexpr std::uint64_t kMaxDirectoryEntries = std::uint64_t{1} << 28;
inline constexpr std::uint32_t kMaxDirectoryDim = 1u << 21;  // cells; 2^30 voxels fit an int32
inline constexpr std::int64_t kMaxVoxelIndex = std::int64_t{1} << 52;  // doubles hold it exactly

// A tree entry of 32 bits. Bit 31 clear: bits 0-30 are the index of a child in the next level's
// section. Bit 31 set: the whole box has the value of bits 0-7; where that value is free, bits
// 8-30 are its clearance: the Chebyshev distance in voxels from the box to the nearest non-free
// voxel, rounded down (0 = unknown); elsewhere they are zero.
//   A clearance of c promises that every voxel within c-1 steps (per axis) of the box is free.
inline constexpr std::uint32_t kUniformBit = 0x8000'0000u;
inline constexpr std::uint32_t kMaxClearance = (1u << 23) - 1;
constexpr bool is_uniform(std::uint32_t entry) { return (entry & kUniformBit) != 0; }
constexpr std::uint32_t uniform_value(std::uint32_t entry) { return entry & 0xffu; }
constexpr std::uint32_t uniform_clearance(std::uint32_t entry) {
  return (entry >> 8) & kMaxClearance;
}
constexpr std::uint32_t uniform_entry(std::uint32_t value, std::uint32_t clearance = 0) {
  return kUniformBit | (clearance << 8) | value;
}

inline constexpr double kMinVoxelSizeM = 1e-9;
inline constexpr double kMaxVoxelSizeM = 1e6;
inline constexpr std::uint32_t kMaxOffsetLayers = 65535;

enum class VoxmapSection : std::uint32_t {
  kDirectory = 1,   // uint32 entries, dims x*y*z, z fastest
  kUpperNodes = 2,  // 512 uint32 entries each
  kLowerNodes = 3,  // 512 uint32 entries each
  kBricks = 4,      // 512 values of bits_per_voxel each; value n at bit n*bits of the brick
  kCompliance =
      5,  // float32 force (N per contact point) over depth in steps of quantum_m; optional
  kProvenance = 6,  // UTF-8 JSON: content hashes and the options that affect voxels
};

// The sides of the valid box where a region of interest cut the scene. Beyond a side whose bit is
// set nothing is known.
enum CroppedSide : std::uint32_t {
  kCroppedMinX = 1,
  kCroppedMaxX = 2,
  kCroppedMinY = 4,
  kCroppedMaxY = 8,
  kCroppedMinZ = 16,
  kCroppedMaxZ = 32,
};

struct VoxmapHeader {                            // offset
  FileHeader file;                               //   0
  double voxel_size_m;                           //  64  s; voxel of x is floor(x / s) per axis
  std::array<std::int64_t, 3> origin_voxel;      //  72  tight box of non-free voxels: lowest voxel
  std::array<std::uint64_t, 3> dims_voxels;      //  96  and extent (all zero where all is free)
  std::array<std::int64_t, 3> valid_min_voxel;   // 120  inclusive
  std::array<std::int64_t, 3> valid_max_voxel;   // 144  exclusive
  std::uint32_t cropped_sides;                   // 168  CroppedSide bits
  std::uint32_t offset_layers;                   // 172  k
  std::uint32_t metric;                          // 176  Metric
  std::uint32_t bits_per_voxel;                  // 180  2, 4 or 8
  std::array<std::int64_t, 3> directory_origin;  // 184  lowest voxel of entry 0; multiple of 512
  std::array<std::uint32_t, 3> directory_dims;   // 208  directory cells
  std::uint32_t reserved0;                       // 220  zero
  std::uint64_t interior_voxels;                 // 224
  std::uint64_t surface_voxels;                  // 232
  std::uint64_t proximity_voxels;                // 240
  std::uint64_t triangles;                       // 248  of the scene
  double static_deviation_m;                     // 256  e_static of the separation guarantee
  double range_m;                         // 264  4, 8 bits: depth of the stored distances; else 0
  double quantum_m;                       // 272  4, 8 bits: meters per step; else 0
  std::uint32_t zero_code;                // 280  4, 8 bits: code of the zero force; else 0
  std::uint32_t surface_code;             // 284  4, 8 bits: lowest code of value 2
  std::uint32_t proximity_code;           // 288  4, 8 bits: lowest code of value 3
  std::uint32_t free_code;                // 292  4, 8 bits: lowest code of value 0
  std::array<std::uint8_t, 88> reserved;  // 296  zero
};
static_assert(sizeof(VoxmapHeader) == 384);
static_assert(offsetof(VoxmapHeader, origin_voxel) == 72);
static_assert(offsetof(VoxmapHeader, cropped_sides) == 168);
static_assert(offsetof(VoxmapHeader, directory_origin) == 184);
static_assert(offsetof(VoxmapHeader, interior_voxels) == 224);
static_assert(offsetof(VoxmapHeader, static_deviation_m) == 256);
static_assert(offsetof(VoxmapHeader, reserved) == 296);

// The voxels whose value is known, counted from the world voxel `origin`: all but those beyond a
// cropped side, which read as free.
struct KnownBox {
  std::array<std::int64_t, 3> low{}, high{};  // inclusive, exclusive
};
constexpr KnownBox known_box(const VoxmapHeader& header,
                             const std::array<std::int64_t, 3>& origin = {}) {
  KnownBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool cut_low = (header.cropped_sides >> (2 * axis)) & 1u;
    const bool cut_high = (header.cropped_sides >> (2 * axis + 1)) & 1u;
    box.low[axis] = cut_low ? header.valid_min_voxel[axis] - origin[axis]
                            : std::numeric_limits<std::int64_t>::min();
    box.high[axis] = cut_high ? header.valid_max_voxel[axis] - origin[axis]
                              : std::numeric_limits<std::int64_t>::max();
  }
  return box;
}

// Limits of a compliance table: the highest force of a contact point and the steepest slope.
inline constexpr float kMostComplianceN = 1e6f;
inline constexpr double kMostComplianceNPerM = 1e12;

// At 4 and 8 bits: the depth of the force layer, from the zero-force surface to the interior, in
// voxels and to the nearest step.
constexpr double force_layer_voxels(const VoxmapHeader& header) {
  if (header.zero_code <= header.surface_code) return 0;
  return (header.zero_code - header.surface_code) * header.quantum_m / header.voxel_size_m;
}

// Bytes of a brick.
constexpr std::uint32_t brick_bytes(std::uint32_t bits_per_voxel) {
  return kNodeEntries / 8 * bits_per_voxel;
}

// The value of Table 1 that a stored code of this map stands for.
constexpr VoxelValue voxel_value(const VoxmapHeader& header, std::uint32_t code) {
  if (header.bits_per_voxel == 2) return static_cast<VoxelValue>(code & 3);
  if (code >= header.free_code) return VoxelValue::kFree;
  if (code >= header.proximity_code) return VoxelValue::kProximity;
  return code >= header.surface_code ? VoxelValue::kSurface : VoxelValue::kInterior;
}

// The lowest code that stands for free. At 4 and 8 bits all codes above it are free too.
constexpr std::uint32_t lowest_free_code(const VoxmapHeader& header) {
  return header.bits_per_voxel == 2 ? 0 : header.free_code;
}

}  // namespace forcelayer
