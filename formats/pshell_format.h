// The .pshell file: the moving part as points with inward unit normals (paper 3), byte by byte.
// The normative text is pshell_format.md.
//
//   header | section table | x | y | z | nx | ny | nz | weight | blocks | super-blocks | [cones] |
//   [losses] | [json] | [two-sided points]
//
// Points stand in blocks of `block_points`, blocks in super-blocks of
// `super_block_blocks`. Every point
// section holds block_count * block_points elements; those beyond point_count repeat the last point
// with weight zero and do not count.
#pragma once

#include "formats/file_format.h"

namespace forcelayer {

inline constexpr std::uint16_t kPshellMajor = 2;
inline constexpr std::uint16_t kPshellMinor = 1;  // of a file with points that have no inside

enum class ShellMethod : std::uint32_t { kVoxelCenters = 0, kSurface = 1 };
enum class MassSource : std::uint32_t { kVolume = 0, kArea = 1 };

inline constexpr std::uint32_t kDefaultBlockPoints = 64;
inline constexpr std::uint32_t kDefaultSuperBlockBlocks = 64;
inline constexpr std::uint32_t kBlockPointsMultiple = 16;  // 64 bytes of float32
inline constexpr std::uint32_t kMaxBlockPoints = 4096;
inline constexpr std::uint32_t kMaxSuperBlockBlocks = 4096;
// Single precision then still places a point to a sixteenth of a voxel.
inline constexpr double kMaxRadiusVoxels = 1 << 20;
inline constexpr std::uint64_t kMaxShellPoints = std::uint64_t{1} << 31;
inline constexpr std::size_t kMaxLosses = 256;

enum class PshellSection : std::uint32_t {
  kPositionX = 1,
  kPositionY = 2,
  kPositionZ = 3,  // float32, m, part frame, less `center_m`
  kNormalX = 4,
  kNormalY = 5,
  kNormalZ = 6,       // float32, unit, inward, part frame
  kWeight = 7,        // float32, m^2: the area that a point stands for
  kBlocks = 8,        // BoundingSphere each
  kSuperBlocks = 9,   // BoundingSphere each
  kNormalCones = 10,  // float32 each: cosine of the half-angle; optional
  kLosses = 11,       // DistanceLoss each; optional
  kProvenance = 12,   // UTF-8 JSON; optional
  kTwoSided = 13,     // uint8 each: 1 where a point has no inside; optional, since 2.1
};

struct BoundingSphere {  // holds its points whatever the rounding
  float x, y, z;         // m, part frame, less `center_m`
  float radius;          // m
};
static_assert(sizeof(BoundingSphere) == 16);

// Where every shell point is at least `distance_m` from a scene, every place of the outer surface
// is proven to be at most `loss_m` nearer.
struct DistanceLoss {
  double distance_m;
  double loss_m;  // from 0 to distance_m
};
static_assert(sizeof(DistanceLoss) == 16);

struct PshellHeader {                    // offset
  FileHeader file;                       //   0
  std::uint64_t point_count;             //  64
  std::uint32_t block_points;            //  72  64
  std::uint32_t super_block_blocks;      //  76  blocks in a super-block
  std::uint64_t block_count;             //  80
  std::uint64_t super_block_count;       //  88
  double covering_radius_m;              //  96  rho, proven over the whole surface
  double voxel_size_m;                   // 104  that the shell was made for
  double bounding_radius_m;              // 112  of all points, about center_m
  double part_deviation_m;               // 120  e_part of the separation guarantee
  std::array<double, 3> center_m;        // 128  centroid, part frame; points are relative to it
  double area_m2;                        // 152
  double volume_m3;                      // 160  0 where mass_source is area
  std::array<double, 6> inertia_m2;      // 168  per unit mass about center_m: xx yy zz xy xz yz
  std::uint32_t mass_source;             // 216  MassSource
  std::uint32_t method;                  // 220  ShellMethod
  std::uint64_t triangles;               // 224  of the part's mesh
  double convex_radius_m;                // 232  rho_h, proven together with
  double convex_gap_m;                   // 240  delta
  std::array<std::uint8_t, 8> reserved;  // 248  zero
};
static_assert(sizeof(PshellHeader) == 256);
static_assert(offsetof(PshellHeader, covering_radius_m) == 96);
static_assert(offsetof(PshellHeader, center_m) == 128);
static_assert(offsetof(PshellHeader, inertia_m2) == 168);
static_assert(offsetof(PshellHeader, convex_radius_m) == 232);
static_assert(offsetof(PshellHeader, reserved) == 248);

}  // namespace forcelayer
