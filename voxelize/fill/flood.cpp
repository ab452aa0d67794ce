#include "voxelize/fill/flood.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <memory>
#include <vector>

#include "voxelize/masks/brick_bits.h"

namespace forcelayer {
namespace {

// The flood runs on three scales: voxels of a brick, bricks of a 64^3 node, nodes of a 512^3 block,
// each an 8x8x8 mask of cells. What holds no surface is one cell of the scale above. Nodes with
// surface are filled in parallel, round by round, reading their neighbours' sides as they stand;
// who changes a side wakes the neighbour for the next round. The fixed point depends on no order.

// A node that holds surface.
struct FloodNode {
  const LowerMaskNode* geometry = nullptr;
  BrickMask surface_bricks;                  // that hold surface
  BrickMask reached_bricks;                  // of those without
  std::vector<BrickMask> reached;            // [surface bricks, ascending] voxels
  std::array<std::uint16_t, 512> number_of;  // of each surface brick
  std::size_t block = 0;                     // where the node stands
  unsigned place = 0;
  unsigned woken_sides = 0;    // bit per side whose neighbour changed
  unsigned changed_sides = 0;  // bit per side that the last fill changed
  struct Seed {
    unsigned brick, voxel;
  };
  std::vector<Seed> seeds;  // to flood from in the next fill

  BrickMask& reached_voxels(unsigned n) { return reached[number_of[n]]; }
  const BrickMask& reached_voxels(unsigned n) const { return reached[number_of[n]]; }
  const std::uint64_t* surface_words(unsigned n) const {
    return words_of(*geometry->getTable()[n].getChild());
  }
};

// A block that holds surface.
struct FloodBlock {
  BrickMask surface_nodes;
  BrickMask reached_nodes;  // of those without
  BrickMask seeds;          // cells that a neighbouring node has opened
  std::array<std::uint32_t, 512> node_of{};
};

// A block without surface is one of these instead of a FloodBlock's number.
constexpr std::int32_t kUnreached = -1;
constexpr std::int32_t kReached = -2;
constexpr std::size_t kOutside = SIZE_MAX;  // beyond the object's blocks, reached from the start

BrickMask load(const BrickMask& mask) {
  BrickMask copy;
  for (std::size_t x = 0; x < 8; ++x) {
    copy.words[x] =
        std::atomic_ref(const_cast<std::uint64_t&>(mask.words[x])).load(std::memory_order_relaxed);
  }
  return copy;
}

void store(BrickMask& mask, const BrickMask& value) {
  for (std::size_t x = 0; x < 8; ++x) {
    std::atomic_ref(mask.words[x]).store(value.words[x], std::memory_order_relaxed);
  }
}

// What a node sees across one side: a node with surface, or a cell that is reached or not.
struct Neighbor {
  const FloodNode* node = nullptr;
  bool reached = false;

  // The reached voxels of its brick n.
  BrickMask brick(unsigned n) const {
    if (node == nullptr) return reached ? full_mask() : BrickMask{};
    if (test(node->surface_bricks, n)) return load(node->reached_voxels(n));
    return test(load(node->reached_bricks), n) ? full_mask() : BrickMask{};
  }
};

// The flood inside one node, until nothing more is reached. What a brick gains is pushed to the
// bricks next to it, as far as it is new to them.
class NodeFill {
 public:
  // Voxels of a node's surface bricks to flood from; any content.
  using Pending = std::array<BrickMask, 512>;

  NodeFill(FloodNode& node, Pending& pending) : node_(node), pending_(pending) {}

  // Takes in what the node across `side` has reached.
  void pull(int side, const Neighbor& neighbor) {
    for_each_set(side_cells(~node_.reached_bricks, side), [&](unsigned n) {
      if (test(node_.surface_bricks, n) && !any_on_side(unreached_voxels(n), side)) return;
      push(n, across(neighbor.brick(stepped(n, side)), side));
    });
  }

  // Reaches the open voxels among `voxels` of brick n.
  void push(unsigned n, const BrickMask& voxels) {
    if (!test(node_.surface_bricks, n)) {
      if (!test(node_.reached_bricks, n) && voxels.any()) set(empty_seeds_, n);
      return;
    }
    const std::uint64_t* surface = node_.surface_words(n);
    const BrickMask& reached = node_.reached_voxels(n);
    BrickMask& pending = pending_[node_.number_of[n]];
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
      const BrickMask todo = dirty_;
      if (!todo.any()) return;
      for_each_set(todo, [&](unsigned n) { fill_surface_brick(n); });
    }
  }

