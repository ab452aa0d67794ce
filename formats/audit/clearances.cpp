#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "formats/audit/contents.h"
#include "formats/audit/distance_cube.h"
#include "formats/audit/effort.h"
#include "formats/audit/neighborhoods.h"
#include "formats/audit/parts.h"

namespace forcelayer::voxmap_audit {
namespace {

// Units of effort: a node whose distances spread, and one without clearances.
constexpr std::uint64_t kNodeUnits = 700'000, kQuickUnits = 500;

std::int64_t clearance_of(std::uint32_t entry) {
  return is_uniform(entry) && uniform_value(entry) == 0 ? uniform_clearance(entry) : 0;
}

// The clearances inside nodes of one level, whose cells have `edge` voxels.
class NodeClearances {
 public:
  explicit NodeClearances(std::int64_t edge) : edge_(edge) {
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) solid_.add(n, Gaps{});
  }

  // `gaps(entry)` are those of a child that is stored.
  template <class GapsOf>
  void add_node(const std::uint32_t* entries, GapsOf gaps) {
    Ring& ring = rings_.emplace_back();
    std::int64_t& largest = max_.emplace_back(1);
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      largest = std::max(largest, clearance_of(entries[n]));
      if (is_uniform(entries[n])) {
        if (uniform_value(entries[n]) != 0) ring.add(n, Gaps{});
      } else if (const Gaps& own = gaps(entries[n]); own[kCenter] < edge_) {
        ring.add(n, own);
      }
    }
  }

  // Calls doubt(n) for each free entry of the node in the middle whose clearance is more than the
  // cube of distances shows.
  template <class Doubt>
  void check(const std::uint32_t* entries, const Around& around, Doubt doubt) {
    const std::int64_t largest = max_[around[kCenter]];
    if (largest == 1) return;  // they promise their own voxels alone
    const std::int64_t margin = std::min((largest - 2) / edge_ + 1, kCells - 1);
    cube_.clear(margin);
    for (std::size_t d = 0; d < kDirections; ++d) {
      if (!is_uniform(around[d])) {
        cube_.add(rings_[around[d]], d);
      } else if (around[d] != kFreeEntry) {
        cube_.add(solid_, d);
      }
    }
    cube_.spread(static_cast<int>(edge_));
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      // Beyond the margin all is an edge farther for each cell.
      const auto smallest = std::min<std::int64_t>(cube_.at(n), margin * edge_ + 1);
      if (clearance_of(entries[n]) > smallest) doubt(n);
    }
  }

  std::int64_t edge() const { return edge_; }
  // The largest clearance of a node's entries, 1 or more.
  std::int64_t largest(std::uint32_t node) const { return max_[node]; }

 private:
  std::int64_t edge_;
  std::vector<Ring> rings_;
  std::vector<std::int64_t> max_;
  Ring solid_;
  DistanceCube cube_;
};

class ClearanceAudit {
 public:
  ClearanceAudit(const Voxmap& map, const Contents& contents, Effort& effort, std::string_view name)
      : name_(name),
        view_(map.view()),
        contents_(contents),
        known_(known_box(map.header())),
        effort_(effort) {
    for (std::uint64_t n = 0; n < map.lower_node_count(); ++n) {
      bricks_.add_node(lower(n),
                       [&](std::uint32_t b) -> const Gaps& { return contents.brick_gaps(b); });
    }
    for (std::uint64_t n = 0; n < map.upper_node_count(); ++n) {
      nodes_.add_node(upper(n),
                      [&](std::uint32_t b) -> const Gaps& { return contents.node_gaps(b); });
      max_below_.push_back(max_below(upper(n)));
    }
  }

  bool ended() const { return bad_ || effort_.is_spent(); }

  bool cell(const Voxel& low, const Around& around) {
    const std::uint32_t entry = around[kCenter];
    if (is_uniform(entry)) {
      look(low, kUpperNodeEdge, directory_entry(low));
      return false;
    }
    return check(nodes_, upper(entry), low, around, max_below_[entry], cells_);
  }

