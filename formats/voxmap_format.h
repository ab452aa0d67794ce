// The .vox file: the static scene as voxels in fixed-depth 512-trees (paper 4.3), byte by byte.
// The normative text is voxmap_format.md.
//
//   header | section table | values | [compliance] | [json] | [distances] | [objects, names]
//
// Values, distances and objects are trees of one shape, each a directory, upper nodes, lower nodes
// and bricks. A directory entry stands for a directory cell of 512^3 voxels, an entry of an upper
// node for 64^3, one of a lower node for 8^3; a brick holds 8^3 voxels. Inside nodes and bricks,
// entry n = x*64 + y*8 + z (z runs fastest).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/bricks/packed_bricks.h"
#include "formats/file_format.h"

namespace forcelayer {

inline constexpr std::uint16_t kVoxmapMajor = 2;

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
// section. Bit 31 set: the whole box has one value. In the tree of values it stands in bits 0-7;
// where it is free, bits 8-30 are the box's clearance: the Chebyshev distance in voxels from the
// box to the nearest non-free voxel, rounded down (0 = unknown); elsewhere they are zero. In the
// trees of distances and objects it stands in bits 0-15, and bits 16-30 are zero.
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
constexpr std::uint32_t uniform_wide_value(std::uint32_t entry) { return entry & 0xffffu; }

inline constexpr double kMinVoxelSizeM = 1e-9;
inline constexpr double kMaxVoxelSizeM = 1e6;
inline constexpr std::uint32_t kMaxOffsetLayers = 65535;

// The trees' element n stands at bit n * bits of a brick.
inline constexpr std::uint32_t kValueBits = 2, kDistanceBits = 8, kObjectBits = 16;
inline constexpr std::uint32_t kMaxDistanceCode = 255;  // "this distance or more"
inline constexpr std::uint32_t kMaxObjects = 65535;     // 0 stands for none
inline constexpr std::uint32_t kMaxObjectNameBytes = 1u << 16;

enum class VoxmapSection : std::uint32_t {
  kDirectory = 1,          // uint32 entries, dims x*y*z, z fastest
  kUpperNodes = 2,         // 512 uint32 entries each
  kLowerNodes = 3,         // 512 uint32 entries each
  kBricks = 4,             // 512 values of two bits each
  kPointForces = 5,        // newtons of a contact point, in files of early programs: refused
  kProvenance = 6,         // UTF-8 JSON: content hashes and the options that affect voxels
  kDistanceDirectory = 7,  // 7 to 10 as 1 to 4, of codes of eight bits; all four, or none
  kDistanceUpperNodes = 8,
  kDistanceLowerNodes = 9,
  kDistanceBricks = 10,   // packed: formats/bricks/packed_bricks.h
  kObjectDirectory = 11,  // 11 to 14 as 1 to 4, of numbers of 16 bits; with 15, or none
  kObjectUpperNodes = 12,
  kObjectLowerNodes = 13,
  kObjectBricks = 14,  // packed
  kObjectNames = 15,   // UTF-8, each name ended by a zero byte
  kCompliance = 16,    // float32 pressure (Pa) over depth; optional
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
  std::uint32_t offset_layers;                   // 172  k; 0: a standoff, or none at all
  std::uint32_t metric;                          // 176  Metric
  std::uint32_t reserved0;                       // 180  zero
  std::array<std::int64_t, 3> directory_origin;  // 184  lowest voxel of entry 0; multiple of 512
  std::array<std::uint32_t, 3> directory_dims;   // 208  directory cells
  std::uint32_t object_count;                    // 220  names; 0 without objects
  std::uint64_t interior_voxels;                 // 224
  std::uint64_t surface_voxels;                  // 232
  std::uint64_t proximity_voxels;                // 240
  std::uint64_t triangles;                       // 248  of the scene
  double static_deviation_m;                     // 256  e_static of the separation guarantee
  double zero_force_m;                    // 264  where the force begins, from the static mesh;
                                          //      Euclidean only, else 0
  double force_depth_m;                   // 272  from there down to the interior; else 0
  double distance_quantum_m;              // 280  a code's step; 0 without distances
  std::int32_t distance_zero_code;        // 288  code of distances from 0 to a step; else 0
  std::uint32_t reserved1;                // 292  zero
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

// Limits of a compliance table: the highest pressure and the steepest slope.
inline constexpr float kMaxCompliancePa = 1e9f;
inline constexpr double kMaxCompliancePaPerM = 1e15;

// Bytes of a brick's elements of so many bits.
constexpr std::uint32_t brick_bytes(std::uint32_t bits) { return kNodeEntries / 8 * bits; }

// Bricks of values have one size, and their number counts them. Those of distances and objects are
// packed, each in bytes of its own number, and a brick's number counts units from the section's
// beginning on. The bytes from one number to the next, and the most that a brick can have: so many
// bytes stand from every brick's beginning on.
constexpr std::uint32_t brick_step_bytes(std::uint32_t bits) {
  return bits == kValueBits ? brick_bytes(bits) : kPackedUnitBytes;
}
constexpr std::uint32_t max_brick_bytes(std::uint32_t bits) {
  return bits == kValueBits      ? brick_bytes(bits)
         : bits == kDistanceBits ? kMaxPackedDistancesBytes
                                 : kMaxPackedObjectsBytes;
}

// Whether a map stores distances, and the depth of its force layer in voxels.
constexpr bool has_distances(const VoxmapHeader& header) { return header.distance_quantum_m > 0; }
constexpr double force_layer_voxels(const VoxmapHeader& header) {
  return header.force_depth_m / header.voxel_size_m;
}

// Where the Euclidean interior ends, from the static mesh, in voxels: of k layers, and at least.
// Half a diagonal of a voxel is less, so all voxels that the mesh passes through are interior.
inline constexpr double kMinInteriorVoxels = 888.0 / 1024;
constexpr double interior_radius_voxels(std::uint32_t layers) {
  return static_cast<double>(layers) - 1 + kMinInteriorVoxels;
}

// Where the Euclidean interior of a map ends, from the static mesh, m.
constexpr double interior_radius_m(const VoxmapHeader& header) {
  return header.zero_force_m - header.force_depth_m;
}

// Whether the force begins at a standoff of its own, where no number of layers places it. Stored
// distances tell then where a point may be, in place of the values (section 7).
constexpr bool has_standoff(const VoxmapHeader& header) {
  return header.offset_layers == 0 &&
         header.metric == static_cast<std::uint32_t>(Metric::kEuclidean);
}

// The layers of value 2 that the force layer takes: one for each voxel of its depth, or part of
// one.
constexpr std::uint32_t force_layers(double force_depth_voxels) {
  std::uint32_t layers = 1;
  while (layers + 1e-9 < force_depth_voxels) ++layers;
  return layers;
}

// No point in a free voxel of Euclidean layers is nearer to the static mesh than this, m; 0 in the
// Chebyshev metric, or beyond a cropped side. Within n + 1 steps of the voxel (n the force layers)
// no center is nearer to the mesh than R, the interior's radius, so the mesh lies outside of the
// balls of radius R around them. These overlap up to n + 1 + sqrt(R^2 - 1/2) voxels from the
// voxel's center along an axis, and the point is half a voxel from it.
inline double free_distance_m(const VoxmapHeader& header) {
  if (header.zero_force_m <= 0) return 0;
  const double s = header.voxel_size_m;
  const double radius = interior_radius_m(header) / s;
  const double layers = force_layers(header.force_depth_m / s);
  return (layers + 0.5 + std::sqrt(std::max(0.0, radius * radius - 0.5))) * s;
}

// How much less than the true distance a code's may be: the writer's error.
inline constexpr double kDistanceErrorVoxels = 0.002;

// The least and the largest distance from the static mesh that a code can stand for, m; infinite
// for the lowest code and the highest.
constexpr double min_distance_m(const VoxmapHeader& header, std::uint32_t code) {
  if (code == 0) return -std::numeric_limits<double>::infinity();
  return (static_cast<double>(code) - header.distance_zero_code) * header.distance_quantum_m;
}
constexpr double max_distance_m(const VoxmapHeader& header, std::uint32_t code) {
  if (code >= kMaxDistanceCode) return std::numeric_limits<double>::infinity();
  return (static_cast<double>(code) + 1 - header.distance_zero_code) * header.distance_quantum_m +
         kDistanceErrorVoxels * header.voxel_size_m;
}

}  // namespace forcelayer
