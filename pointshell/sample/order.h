// The order of shell points and their grouping into blocks and super-blocks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/pshell_format.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::sample {

// Indices of `points` in an order in which every `block` consecutive points, and every
// `super_block` consecutive blocks, are close together. The points are halved again and again
// across the longest side of their box, at a multiple of a super-block and then of a block. The
// blocks' spheres are about a quarter smaller than along a Hilbert curve. Depends on the set of
// points alone.
std::vector<std::uint32_t> block_order(std::span<const part::Vec3> points, std::size_t block,
                                       std::size_t super_block);

// The smallest sphere around every `group` successive points, rounded outwards. Positions must be
// stored positions.
std::vector<BoundingSphere> bounding_spheres(std::span<const part::Vec3> points, std::size_t group);

}  // namespace forcelayer::sample
