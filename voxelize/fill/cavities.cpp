#include "voxelize/fill/cavities.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <unordered_map>

#include "formats/lattice/brick_bits.h"

namespace forcelayer::fill {
namespace {

using Id = std::uint32_t;

// A connected set of cells of one 8x8x8 mask: voxels of a brick, whole bricks of a node, whole
// nodes of a directory cell, or one whole directory cell.
struct Cluster {
  masks::Coord origin;  // of the mask
  int cell = 1;         // edge of a cell in voxels
  lattice::BrickMask cells;
};

// The 6-connected sets of a mask.
template <class F>
void for_each_cluster(const lattice::BrickMask& mask, F&& f) {
  lattice::BrickMask rest = mask;
  while (rest.any()) {
    lattice::BrickMask seed;
    for (std::size_t x = 0; x < 8; ++x) {
      if (rest.words[x] == 0) continue;
      seed.words[x] = rest.words[x] & (~rest.words[x] + 1);
      break;
    }
    const lattice::BrickMask cluster = lattice::flooded(seed, rest);
    f(cluster);
    rest = rest & ~cluster;
  }
}

// The clusters in one cell of a mask: some inside it, or one that holds all of it.
struct CellClusters {
  std::vector<std::pair<const Cluster*, Id>> inner;  // of the mask inside the cell
  bool whole = false;
  Id whole_id = 0;
};

// The clusters of one 64^3 node.
struct NodeClusters {
  std::vector<Cluster> clusters;
  std::vector<std::uint32_t> first;  // [513] each brick's first cluster; then those of whole bricks
  lattice::BrickMask whole, partial;  // bricks
  Id base = 0;                        // of clusters[0]
  std::vector<std::pair<Id, Id>> unions;

  explicit NodeClusters(const masks::LowerMaskNode& node) {
    whole = masks::mask_of(node.getValueMask());
    partial = masks::mask_of(node.getChildMask());
    first.assign(513, 0);
    for (unsigned n = 0; n < 512; ++n) {
      first[n] = static_cast<std::uint32_t>(clusters.size());
      if (!test(partial, n)) continue;
      const masks::MaskLeaf& leaf = *node.getTable()[n].getChild();
      for_each_cluster(masks::brick_of(leaf), [&](const lattice::BrickMask& cells) {
        clusters.push_back({leaf.origin(), 1, cells});
      });
    }
    first[512] = static_cast<std::uint32_t>(clusters.size());
    for_each_cluster(whole, [&](const lattice::BrickMask& cells) {
      clusters.push_back({node.origin(), 8, cells});
    });
  }

  CellClusters at(unsigned n) const {
    CellClusters result;
    if (test(whole, n)) {
      result.whole = true;
      std::uint32_t i = first[512];
      while (!test(clusters[i].cells, n)) ++i;
      result.whole_id = base + i;
    }
    for (std::uint32_t i = first[n]; i < first[n + 1]; ++i) {
      result.inner.emplace_back(&clusters[i], base + i);
    }
    return result;
  }
};

// Notes which clusters of cell a touch which clusters of cell b, across `side` of a.
void touch(const CellClusters& a, const CellClusters& b, int side,
           std::vector<std::pair<Id, Id>>& unions) {
  if (a.whole && b.whole) unions.emplace_back(a.whole_id, b.whole_id);
  for (const auto& [cluster, id] : a.inner) {
    if (b.whole && lattice::any_on_side(cluster->cells, side)) unions.emplace_back(id, b.whole_id);
    for (const auto& [other, other_id] : b.inner) {
      if ((lattice::across(cluster->cells, lattice::opposite(side)) & other->cells).any()) {
        unions.emplace_back(id, other_id);
      }
    }
  }
  for (const auto& [other, other_id] : b.inner) {
    if (a.whole && lattice::any_on_side(other->cells, lattice::opposite(side))) {
      unions.emplace_back(a.whole_id, other_id);
    }
  }
}

struct CoordHash {
  std::size_t operator()(const masks::Coord& c) const { return c.hash<20>(); }
};

class Pieces {
 public:
  explicit Pieces(const masks::MaskTree& interior) : interior_(interior) {
    collect();
    join();
  }

