#include "voxelize/fill/flood.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <memory>
#include <vector>

#include "formats/lattice/brick_bits.h"

namespace forcelayer::fill {
namespace {

// The flood runs on three scales, each an 8x8x8 mask: voxels of a brick, bricks of a 64^3 node,
// nodes of a directory cell (512^3 voxels). A cube without surface is one bit of the scale above.
// Nodes with surface are filled in parallel, round by round, and read their neighbors' sides as
// they stand. A node that changes a side wakes the neighbor for the next round. The fixed point
// depends on no order.

// A node that holds surface.
struct FloodNode {
  const masks::LowerMaskNode* geometry = nullptr;
  lattice::BrickMask surface_bricks;         // bricks that hold surface
  lattice::BrickMask reached_bricks;         // reached bricks among the others
  std::vector<lattice::BrickMask> reached;   // [surface bricks, ascending] voxels
  std::array<std::uint16_t, 512> number_of;  // of each surface brick
  std::size_t cell = 0;                      // the node's directory cell
  unsigned entry = 0;                        // of the directory cell
  unsigned woken_sides = 0;                  // bit per side whose neighbor changed
  unsigned changed_sides = 0;                // bit per side that the last fill changed
  struct Seed {
    unsigned brick, voxel;
  };
  std::vector<Seed> seeds;  // to flood from in the next fill

  lattice::BrickMask& reached_voxels(unsigned n) { return reached[number_of[n]]; }
  const lattice::BrickMask& reached_voxels(unsigned n) const { return reached[number_of[n]]; }
  const std::uint64_t* surface_words(unsigned n) const {
    return masks::words_of(*geometry->getTable()[n].getChild());
  }
};

// A directory cell that holds surface.
struct FloodCell {
  lattice::BrickMask surface_nodes;
  lattice::BrickMask reached_nodes;  // reached nodes among the others
  lattice::BrickMask seeds;          // nodes that a neighboring node has opened
  std::array<std::uint32_t, 512> node_of{};
};

// The state of a directory cell without surface; of any other it is a FloodCell's number.
constexpr std::int32_t kUnreached = -1;
constexpr std::int32_t kReached = -2;
constexpr std::size_t kOutside = SIZE_MAX;  // beyond the object's cells, reached from the start

lattice::BrickMask load(const lattice::BrickMask& mask) {
  lattice::BrickMask copy;
  for (std::size_t x = 0; x < 8; ++x) {
    copy.words[x] =
        std::atomic_ref(const_cast<std::uint64_t&>(mask.words[x])).load(std::memory_order_relaxed);
  }
  return copy;
}

void store(lattice::BrickMask& mask, const lattice::BrickMask& value) {
  for (std::size_t x = 0; x < 8; ++x) {
    std::atomic_ref(mask.words[x]).store(value.words[x], std::memory_order_relaxed);
  }
}

// The neighbor of a node across one side: a node with surface, or a cube that is reached or not.
struct Neighbor {
  const FloodNode* node = nullptr;
  bool reached = false;

  // The reached voxels of its brick n.
  lattice::BrickMask brick(unsigned n) const {
    if (node == nullptr) return reached ? lattice::full_mask() : lattice::BrickMask{};
    if (test(node->surface_bricks, n)) return load(node->reached_voxels(n));
    return test(load(node->reached_bricks), n) ? lattice::full_mask() : lattice::BrickMask{};
  }
};

// The flood inside one node. A brick pushes the voxels that it gains to the bricks next to it,
// until no brick gains any.
class NodeFill {
 public:
  // Voxels of a node's surface bricks to flood from; any content.
  using Pending = std::array<lattice::BrickMask, 512>;

  NodeFill(FloodNode& node, Pending& pending) : node_(node), pending_(pending) {}

  // Takes in the voxels that the node across `side` has reached.
  void pull(int side, const Neighbor& neighbor) {
    lattice::for_each_set(lattice::side_cells(~node_.reached_bricks, side), [&](unsigned n) {
      if (test(node_.surface_bricks, n) && !lattice::any_on_side(unreached_voxels(n), side)) return;
      push(n, lattice::across(neighbor.brick(lattice::stepped(n, side)), side));
    });
  }

