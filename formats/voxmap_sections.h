// The header and sections that a .vox file must and may have. Internal to formats/.
#pragma once

#include <array>

#include "formats/section_table.h"
#include "formats/voxmap_format.h"

namespace forcelayer {

inline constexpr HeaderRule kVoxmapHeaderRule{kVoxmapMagic, kVoxmapMajor, 0, sizeof(VoxmapHeader)};

// In ascending order of id.
constexpr std::array<SectionRule, 16> voxmap_section_rules() {
  constexpr auto id = [](VoxmapSection section) { return static_cast<std::uint32_t>(section); };
  constexpr std::uint32_t kNodeBytes = kNodeEntries * sizeof(std::uint32_t);
  return {{{id(VoxmapSection::kDirectory), "directory", sizeof(std::uint32_t), true},
           {id(VoxmapSection::kUpperNodes), "upper nodes", kNodeBytes, true},
           {id(VoxmapSection::kLowerNodes), "lower nodes", kNodeBytes, true},
           {id(VoxmapSection::kBricks), "bricks", brick_bytes(kValueBits), true},
           {id(VoxmapSection::kPointForces), "point forces", sizeof(float), false},
           {id(VoxmapSection::kProvenance), "provenance", 1, false},
           {id(VoxmapSection::kDistanceDirectory), "distance directory", 4, false},
           {id(VoxmapSection::kDistanceUpperNodes), "distance upper nodes", kNodeBytes, false},
           {id(VoxmapSection::kDistanceLowerNodes), "distance lower nodes", kNodeBytes, false},
           {id(VoxmapSection::kDistanceBricks), "distance bricks", kPackedUnitBytes, false},
           {id(VoxmapSection::kObjectDirectory), "object directory", 4, false},
           {id(VoxmapSection::kObjectUpperNodes), "object upper nodes", kNodeBytes, false},
           {id(VoxmapSection::kObjectLowerNodes), "object lower nodes", kNodeBytes, false},
           {id(VoxmapSection::kObjectBricks), "object bricks", kPackedUnitBytes, false},
           {id(VoxmapSection::kObjectNames), "object names", 1, false},
           {id(VoxmapSection::kCompliance), "compliance", sizeof(float), false}}};
}

}  // namespace forcelayer
