// The header and sections that a .vox file must and may have. Internal to formats/.
#pragma once

#include <array>

#include "formats/section_table.h"
#include "formats/voxmap_format.h"

namespace forcelayer {

inline constexpr HeaderRule kVoxmapHeaderRule{kVoxmapMagic, sizeof(VoxmapHeader)};

// In ascending order of id.
constexpr std::array<SectionRule, 6> voxmap_section_rules(std::uint32_t bits_per_voxel) {
  constexpr auto id = [](VoxmapSection section) { return static_cast<std::uint32_t>(section); };
  constexpr std::uint32_t kNodeBytes = kNodeEntries * sizeof(std::uint32_t);
  return {{{id(VoxmapSection::kDirectory), "directory", sizeof(std::uint32_t), true},
           {id(VoxmapSection::kUpperNodes), "upper nodes", kNodeBytes, true},
           {id(VoxmapSection::kLowerNodes), "lower nodes", kNodeBytes, true},
           {id(VoxmapSection::kBricks), "bricks", brick_bytes(bits_per_voxel), true},
           {id(VoxmapSection::kCompliance), "compliance", sizeof(float), false},
           {id(VoxmapSection::kProvenance), "provenance", 1, false}}};
}

}  // namespace forcelayer
