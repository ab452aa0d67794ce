// The broad phase: which boxes are near each other.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "formats/mesh/mesh.h"

namespace forcelayer::pairs {

// The distance between two boxes; 0 where they meet.
double distance_of(const mesh::Box& a, const mesh::Box& b);

// Whether all of `inner` lies in `outer`.
bool contains(const mesh::Box& outer, const mesh::Box& inner);

using Pair = std::pair<std::uint32_t, std::uint32_t>;  // the lower number first

// All pairs of boxes that are `reach_m` apart or less, and for which is_asked() is true: by a sweep
// along the axis on which the boxes are spread most. The pairs are in the order of the sweep, so
// that those of one box follow each other closely.
std::vector<Pair> near_boxes(std::span<const mesh::Box> boxes_m, double reach_m,
                             const std::function<bool(const Pair&)>& is_asked);

}  // namespace forcelayer::pairs
