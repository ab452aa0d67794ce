// The kinds of maps that a scene can be baked to (voxmap_format.md, sections 5 and 6): Chebyshev or
// Euclidean layers alone, distances beside them, and those with a soft covering.
#pragma once

#include <array>
#include <cstdint>

namespace forcelayer::test {

enum class VoxelKind { kChebyshev, kLean, kFull, kCovered };

inline constexpr std::array kVoxelKinds{VoxelKind::kChebyshev, VoxelKind::kLean, VoxelKind::kFull,
                                        VoxelKind::kCovered};

constexpr bool stores_distances(VoxelKind kind) {
  return kind == VoxelKind::kFull || kind == VoxelKind::kCovered;
}

constexpr const char* name_of(VoxelKind kind) {
  constexpr const char* kNames[] = {"chebyshev", "lean", "full", "covered"};
  return kNames[static_cast<int>(kind)];
}

}  // namespace forcelayer::test
