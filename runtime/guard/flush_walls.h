// Sheets and thin walls of the scene that are flush around a position. In a cell of eight voxel
// centers through which such a wall goes, the interpolated slope has neither its direction nor
// tells its side. The stored distances of cells on both sides of it are exact, and tell both.
//
// A wall is known if it is flat to 0.06 voxels there, thinner than 1.74 voxels, and if no end of it
// and no other wall is nearer than three voxels. Nearer than that to its end it may be unknown, or
// seem to go on beyond it: at 2,500 walls with an end, walls were unknown up to 2.3 voxels from it,
// and seemed to go on up to 2.1; where two walls meet, they were unknown up to 2.7. Heights are off
// by up to 0.035 voxels.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "runtime/field/field_probe.h"

namespace forcelayer::guard {

struct FlushWall {
  glm::vec3 direction{0};  // unit, across the wall, to one of its sides; 0: no wall is known
  float height = 0;        // of the position over the wall's middle, along the direction, voxels
  bool is_known() const { return direction != glm::vec3(0); }
};

class FlushWalls {
 public:
  // The probe must outlive this.
  explicit FlushWalls(const field::FieldProbe& probe);

  // Makes room for what the points of a shell need in a frame. Set-up only.
  void reserve(std::size_t points);

  // The wall near the i-th point that the probe queried last.
  FlushWall beside(std::uint32_t i) const noexcept;

 private:
  // Heights are those of the cell's middle. The cell is the one from a voxel on.
  struct Cell {
    glm::ivec3 voxel{std::numeric_limits<std::int32_t>::min()};
    FlushWall wall;
  };
  FlushWall near_cell(const glm::ivec3& voxel) const noexcept;
  FlushWall through_cell(const glm::ivec3& voxel) const noexcept;

  const field::FieldProbe& probe_;
  mutable std::vector<Cell> cells_;  // those found last, by hash; no answer depends on its content
};

}  // namespace forcelayer::guard
