// A walk over the directory cells and lower nodes of a tree of values, each with the 26 around it.
// Internal to formats/audit/.
#pragma once

#include <unordered_set>
#include <vector>

#include "formats/audit/brick_facts.h"
#include "formats/audit/parts.h"
#include "formats/voxmap.h"
#include "formats/voxmap_walk.h"

namespace forcelayer::voxmap_audit {

inline constexpr std::uint32_t kFreeEntry = uniform_entry(0);
inline constexpr std::uint32_t kInteriorEntry = uniform_entry(1);

inline std::uint32_t without_clearance(std::uint32_t entry) {
  return is_uniform(entry) ? uniform_entry(uniform_value(entry)) : entry;
}

// The entries of a cube and of its 26 neighbors in the order of direction(), without clearances.
using Around = std::array<std::uint32_t, kDirections>;

struct AroundHash {
  std::size_t operator()(const Around& around) const {
    std::uint64_t hash = 0;
    for (const std::uint32_t entry : around) {
      hash = (hash ^ entry) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    }
    return hash;
  }
};
using AroundSet = std::unordered_set<Around, AroundHash>;

// Surroundings that were looked at: once, where all of them is known. A bake has about as many as
// its nodes have children. Few nodes strewn so that no two places are alike have any number: these
// are not looked at to the end.
class Surroundings {
 public:
  explicit Surroundings(const Voxmap& map)
      : most_((1u << 17) + 4 * cells_of(map.view()) + 2 * kNodeEntries * map.upper_node_count()) {}

  bool is_new(AroundSet& seen, const Around& around, bool known) {
    if (known && !seen.insert(around).second) return false;
    ++looks_;
    return true;
  }
  bool too_many() const { return looks_ > most_; }

  AroundSet cells, nodes;

 private:
  std::uint64_t most_, looks_ = 0;
};

inline Voxel beside(const Voxel& at, std::size_t n) {
  const Voxel d = direction(n);
  return {at[0] + d[0], at[1] + d[1], at[2] + d[2]};
}

// Calls visitor.cell(low, around) for every directory cell. Where it returns true, calls
// visitor.node(low, around) for the cell's 512 nodes. `low` is the lowest voxel, a world index. The
// walk ends as soon as visitor.ended() is true.
template <class Visitor>
class NeighborhoodWalk {
 public:
  NeighborhoodWalk(const VoxmapView& view, Visitor& visitor) : view_(view), visitor_(visitor) {}

  void run() {
    const auto& dims = view_.directory_dims;
    for (std::int64_t x = 0; x < dims[0]; ++x) {
      for (std::int64_t y = 0; y < dims[1]; ++y) {
        for (std::int64_t z = 0; z < dims[2]; ++z) {
          if (visitor_.ended()) return;
          visit_cell({x, y, z});
        }
      }
    }
  }

 private:
  void visit_cell(const Voxel& at) {
    Around around;
    for (std::size_t n = 0; n < kDirections; ++n) around[n] = cell(beside(at, n));
    Voxel low;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = view_.directory_origin[axis] + at[axis] * kUpperNodeEdge;
    }
    if (visitor_.cell(low, around)) visit_nodes(low, around);
  }

  std::uint32_t cell(const Voxel& at) const {
    const auto& dims = view_.directory_dims;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (at[axis] < 0 || at[axis] >= dims[axis]) return kFreeEntry;
    }
    return without_clearance(view_.directory[(at[0] * dims[1] + at[1]) * dims[2] + at[2]]);
  }

  void visit_nodes(const Voxel& low, const Around& around) {
    const auto index = [](std::int64_t x, std::int64_t y, std::int64_t z) {
      return static_cast<std::size_t>((x * 10 + y) * 10 + z);
    };
    for (std::int64_t x = 0; x < 10; ++x) {
      for (std::int64_t y = 0; y < 10; ++y) {
        for (std::int64_t z = 0; z < 10; ++z) {
          // Child 0 of the cube stands at index 1: (i + 7) / 8 is its cube's place in `around`.
          const std::uint32_t entry =
              around[static_cast<std::size_t>(((x + 7) / 8 * 3 + (y + 7) / 8) * 3 + (z + 7) / 8)];
          const std::int64_t slot = ((x + 7) % 8 * 8 + (y + 7) % 8) * 8 + (z + 7) % 8;
          nodes_[index(x, y, z)] =
              is_uniform(entry)
                  ? entry
                  : without_clearance(view_.upper_nodes[std::int64_t{entry} * kNodeEntries + slot]);
        }
      }
    }
    for (std::uint32_t n = 0; n < kNodeEntries && !visitor_.ended(); ++n) {
      const Voxel at = voxmap_walk::child_low({1, 1, 1}, n, 1);
      Around child;
      for (std::size_t i = 0; i < kDirections; ++i) {
        const Voxel next = beside(at, i);
        child[i] = nodes_[index(next[0], next[1], next[2])];
      }
      visitor_.node(voxmap_walk::child_low(low, n, kLowerNodeEdge), child);
    }
  }

  const VoxmapView& view_;
  Visitor& visitor_;
  std::array<std::uint32_t, 1000> nodes_{};  // 10^3: the 8^3 of a cell and one layer around them
};

}  // namespace forcelayer::voxmap_audit
