#include "formats/audit/voxmap_audit.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "formats/audit/parts.h"
#include "formats/voxmap_walk.h"

namespace forcelayer {
namespace {

using voxmap_audit::untrue;
using voxmap_audit::Voxel;

// Half-open, relative to the directory's origin or to a node's lowest voxel.
struct Box {
  Voxel low{0, 0, 0};
  Voxel high{0, 0, 0};

  bool empty() const { return low[0] >= high[0] || low[1] >= high[1] || low[2] >= high[2]; }
};

Box intersection(const Box& a, const Box& b) {
  Box both;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    both.low[axis] = std::max(a.low[axis], b.low[axis]);
    both.high[axis] = std::min(a.high[axis], b.high[axis]);
  }
  return both;
}

Box shifted(Box box, const Voxel& by, std::int64_t sign) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] += sign * by[axis];
    box.high[axis] += sign * by[axis];
  }
  return box;
}

Voxel scaled(const Voxel& at, std::int64_t edge) {
  return {at[0] * edge, at[1] * edge, at[2] * edge};
}

// Makes `box` hold `other` too.
void extend(Box& box, const Box& other) {
  if (other.empty()) return;
  if (box.empty()) box = other;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(box.low[axis], other.low[axis]);
    box.high[axis] = std::max(box.high[axis], other.high[axis]);
  }
}

Box cube(std::int64_t edge) { return {{0, 0, 0}, {edge, edge, edge}}; }

// The content of a node or brick: the number of voxels of values 1, 2 and 3, and their tight box
// relative to its lowest voxel.
struct Summary {
  std::array<std::uint64_t, 3> counts{};
  Box tight{};

  void add(const Summary& child, const Voxel& at) {
    if (child.tight.empty()) return;
    extend(tight, shifted(child.tight, at, 1));
    for (std::size_t n = 0; n < 3; ++n) counts[n] += child.counts[n];
  }
};

// The summaries of all stored elements, from the bricks up; a shared element has one.
class Summaries {
 public:
  explicit Summaries(const Voxmap& map) : view_(map.view()) {
    bricks_.reserve(map.brick_count());
    for (std::uint32_t b = 0; b < map.brick_count(); ++b) bricks_.push_back(of_brick(b));
    lower_ = of_nodes(view_.lower_nodes, map.lower_node_count(), kBrickEdge, bricks_);
    upper_ = of_nodes(view_.upper_nodes, map.upper_node_count(), kLowerNodeEdge, lower_);
    const auto& dims = view_.directory_dims;
    std::size_t entry = 0;
    for (std::int64_t x = 0; x < dims[0]; ++x) {
      for (std::int64_t y = 0; y < dims[1]; ++y) {
        for (std::int64_t z = 0; z < dims[2]; ++z) {
          scene_.add(of_entry(view_.directory[entry++], kUpperNodeEdge, upper_),
                     {x * kUpperNodeEdge, y * kUpperNodeEdge, z * kUpperNodeEdge});
        }
      }
    }
    group_cells();
  }

  const Summary& scene() const { return scene_; }

  // Whether a box, relative to the directory's origin, holds a voxel that is not free.
  bool holds_non_free(const Box& box) const {
    return group_holds_non_free(groups_.size(), {0, 0, 0}, box);
  }

