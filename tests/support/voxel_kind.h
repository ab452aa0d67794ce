// The kinds of maps that a scene can be baked to (voxmap_format.md, sections 5 and 6): Chebyshev or
// Euclidean layers alone, distances beside them, and those with a soft covering or a near standoff.
#pragma once

#include <array>
#include <cstdint>

namespace forcelayer::test {

enum class VoxelKind { kChebyshev, kLean, kFull, kCovered, kNear };

inline constexpr std::array kVoxelKinds{VoxelKind::kChebyshev, VoxelKind::kLean, VoxelKind::kFull,
                                        VoxelKind::kCovered, VoxelKind::kNear};

// The standoff of kNear, in voxels: a guarantee is left for shells of the usual covering radius.
inline constexpr double kNearStandoffVoxels = 1.3;

constexpr bool stores_distances(VoxelKind kind) {
  return kind == VoxelKind::kFull || kind == VoxelKind::kCovered || kind == VoxelKind::kNear;
}

constexpr const char* name_of(VoxelKind kind) {
  constexpr const char* kNames[] = {"chebyshev", "lean", "full", "covered", "near"};
  return kNames[static_cast<int>(kind)];
}

}  // namespace forcelayer::test
