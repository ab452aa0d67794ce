#include "voxelize/tree/clearance.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <unordered_map>
#include <vector>

#include "formats/lattice/brick_bits.h"
#include "voxelize/masks/voxel_box.h"
#include "voxelize/tree/clearance_cube.h"

namespace forcelayer::tree {
namespace {

// On each level (bricks, nodes, directory cells) a cell is free, or holds voxels that are not free.
// The gaps of a free cell's 26 neighbors give its distance from the voxels that they hold. Where
// all 26 are free, the distance is the cell's edge plus the least distance of a neighbor: the cell
// grown by its edge is the union of the 27, and the distance to a union is the least of the
// distances. A parent that holds something has no cell 8 or more cells away from it, so cells
// beyond the neighboring parents never count.

struct Offset {
  int x, y, z;
};
constexpr Offset offset_of(unsigned direction) {
  return {static_cast<int>(direction / 9) - 1, static_cast<int>(direction / 3 % 3) - 1,
          static_cast<int>(direction % 3) - 1};
}

using Place = std::array<std::int64_t, 3>;  // a parent's index from the directory's origin

Place neighbor(const Place& place, unsigned direction) {
  const Offset d = offset_of(direction);
  return {place[0] + d.x, place[1] + d.y, place[2] + d.z};
}

// A level of the tree: parents, each of 512 cells.
struct BrickLevel {
  using Distance = std::uint8_t;  // at most 7 bricks
  static constexpr unsigned kEdge = kBrickEdge;

  const BuiltTree& tree;

  std::size_t parents() const { return tree.lower.size(); }
  std::uint32_t parent(const Place& p) const { return tree.node(p[0], p[1], p[2]); }
  const lattice::BrickMask& held(std::uint32_t parent) const { return tree.lower[parent].held; }
  const Entries& entries(std::uint32_t parent) const { return tree.lower[parent].entries; }
  const BrickGaps& gaps(std::uint32_t parent, std::uint32_t entry) const {
    return tree.lower[parent].gaps[entry];
  }
  const NodeGaps* known(std::uint32_t parent) const {
    return tree.lower[parent].finished ? &tree.lower[parent].node_gaps : nullptr;
  }
};

struct NodeLevel {
  using Distance = std::uint16_t;  // at most 7 nodes
  static constexpr unsigned kEdge = kLowerNodeEdge;

  const BuiltTree& tree;
  const std::vector<NodeGaps>& of_lower;       // [lower nodes]
  std::vector<lattice::BrickMask> held_nodes;  // [upper nodes]

  NodeLevel(const BuiltTree& built, const std::vector<NodeGaps>& gaps_of_lower)
      : tree(built), of_lower(gaps_of_lower), held_nodes(built.upper.size()) {
    for (std::size_t i = 0; i < built.upper.size(); ++i) {
      for (unsigned n = 0; n < kNodeEntries; ++n) {
        if (!is_free(built.upper[i][n])) set(held_nodes[i], n);
      }
    }
  }

  std::size_t parents() const { return tree.upper.size(); }
  std::uint32_t parent(const Place& p) const { return tree.directory_entry(p[0], p[1], p[2]); }
  const lattice::BrickMask& held(std::uint32_t parent) const { return held_nodes[parent]; }
  const Entries& entries(std::uint32_t parent) const { return tree.upper[parent]; }
  const NodeGaps& gaps(std::uint32_t, std::uint32_t entry) const { return of_lower[entry]; }
  const NodeGaps* known(std::uint32_t) const { return nullptr; }
};

// First distances of a parent's cells: 0 where not free, from the neighbors' gaps where a neighbor
// holds something, else kFar.
template <class T>
using FirstDistances = std::array<T, kNodeEntries>;
template <class T>
constexpr T kFar = std::numeric_limits<T>::max();

// A mask's outermost cells towards a neighbor from which it lies in `direction`: a side, an edge or
// a corner; all cells for kSelf.
lattice::BrickMask facing_cells(unsigned direction) { return detail::kShells[direction][0]; }

// Collects a parent's first distances from its own cells and from the layer of cells around it.
template <class Level>
class FirstDistanceCube {
 public:
  using Distance = typename Level::Distance;

  FirstDistanceCube(const Level& level, const Place& place) {
    cells_.fill(kFar<Distance>);
    for (unsigned direction = 0; direction < kDirections; ++direction) {
      const std::uint32_t parent = level.parent(neighbor(place, direction));
      if (is_free(parent)) continue;
      const lattice::BrickMask facing = facing_cells(direction);
      if (is_uniform(parent)) {
        lattice::for_each_set(facing,
                              [&](unsigned n) { lower_around_solid(place_of(direction, n)); });
      } else {
        lattice::for_each_set(facing & level.held(parent), [&](unsigned n) {
          const std::uint32_t entry = level.entries(parent)[n];
          const std::size_t at = place_of(direction, n);
          is_uniform(entry) ? lower_around_solid(at) : lower_around(level.gaps(parent, entry), at);
        });
      }
    }
  }

