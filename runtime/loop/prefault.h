// The pages of a map that a part can reach, in memory before the loop runs; the others are never
// read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "formats/voxmap.h"

namespace forcelayer {

// A box of the scene, world axes, m.
struct ReachBox {
  glm::dvec3 min_m{0}, max_m{0};
};

// Reads every page that holds a brick of `reach`, or of the bricks next to it, whose levels a force
// field reads too, and keeps the system from reading ahead of what is asked for. The directory and
// the nodes are there already: Voxmap::open() checks them all. A map in memory is as it is. Returns
// the bytes of those pages. Not for the loop's thread.
std::uint64_t prefault(const Voxmap& voxmap, const ReachBox& reach);

// Of a mapping, the bytes that this process has in memory (/proc/self/smaps); 0 where the system
// does not say.
std::uint64_t resident_bytes(std::span<const std::byte> mapping);

}  // namespace forcelayer