  // Reaches the open voxels among `voxels` of brick n.
  void push(unsigned n, const lattice::BrickMask& voxels) {
    if (!test(node_.surface_bricks, n)) {
      if (!test(node_.reached_bricks, n) && voxels.any()) set(empty_seeds_, n);
      return;
    }
    const std::uint64_t* surface = node_.surface_words(n);
    const lattice::BrickMask& reached = node_.reached_voxels(n);
    lattice::BrickMask& pending = pending_[node_.number_of[n]];
    if (!test(dirty_, n)) pending = {};
    std::uint64_t any = 0;
    for (std::size_t x = 0; x < 8; ++x) {
      const std::uint64_t fresh = voxels.words[x] & ~(surface[x] | reached.words[x]);
      pending.words[x] |= fresh;
      any |= fresh;
    }
    if (any != 0) set(dirty_, n);
  }

  void run() {
    for (;;) {
      if (empty_seeds_.any()) fill_empty_bricks();
      const lattice::BrickMask todo = dirty_;
      if (!todo.any()) return;
      lattice::for_each_set(todo, [&](unsigned n) { fill_surface_brick(n); });
    }
  }

 private:
  // The voxels of a surface brick that are neither surface nor reached.
  lattice::BrickMask unreached_voxels(unsigned n) const {
    const std::uint64_t* surface = node_.surface_words(n);
    const lattice::BrickMask& reached = node_.reached_voxels(n);
    lattice::BrickMask voxels;
    for (std::size_t x = 0; x < 8; ++x) voxels.words[x] = ~(surface[x] | reached.words[x]);
    return voxels;
  }

  void fill_empty_bricks() {
    const lattice::BrickMask unreached = ~(node_.surface_bricks | node_.reached_bricks);
    const lattice::BrickMask added = lattice::flooded(empty_seeds_, unreached);
    empty_seeds_ = {};
    store(node_.reached_bricks, node_.reached_bricks | added);
    for (int side = 0; side < lattice::kSides; ++side) {
      const lattice::BrickMask flow =
          lattice::across(lattice::full_mask(), lattice::opposite(side));
      lattice::for_each_set(lattice::shifted(added, side) & node_.surface_bricks,
                            [&](unsigned n) { push(n, flow); });
      if (lattice::any_on_side(added, side)) node_.changed_sides |= 1u << side;
    }
  }

  void fill_surface_brick(unsigned n) {
    lattice::BrickMask& reached = node_.reached_voxels(n);
    const lattice::BrickMask added =
        lattice::flooded(pending_[node_.number_of[n]], unreached_voxels(n));
    dirty_.words[n >> 6] &= ~(std::uint64_t{1} << (n & 63));
    store(reached, reached | added);
    for (int side = 0; side < lattice::kSides; ++side) {
      if (!lattice::any_on_side(added, side)) continue;
      if (lattice::lies_on(n, side)) {
        node_.changed_sides |= 1u << side;
      } else {
        push(lattice::stepped(n, side), lattice::across(added, lattice::opposite(side)));
      }
    }
  }

  FloodNode& node_;
  lattice::BrickMask dirty_;        // surface bricks with something pending
  lattice::BrickMask empty_seeds_;  // bricks without surface to flood from
  Pending& pending_;                // [surface bricks] defined where dirty
};

class Flood {
 public:
  explicit Flood(const masks::MaskTree& geometry);

  void run(std::span<const masks::Coord> seeds);
  std::unique_ptr<masks::MaskTree> interior() const;

 private:
  struct NodePlace {
    std::size_t cell;
    unsigned entry;
  };

  std::size_t cell_at(const masks::Coord& voxel) const;
  std::size_t cell_across(std::size_t cell, int side) const;
  masks::Coord cell_origin(std::size_t cell) const;
  FloodCell* surface_cell(std::size_t cell) {
    return states_[cell] >= 0 ? &cells_[static_cast<std::size_t>(states_[cell])] : nullptr;
  }
  const FloodCell* surface_cell(std::size_t cell) const {
    return const_cast<Flood*>(this)->surface_cell(cell);
  }
  NodePlace node_across(const FloodNode& node, int side) const;
  Neighbor neighbor(const FloodNode& node, int side) const;
  lattice::BrickMask inflow(std::size_t cell) const;

