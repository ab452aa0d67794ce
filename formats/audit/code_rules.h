// Which codes of distances may stand beside which values, and beside which codes
// (voxmap_format.md, section 13). Internal to formats/audit/.
#pragma once

#include <array>
#include <cstdint>

#include "formats/voxmap_format.h"

namespace forcelayer::voxmap_audit {

class CodeRules {
 public:
  explicit CodeRules(const VoxmapHeader& header);

  bool beside_value(std::uint32_t value, std::uint32_t code) const {
    return beside_value_[value][code];
  }
  // Whether two voxels that share a face may have these codes.
  bool beside_code(std::uint32_t a, std::uint32_t b) const { return beside_code_[a][b]; }

  // The same for many at once. True only where each pair is allowed; false says nothing yet.
  using BrickCodes = std::array<std::uint8_t, 512>;
  using FaceCodes = std::array<std::uint8_t, 64>;
  // `values` are the 128 bytes of a brick.
  bool surely_beside_values(const std::uint8_t* values, const BrickCodes& codes) const;
  bool surely_even(const BrickCodes& codes) const;
  bool surely_beside(const FaceCodes& a, const FaceCodes& b) const;

 private:
  void find_limits();
  void find_leap();

  std::array<std::array<bool, 256>, 4> beside_value_{};
  std::array<std::array<bool, 256>, 256> beside_code_{};
  // Lower and upper limits of the codes of four values at once, by the byte that holds the values.
  std::array<std::uint32_t, 256> least_of_four_{}, most_of_four_{};
  std::uint8_t zero_;  // distance_zero_code
  int leap_ = -1;      // steps from the mesh that differ by no more may be neighbors; -1: none may
};

}  // namespace forcelayer::voxmap_audit