 private:
  // Of a surface brick, neither surface nor reached.
  BrickMask unreached_voxels(unsigned n) const {
    const std::uint64_t* surface = node_.surface_words(n);
    const BrickMask& reached = node_.reached_voxels(n);
    BrickMask voxels;
    for (std::size_t x = 0; x < 8; ++x) voxels.words[x] = ~(surface[x] | reached.words[x]);
    return voxels;
  }

  void fill_empty_bricks() {
    const BrickMask unreached = ~(node_.surface_bricks | node_.reached_bricks);
    const BrickMask added = flooded(empty_seeds_, unreached);
    empty_seeds_ = {};
    store(node_.reached_bricks, node_.reached_bricks | added);
    for (int side = 0; side < kSides; ++side) {
      const BrickMask flow = across(full_mask(), opposite(side));
      for_each_set(shifted(added, side) & node_.surface_bricks, [&](unsigned n) { push(n, flow); });
      if (any_on_side(added, side)) node_.changed_sides |= 1u << side;
    }
  }

  void fill_surface_brick(unsigned n) {
    BrickMask& reached = node_.reached_voxels(n);
    const BrickMask added = flooded(pending_[node_.number_of[n]], unreached_voxels(n));
    dirty_.words[n >> 6] &= ~(std::uint64_t{1} << (n & 63));
    store(reached, reached | added);
    for (int side = 0; side < kSides; ++side) {
      if (!any_on_side(added, side)) continue;
      if (lies_on(n, side)) {
        node_.changed_sides |= 1u << side;
      } else {
        push(stepped(n, side), across(added, opposite(side)));
      }
    }
  }

  FloodNode& node_;
  BrickMask dirty_;        // surface bricks with something pending
  BrickMask empty_seeds_;  // bricks without surface that something has reached
  Pending& pending_;       // [surface bricks] set where dirty
};

class Flood {
 public:
  explicit Flood(const MaskTree& geometry);

  void run(std::span<const Coord> seeds);
  std::unique_ptr<MaskTree> interior() const;

 private:
  struct Cell {  // a node's place
    std::size_t block;
    unsigned place;
  };

  std::size_t block_at(const Coord& voxel) const;
  std::size_t block_across(std::size_t block, int side) const;
  Coord block_origin(std::size_t block) const;
  FloodBlock* surface_block(std::size_t block) {
    return states_[block] >= 0 ? &blocks_[static_cast<std::size_t>(states_[block])] : nullptr;
  }
  const FloodBlock* surface_block(std::size_t block) const {
    return const_cast<Flood*>(this)->surface_block(block);
  }
  Cell cell_across(const FloodNode& node, int side) const;
  Neighbor neighbor(const FloodNode& node, int side) const;
  BrickMask inflow(std::size_t block) const;

  void add_nodes(const MaskTree& geometry);
  void seed(const Coord& voxel);
  void seed_node(std::uint32_t number, unsigned brick, unsigned voxel);
  void fill(FloodNode& node, NodeFill::Pending& pending) const;
  void open_border();
  void wake(std::uint32_t node, int side);
  void wake_all(std::size_t block, const BrickMask& places, int side);
  void announce(std::size_t block, const BrickMask& added);
  void spread_blocks();
  void tell_neighbors(const FloodNode& node);

