// Brings the pages of a map that a part can reach into memory before the loop runs, and no others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "formats/voxmap.h"

namespace forcelayer::machine {

// A box of the scene, world axes, m.
struct ReachBox {
  glm::dvec3 min_m{0}, max_m{0};
};

// Reads every page that holds a brick inside `reach` or next to it (a force field reads the
// neighboring bricks too), and switches read-ahead off. Returns the bytes of those pages. The
// directory and the nodes need no reading: Voxmap::open() has checked them all. A map that is not a
// file stays as it is. Not for the loop's thread.
std::uint64_t prefault(const Voxmap& voxmap, const ReachBox& reach);

// Gives back the memory of a map of a file, whose pages would be read from there again. Not for a
// map in memory.
void let_go(const Voxmap& voxmap);

// The bytes of `mapping` that this process has in memory (/proc/self/smaps); 0 if unknown.
std::uint64_t resident_bytes(std::span<const std::byte> mapping);

}  // namespace forcelayer::machine
