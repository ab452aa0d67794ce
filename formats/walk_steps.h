// How long a walk over a tree of a voxmap takes. Equal nodes are stored once and can stand in many
// positions, so a small file can describe more than anyone can look at.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "formats/result.h"
#include "formats/voxmap.h"

namespace forcelayer {

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
                "the scene repeats nodes so often that more than %.2g voxels and entries must be "
                "looked at",
                kMaxWalkSteps);
  return Error{ErrorCode::kUsage, file, "", what,
               "bake a smaller region (--roi), or with larger voxels"};
}

}  // namespace forcelayer
