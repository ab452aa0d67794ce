// Which codes of distances may stand beside which values, and beside which codes
// (voxmap_format.md, sections 13.2 and 13.5). Internal to formats/audit/.
#pragma once

#include <array>
#include <cstdint>

#include "formats/audit/code_cube.h"
#include "formats/voxmap_format.h"

namespace forcelayer::voxmap_audit {

// A step to a voxel at most two away along each axis, by the shortest one in its direction; one of
// the two steps of each pair.
struct Step {
  int x, y, z;
  int squared() const { return x * x + y * y + z * z; }
};
inline constexpr std::size_t kSteps = 49;
extern const std::array<Step, kSteps> kNearSteps;  // the three along the axes first

class CodeRules {
 public:
  explicit CodeRules(const VoxmapHeader& header);

  bool beside_value(std::uint32_t value, std::uint32_t code) const {
    return beside_value_[value][code];
  }
  // Whether two voxels that are a step apart may have these codes.
  bool beside_code(const Step& step, std::uint32_t a, std::uint32_t b) const;
  // Whether a voxel of this code may have a neighbor of that code, over a face, in the direction in
  // which the mesh is nearest.
  bool may_lead_to_mesh(std::uint32_t code, std::uint32_t neighbor) const {
    return neighbor <= max_towards_mesh_[code];
  }

  // Whether a voxel of this code may lie between two neighbors along an axis, of those codes.
  // Looked at within a voxel of the mesh, where neither neighbor is nearer: elsewhere the other
  // rules say nearly as much.
  bool may_lie_between(std::uint32_t code, std::uint32_t a, std::uint32_t b) const {
    return code_steps(code) >= near_steps_ || code_steps(code) > code_steps(a) ||
           code_steps(code) > code_steps(b) || squared_[a] + squared_[b] <= max_squared_[code];
  }

  // The same for many at once. True only where each is allowed; false says nothing yet.
  // `values` are the 128 bytes of a brick.
  bool surely_beside_values(const std::uint8_t* values, const BrickCodes& codes) const;
  // Each voxel of the brick in the middle and those that are a step away.
  bool surely_beside_codes(const CodeCube& cube) const;
  // Each voxel of the brick in the middle has a neighbor that may lead to the mesh.
  bool surely_lead_to_mesh(const CodeCube& cube) const;
  // Each voxel of the brick in the middle may lie between its neighbors; false where one may not.
  bool lie_between(const CodeCube& cube) const;

 private:
  // Steps from the mesh, on either side.
  std::uint32_t code_steps(std::uint32_t code) const {
    return code < zero_ ? zero_ - 1 - code : code - zero_;
  }
  void find_limits();
  void find_leaps();
  void find_descent();

  std::array<std::array<bool, 256>, 4> beside_value_{};
  // Lower and upper limits of the codes of four values at once, by the byte that holds the values.
  std::array<std::uint32_t, 256> min_of_four_{}, max_of_four_{};
  std::uint32_t zero_;                              // distance_zero_code
  double quantum_;                                  // voxels
  std::array<double, 256> nearest_{}, farthest_{};  // of the unsigned distance, voxels
  // For the nearest: what those of two neighbors may be together.
  std::array<double, 256> squared_{}, max_squared_{};
  std::uint32_t near_steps_ = 0;             // a voxel
  std::array<std::uint8_t, kSteps> leap_{};  // codes that differ by no more may be a step apart
  std::array<std::uint8_t, 256> max_towards_mesh_{};
  // No code but 255 has a lower limit than itself less the drop, or than the floor.
  std::uint8_t drop_ = 0, floor_ = 255;
};

}  // namespace forcelayer::voxmap_audit
