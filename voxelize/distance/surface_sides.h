// Which side of each triangle of an object is outside: decided for each closed part of its surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voxelize/scan/snap.h"

namespace forcelayer::distance {

// The component of a triangle, and the side on which its outside lies.
class TriangleSide {
 public:
  TriangleSide() = default;  // of no closed component
  TriangleSide(std::uint32_t component, bool is_reversed)
      : code_(static_cast<std::uint16_t>(2 * (1 + component % 0x7fff) + (is_reversed ? 1 : 0))) {}

  bool is_closed() const { return code_ != 0; }
  // Whether the normal of the triangle's corners, in their order, points inside.
  bool is_reversed() const { return (code_ & 1) != 0; }
  TriangleSide turned() const {
    TriangleSide other = *this;
    if (is_closed()) other.code_ ^= 1;
    return other;
  }
  // Whether two triangles of one object are of one component, or both of none. Numbers of
  // components repeat after 32767.
  bool is_with(const TriangleSide& other) const { return code_ >> 1 == other.code_ >> 1; }
  bool operator==(const TriangleSide&) const = default;

 private:
  std::uint16_t code_ = 0;
};

// The triangles of an object form components: triangles that share a corner are of one. A component
// is closed if it runs along each edge as often one way as the other, and encloses a volume other
// than 0. Corners at the same lattice point count as one where components are open without that. A
// 64-bit sum of hashes decides whether edges cancel out.
//
// A closed component is wound the wrong way round if it encloses a negative volume in free space.
// In the material of other components of the object it is a cavity, or a body that overlaps
// theirs, and is wound as the smallest of them is. All this is decided in integers. An object
// counts as open where it is wider than 2^30 voxels, or where the search for what encloses what
// takes too long.
class SurfaceSides {
 public:
  SurfaceSides() = default;
  SurfaceSides(SurfaceSides&&) = default;  // the sides stay where they are
  SurfaceSides& operator=(SurfaceSides&&) = default;
  explicit SurfaceSides(const scan::SnappedObject& object, scan::SpillFile* spill = nullptr);

  TriangleSide operator[](std::uint32_t triangle) const {
    return sides_.empty() ? side_ : sides_[triangle];
  }
  // Whether all triangles have the same side.
  bool is_uniform() const { return sides_.empty(); }

 private:
  TriangleSide side_;                    // of all, where `sides_` is empty
  std::vector<TriangleSide> own_sides_;  // empty where they wait on disk
  std::span<TriangleSide> sides_;        // [triangles]
};

}  // namespace forcelayer::distance