  void node(const Voxel& low, const Around& around) {
    const std::uint32_t entry = around[kCenter];
    if (!is_uniform(entry)) check(bricks_, lower(entry), low, around, 1, nodes_seen_);
  }

  Status status() const {
    if (bad_) return *bad_;
    return effort_.is_spent() ? Status(strewn(name_)) : Status();
  }

 private:
  const std::uint32_t* lower(std::uint64_t node) const {
    return view_.lower_nodes + node * kNodeEntries;
  }
  const std::uint32_t* upper(std::uint64_t node) const {
    return view_.upper_nodes + node * kNodeEntries;
  }
  // The largest clearance of what an upper node's children hold.
  std::int64_t max_below(const std::uint32_t* entries) const {
    std::int64_t largest = 1;
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      if (!is_uniform(entries[n])) largest = std::max(largest, bricks_.largest(entries[n]));
    }
    return largest;
  }
  std::uint32_t directory_entry(const Voxel& low) const {
    Voxel at;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      at[axis] = (low[axis] - view_.directory_origin[axis]) / kUpperNodeEdge;
    }
    const auto& dims = view_.directory_dims;
    return view_.directory[(at[0] * dims[1] + at[1]) * dims[2] + at[2]];
  }

  bool is_known(const Span& box) const { return known_part(box, known_) == box; }

  // The clearances of a node at `low`; false where it was checked before, with all below it.
  bool check(NodeClearances& level, const std::uint32_t* entries, const Voxel& low,
             const Around& around, std::int64_t below, AroundSet& seen) {
    const Span box = Span::cube(low, kCells * level.edge());
    const std::int64_t largest = level.largest(around[kCenter]);
    const bool known = is_known(grown(box, std::max(largest, below) - 1));
    if (known && !seen.is_new(around, effort_)) return false;
    effort_.spend(largest > 1 ? kNodeUnits : kQuickUnits);
    const auto look_at = [&](std::uint32_t n) {
      look(voxmap_walk::child_low(low, n, level.edge()), level.edge(), entries[n]);
    };
    if (is_known(grown(box, largest - 1))) {
      level.check(entries, around, look_at);
    } else {
      for (std::uint32_t n = 0; n < kNodeEntries; ++n) look_at(n);
    }
    return true;
  }

  // Looks at all that lies within the reach of the clearance of a uniform box.
  void look(const Voxel& low, std::int64_t edge, std::uint32_t entry) {
    const std::int64_t clearance = clearance_of(entry);
    if (clearance == 0 || ended()) return;
    const Span reach = grown(Span::cube(low, edge), clearance - 1);
    const bool known = is_known(reach);
    if (known && !contents_.holds_non_free(shifted(reach, view_.directory_origin, -1), effort_))
      return;
    if (effort_.is_spent()) return;
    bad_ = untrue(name_, "free box of " + std::to_string(edge) + " voxels at " + voxel_text(low),
                  "the clearance " + std::to_string(clearance) + " is wrong: " +
                      (known ? "a voxel that is not free is within that distance"
                             : "a cropped side of the scene is within that distance"));
  }

  std::string_view name_;
  const VoxmapView& view_;
  const Contents& contents_;
  KnownBox known_;
  NodeClearances bricks_{kBrickEdge};
  NodeClearances nodes_{kLowerNodeEdge};
  std::vector<std::int64_t> max_below_;  // [upper node]
  Effort& effort_;
  AroundSet cells_, nodes_seen_;
  std::optional<Error> bad_;
};

}  // namespace

Status audit_clearances(const Voxmap& map, const Contents& contents, Effort& effort,
                        std::string_view name) {
  const auto audit = std::make_unique<ClearanceAudit>(map, contents, effort, name);
  NeighborhoodWalk walk(map.view(), *audit, effort);
  walk.run();
  return audit->status();
}

}  // namespace forcelayer::voxmap_audit
