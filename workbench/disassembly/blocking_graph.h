// Which parts block which, for motions along one direction, and what follows from it: groups that
// block each other only together, and the fewest removals that set a part free. Pure graphs: no
// meshes.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace forcelayer::disassembly {

// Numbers, in ascending order.
using Parts = std::vector<std::size_t>;

// Without those of `removed`, both ascending.
Parts without(const Parts& parts, const Parts& removed);
bool contains(const Parts& parts, std::size_t part);

// The sets of nodes that reach each other along edges, and from which no edge leads to another
// node: parts that block each other, and that nothing else blocks. [nodes] `blockers`: where the
// edges of a node lead. Sets are in the order of their lowest nodes.
std::vector<Parts> closed_groups(const std::vector<Parts>& blockers);

// One of several motions of a part, and the parts that are in the way.
struct BlockedMotion {
  std::size_t direction = 0;
  Parts blockers;
};

// Removals that set a part free, in an order in which each is free: with few parts in all. A plan
// of least cost by the sum of its blockers' costs is found, and then made smaller by leaving out.
struct Removal {
  std::size_t part = 0;
  std::size_t direction = 0;
};
// `motions_of` is asked once for each part that may be of use. None where no order is found.
std::optional<std::vector<Removal>> fewest_removals(
    std::size_t parts, std::size_t target,
    const std::function<std::vector<BlockedMotion>(std::size_t part)>& motions_of);

}  // namespace forcelayer::disassembly
