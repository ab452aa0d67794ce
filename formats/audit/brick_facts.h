// One brick of values as bits, and its facts: counts, tight box, gaps. The audit computes them once
// for each stored brick. Internal to formats/audit/.
#pragma once

#include <array>
#include <cstdint>

#include "formats/voxmap_format.h"

namespace forcelayer::voxmap_audit {

// The 27 cells of a neighborhood, x slowest; the middle one is the cell itself.
inline constexpr std::size_t kDirections = 27, kCenter = 13;
constexpr std::array<std::int64_t, 3> direction(std::size_t n) {
  return {static_cast<std::int64_t>(n / 9) - 1, static_cast<std::int64_t>(n / 3 % 3) - 1,
          static_cast<std::int64_t>(n % 3) - 1};
}

// The two bits of each value: a word for each x, bit y*8 + z.
struct BrickPlanes {
  std::array<std::uint64_t, 8> low{}, high{};
};
BrickPlanes planes_of(const std::uint32_t* brick);

// The gaps of a box: for each direction towards a neighbor, how many layers of free voxels lie
// between that side, edge or corner of the box and its first voxel that is not free. The box's edge
// where all of it is free.
using Gaps = std::array<std::uint8_t, kDirections>;

struct BrickFacts {
  std::array<std::uint16_t, 3> counts{};  // of the values 1, 2 and 3
  std::array<std::uint8_t, 3> low{},
      high{};  // the tight box of voxels that are not free, half-open
  Gaps gaps{};
};
BrickFacts facts_of(const BrickPlanes& planes);

}  // namespace forcelayer::voxmap_audit