 private:
  Summary of_brick(std::uint32_t brick) const {
    Summary summary;
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      const VoxelValue value = static_cast<VoxelValue>(view_.brick_code(brick, n));
      if (value != VoxelValue::kFree) {
        summary.add(full(value, 1), voxmap_walk::child_low({0, 0, 0}, n, 1));
      }
    }
    return summary;
  }

  static Summary full(VoxelValue value, std::int64_t edge) {
    Summary summary;
    if (value == VoxelValue::kFree) return summary;
    summary.counts[static_cast<std::size_t>(value) - 1] =
        static_cast<std::uint64_t>(edge * edge * edge);
    summary.tight = cube(edge);
    return summary;
  }

  Summary of_entry(std::uint32_t entry, std::int64_t edge,
                   const std::vector<Summary>& children) const {
    if (!is_uniform(entry)) return children[entry];
    return full(static_cast<VoxelValue>(uniform_value(entry)), edge);
  }

  std::vector<Summary> of_nodes(const std::uint32_t* entries, std::uint64_t count,
                                std::int64_t entry_edge,
                                const std::vector<Summary>& children) const {
    std::vector<Summary> summaries(count);
    for (std::uint64_t node = 0; node < count; ++node) {
      for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
        summaries[node].add(of_entry(entries[node * kNodeEntries + n], entry_edge, children),
                            voxmap_walk::child_low({0, 0, 0}, n, entry_edge));
      }
    }
    return summaries;
  }

  // `box` is relative to the entry's lowest voxel.
  bool entry_holds_non_free(std::uint32_t entry, std::int64_t edge, const Box& box) const {
    if (is_uniform(entry)) {
      const bool free = static_cast<VoxelValue>(uniform_value(entry)) == VoxelValue::kFree;
      return !free && !intersection(box, cube(edge)).empty();
    }
    const std::vector<Summary>& level = edge == kUpperNodeEdge   ? upper_
                                        : edge == kLowerNodeEdge ? lower_
                                                                 : bricks_;
    const Box overlap = intersection(box, level[entry].tight);
    if (overlap.empty()) return false;
    const std::int64_t child_edge = edge / 8;
    for (std::int64_t x = overlap.low[0] / child_edge; x * child_edge < overlap.high[0]; ++x) {
      for (std::int64_t y = overlap.low[1] / child_edge; y * child_edge < overlap.high[1]; ++y) {
        for (std::int64_t z = overlap.low[2] / child_edge; z * child_edge < overlap.high[2]; ++z) {
          const auto n = static_cast<std::uint32_t>(x * 64 + y * 8 + z);
          const Voxel at{x * child_edge, y * child_edge, z * child_edge};
          if (child_holds_non_free(entry, n, edge, shifted(overlap, at, -1))) return true;
        }
      }
    }
    return false;
  }

  bool child_holds_non_free(std::uint32_t node, std::uint32_t n, std::int64_t edge,
                            const Box& box) const {
    if (edge == kBrickEdge) {
      return static_cast<VoxelValue>(view_.brick_code(node, n)) != VoxelValue::kFree;
    }
    const std::uint32_t* entries = edge == kUpperNodeEdge ? view_.upper_nodes : view_.lower_nodes;
    return entry_holds_non_free(entries[std::uint64_t{node} * kNodeEntries + n], edge / 8, box);
  }

  // Tight boxes of 4^3 directory cells, of 4^3 such groups, and so on up to one group. Without
  // them, a look around every free cell of a scene of n cells in a row would take n^2 steps.
  void group_cells() {
    std::array<std::int64_t, 3> dims;
    for (std::size_t axis = 0; axis < 3; ++axis) dims[axis] = view_.directory_dims[axis];
    while (std::max({dims[0], dims[1], dims[2]}) > 1) {
      const std::array<std::int64_t, 3> below = dims;
      for (std::int64_t& cells : dims) cells = (cells + kGroupEdge - 1) / kGroupEdge;
      Groups groups{dims, std::vector<Box>(static_cast<std::size_t>(dims[0] * dims[1] * dims[2]))};
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
  Box tight_box(std::size_t level, const Voxel& at) const {
    if (level > 0) return groups_[level - 1].tight[groups_[level - 1].index(at)];
    const Box box = of_entry(cell(at), kUpperNodeEdge, upper_).tight;
    return box.empty() ? box : shifted(box, scaled(at, kUpperNodeEdge), 1);
  }

  // Level 0: directory cell `at`; else a group.
  bool group_holds_non_free(std::size_t level, const Voxel& at, const Box& box) const {
    if (level == 0) {
      const Voxel low = scaled(at, kUpperNodeEdge);
      return entry_holds_non_free(cell(at), kUpperNodeEdge, shifted(box, low, -1));
    }
    const Box overlap = intersection(box, tight_box(level, at));
    if (overlap.empty()) return false;
    std::int64_t edge = kUpperNodeEdge;  // of the cells or groups below
    for (std::size_t n = 1; n < level; ++n) edge *= kGroupEdge;
    for (std::int64_t x = overlap.low[0] / edge; x * edge < overlap.high[0]; ++x) {
      for (std::int64_t y = overlap.low[1] / edge; y * edge < overlap.high[1]; ++y) {
        for (std::int64_t z = overlap.low[2] / edge; z * edge < overlap.high[2]; ++z) {
          if (group_holds_non_free(level - 1, {x, y, z}, overlap)) return true;
        }
      }
    }
    return false;
  }

  std::uint32_t cell(const Voxel& at) const {
    const auto& dims = view_.directory_dims;
    return view_.directory[(at[0] * dims[1] + at[1]) * dims[2] + at[2]];
  }

  static constexpr std::int64_t kGroupEdge = 4;

  struct Groups {
    std::array<std::int64_t, 3> dims;
    std::vector<Box> tight;

    std::size_t index(const Voxel& at) const {
      return static_cast<std::size_t>((at[0] * dims[1] + at[1]) * dims[2] + at[2]);
    }
  };

  const VoxmapView& view_;
  std::vector<Groups> groups_;  // from the smallest on
  std::vector<Summary> bricks_, lower_, upper_;
  Summary scene_;
};

Status audit_counts(const VoxmapHeader& h, const Summary& scene, std::string_view name) {
  const struct {
    const char* field;
    std::uint64_t said, counted;
  } facts[] = {{"interior_voxels", h.interior_voxels, scene.counts[0]},
               {"surface_voxels", h.surface_voxels, scene.counts[1]},
               {"proximity_voxels", h.proximity_voxels, scene.counts[2]}};
  for (const auto& [field, said, counted] : facts) {
    if (said == counted) continue;
    return untrue(name, std::string("header (") + field + ")",
                  "says " + std::to_string(said) + ", the tree holds " + std::to_string(counted));
  }
  return {};
}

Status audit_tight_box(const VoxmapHeader& h, const Summary& scene, std::string_view name) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t extent = scene.tight.high[axis] - scene.tight.low[axis];
    const std::int64_t low = extent == 0 ? 0 : h.directory_origin[axis] + scene.tight.low[axis];
    if (h.origin_voxel[axis] == low && h.dims_voxels[axis] == static_cast<std::uint64_t>(extent)) {
      continue;
    }
    return untrue(name, "header (origin_voxel, dims_voxels)",
                  "not the tight box of the voxels: along axis " + std::to_string(axis) +
                      " it is " + std::to_string(extent) + " voxels from " + std::to_string(low));
  }
  return {};
}

