// The versions of the algorithms whose results a cache holds. They are in every entry's key, so
// that no entry is taken for the output of another version.
// tests/golden/voxelize_cache_versions.cpp fails where an output has changed and its version has
// not. Raise a version when
#pragma once

#include <cstdint>

namespace forcelayer::cache {

// ... a reader gives another mesh for the same file, or refuses it, or the record changes.
// 2: STEP and IGES files of which faces are lost are refused.
// 3: the record holds missing faces and the nodes left out.
// 4: the record holds the tree of nodes; siblings of a name are called "name[2]".
// 5: glTF is turned, so that z is up.
// 6: vertices that no triangle uses are dropped.
// 7: the record holds the deviation of each instance.
inline constexpr std::uint32_t kAssemblyCacheVersion = 7;

// ... mesh_facts() gives other facts for the same mesh, or the record changes.
inline constexpr std::uint32_t kFactsCacheVersion = 2;

// ... snap, scan conversion, flood or the search for cavities give something else for the same
// input, or the record changes.
// 2: the record holds the grown surface beside G.
inline constexpr std::uint32_t kObjectCacheVersion = 3;

// ... grow_surface() finds other voxels. Counts beside the version above.
// 2: needles are not near beyond their tips.
// 3: a piece of a large triangle without area is a line.
inline constexpr std::uint32_t kGrowthCacheVersion = 3;

// ... measured distances, their sides or the nearest objects come out differently.
// 2: a piece of a large triangle without area is a line.
// 3: near an edge the side is that of the voxels that a center sees.
// 4: closed walls are negative inside, however thin.
inline constexpr std::uint32_t kDistanceCacheVersion = 4;

// ... offset, bricks or clearance come out differently for the same voxels.
inline constexpr std::uint64_t kNodeCacheVersion = 1;

}  // namespace forcelayer::cache
