// The codes of a brick and of two voxels around it. Internal to formats/audit/.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "formats/bricks/packed_bricks.h"

namespace forcelayer::voxmap_audit {

// Codes [x][y][z], a row of 12 in 16 bytes. Voxel (0, 0, 0) is the brick's lowest one.
class CodeCube {
 public:
  static constexpr int kHalo = 2, kWidth = 8 + 2 * kHalo, kRow = 16, kPlane = kWidth * kRow;
  static constexpr int kBytes = kWidth * kPlane;

  // x, y and z from -2 to 9.
  std::uint8_t at(int x, int y, int z) const { return codes_[index(x, y, z)]; }
  void set(int x, int y, int z, std::uint8_t code) { codes_[index(x, y, z)] = code; }
  const std::uint8_t* data() const { return codes_.data(); }  // one row more can be read

  // Takes in what it holds of the brick that lies `dx`, `dy` and `dz` bricks away, -1 to 1 each.
  void put(int dx, int dy, int dz, const BrickCodes& brick) {
    const int z = dz < 0 ? 8 - kHalo : 0;
    for (int x = dx < 0 ? 8 - kHalo : 0; x < (dx > 0 ? kHalo : 8); ++x) {
      for (int y = dy < 0 ? 8 - kHalo : 0; y < (dy > 0 ? kHalo : 8); ++y) {
        std::uint8_t* const to = &codes_[index(8 * dx + x, 8 * dy + y, 8 * dz + z)];
        const std::uint8_t* const from = &brick[static_cast<std::size_t>(64 * x + 8 * y + z)];
        if (dz == 0) {
          std::memcpy(to, from, 8);
        } else {
          std::memcpy(to, from, kHalo);
        }
      }
    }
  }

 private:
  static constexpr std::size_t index(int x, int y, int z) {
    return static_cast<std::size_t>((x + kHalo) * kPlane + (y + kHalo) * kRow + z + kHalo);
  }

  std::array<std::uint8_t, kBytes + kRow> codes_{};
};

// The same codes as five cubes, shifted against each other along z, without anything between rows:
// so 64 codes of the brick, and their neighbors by any step, are consecutive.
class ShiftedCubes {
 public:
  explicit ShiftedCubes(const CodeCube& cube) {
    for (int row = 0; row < kRows; ++row) {
      for (int z = 0; z < kShifts; ++z) {
        std::memcpy(&codes_[static_cast<std::size_t>((z * kRows + row) * 8)],
                    cube.data() + row * CodeCube::kRow + z, 8);
      }
    }
  }

  // The 64 codes that are (x, dy, dz) away from those of the brick at x = 0.
  const std::uint8_t* plane(int x, int dy, int dz) const {
    constexpr int kHalo = CodeCube::kHalo;
    const int row = (x + kHalo) * CodeCube::kWidth + dy + kHalo;
    return &codes_[static_cast<std::size_t>(((dz + kHalo) * kRows + row) * 8)];
  }

 private:
  static constexpr int kShifts = 2 * CodeCube::kHalo + 1;
  static constexpr int kRows = CodeCube::kWidth * CodeCube::kWidth;
  std::array<std::uint8_t, std::size_t{kShifts} * kRows * 8> codes_;
};

}  // namespace forcelayer::voxmap_audit
