// A walk over the directory cells and lower nodes of a tree, each with the 26 around it.
// Internal to formats/audit/.
#pragma once

#include <unordered_set>
#include <vector>

#include "formats/audit/brick_facts.h"
#include "formats/audit/effort.h"
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
    std::uint64_t hash = around[kCenter];
    for (std::size_t n = 1; n < kDirections; n += 2) {
      hash = (hash ^ (std::uint64_t{around[n - 1]} << 32 | around[n])) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    }
    return (hash ^ around[kDirections - 1]) * 0x9e3779b97f4a7c15u;
  }
};

// Surroundings that were looked at.
class AroundSet {
 public:
  bool is_new(const Around& around, Effort& effort) {
    effort.spend(Effort::kAskUnits);
    return seen_.insert(around).second;
  }

 private:
  std::unordered_set<Around, AroundHash> seen_;
};

inline Voxel beside(const Voxel& at, std::size_t n) {
  const Voxel d = direction(n);
  return {at[0] + d[0], at[1] + d[1], at[2] + d[2]};
}

// The children of a cube and one layer of those around it; a uniform entry is its own child.
class ChildGrid {
 public:
  // `nodes` are those of the level of the cube and its neighbors.
  void fill(const Around& around, const std::uint32_t* nodes) {
    for (std::int64_t x = 0; x < 10; ++x) {
      for (std::int64_t y = 0; y < 10; ++y) {
        for (std::int64_t z = 0; z < 10; ++z) {
          // Child 0 of the cube stands at index 1: (i + 7) / 8 is its cube's place in `around`.
          const std::uint32_t entry =
              around[static_cast<std::size_t>(((x + 7) / 8 * 3 + (y + 7) / 8) * 3 + (z + 7) / 8)];
          const std::int64_t slot = ((x + 7) % 8 * 8 + (y + 7) % 8) * 8 + (z + 7) % 8;
          children_[index(x, y, z)] =
              is_uniform(entry)
                  ? entry
                  : without_clearance(nodes[std::int64_t{entry} * kNodeEntries + slot]);
        }
      }
    }
  }

  // Those of child n.
  Around around(std::uint32_t n) const {
    const std::uint32_t* const first = &children_[(n >> 6) * 100 + (n >> 3 & 7) * 10 + (n & 7)];
    Around around;
    std::size_t i = 0;
    for (std::size_t x = 0; x < 3; ++x) {
      for (std::size_t y = 0; y < 3; ++y) {
        for (std::size_t z = 0; z < 3; ++z) around[i++] = first[x * 100 + y * 10 + z];
      }
    }
    return around;
  }

 private:
  static std::size_t index(std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::size_t>((x * 10 + y) * 10 + z);
  }

  std::array<std::uint32_t, 1000> children_{};  // 10^3
};

// Calls visitor.cell(low, around) for every directory cell, and for `beyond` more on each side.
// Where it returns true, calls visitor.node(low, around) for the cell's 512 nodes. `low` is the
// lowest voxel, a world index; all cells outside of the directory are `outside`. The walk ends as
// soon as visitor.ended() is true.
template <class View, class Visitor>
class NeighborhoodWalk {
 public:
  NeighborhoodWalk(const View& view, Visitor& visitor, Effort& effort,
                   std::uint32_t outside = kFreeEntry, std::int64_t beyond = 0)
      : view_(view), visitor_(visitor), effort_(effort), outside_(outside), beyond_(beyond) {}

  void run() {
    const auto& dims = view_.directory_dims;
    for (std::int64_t x = -beyond_; x < dims[0] + beyond_; ++x) {
      for (std::int64_t y = -beyond_; y < dims[1] + beyond_; ++y) {
        for (std::int64_t z = -beyond_; z < dims[2] + beyond_; ++z) {
          if (visitor_.ended()) return;
          visit_cell({x, y, z});
        }
      }
    }
  }

 private:
  static constexpr std::uint64_t kCellUnits = 300, kNodesUnits = 50'000;

  void visit_cell(const Voxel& at) {
    effort_.spend(kCellUnits);
    Around around;
    for (std::size_t n = 0; n < kDirections; ++n) around[n] = cell(beside(at, n));
    Voxel low;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = view_.directory_origin[axis] + at[axis] * kUpperNodeEdge;
    }
    if (!visitor_.cell(low, around)) return;
    effort_.spend(kNodesUnits);
    nodes_.fill(around, view_.upper_nodes);
    for (std::uint32_t n = 0; n < kNodeEntries && !visitor_.ended(); ++n) {
      visitor_.node(voxmap_walk::child_low(low, n, kLowerNodeEdge), nodes_.around(n));
    }
  }

  std::uint32_t cell(const Voxel& at) const {
    const auto& dims = view_.directory_dims;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (at[axis] < 0 || at[axis] >= dims[axis]) return outside_;
    }
    return without_clearance(view_.directory[(at[0] * dims[1] + at[1]) * dims[2] + at[2]]);
  }

  const View& view_;
  Visitor& visitor_;
  Effort& effort_;
  std::uint32_t outside_;
  std::int64_t beyond_;
  ChildGrid nodes_;
};

}  // namespace forcelayer::voxmap_audit
