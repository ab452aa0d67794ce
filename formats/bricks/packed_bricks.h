// The bricks of distances and of objects as a .vox file packs them (voxmap_format.md, section 5).
// A brick is 8^3 elements, element n = x*64 + y*8 + z. Reading takes any bytes: nothing beyond the
// most bytes that a packed brick can have is read, whatever they hold.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace forcelayer {

inline constexpr std::uint32_t kPackedUnitBytes = 16;  // packed bricks begin at multiples of it
inline constexpr std::uint32_t kMaxPackedDistancesBytes = 560;  // read of a brick, at most
inline constexpr std::uint32_t kMaxPackedObjectsBytes = 1040;

using BrickCodes = std::array<std::uint8_t, 512>;     // distances
using BrickNumbers = std::array<std::uint16_t, 512>;  // objects

// The codes of a packed brick.
void unpack_distances(const std::uint8_t* packed, BrickCodes& codes) noexcept;
// One of them, at the cost of about a third.
std::uint8_t packed_distance(const std::uint8_t* packed, std::uint32_t n) noexcept;

// The numbers of a packed brick, and one of them.
void unpack_objects(const std::uint8_t* packed, BrickNumbers& numbers) noexcept;
std::uint16_t packed_object(const std::uint8_t* packed, std::uint32_t n) noexcept;

// The rule for writers that a packed brick breaks, in words; null where it breaks none.
const char* packed_distances_fault(const std::uint8_t* packed) noexcept;
const char* packed_objects_fault(const std::uint8_t* packed, std::uint32_t object_count) noexcept;

// Bricks packed one behind the other.
struct PackedBricks {
  std::vector<std::uint8_t> bytes;   // a multiple of kPackedUnitBytes
  std::vector<std::uint32_t> units;  // [bricks] where each begins
};

// Packs bricks of 512 codes, or 512 numbers, each. After the last stand zeros, so that the most
// bytes of a packed brick can be read from every unit of `units` on. Same bricks, same bytes.
PackedBricks pack_distances(std::span<const std::uint8_t> codes);
PackedBricks pack_objects(std::span<const std::uint16_t> numbers);

}  // namespace forcelayer