  void add_nodes(const masks::MaskTree& geometry);
  void seed(const masks::Coord& voxel);
  void seed_node(std::uint32_t number, unsigned brick, unsigned voxel);
  void fill(FloodNode& node, NodeFill::Pending& pending) const;
  void open_border();
  void wake(std::uint32_t node, int side);
  void wake_all(std::size_t cell, const lattice::BrickMask& entries, int side);
  void announce(std::size_t cell, const lattice::BrickMask& added);
  void spread_cells();
  void tell_neighbors(const FloodNode& node);

  std::array<std::int64_t, 3> low_{}, dims_{};  // of the object's directory cells
  std::vector<std::int32_t> states_;  // [directory cells] number in cells_, or kUnreached/kReached
  std::vector<FloodCell> cells_;
  std::vector<FloodNode> nodes_;
  std::vector<std::size_t> pending_cells_;
  std::vector<std::uint32_t> awake_;
};

Flood::Flood(const masks::MaskTree& geometry) {
  std::array<std::int64_t, 3> high;
  low_.fill(INT64_MAX);
  high.fill(INT64_MIN);
  for (auto cell = geometry.cbeginChildOn(); cell; ++cell) {
    const masks::Coord origin = cell->origin();
    for (std::size_t d = 0; d < 3; ++d) {
      const std::int64_t at = origin[d] >> 9;
      low_[d] = std::min(low_[d], at);
      high[d] = std::max(high[d], at);
    }
  }
  for (std::size_t d = 0; d < 3; ++d) dims_[d] = high[d] - low_[d] + 1;
  states_.assign(static_cast<std::size_t>(dims_[0] * dims_[1] * dims_[2]), kUnreached);
  add_nodes(geometry);
}

void Flood::add_nodes(const masks::MaskTree& geometry) {
  for (auto upper = geometry.cbeginChildOn(); upper; ++upper) {
    const std::size_t cell = cell_at(upper->origin());
    states_[cell] = static_cast<std::int32_t>(cells_.size());
    FloodCell& flood_cell = cells_.emplace_back();
    flood_cell.surface_nodes = masks::mask_of(upper->getChildMask());
    lattice::for_each_set(flood_cell.surface_nodes, [&](unsigned n) {
      flood_cell.node_of[n] = static_cast<std::uint32_t>(nodes_.size());
      FloodNode& node = nodes_.emplace_back();
      node.geometry = upper->getTable()[n].getChild();
      node.cell = cell;
      node.entry = n;
    });
  }
  tbb::parallel_for(std::size_t{0}, nodes_.size(), [&](std::size_t i) {
    FloodNode& node = nodes_[i];
    node.surface_bricks = masks::mask_of(node.geometry->getChildMask());
    std::uint16_t number = 0;
    lattice::for_each_set(node.surface_bricks, [&](unsigned n) { node.number_of[n] = number++; });
    node.reached.resize(number);
  });
}

std::size_t Flood::cell_at(const masks::Coord& voxel) const {
  std::size_t index = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    const std::int64_t at = (voxel[d] >> 9) - low_[d];
    if (at < 0 || at >= dims_[d]) return kOutside;
    index = index * static_cast<std::size_t>(dims_[d]) + static_cast<std::size_t>(at);
  }
  return index;
}

masks::Coord Flood::cell_origin(std::size_t cell) const {
  const auto index = static_cast<std::int64_t>(cell);
  return masks::Coord(static_cast<int>((index / (dims_[1] * dims_[2]) + low_[0]) * 512),
                      static_cast<int>((index / dims_[2] % dims_[1] + low_[1]) * 512),
                      static_cast<int>((index % dims_[2] + low_[2]) * 512));
}

std::size_t Flood::cell_across(std::size_t cell, int side) const {
  constexpr int kStep = 512;
  masks::Coord origin = cell_origin(cell);
  origin[side / 2] += side % 2 == 1 ? kStep : -kStep;
  return cell_at(origin);
}

Flood::NodePlace Flood::node_across(const FloodNode& node, int side) const {
  return {lattice::lies_on(node.entry, side) ? cell_across(node.cell, side) : node.cell,
          lattice::stepped(node.entry, side)};
}

Neighbor Flood::neighbor(const FloodNode& node, int side) const {
  const NodePlace at = node_across(node, side);
  if (at.cell == kOutside) return {nullptr, true};
  const FloodCell* cell = surface_cell(at.cell);
  if (cell == nullptr) return {nullptr, states_[at.cell] == kReached};
  if (test(cell->surface_nodes, at.entry)) return {&nodes_[cell->node_of[at.entry]], false};
  return {nullptr, test(cell->reached_nodes, at.entry)};
}

void Flood::wake(std::uint32_t node, int side) {
  if (nodes_[node].woken_sides == 0 && nodes_[node].seeds.empty()) awake_.push_back(node);
  nodes_[node].woken_sides |= 1u << side;
}

// Wakes the surface nodes among `entries` of a cell: the neighbors across their `side` were
// reached.
void Flood::wake_all(std::size_t cell, const lattice::BrickMask& entries, int side) {
  FloodCell* flood_cell = surface_cell(cell);
  if (flood_cell == nullptr) return;
  lattice::for_each_set(entries & flood_cell->surface_nodes,
                        [&](unsigned n) { wake(flood_cell->node_of[n], side); });
}

// Wakes the neighbors of a cell's newly reached nodes.
void Flood::announce(std::size_t cell, const lattice::BrickMask& added) {
  for (int side = 0; side < lattice::kSides; ++side) {
    wake_all(cell, lattice::shifted(added, side), lattice::opposite(side));
    if (!lattice::any_on_side(added, side)) continue;
    const std::size_t next = cell_across(cell, side);
    if (next == kOutside) continue;
    wake_all(next, lattice::across(added, lattice::opposite(side)), lattice::opposite(side));
    if (states_[next] != kReached) pending_cells_.push_back(next);
  }
}

// The nodes of a cell next to reached nodes, without surface, of other cells.
lattice::BrickMask Flood::inflow(std::size_t cell) const {
  lattice::BrickMask seeds;
  for (int side = 0; side < lattice::kSides; ++side) {
    const std::size_t next = cell_across(cell, side);
    if (next == kOutside || states_[next] == kReached) {
      seeds = seeds | lattice::across(lattice::full_mask(), side);
    } else if (const FloodCell* neighbor = surface_cell(next)) {
      seeds = seeds | lattice::across(neighbor->reached_nodes, side);
    }
  }
  return seeds;
}

void Flood::spread_cells() {
  while (!pending_cells_.empty()) {
    const std::size_t index = pending_cells_.back();
    pending_cells_.pop_back();
    if (states_[index] == kReached) continue;
    if (FloodCell* cell = surface_cell(index)) {
      const lattice::BrickMask unreached = ~(cell->surface_nodes | cell->reached_nodes);
      const lattice::BrickMask added = lattice::flooded(inflow(index) | cell->seeds, unreached);
      cell->reached_nodes = cell->reached_nodes | added;
      cell->seeds = {};
      announce(index, added);
    } else {
      states_[index] = kReached;
      announce(index, lattice::full_mask());
    }
  }
}

// Wakes the neighbors of a node across the sides that its fill changed.
void Flood::tell_neighbors(const FloodNode& node) {
  for (int side = 0; side < lattice::kSides; ++side) {
    if ((node.changed_sides >> side & 1) == 0) continue;
    const NodePlace at = node_across(node, side);
    if (at.cell == kOutside || states_[at.cell] == kReached) continue;
    if (FloodCell* cell = surface_cell(at.cell)) {
      if (test(cell->surface_nodes, at.entry)) {
        wake(cell->node_of[at.entry], lattice::opposite(side));
        continue;
      }
      set(cell->seeds, at.entry);
    }
    pending_cells_.push_back(at.cell);
  }
}

// Everything beyond the object's directory cells is reached.
void Flood::open_border() {
  for (std::size_t cell = 0; cell < states_.size(); ++cell) {
    bool border = false;
    for (int side = 0; side < lattice::kSides; ++side) {
      if (cell_across(cell, side) != kOutside) continue;
      border = true;
      wake_all(cell, lattice::side_cells(lattice::full_mask(), side), side);
    }
    if (border) pending_cells_.push_back(cell);
  }
}

void Flood::seed(const masks::Coord& voxel) {
  const std::size_t index = cell_at(voxel);
  if (index == kOutside) return;
  FloodCell* cell = surface_cell(index);
  if (cell == nullptr) {
    pending_cells_.push_back(index);
    return;
  }
  const unsigned entry = masks::UpperMaskNode::coordToOffset(voxel);
  if (!test(cell->surface_nodes, entry)) {
    set(cell->seeds, entry);
    pending_cells_.push_back(index);
    return;
  }
  seed_node(cell->node_of[entry], masks::LowerMaskNode::coordToOffset(voxel),
            masks::MaskLeaf::coordToOffset(voxel));
}

void Flood::seed_node(std::uint32_t number, unsigned brick, unsigned voxel) {
  FloodNode& node = nodes_[number];
  if (node.woken_sides == 0 && node.seeds.empty()) awake_.push_back(number);
  node.seeds.push_back({brick, voxel});
}

// One round of a node's flood.
void Flood::fill(FloodNode& node, NodeFill::Pending& pending) const {
  NodeFill fill(node, pending);
  node.changed_sides = 0;
  for (int side = 0; side < lattice::kSides; ++side) {
    if (node.woken_sides >> side & 1) fill.pull(side, neighbor(node, side));
  }
  for (const FloodNode::Seed& seed : node.seeds) {
    lattice::BrickMask point;
    set(point, seed.voxel);
    fill.push(seed.brick, point);
  }
  node.woken_sides = 0;
  node.seeds.clear();
  fill.run();
}

void Flood::run(std::span<const masks::Coord> seeds) {
  open_border();
  for (const masks::Coord& voxel : seeds) seed(voxel);
  spread_cells();
  tbb::enumerable_thread_specific<NodeFill::Pending> pending;
  while (!awake_.empty()) {
    const std::vector<std::uint32_t> round = std::move(awake_);
    awake_.clear();
    tbb::parallel_for(std::size_t{0}, round.size(),
                      [&](std::size_t i) { fill(nodes_[round[i]], pending.local()); });
    for (const std::uint32_t node : round) tell_neighbors(nodes_[node]);
    spread_cells();
  }
}

// The interior of a node with surface; null where it has none.
std::unique_ptr<masks::LowerMaskNode> interior_node(const FloodNode& node,
                                                    const masks::Coord& origin) {
  auto result = std::make_unique<masks::LowerMaskNode>(origin, false, false);
  const lattice::BrickMask unreached = ~(node.surface_bricks | node.reached_bricks);
  bool any = unreached.any();
  lattice::for_each_set(unreached, [&](unsigned n) { result->addTile(n, true, true); });
  lattice::for_each_set(node.surface_bricks, [&](unsigned n) {
    const lattice::BrickMask voxels =
        ~(node.reached_voxels(n) | masks::brick_of(*node.geometry->getTable()[n].getChild()));
    if (!voxels.any()) return;
    any = true;
    auto leaf = std::make_unique<masks::MaskLeaf>(masks::entry_origin(origin, n, 8), false);
    masks::assign(*leaf, voxels);
    result->addLeaf(leaf.release());
  });
  return any ? std::move(result) : nullptr;
}

std::unique_ptr<masks::MaskTree> Flood::interior() const {
  std::vector<std::unique_ptr<masks::LowerMaskNode>> nodes(nodes_.size());
  tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) {
    nodes[i] = interior_node(nodes_[i], nodes_[i].geometry->origin());
  });
  auto tree = std::make_unique<masks::MaskTree>();
  for (std::size_t index = 0; index < states_.size(); ++index) {
    const masks::Coord origin = cell_origin(index);
    const FloodCell* cell = surface_cell(index);
    if (cell == nullptr) {
      if (states_[index] == kUnreached) tree->addTile(origin, true, true);
      continue;
    }
    auto upper = std::make_unique<masks::UpperMaskNode>(origin, false, false);
    const lattice::BrickMask unreached = ~(cell->surface_nodes | cell->reached_nodes);
    bool any = unreached.any();
    lattice::for_each_set(unreached, [&](unsigned n) { upper->addTile(n, true, true); });
    lattice::for_each_set(cell->surface_nodes, [&](unsigned n) {
      auto& node = nodes[cell->node_of[n]];
      if (node == nullptr) return;
      any = true;
      upper->addChild(node.release());
    });
    if (any) tree->addChild(upper.release());
  }
  return tree;
}

}  // namespace

std::unique_ptr<masks::MaskTree> flood_interior(const masks::MaskTree& geometry,
                                                std::span<const masks::Coord> seeds) {
  if (geometry.empty()) return std::make_unique<masks::MaskTree>();
  Flood flood(geometry);
  flood.run(seeds);
  return flood.interior();
}

}  // namespace forcelayer::fill
