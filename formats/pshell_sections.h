// The header and sections that a .pshell file must and may have. Internal to formats/.
#pragma once

#include <array>

#include "formats/pshell_format.h"
#include "formats/section_table.h"

namespace forcelayer {

inline constexpr HeaderRule kPshellHeaderRule{kPshellMagic, kPshellMajor, kPshellMinor,
                                              sizeof(PshellHeader)};

// In ascending order of id.
constexpr std::array<SectionRule, 13> pshell_section_rules() {
  constexpr auto id = [](PshellSection section) { return static_cast<std::uint32_t>(section); };
  return {{{id(PshellSection::kPositionX), "x", sizeof(float), true},
           {id(PshellSection::kPositionY), "y", sizeof(float), true},
           {id(PshellSection::kPositionZ), "z", sizeof(float), true},
           {id(PshellSection::kNormalX), "normal x", sizeof(float), true},
           {id(PshellSection::kNormalY), "normal y", sizeof(float), true},
           {id(PshellSection::kNormalZ), "normal z", sizeof(float), true},
           {id(PshellSection::kWeight), "weight", sizeof(float), true},
           {id(PshellSection::kBlocks), "blocks", sizeof(BoundingSphere), true},
           {id(PshellSection::kSuperBlocks), "super-blocks", sizeof(BoundingSphere), true},
           {id(PshellSection::kNormalCones), "normal cones", sizeof(float), false},
           {id(PshellSection::kLosses), "losses", sizeof(DistanceLoss), false},
           {id(PshellSection::kProvenance), "provenance", 1, false},
           {id(PshellSection::kTwoSided), "two-sided points", 1, false, 1}}};
}

}  // namespace forcelayer