  // The parent's own cells, of which `held` are not free.
  FirstDistances<Distance> result(const lattice::BrickMask& held) const {
    FirstDistances<Distance> first;
    for (unsigned n = 0; n < kNodeEntries; ++n) first[n] = cells_[place_of(kSelf, n)];
    lattice::for_each_set(held, [&](unsigned n) { first[n] = 0; });
    return first;
  }

 private:
  static constexpr int kMargin = 2;  // the layer around the parent, and the layer around that
  static constexpr int kWidth = 8 + 2 * kMargin;
  static constexpr std::ptrdiff_t flat(int x, int y, int z) {
    return (std::ptrdiff_t{x} * kWidth + y) * kWidth + z;
  }

  // Cell n of the neighbor in `direction`.
  static std::size_t place_of(unsigned direction, unsigned n) {
    const Offset d = offset_of(direction);
    return static_cast<std::size_t>(flat(static_cast<int>(n >> 6) + 8 * d.x + kMargin,
                                         static_cast<int>(n >> 3 & 7) + 8 * d.y + kMargin,
                                         static_cast<int>(n & 7) + 8 * d.z + kMargin));
  }

  // Lowers the distances of the 26 cells around the cell at `at`, which has these gaps. The cell
  // lies in `direction` of the one that is one step the other way.
  template <class Gaps>
  void lower_around(const Gaps& gaps, std::size_t at) {
    for (unsigned direction = 0; direction < kDirections; ++direction) {
      const Offset d = offset_of(direction);
      Distance& cell = cells_[at - static_cast<std::size_t>(flat(d.x, d.y, d.z))];
      cell = std::min(cell, static_cast<Distance>(gaps.towards(direction) + 1));
    }
  }
  void lower_around_solid(std::size_t at) {
    for (unsigned direction = 0; direction < kDirections; ++direction) {
      const Offset d = offset_of(direction);
      cells_[at - static_cast<std::size_t>(flat(d.x, d.y, d.z))] = 1;
    }
  }

  std::array<Distance, kWidth * kWidth * kWidth> cells_;
};

// The first distances of the parents that hold something and of their free neighbors.
template <class Level>
class FirstDistanceMap {
 public:
  using Distance = typename Level::Distance;

  FirstDistanceMap(const Level& level, const std::vector<Place>& mixed_parents) {
    std::vector<Place> places;
    index_.reserve(mixed_parents.size() * 3);
    for (const Place& place : mixed_parents) {
      for (unsigned direction = 0; direction < kDirections; ++direction) {
        const Place next = neighbor(place, direction);
        const std::uint32_t parent = level.parent(next);
        if (is_uniform(parent) && !is_free(parent)) continue;
        if (index_.try_emplace(next, places.size()).second) places.push_back(next);
      }
    }
    distances_.resize(places.size());
    tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
      const std::uint32_t parent = level.parent(places[i]);
      distances_[i] = FirstDistanceCube<Level>(level, places[i])
                          .result(is_uniform(parent) ? lattice::BrickMask{} : level.held(parent));
    });
  }

  // Null for any other parent.
  const FirstDistances<Distance>* find(const Place& place) const {
    const auto found = index_.find(place);
    return found == index_.end() ? nullptr : &distances_[found->second];
  }

 private:
  std::unordered_map<Place, std::size_t, masks::IndexHash> index_;
  std::vector<FirstDistances<Distance>> distances_;
};

// After how many steps to the 26 neighbors the held cells have reached all 512.
int reach_of(const lattice::BrickMask& first) {
  lattice::BrickMask held = first;
  int steps = 0;
  for (; held != lattice::full_mask(); ++steps) {
    for (const int side : {4, 2, 0})
      held = held | lattice::shifted(held, side) | lattice::shifted(held, side + 1);
  }
  return steps;
}

// Copies the cells of the neighbor in `direction` into a cube, as far as its margin reaches. Null
// distances stand for cells that are all `uniform`.
template <class Distance>
void place_neighbor(unsigned direction, const FirstDistances<Distance>* distances, Distance uniform,
                    ClearanceCube<Distance>& cube) {
  struct Range {
    int first, last;  // last exclusive
  };
  const int margin = cube.margin();
  const auto range = [margin](int d) {
    return d < 0 ? Range{-margin, 0} : d > 0 ? Range{8, 8 + margin} : Range{0, 8};
  };
  const Offset d = offset_of(direction);
  const Range xs = range(d.x), ys = range(d.y), zs = range(d.z);
  for (int x = xs.first; x < xs.last; ++x) {
    for (int y = ys.first; y < ys.last; ++y) {
      Distance* to = cube.row(x, y) + zs.first;
      if (distances == nullptr) {
        std::fill_n(to, zs.last - zs.first, uniform);
      } else {
        std::copy_n(distances->data() + ((x & 7) * 64 + (y & 7) * 8 + (zs.first & 7)),
                    zs.last - zs.first, to);
      }
    }
  }
}

