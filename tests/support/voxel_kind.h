// The kinds of voxels that a scene can be baked to (voxmap_format.md, 5 and 6), the last with a
// soft covering.
#pragma once

#include <array>
#include <cstdint>

namespace forcelayer::test {

enum class VoxelKind { kChebyshev, kEuclidean, kDistance4, kDistance8, kCovered8 };

inline constexpr std::array kVoxelKinds{VoxelKind::kChebyshev, VoxelKind::kEuclidean,
                                        VoxelKind::kDistance4, VoxelKind::kDistance8,
                                        VoxelKind::kCovered8};

constexpr std::uint32_t bits_of(VoxelKind kind) {
  if (kind == VoxelKind::kDistance4) return 4;
  return kind == VoxelKind::kDistance8 || kind == VoxelKind::kCovered8 ? 8 : 2;
}

constexpr const char* name_of(VoxelKind kind) {
  constexpr const char* kNames[] = {"chebyshev", "euclidean", "distance4", "distance8", "covered8"};
  return kNames[static_cast<int>(kind)];
}

}  // namespace forcelayer::test
