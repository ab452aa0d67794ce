#include "formats/audit/contents.h"

#include <algorithm>

#include "formats/voxmap_walk.h"

namespace forcelayer::voxmap_audit {
namespace {

constexpr std::uint64_t kBoxUnits = 10;  // of effort, for each box that a look touches

// Makes `box` hold `other` too.
void extend(Span& box, const Span& other) {
  if (other.empty()) return;
  if (box.empty()) box = other;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(box.low[axis], other.low[axis]);
    box.high[axis] = std::max(box.high[axis], other.high[axis]);
  }
}

Voxel scaled(const Voxel& at, std::int64_t edge) {
  return {at[0] * edge, at[1] * edge, at[2] * edge};
}

Summary full(VoxelValue value, std::int64_t edge) {
  Summary summary;
  if (value == VoxelValue::kFree) return summary;
  summary.counts[static_cast<std::size_t>(value) - 1] =
      static_cast<std::uint64_t>(edge * edge * edge);
  summary.tight = Span::cube({0, 0, 0}, edge);
  return summary;
}

}  // namespace

void Summary::add(const Summary& child, const Voxel& at) {
  if (child.tight.empty()) return;
  extend(tight, shifted(child.tight, at, 1));
  for (std::size_t n = 0; n < 3; ++n) counts[n] += child.counts[n];
}

Contents::Contents(const Voxmap& map) : view_(map.view()) {
  planes_.reserve(map.brick_count());
  bricks_.reserve(map.brick_count());
  for (std::uint64_t b = 0; b < map.brick_count(); ++b) {
    planes_.push_back(planes_of(view_.bricks + b * 16 * kValueBits));
    bricks_.push_back(facts_of(planes_.back()));
  }
  lower_ = of_nodes(view_.lower_nodes, map.lower_node_count(), kBrickEdge);
  upper_ = of_nodes(view_.upper_nodes, map.upper_node_count(), kLowerNodeEdge);
  node_gaps_.reserve(lower_.size());
  for (std::uint32_t n = 0; n < lower_.size(); ++n) node_gaps_.push_back(gaps_of_node(n));
  summarize_scene();
  group_cells();
}

void Contents::summarize_scene() {
  const auto& dims = view_.directory_dims;
  std::size_t entry = 0;
  for (std::int64_t x = 0; x < dims[0]; ++x) {
    for (std::int64_t y = 0; y < dims[1]; ++y) {
      for (std::int64_t z = 0; z < dims[2]; ++z) {
        scene_.add(of_entry(view_.directory[entry++], kUpperNodeEdge),
                   scaled({x, y, z}, kUpperNodeEdge));
      }
    }
  }
}

Summary Contents::of_brick(std::uint32_t brick) const {
  const BrickFacts& facts = bricks_[brick];
  Summary summary;
  for (std::size_t n = 0; n < 3; ++n) {
    summary.counts[n] = facts.counts[n];
    summary.tight.low[n] = facts.low[n];
    summary.tight.high[n] = facts.high[n];
  }
  return summary;
}

Summary Contents::of_entry(std::uint32_t entry, std::int64_t edge) const {
  if (is_uniform(entry)) return full(static_cast<VoxelValue>(uniform_value(entry)), edge);
  return edge == kUpperNodeEdge   ? upper_[entry]
         : edge == kLowerNodeEdge ? lower_[entry]
                                  : of_brick(entry);
}

std::vector<Summary> Contents::of_nodes(const std::uint32_t* entries, std::uint64_t count,
                                        std::int64_t entry_edge) const {
  std::vector<Summary> summaries(count);
  for (std::uint64_t node = 0; node < count; ++node) {
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      const std::uint32_t entry = entries[node * kNodeEntries + n];
      if (is_uniform(entry) && uniform_value(entry) == 0) continue;
      summaries[node].add(of_entry(entry, entry_edge),
                          voxmap_walk::child_low({0, 0, 0}, n, entry_edge));
    }
  }
  return summaries;
}

Gaps Contents::gaps_of_node(std::uint32_t node) const {
  Gaps gaps;
  gaps.fill(kLowerNodeEdge);
  const std::uint32_t* const entries = view_.lower_nodes + std::uint64_t{node} * kNodeEntries;
  for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
    if (is_uniform(entries[n]) && uniform_value(entries[n]) == 0) continue;
    const auto at = voxmap_walk::child_low({0, 0, 0}, n, 1);
    for (std::size_t i = 0; i < kDirections; ++i) {
      // The cells before the child along the axes on which it lies deepest; its own gap along
      // these.
      const Voxel d = direction(i);
      std::int64_t deepest = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (d[axis] != 0) deepest = std::max(deepest, d[axis] < 0 ? at[axis] : 7 - at[axis]);
      }
      std::size_t along = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const bool counts = d[axis] != 0 && (d[axis] < 0 ? at[axis] : 7 - at[axis]) == deepest;
        along = along * 3 + static_cast<std::size_t>((counts ? d[axis] : 0) + 1);
      }
      const int own = is_uniform(entries[n]) ? 0 : bricks_[entries[n]].gaps[along];
      if (own == static_cast<int>(kBrickEdge)) break;  // all of it is free
      const auto gap = static_cast<std::uint8_t>(8 * deepest + own);
      gaps[i] = std::min(gaps[i], gap);
    }
  }
  return gaps;
}