// Whether a box of world voxels lies inside the valid box at all cropped sides.
bool is_known(const VoxmapHeader& h, const Box& world) {
  const KnownBox known = known_box(h);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (world.low[axis] < known.low[axis] || world.high[axis] > known.high[axis]) return false;
  }
  return true;
}

// The reason why the region's clearance is not true; nothing where it is.
std::optional<std::string> untrue_clearance(const VoxmapHeader& h, const Summaries& summaries,
                                            const VoxmapRegion& region) {
  const std::int64_t clearance = uniform_clearance(region.entry);
  if (region.is_brick || clearance == 0) return std::nullopt;
  Box reach;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    reach.low[axis] = region.low[axis] - (clearance - 1);
    reach.high[axis] = region.low[axis] + region.edge_voxels + (clearance - 1);
  }
  if (!is_known(h, reach)) return "reaches across a cropped side";
  if (!summaries.holds_non_free(shifted(reach, h.directory_origin, -1))) return std::nullopt;
  return "a voxel within its reach is not free";
}

Status audit_clearances(const Voxmap& map, const Summaries& summaries, std::string_view name) {
  Status status;
  for_each_region(map.view(), [&](const VoxmapRegion& region) {
    if (!status) return;
    const auto reason = untrue_clearance(map.header(), summaries, region);
    if (!reason) return;
    const Voxel& low = region.low;
    status = untrue(name,
                    "free box of " + std::to_string(region.edge_voxels) + " voxels at voxel " +
                        std::to_string(low[0]) + " " + std::to_string(low[1]) + " " +
                        std::to_string(low[2]),
                    "its clearance " + std::to_string(uniform_clearance(region.entry)) +
                        " is not true: " + *reason);
  });
  return status;
}

}  // namespace

Status audit_voxmap(const Voxmap& map, std::string_view name) {
  const Summaries summaries(map);
  if (Status s = audit_counts(map.header(), summaries.scene(), name); !s) return s;
  if (Status s = audit_tight_box(map.header(), summaries.scene(), name); !s) return s;
  if (Status s = audit_clearances(map, summaries, name); !s) return s;
  if (Status s = voxmap_audit::audit_layers(map, name); !s) return s;
  if (Status s = voxmap_audit::audit_distances(map, name); !s) return s;
  return voxmap_audit::audit_objects(map, name);
}

}  // namespace forcelayer