  std::array<std::int64_t, 3> low_{}, dims_{};  // the object's blocks
  std::vector<std::int32_t> states_;  // [blocks] number in blocks_, or kUnreached/kReached
  std::vector<FloodBlock> blocks_;
  std::vector<FloodNode> nodes_;
  std::vector<std::size_t> pending_blocks_;
  std::vector<std::uint32_t> awake_;
};

Flood::Flood(const MaskTree& geometry) {
  std::array<std::int64_t, 3> high;
  low_.fill(INT64_MAX);
  high.fill(INT64_MIN);
  for (auto block = geometry.cbeginChildOn(); block; ++block) {
    const Coord origin = block->origin();
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

void Flood::add_nodes(const MaskTree& geometry) {
  for (auto upper = geometry.cbeginChildOn(); upper; ++upper) {
    const std::size_t block = block_at(upper->origin());
    states_[block] = static_cast<std::int32_t>(blocks_.size());
    FloodBlock& flood_block = blocks_.emplace_back();
    flood_block.surface_nodes = mask_of(upper->getChildMask());
    for_each_set(flood_block.surface_nodes, [&](unsigned n) {
      flood_block.node_of[n] = static_cast<std::uint32_t>(nodes_.size());
      FloodNode& node = nodes_.emplace_back();
      node.geometry = upper->getTable()[n].getChild();
      node.block = block;
      node.place = n;
    });
  }
  tbb::parallel_for(std::size_t{0}, nodes_.size(), [&](std::size_t i) {
    FloodNode& node = nodes_[i];
    node.surface_bricks = mask_of(node.geometry->getChildMask());
    std::uint16_t number = 0;
    for_each_set(node.surface_bricks, [&](unsigned n) { node.number_of[n] = number++; });
    node.reached.resize(number);
  });
}

std::size_t Flood::block_at(const Coord& voxel) const {
  std::size_t index = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    const std::int64_t at = (voxel[d] >> 9) - low_[d];
    if (at < 0 || at >= dims_[d]) return kOutside;
    index = index * static_cast<std::size_t>(dims_[d]) + static_cast<std::size_t>(at);
  }
  return index;
}

Coord Flood::block_origin(std::size_t block) const {
  const auto index = static_cast<std::int64_t>(block);
  return Coord(static_cast<int>((index / (dims_[1] * dims_[2]) + low_[0]) * 512),
               static_cast<int>((index / dims_[2] % dims_[1] + low_[1]) * 512),
               static_cast<int>((index % dims_[2] + low_[2]) * 512));
}

std::size_t Flood::block_across(std::size_t block, int side) const {
  constexpr int kStep = 512;
  Coord origin = block_origin(block);
  origin[side / 2] += side % 2 == 1 ? kStep : -kStep;
  return block_at(origin);
}

Flood::Cell Flood::cell_across(const FloodNode& node, int side) const {
  return {lies_on(node.place, side) ? block_across(node.block, side) : node.block,
          stepped(node.place, side)};
}

Neighbor Flood::neighbor(const FloodNode& node, int side) const {
  const Cell cell = cell_across(node, side);
  if (cell.block == kOutside) return {nullptr, true};
  const FloodBlock* block = surface_block(cell.block);
  if (block == nullptr) return {nullptr, states_[cell.block] == kReached};
  if (test(block->surface_nodes, cell.place)) return {&nodes_[block->node_of[cell.place]], false};
  return {nullptr, test(block->reached_nodes, cell.place)};
}

void Flood::wake(std::uint32_t node, int side) {
  if (nodes_[node].woken_sides == 0 && nodes_[node].seeds.empty()) awake_.push_back(node);
  nodes_[node].woken_sides |= 1u << side;
}

// Wakes the surface nodes among `places` of a block: what lies across their `side` was reached.
void Flood::wake_all(std::size_t block, const BrickMask& places, int side) {
  FloodBlock* flood_block = surface_block(block);
  if (flood_block == nullptr) return;
  for_each_set(places & flood_block->surface_nodes,
               [&](unsigned n) { wake(flood_block->node_of[n], side); });
}

// Newly reached cells of a block: their neighbours hear of it.
void Flood::announce(std::size_t block, const BrickMask& added) {
  for (int side = 0; side < kSides; ++side) {
    wake_all(block, shifted(added, side), opposite(side));
    if (!any_on_side(added, side)) continue;
    const std::size_t next = block_across(block, side);
    if (next == kOutside) continue;
    wake_all(next, across(added, opposite(side)), opposite(side));
    if (states_[next] != kReached) pending_blocks_.push_back(next);
  }
}

// The cells of a block whose neighbours in other blocks, without surface, are reached.
BrickMask Flood::inflow(std::size_t block) const {
  BrickMask seeds;
  for (int side = 0; side < kSides; ++side) {
    const std::size_t next = block_across(block, side);
    if (next == kOutside || states_[next] == kReached) {
      seeds = seeds | across(full_mask(), side);
    } else if (const FloodBlock* neighbor = surface_block(next)) {
      seeds = seeds | across(neighbor->reached_nodes, side);
    }
  }
  return seeds;
}

void Flood::spread_blocks() {
  while (!pending_blocks_.empty()) {
    const std::size_t index = pending_blocks_.back();
    pending_blocks_.pop_back();
    if (states_[index] == kReached) continue;
    if (FloodBlock* block = surface_block(index)) {
      const BrickMask unreached = ~(block->surface_nodes | block->reached_nodes);
      const BrickMask added = flooded(inflow(index) | block->seeds, unreached);
      block->reached_nodes = block->reached_nodes | added;
      block->seeds = {};
      announce(index, added);
    } else {
      states_[index] = kReached;
      announce(index, full_mask());
    }
  }
}

// What a filled node has reached on its sides flows on.
void Flood::tell_neighbors(const FloodNode& node) {
  for (int side = 0; side < kSides; ++side) {
    if ((node.changed_sides >> side & 1) == 0) continue;
    const Cell cell = cell_across(node, side);
    if (cell.block == kOutside || states_[cell.block] == kReached) continue;
    if (FloodBlock* block = surface_block(cell.block)) {
      if (test(block->surface_nodes, cell.place)) {
        wake(block->node_of[cell.place], opposite(side));
        continue;
      }
      set(block->seeds, cell.place);
    }
    pending_blocks_.push_back(cell.block);
  }
}

// Everything beyond the object's blocks is reached.
void Flood::open_border() {
  for (std::size_t block = 0; block < states_.size(); ++block) {
    bool border = false;
    for (int side = 0; side < kSides; ++side) {
      if (block_across(block, side) != kOutside) continue;
      border = true;
      wake_all(block, side_cells(full_mask(), side), side);
    }
    if (border) pending_blocks_.push_back(block);
  }
}

void Flood::seed(const Coord& voxel) {
  const std::size_t index = block_at(voxel);
  if (index == kOutside) return;
  FloodBlock* block = surface_block(index);
  if (block == nullptr) {
    pending_blocks_.push_back(index);
    return;
  }
  const unsigned place = UpperMaskNode::coordToOffset(voxel);
  if (!test(block->surface_nodes, place)) {
    set(block->seeds, place);
    pending_blocks_.push_back(index);
    return;
  }
  seed_node(block->node_of[place], LowerMaskNode::coordToOffset(voxel),
            MaskLeaf::coordToOffset(voxel));
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
  for (int side = 0; side < kSides; ++side) {
    if (node.woken_sides >> side & 1) fill.pull(side, neighbor(node, side));
  }
  for (const FloodNode::Seed& seed : node.seeds) {
    BrickMask point;
    set(point, seed.voxel);
    fill.push(seed.brick, point);
  }
  node.woken_sides = 0;
  node.seeds.clear();
  fill.run();
}

void Flood::run(std::span<const Coord> seeds) {
  open_border();
  for (const Coord& voxel : seeds) seed(voxel);
  spread_blocks();
  tbb::enumerable_thread_specific<NodeFill::Pending> pending;
  while (!awake_.empty()) {
    const std::vector<std::uint32_t> round = std::move(awake_);
    awake_.clear();
    tbb::parallel_for(std::size_t{0}, round.size(),
                      [&](std::size_t i) { fill(nodes_[round[i]], pending.local()); });
    for (const std::uint32_t node : round) tell_neighbors(nodes_[node]);
    spread_blocks();
  }
}

// The interior of a node with surface; none where it has no interior.
std::unique_ptr<LowerMaskNode> interior_node(const FloodNode& node, const Coord& origin) {
  auto result = std::make_unique<LowerMaskNode>(origin, false, false);
  const BrickMask unreached = ~(node.surface_bricks | node.reached_bricks);
  bool any = unreached.any();
  for_each_set(unreached, [&](unsigned n) { result->addTile(n, true, true); });
  for_each_set(node.surface_bricks, [&](unsigned n) {
    const BrickMask voxels =
        ~(node.reached_voxels(n) | brick_of(*node.geometry->getTable()[n].getChild()));
    if (!voxels.any()) return;
    any = true;
    auto leaf = std::make_unique<MaskLeaf>(entry_origin(origin, n, 8), false);
    assign(*leaf, voxels);
    result->addLeaf(leaf.release());
  });
  return any ? std::move(result) : nullptr;
}

std::unique_ptr<MaskTree> Flood::interior() const {
  std::vector<std::unique_ptr<LowerMaskNode>> nodes(nodes_.size());
  tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) {
    nodes[i] = interior_node(nodes_[i], nodes_[i].geometry->origin());
  });
  auto tree = std::make_unique<MaskTree>();
  for (std::size_t index = 0; index < states_.size(); ++index) {
    const Coord origin = block_origin(index);
    const FloodBlock* block = surface_block(index);
    if (block == nullptr) {
      if (states_[index] == kUnreached) tree->addTile(origin, true, true);
      continue;
    }
    auto upper = std::make_unique<UpperMaskNode>(origin, false, false);
    const BrickMask unreached = ~(block->surface_nodes | block->reached_nodes);
    bool any = unreached.any();
    for_each_set(unreached, [&](unsigned n) { upper->addTile(n, true, true); });
    for_each_set(block->surface_nodes, [&](unsigned n) {
      auto& node = nodes[block->node_of[n]];
      if (node == nullptr) return;
      any = true;
      upper->addChild(node.release());
    });
    if (any) tree->addChild(upper.release());
  }
  return tree;
}

}  // namespace

std::unique_ptr<MaskTree> flood_interior(const MaskTree& geometry, std::span<const Coord> seeds) {
  if (geometry.empty()) return std::make_unique<MaskTree>();
  Flood flood(geometry);
  flood.run(seeds);
  return flood.interior();
}

}  // namespace forcelayer
