// The versions of what goes into a cache: part of every entry's key, so that nothing is taken for
// the output of another algorithm. tests/golden/voxelize_cache_versions.cpp fails where the output
// has changed and its version has not.
#pragma once

#include <cstdint>

namespace forcelayer {

// To be raised whenever a reader gives another mesh for the same file, or the record changes.
inline constexpr std::uint32_t kAssemblyCacheVersion = 1;

// ... mesh_facts() gives other facts for the same mesh, or the record changes.
inline constexpr std::uint32_t kFactsCacheVersion = 1;

// ... snap, scan conversion, flood or the search for cavities give something else for the same
// input, or the record changes.
inline constexpr std::uint32_t kPartCacheVersion = 1;

// ... near_voxels() finds others: parts of Euclidean layers, beside the version of all parts.
// 2: needles are not near beyond their tips.
inline constexpr std::uint32_t kNearVoxelsCacheVersion = 2;

// ... offset, bricks or clearance come out differently for the same voxels.
inline constexpr std::uint64_t kNodeCacheVersion = 1;

}  // namespace forcelayer
