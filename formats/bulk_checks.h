// The checks that look at every entry and every point of a file. Internal to formats/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/pshell.h"
#include "formats/voxmap_format.h"

namespace forcelayer {

// The entries that a level of a tree may have.
struct EntryRule {
  std::uint64_t child_count;  // elements of the next level's section
  std::uint32_t value_mask;   // the bits that hold a uniform entry's value
  std::uint32_t max_value;
  std::uint32_t clearance_mask;  // the bits that may be set beside the value 0
};

// The index of the first entry that breaks the rule; entries.size() where none does.
std::size_t first_bad_entry(std::span<const std::uint32_t> entries, const EntryRule& rule);

// A point is outside a sphere when it is farther by more than this fraction of the squared radius:
// squares of floats are exact in double precision, and two additions round by 2^-53 each.
inline constexpr double kSphereTolerance = 0x1p-50;

// Whether no point of [begin, end) lies outside `sphere`. NaN lies outside.
bool holds_points(const BoundingSphere& sphere, const PshellView& view, std::size_t begin,
                  std::size_t end);

enum class PointFault { kNone, kPosition, kNormal, kWeight, kCone, kSides };
struct PointsChecked {
  std::size_t bad = 0;  // the first point with a fault
  PointFault fault = PointFault::kNone;
  double area_m2 = 0;  // of all weights
};
PointsChecked check_points(const PshellView& view, double bounding_radius_m);

}  // namespace forcelayer
