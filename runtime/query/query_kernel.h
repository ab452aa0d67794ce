// The vectorised inner loops of the contact query, dispatched at run time to the machine's
// instruction set (Highway: AVX-512, AVX2, SSE4; NEON, which scripts/test_neon.sh runs in an
// emulator). Plain pointers in and out.
#pragma once

#include <array>
#include <cstdint>

namespace forcelayer::query {

struct VoxelPose;

// The map as the kernels read it. Voxels are relative to the directory.
struct KernelMap {
  const std::uint32_t* directory = nullptr;
  const std::uint32_t* upper_nodes = nullptr;
  const std::uint32_t* lower_nodes = nullptr;
  const std::uint32_t* bricks = nullptr;
  std::array<std::int32_t, 3> dims{};       // directory cells of 512^3 voxels
  std::array<std::int32_t, 3> tight_min{};  // box of the non-free voxels
  std::array<std::int32_t, 3> tight_max{};  // exclusive
  std::array<std::int32_t, 3> known_min{};  // box of the known voxels, where sides are cropped
  std::array<std::int32_t, 3> known_max{};  // exclusive
  bool cropped = false;
  float voxel_size_m = 0;
};

// The shell's columns, each of whole blocks.
struct KernelShell {
  const float *x = nullptr, *y = nullptr, *z = nullptr;     // m
  const float *nx = nullptr, *ny = nullptr, *nz = nullptr;  // unit
  std::uint32_t point_count = 0;
};

// Points that are looked up together: a vector of the widest kind. Blocks are whole rows.
inline constexpr std::uint32_t kRowPoints = 16;

// How rows are collected: in one pass or, where threads share them, in two. The first looks all
// points up and counts those to collect; the second puts these in their place. Where the run before
// collected all points, the first does so too, should they be all again.
enum class Pass : std::uint8_t { kWhole, kLookUp, kLookUpAndAppend, kAppend };

// Where collected points go: the columns of CollectedPoints from some element on. Each has room for
// all points of the rows and a vector behind them.
struct PointColumns {
  std::uint32_t* index = nullptr;
  std::uint8_t* value = nullptr;
  std::int32_t *vx = nullptr, *vy = nullptr, *vz = nullptr;
  float *fx = nullptr, *fy = nullptr, *fz = nullptr;
  float *rx = nullptr, *ry = nullptr, *rz = nullptr;
  float *nx = nullptr, *ny = nullptr, *nz = nullptr;
  std::uint32_t count = 0;
  std::array<std::uint32_t, 4> count_of_value{};  // 1, 2, 3
  bool outside_map = false;
  Pass pass = Pass::kWhole;
  std::uint8_t* values = nullptr;  // of the rows' next points, from the first pass to the second
};

// Whether the kernels' 32-bit gathers reach everything in a map of these counts.
bool kernel_reaches(std::uint64_t upper_nodes, std::uint64_t lower_nodes, std::uint64_t bricks);

// Appends the points of `rows` (ascending; row r is points 16 r to 16 r + 15) that lie in values 1,
// 2 and 3 to `out`, bit for bit as ContactQuery::collect_point() does. Pass::kLookUp appends none,
// but adds to `count` how many there are.
void collect_rows(const KernelMap& map, const KernelShell& shell, const VoxelPose& pose,
                  const std::uint32_t* rows, std::uint32_t row_count, PointColumns& out) noexcept;

// Flat cylinders, each of which holds the points of one block, as quadruples. A shell is locally
// flat, so they are much thinner than spheres. Part frame, m.
struct KernelDiscs {
  const float* place = nullptr;  // center x, y, z; radius
  const float* shape = nullptr;  // unit axis x, y, z; half the height
};

// From a disc's extent to a bound that includes rounding: times `scale`, plus `voxels`.
struct DiscMargin {
  float scale = 1;   // voxels per meter, rounded up
  float voxels = 0;  // rounding of places
};

// For discs [begin, end): how far, in voxels, each may move before one of its points can lie in a
// voxel that is not free or not known. At most 0 where one look-up of the disc's center cannot
// tell.
void survey_discs(const KernelMap& map, const VoxelPose& pose, const DiscMargin& margin,
                  const KernelDiscs& discs, std::uint32_t begin, std::uint32_t end,
                  float* slack_voxels) noexcept;

// Name of the instruction set in use, for reports.
const char* kernel_target();

}  // namespace forcelayer::query