  std::vector<InteriorPiece> result();

 private:
  void collect();
  void join();
  void join_node(NodeClusters& node, const masks::Coord& origin) const;
  void join_directory_cells();
  // The cluster of whole nodes or directory cells at a voxel; false where there is none.
  bool coarse(const masks::Coord& voxel, Id& id) const;
  Id root(Id id) {
    while (parents_[id] != id) id = parents_[id] = parents_[parents_[id]];
    return id;
  }

  const masks::MaskTree& interior_;
  std::vector<Cluster> coarse_;  // ids 0..
  std::unordered_map<masks::Coord, std::vector<Id>, CoordHash>
      of_directory_cell_;              // coarse clusters
  std::vector<masks::Coord> origins_;  // of the nodes
  std::vector<NodeClusters> nodes_;
  std::unordered_map<masks::Coord, std::size_t, CoordHash> node_at_;
  std::vector<Id> parents_;
};

void Pieces::collect() {
  for (auto tile = interior_.cbeginValueOn(); tile; ++tile) {
    lattice::BrickMask one;
    set(one, 0);
    of_directory_cell_[tile.getCoord()].push_back(static_cast<Id>(coarse_.size()));
    coarse_.push_back({tile.getCoord(), 512, one});
  }
  std::vector<const masks::LowerMaskNode*> lower;
  for (auto upper = interior_.cbeginChildOn(); upper; ++upper) {
    for_each_cluster(masks::mask_of(upper->getValueMask()), [&](const lattice::BrickMask& cells) {
      of_directory_cell_[upper->origin()].push_back(static_cast<Id>(coarse_.size()));
      coarse_.push_back({upper->origin(), 64, cells});
    });
    for (auto node = upper->cbeginChildOn(); node; ++node) lower.push_back(&*node);
  }
  std::vector<std::optional<NodeClusters>> made(lower.size());
  tbb::parallel_for(std::size_t{0}, lower.size(),
                    [&](std::size_t i) { made[i].emplace(*lower[i]); });
  auto next = static_cast<Id>(coarse_.size());
  for (std::size_t i = 0; i < lower.size(); ++i) {
    node_at_.emplace(lower[i]->origin(), i);
    origins_.push_back(lower[i]->origin());
    made[i]->base = next;
    next += static_cast<Id>(made[i]->clusters.size());
    nodes_.push_back(std::move(*made[i]));
  }
  parents_.resize(next);
  std::iota(parents_.begin(), parents_.end(), Id{0});
}

bool Pieces::coarse(const masks::Coord& voxel, Id& id) const {
  const masks::Coord cell(voxel.x() & ~511, voxel.y() & ~511, voxel.z() & ~511);
  const auto found = of_directory_cell_.find(cell);
  if (found == of_directory_cell_.end()) return false;
  const unsigned place = masks::UpperMaskNode::coordToOffset(voxel);
  for (const Id candidate : found->second) {
    const Cluster& cluster = coarse_[candidate];
    if (cluster.cell == 512 || test(cluster.cells, place)) {
      id = candidate;
      return true;
    }
  }
  return false;
}

// Joins clusters inside a node, across its far sides to other nodes, and across all sides to whole
// nodes.
void Pieces::join_node(NodeClusters& node, const masks::Coord& origin) const {
  const lattice::BrickMask used = node.whole | node.partial;
  for (int side = 0; side < lattice::kSides; ++side) {
    masks::Coord next_origin = origin;
    next_origin[side / 2] += side % 2 == 1 ? 64 : -64;
    const auto found = node_at_.find(next_origin);
    const NodeClusters* next = found == node_at_.end() ? nullptr : &nodes_[found->second];
    CellClusters solid;
    solid.whole = next == nullptr && coarse(next_origin, solid.whole_id);
    lattice::for_each_set(used, [&](unsigned n) {
      if (!lattice::lies_on(n, side)) {
        const unsigned m = lattice::stepped(n, side);
        if (side % 2 == 1 && test(used, m) && !(test(node.whole, n) && test(node.whole, m))) {
          touch(node.at(n), node.at(m), side, node.unions);
        }
      } else if (next != nullptr && side % 2 == 1) {
        touch(node.at(n), next->at(lattice::stepped(n, side)), side, node.unions);
      } else if (solid.whole) {
        touch(node.at(n), solid, side, node.unions);
      }
    });
  }
}

// Joins whole nodes and directory cells across the far sides of directory cells.
void Pieces::join_directory_cells() {
  const auto join_two = [&](Id a, Id b) { parents_[root(a)] = root(b); };
  for (const auto& [origin, ids] : of_directory_cell_) {
    for (const Id id : ids) {
      const lattice::BrickMask cells =
          coarse_[id].cell == 512 ? lattice::full_mask() : coarse_[id].cells;
      for (const int side : {1, 3, 5}) {
        masks::Coord next = origin;
        next[side / 2] += 512;
        const auto found = of_directory_cell_.find(next);
        if (found == of_directory_cell_.end()) continue;
        for (const Id other : found->second) {
          const lattice::BrickMask others =
              coarse_[other].cell == 512 ? lattice::full_mask() : coarse_[other].cells;
          if ((lattice::across(cells, lattice::opposite(side)) & others).any()) join_two(id, other);
        }
      }
    }
  }
}

void Pieces::join() {
  tbb::parallel_for(std::size_t{0}, nodes_.size(),
                    [&](std::size_t i) { join_node(nodes_[i], origins_[i]); });
  for (NodeClusters& node : nodes_) {
    for (const auto& [a, b] : node.unions) parents_[root(a)] = root(b);
    node.unions = {};
  }
  join_directory_cells();
}

std::vector<InteriorPiece> Pieces::result() {
  struct JoinedPiece {
    InteriorPiece piece;
    int cell = 0;
  };
  std::unordered_map<Id, JoinedPiece> pieces;
  const auto add = [&](const Cluster& cluster, Id id) {
    JoinedPiece& found = pieces[root(id)];
    const auto cell = static_cast<std::uint64_t>(cluster.cell);
    found.piece.voxels += static_cast<std::uint64_t>(count(cluster.cells)) * cell * cell * cell;
    unsigned n = 0;
    while (!test(cluster.cells, n)) ++n;
    const masks::Coord seed =
        masks::entry_origin(cluster.origin, n, cluster.cell).offsetBy(cluster.cell / 2);
    // The middle of the largest cell; the first of those, so that it depends on the voxels alone.
    if (cluster.cell > found.cell || (cluster.cell == found.cell && seed < found.piece.seed)) {
      found.cell = cluster.cell;
      found.piece.seed = seed;
    }
  };
  for (std::size_t i = 0; i < coarse_.size(); ++i) add(coarse_[i], static_cast<Id>(i));
  for (const NodeClusters& node : nodes_) {
    for (std::size_t i = 0; i < node.clusters.size(); ++i) {
      add(node.clusters[i], node.base + static_cast<Id>(i));
    }
  }
  std::vector<InteriorPiece> result;
  for (const auto& [id, found] : pieces) result.push_back(found.piece);
  std::sort(result.begin(), result.end(), [](const InteriorPiece& a, const InteriorPiece& b) {
    return a.voxels != b.voxels ? a.voxels > b.voxels : a.seed < b.seed;
  });
  return result;
}

}  // namespace

std::vector<InteriorPiece> interior_pieces(const masks::MaskTree& interior) {
  return Pieces(interior).result();
}

}  // namespace forcelayer::fill
