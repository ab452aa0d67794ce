// Sheets and thin walls of the scene that are flush around a position. In a cell of eight voxel
// centers through which such a wall goes, the interpolated slope has neither its direction nor
// tells its side. The stored distances of cells on both sides of it are exact, and tell both.
//
// A wall is known if it is flat to 0.06 voxels there, thinner than 1.74 voxels, and ends not nearer
// than some 1.6 voxels. Another wall must be three voxels away, or 2.5 where the two meet. Within a
// voxel beyond its end a wall may seem to go on. Heights are off by up to 0.035 voxels.
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
