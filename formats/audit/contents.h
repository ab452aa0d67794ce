// The content of every stored brick and node of a tree of values: numbers of voxels, tight box,
// gaps. An element that many entries share is looked at once. Internal to formats/audit/.
#pragma once

#include <vector>

#include "formats/audit/brick_facts.h"
#include "formats/audit/effort.h"
#include "formats/audit/parts.h"
#include "formats/voxmap.h"

namespace forcelayer::voxmap_audit {

// The numbers of a cube's voxels of value 1, 2 and 3, and the tight box of these voxels, counted
// from the cube's lowest voxel.
struct Summary {
  std::array<std::uint64_t, 3> counts{};
  Span tight{};

  void add(const Summary& child, const Voxel& at);
};

class Contents {
 public:
  explicit Contents(const Voxmap& map);

  const Summary& scene() const { return scene_; }
  const std::vector<BrickPlanes>& planes() const { return planes_; }

  // The gaps of a brick, at most 8, and of a lower node, at most 64.
  const Gaps& brick_gaps(std::uint32_t brick) const { return bricks_[brick].gaps; }
  const Gaps& node_gaps(std::uint32_t node) const { return node_gaps_[node]; }

  // Whether a box, relative to the directory's origin, holds a voxel that is not free. Any answer
  // where the effort is spent.
  bool holds_non_free(const Span& box, Effort& effort) const {
    return group_holds_non_free(groups_.size(), {0, 0, 0}, box, effort);
  }

 private:
  static constexpr std::int64_t kGroupEdge = 4;

  struct Groups {
    std::array<std::int64_t, 3> dims;
    std::vector<Span> tight;

    std::size_t index(const Voxel& at) const {
      return static_cast<std::size_t>((at[0] * dims[1] + at[1]) * dims[2] + at[2]);
    }
  };

  Summary of_brick(std::uint32_t brick) const;
  Summary of_entry(std::uint32_t entry, std::int64_t edge) const;
  std::vector<Summary> of_nodes(const std::uint32_t* entries, std::uint64_t count,
                                std::int64_t entry_edge) const;
  Gaps gaps_of_node(std::uint32_t node) const;
  void summarize_scene();
  void group_cells();
  Span tight_box(std::size_t level, const Voxel& at) const;
  std::uint32_t cell(const Voxel& at) const;
  Span tight_of(std::uint32_t entry, std::int64_t edge) const;
  bool entry_holds_non_free(std::uint32_t entry, std::int64_t edge, const Span& box,
                            Effort& effort) const;
  bool group_holds_non_free(std::size_t level, const Voxel& at, const Span& box,
                            Effort& effort) const;

  const VoxmapView& view_;
  std::vector<Groups> groups_;  // tight boxes of 4^3 directory cells, of 4^3 such groups, and so on
  std::vector<BrickPlanes> planes_;
  std::vector<BrickFacts> bricks_;
  std::vector<Summary> lower_, upper_;
  std::vector<Gaps> node_gaps_;
  Summary scene_;
};

}  // namespace forcelayer::voxmap_audit
