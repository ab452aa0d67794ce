// A walk over a tree of a voxmap: every uniform box and brick with its place, in the order of the
// file's directory (x slowest, z fastest). It takes no memory. A node that several entries share is
// visited once for each of them.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <string_view>
#include <vector>

#include "formats/result.h"
#include "formats/voxmap.h"

namespace forcelayer {

// One uniform box, or one brick.
struct VoxmapRegion {
  std::array<std::int64_t, 3> low{};  // lowest voxel, world index
  std::uint32_t edge_voxels = 0;      // 512, 64 or 8; of a brick 8
  bool is_brick = false;
  std::uint32_t entry = 0;  // a uniform entry, or a brick's index
};

namespace voxmap_walk {

// The place of entry n of a node at `low` whose entries have `edge` voxels.
inline std::array<std::int64_t, 3> child_low(const std::array<std::int64_t, 3>& low,
                                             std::uint32_t n, std::int64_t edge) {
  return {low[0] + edge * (n >> 6), low[1] + edge * ((n >> 3) & 7), low[2] + edge * (n & 7)};
}

template <std::uint32_t kBits, typename Wanted, typename Visit>
void visit_entry(const TreeView<kBits>& view, std::uint32_t entry,
                 const std::array<std::int64_t, 3>& low, std::uint32_t edge, Wanted& wanted,
                 Visit& visit) {
  if (!wanted(low, std::int64_t{edge})) return;
  if (is_uniform(entry)) {
    visit(VoxmapRegion{low, edge, false, entry});
    return;
  }
  const std::uint32_t child_edge = edge / 8;
  const bool below_are_bricks = edge == kLowerNodeEdge;
  const std::uint32_t* const nodes = below_are_bricks ? view.lower_nodes : view.upper_nodes;
  for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
    const std::uint32_t child = nodes[std::uint64_t{entry} * kNodeEntries + n];
    const auto at = child_low(low, n, child_edge);
    if (below_are_bricks && !is_uniform(child)) {
      if (wanted(at, std::int64_t{child_edge})) visit(VoxmapRegion{at, kBrickEdge, true, child});
    } else {
      visit_entry(view, child, at, child_edge, wanted, visit);
    }
  }
}

}  // namespace voxmap_walk

// Calls visit(const VoxmapRegion&) for every uniform box and brick in boxes of which wanted(low,
// edge) is true: the lowest voxel of a box and its edge in voxels, those of the boxes around it
// first.
template <std::uint32_t kBits, typename Wanted, typename Visit>
void for_each_region_where(const TreeView<kBits>& view, Wanted wanted, Visit visit) {
  const auto& dims = view.directory_dims;
  const std::uint32_t* entry = view.directory;
  for (std::int64_t x = 0; x < dims[0]; ++x) {
    for (std::int64_t y = 0; y < dims[1]; ++y) {
      for (std::int64_t z = 0; z < dims[2]; ++z) {
        voxmap_walk::visit_entry(view, *entry++,
                                 {view.directory_origin[0] + x * kUpperNodeEdge,
                                  view.directory_origin[1] + y * kUpperNodeEdge,
                                  view.directory_origin[2] + z * kUpperNodeEdge},
                                 kUpperNodeEdge, wanted, visit);
      }
    }
  }
}

// The same for every uniform box and brick; the boxes are disjoint and fill the directory.
template <std::uint32_t kBits, typename Visit>
void for_each_region(const TreeView<kBits>& view, Visit visit) {
  for_each_region_where(
      view, [](const std::array<std::int64_t, 3>&, std::int64_t) { return true; }, visit);
}

// How many entries and voxels a walk looks at: the directory, 512 in every brick and in every node
// that enters_node(edge, node) is true of (for_each_region_where()), and in_uniform(code, edge) in
// a uniform box. Looks at each node of the file once.
template <std::uint32_t kBits, typename EntersNode, typename InUniform>
double walk_steps(const TreeView<kBits>& view, const TreeCounts& counts, EntersNode enters_node,
                  InUniform in_uniform) {
  std::vector<double> of_lower(counts.lower_nodes), of_upper(counts.upper_nodes);
  const auto steps_below = [&](std::uint32_t entry, std::uint32_t edge) -> double {
    if (is_uniform(entry)) return in_uniform(TreeView<kBits>::uniform(entry, edge).code, edge);
    if (edge == kBrickEdge) return kNodeEntries;
    if (!enters_node(edge, entry)) return 0;
    return edge == kLowerNodeEdge ? of_lower[entry] : of_upper[entry];
  };
  const auto add_nodes = [&](std::vector<double>& steps, const std::uint32_t* entries,
                             std::uint32_t edge) {
    for (double& of_node : steps) {
      of_node = kNodeEntries;
      for (std::uint32_t n = 0; n < kNodeEntries; ++n) of_node += steps_below(*entries++, edge);
    }
  };
  add_nodes(of_lower, view.lower_nodes, kBrickEdge);
  add_nodes(of_upper, view.upper_nodes, kLowerNodeEdge);
  const auto& dims = view.directory_dims;
  const std::int64_t cells = std::int64_t{dims[0]} * dims[1] * dims[2];
  double steps = static_cast<double>(cells);
  for (std::int64_t n = 0; n < cells; ++n) steps += steps_below(view.directory[n], kUpperNodeEdge);
  return steps;
}

// So many steps take minutes. Bricks that all differ need a file of a gigabyte for them.
inline constexpr double kMaxWalkSteps = 0x1p34;

// Refuses a walk of more steps. `file`: for the error.
inline Status check_walk(double steps, std::string_view file) {
  if (steps <= kMaxWalkSteps) return {};
  char what[160];
  std::snprintf(what, sizeof what,
                "the scene is too large: more than %.2g voxels and entries must be read (repeated "
                "nodes are read each time)",
                kMaxWalkSteps);
  return Error{ErrorCode::kUsage, file, "", what,
               "bake a smaller region (--roi), or with larger voxels"};
}

}  // namespace forcelayer