// The distances of all cells of a parent that holds something, into its free entries.
template <class Level>
void fill_entries(const Level& level, const FirstDistanceMap<Level>& first, const Place& place,
                  Entries& entries) {
  using Distance = typename Level::Distance;
  ClearanceCube<Distance> cube(reach_of(level.held(level.parent(place))));
  for (unsigned direction = 0; direction < kDirections; ++direction) {
    const Place next = neighbor(place, direction);
    const FirstDistances<Distance>* distances = first.find(next);
    const bool solid = distances == nullptr && !is_free(level.parent(next));
    place_neighbor(direction, distances, solid ? Distance{0} : kFar<Distance>, cube);
  }
  cube.spread(static_cast<Distance>(Level::kEdge));
  for (int n = 0; n < static_cast<int>(kNodeEntries); ++n) {
    std::uint32_t& entry = entries[static_cast<std::size_t>(n)];
    if (is_free(entry)) entry = uniform_entry(0, cube.row(n >> 6, n >> 3 & 7)[n & 7]);
  }
}

template <class Level>
void fill_level(const Level& level, const std::vector<Place>& parents,
                const std::vector<Entries*>& entries) {
  const FirstDistanceMap<Level> first(level, parents);
  tbb::parallel_for(std::size_t{0}, parents.size(),
                    [&](std::size_t i) { fill_entries(level, first, parents[i], *entries[i]); });
}

// The gaps of every parent.
template <class Level>
std::vector<NodeGaps> gaps_of_parents(const Level& level) {
  std::vector<NodeGaps> gaps(level.parents());
  tbb::parallel_for(std::size_t{0}, gaps.size(), [&](std::size_t i) {
    const auto parent = static_cast<std::uint32_t>(i);
    if (const NodeGaps* known = level.known(parent)) {
      gaps[i] = *known;
      return;
    }
    const Entries& entries = level.entries(parent);
    gaps[i] = combine_gaps(level.held(parent), Level::kEdge, [&](unsigned n, unsigned direction) {
      return is_uniform(entries[n]) ? 0u : level.gaps(parent, entries[n]).towards(direction);
    });
  });
  return gaps;
}

// The voxels of a brick that are not free: those of whose two bits one is set.
lattice::BrickMask non_free(const Brick& brick) {
  lattice::BrickMask mask;
  for (std::size_t n = 0; n < brick.size(); ++n) {
    std::uint32_t bits = (brick[n] | brick[n] >> 1) & 0x55555555u;
    bits = (bits | bits >> 1) & 0x33333333u;
    bits = (bits | bits >> 2) & 0x0f0f0f0fu;
    bits = (bits | bits >> 4) & 0x00ff00ffu;
    bits = (bits | bits >> 8) & 0x0000ffffu;
    mask.words[n / 4] |= std::uint64_t{bits} << (n % 4 * 16);
  }
  return mask;
}

// Computes the brick gaps of finished nodes up to two nodes away from `places`, the nodes that are
// not finished: they will be asked for.
void restore_gaps(BuiltTree& tree, const std::vector<Place>& places) {
  std::vector<std::uint32_t> asked;
  for (const Place& place : places) {
    for (std::int64_t n = 0; n < 125; ++n) {
      const std::uint32_t node =
          tree.node(place[0] + n / 25 - 2, place[1] + n / 5 % 5 - 2, place[2] + n % 5 - 2);
      if (!is_uniform(node) && tree.lower[node].finished) asked.push_back(node);
    }
  }
  std::sort(asked.begin(), asked.end());
  asked.erase(std::unique(asked.begin(), asked.end()), asked.end());
  tbb::parallel_for(std::size_t{0}, asked.size(), [&](std::size_t i) {
    BuiltNode& node = tree.lower[asked[i]];
    for (const Brick& brick : node.bricks) node.gaps.emplace_back(non_free(brick));
  });
}

// The distances of free directory cells. Two sweeps over the directory; in each, a cell looks at
// the 13 neighbors that the sweep has passed. A shortest path can be ordered as forward steps
// followed by backward steps, so two sweeps find it.
class DirectoryDistances {
 public:
  DirectoryDistances(BuiltTree& tree, const std::vector<NodeGaps>& of_upper)
      : tree_(tree), of_upper_(of_upper), distances_(tree.directory.size(), kUnknown) {}