Span Contents::tight_of(std::uint32_t entry, std::int64_t edge) const {
  if (edge == kUpperNodeEdge) return upper_[entry].tight;
  return edge == kLowerNodeEdge ? lower_[entry].tight : of_brick(entry).tight;
}

// `box` is relative to the entry's lowest voxel.
bool Contents::entry_holds_non_free(std::uint32_t entry, std::int64_t edge, const Span& box,
                                    Effort& effort) const {
  effort.spend(kBoxUnits);
  if (effort.is_spent()) return false;
  if (is_uniform(entry)) {
    const bool free = static_cast<VoxelValue>(uniform_value(entry)) == VoxelValue::kFree;
    return !free && !intersection(box, Span::cube({0, 0, 0}, edge)).empty();
  }
  const Span overlap = intersection(box, tight_of(entry, edge));
  if (overlap.empty()) return false;
  const std::int64_t child_edge = edge / 8;
  const std::uint32_t* entries = edge == kUpperNodeEdge ? view_.upper_nodes : view_.lower_nodes;
  for (std::int64_t x = overlap.low[0] / child_edge; x * child_edge < overlap.high[0]; ++x) {
    for (std::int64_t y = overlap.low[1] / child_edge; y * child_edge < overlap.high[1]; ++y) {
      for (std::int64_t z = overlap.low[2] / child_edge; z * child_edge < overlap.high[2]; ++z) {
        const auto n = static_cast<std::uint32_t>(x * 64 + y * 8 + z);
        if (edge == kBrickEdge) {
          if (view_.brick_code(entry, n) != 0) return true;
          continue;
        }
        const std::uint32_t child = entries[std::uint64_t{entry} * kNodeEntries + n];
        const Span inside = shifted(overlap, scaled({x, y, z}, child_edge), -1);
        if (entry_holds_non_free(child, child_edge, inside, effort)) return true;
      }
    }
  }
  return false;
}

// Tight boxes of 4^3 directory cells, of 4^3 such groups, and so on up to one group. Without
// them, a look around every free cell of a scene of n cells in a row would take n^2 steps.
void Contents::group_cells() {
  std::array<std::int64_t, 3> dims;
  for (std::size_t axis = 0; axis < 3; ++axis) dims[axis] = view_.directory_dims[axis];
  while (std::max({dims[0], dims[1], dims[2]}) > 1) {
    const std::array<std::int64_t, 3> below = dims;
    for (std::int64_t& cells : dims) cells = (cells + kGroupEdge - 1) / kGroupEdge;
    Groups groups{dims, std::vector<Span>(static_cast<std::size_t>(dims[0] * dims[1] * dims[2]))};
    for (std::int64_t x = 0; x < below[0]; ++x) {
      for (std::int64_t y = 0; y < below[1]; ++y) {
        for (std::int64_t z = 0; z < below[2]; ++z) {
          const Voxel at{x / kGroupEdge, y / kGroupEdge, z / kGroupEdge};
          extend(groups.tight[groups.index(at)], tight_box(groups_.size(), {x, y, z}));
        }
      }
    }
    groups_.push_back(std::move(groups));
  }
}

// The tight box of directory cell `at` at level 0, of a group above it; relative to the
// directory's origin.
Span Contents::tight_box(std::size_t level, const Voxel& at) const {
  if (level > 0) return groups_[level - 1].tight[groups_[level - 1].index(at)];
  const Span box = of_entry(cell(at), kUpperNodeEdge).tight;
  return box.empty() ? box : shifted(box, scaled(at, kUpperNodeEdge), 1);
}

// Level 0: directory cell `at`; else a group.
bool Contents::group_holds_non_free(std::size_t level, const Voxel& at, const Span& box,
                                    Effort& effort) const {
  effort.spend(kBoxUnits);
  if (effort.is_spent()) return false;
  if (level == 0) {
    const Voxel low = scaled(at, kUpperNodeEdge);
    return entry_holds_non_free(cell(at), kUpperNodeEdge, shifted(box, low, -1), effort);
  }
  const Span overlap = intersection(box, tight_box(level, at));
  if (overlap.empty()) return false;
  std::int64_t edge = kUpperNodeEdge;  // of the cells or groups below
  for (std::size_t n = 1; n < level; ++n) edge *= kGroupEdge;
  for (std::int64_t x = overlap.low[0] / edge; x * edge < overlap.high[0]; ++x) {
    for (std::int64_t y = overlap.low[1] / edge; y * edge < overlap.high[1]; ++y) {
      for (std::int64_t z = overlap.low[2] / edge; z * edge < overlap.high[2]; ++z) {
        if (group_holds_non_free(level - 1, {x, y, z}, overlap, effort)) return true;
      }
    }
  }
  return false;
}

std::uint32_t Contents::cell(const Voxel& at) const {
  const auto& dims = view_.directory_dims;
  return view_.directory[(at[0] * dims[1] + at[1]) * dims[2] + at[2]];
}

}  // namespace forcelayer::voxmap_audit