  void fill_entries() {
    for_each_directory_cell(false,
                            [&](const Place& at, std::size_t i) { distances_[i] = near(at, i); });
    for_each_directory_cell(false,
                            [&](const Place& at, std::size_t i) { look_back(at, i, 0, kSelf); });
    for_each_directory_cell(
        true, [&](const Place& at, std::size_t i) { look_back(at, i, kSelf + 1, kDirections); });
    for (std::size_t i = 0; i < distances_.size(); ++i) {
      std::uint32_t& entry = tree_.directory[i];
      if (!is_free(entry)) continue;
      entry =
          uniform_entry(0, distances_[i] == kUnknown ? 0 : std::min(distances_[i], kMaxClearance));
    }
  }

 private:
  static constexpr std::uint32_t kUnknown = UINT32_MAX;  // until something is found

  template <class F>
  void for_each_directory_cell(bool backward, F&& f) const {
    const std::size_t count = distances_.size();
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t i = backward ? count - 1 - n : n;
      const auto index = static_cast<std::int64_t>(i);
      f(Place{index / tree_.dims[2] / tree_.dims[1], index / tree_.dims[2] % tree_.dims[1],
              index % tree_.dims[2]},
        i);
    }
  }

  std::uint32_t near(const Place& at, std::size_t i) const {
    if (!is_free(tree_.directory[i])) return 0;
    std::uint32_t smallest = kUnknown;
    for (unsigned direction = 0; direction < kDirections; ++direction) {
      const Offset d = offset_of(direction);
      const std::uint32_t entry = tree_.directory_entry(at[0] + d.x, at[1] + d.y, at[2] + d.z);
      if (is_free(entry)) continue;
      smallest =
          std::min(smallest, is_uniform(entry) ? 1 : of_upper_[entry].towards(direction) + 1);
    }
    return smallest;
  }

  void look_back(const Place& at, std::size_t i, unsigned first, unsigned last) {
    for (unsigned direction = first; direction < last; ++direction) {
      const Offset d = offset_of(direction);
      const Place next = {at[0] + d.x, at[1] + d.y, at[2] + d.z};
      if (next[0] < 0 || next[1] < 0 || next[2] < 0 || next[0] >= tree_.dims[0] ||
          next[1] >= tree_.dims[1] || next[2] >= tree_.dims[2]) {
        continue;
      }
      const std::uint32_t from = distances_[static_cast<std::size_t>(
          (next[0] * tree_.dims[1] + next[1]) * tree_.dims[2] + next[2])];
      if (from != kUnknown) distances_[i] = std::min(distances_[i], from + kUpperNodeEdge);
    }
  }

  BuiltTree& tree_;
  const std::vector<NodeGaps>& of_upper_;
  std::vector<std::uint32_t> distances_;
};

}  // namespace

void add_clearance(BuiltTree& tree) {
  std::vector<Place> node_places(tree.lower.size()), directory_places(tree.upper.size());
  for (std::size_t i = 0; i < tree.directory.size(); ++i) {
    if (is_uniform(tree.directory[i])) continue;
    const auto index = static_cast<std::int64_t>(i);
    const Place cell = {index / tree.dims[2] / tree.dims[1], index / tree.dims[2] % tree.dims[1],
                        index % tree.dims[2]};
    directory_places[tree.directory[i]] = cell;
    const Entries& entries = tree.upper[tree.directory[i]];
    for (unsigned n = 0; n < kNodeEntries; ++n) {
      if (is_uniform(entries[n])) continue;
      node_places[entries[n]] = {cell[0] * 8 + (n >> 6), cell[1] * 8 + (n >> 3 & 7),
                                 cell[2] * 8 + (n & 7)};
    }
  }
  std::vector<Place> new_places;
  std::vector<Entries*> lower, upper;
  for (std::size_t i = 0; i < tree.lower.size(); ++i) {
    if (tree.lower[i].finished) continue;
    new_places.push_back(node_places[i]);
    lower.push_back(&tree.lower[i].entries);
  }
  for (Entries& entries : tree.upper) upper.push_back(&entries);
  if (lower.size() < tree.lower.size()) restore_gaps(tree, new_places);

  const BrickLevel bricks{tree};
  const auto of_lower = gaps_of_parents(bricks);
  for (std::size_t i = 0; i < tree.lower.size(); ++i) tree.lower[i].node_gaps = of_lower[i];
  const NodeLevel nodes(tree, of_lower);
  const auto of_upper = gaps_of_parents(nodes);
  fill_level(bricks, new_places, lower);
  fill_level(nodes, directory_places, upper);
  DirectoryDistances(tree, of_upper).fill_entries();
}

}  // namespace forcelayer::tree
