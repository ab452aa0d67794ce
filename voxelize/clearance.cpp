#include "voxelize/clearance.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <unordered_map>
#include <vector>

#include "voxelize/brick_bits.h"

namespace forcelayer {
namespace {

// On every level, a cell is free or holds something. How far a free cell is from what its 26
// neighbours hold, their nearness tells. Where all of them are free, it is the cell's edge more
// than the least distance of a neighbour, since the cell grown by its edge is the union of the 27,
// and distance to a union is the least of the distances. In a node that holds something, no cell is
// 8 cells away from it, so nothing beyond the neighbouring nodes ever matters.

constexpr bool is_free(std::uint32_t entry) {
  return is_uniform(entry) && uniform_value(entry) == 0;
}

struct Offset {
  int x, y, z;
};
constexpr Offset offset_of(unsigned direction) {
  return {static_cast<int>(direction / 9) - 1, static_cast<int>(direction / 3 % 3) - 1,
          static_cast<int>(direction % 3) - 1};
}

// A cube of cells with its origin in the middle 8x8x8.
template <class T, int kMargin>
struct Window {
  static constexpr int kWidth = 8 + 2 * kMargin;
  std::array<T, std::size_t{kWidth} * kWidth * kWidth> cells;

  T& at(int x, int y, int z) {
    return cells[static_cast<std::size_t>(((x + kMargin) * kWidth + y + kMargin) * kWidth + z +
                                          kMargin)];
  }
  static constexpr std::ptrdiff_t step(const Offset& d) {
    return (std::ptrdiff_t{d.x} * kWidth + d.y) * kWidth + d.z;
  }
};

// Places of a window along one axis that lie in the neighbouring node at d (-1, 0, 1).
struct Range {
  int first, last;  // last exclusive
};
constexpr Range range_of(int d, int margin) {
  return d < 0 ? Range{-margin, 0} : d > 0 ? Range{8, 8 + margin} : Range{0, 8};
}

// Calls f(x, y, z, n) for the window's places in the neighbouring node in `direction`; n is the
// place's entry in that node.
template <class F>
void for_each_place(unsigned direction, int margin, F&& f) {
  const Offset d = offset_of(direction);
  const Range xs = range_of(d.x, margin), ys = range_of(d.y, margin), zs = range_of(d.z, margin);
  for (int x = xs.first; x < xs.last; ++x) {
    for (int y = ys.first; y < ys.last; ++y) {
      for (int z = zs.first; z < zs.last; ++z) {
        f(x, y, z, static_cast<unsigned>((x & 7) << 6 | (y & 7) << 3 | (z & 7)));
      }
    }
  }
}

// Distances of a node's cells as far as their neighbours tell: 0 where not free, up to the edge of
// a cell where a neighbour holds something, else kFar.
template <class T>
using Near = std::array<T, kNodeEntries>;
template <class T>
constexpr T kFar = std::numeric_limits<T>::max();

// A level of the tree: what its cells hold. A null nearness is a free cell.
struct BrickLevel {
  using Nearness = BrickNearness;
  using Distance = std::uint8_t;
  static constexpr unsigned kEdge = kBrickEdge;

  const BuiltTree& tree;
  std::uint32_t parent(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return tree.node(x, y, z);
  }
  const Entries& entries(std::uint32_t node) const { return tree.lower[node].entries; }
  const Nearness* nearness(std::uint32_t node, std::uint32_t entry) const {
    return &tree.lower[node].nearness[entry];
  }
};

struct NodeLevel {
  using Nearness = NodeNearness;
  using Distance = std::uint16_t;
  static constexpr unsigned kEdge = kLowerNodeEdge;

  const BuiltTree& tree;
  const std::vector<NodeNearness>& of_lower;  // of every lower node
  std::uint32_t parent(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return tree.block(x, y, z);
  }
  const Entries& entries(std::uint32_t block) const { return tree.upper[block]; }
  const Nearness* nearness(std::uint32_t, std::uint32_t entry) const { return &of_lower[entry]; }
};

using Place = std::array<std::int64_t, 3>;  // of a parent, in parents from the directory's origin

// The nearness of the cells of the parent at `place`, and of one layer around them.
template <class Level>
void gather_nearness(const Level& level, const Place& place,
                     Window<const typename Level::Nearness*, 1>& window) {
  static const typename Level::Nearness kSolid{};  // non-free up to every side
  for (unsigned direction = 0; direction < kDirections; ++direction) {
    const Offset d = offset_of(direction);
    const std::uint32_t parent = level.parent(place[0] + d.x, place[1] + d.y, place[2] + d.z);
    for_each_place(direction, 1, [&](int x, int y, int z, unsigned n) {
      const std::uint32_t entry = is_uniform(parent) ? parent : level.entries(parent)[n];
      window.at(x, y, z) = is_free(entry)      ? nullptr
                           : is_uniform(entry) ? &kSolid
                                               : level.nearness(parent, entry);
    });
  }
}

template <class Level>
Near<typename Level::Distance> near_of(const Level& level, const Place& place) {
  using Distance = typename Level::Distance;
  Window<const typename Level::Nearness*, 1> window;
  gather_nearness(level, place, window);
  Near<Distance> near;
  for_each_place(kSelf, 0, [&](int x, int y, int z, unsigned n) {
    const auto* cell = &window.at(x, y, z);
    near[n] = *cell != nullptr ? Distance{0} : kFar<Distance>;
    if (*cell != nullptr) return;
    for (unsigned direction = 0; direction < kDirections; ++direction) {
      const auto* neighbor = cell[window.step(offset_of(direction))];
      if (neighbor == nullptr) continue;
      near[n] = std::min(near[n], static_cast<Distance>(neighbor->towards(direction) + 1));
    }
  });
  return near;
}

// near_of() for the parents that hold something and for their free neighbours.
template <class Level>
class NearMap {
 public:
  using Distance = typename Level::Distance;

  NearMap(const Level& level, const std::vector<Place>& mixed_parents) {
    for (const Place& place : mixed_parents) {
      for (unsigned direction = 0; direction < kDirections; ++direction) {
        const Offset d = offset_of(direction);
        const Place next = {place[0] + d.x, place[1] + d.y, place[2] + d.z};
        const std::uint32_t parent = level.parent(next[0], next[1], next[2]);
        if (is_uniform(parent) && !is_free(parent)) continue;
        if (index_.try_emplace(next, places_.size()).second) places_.push_back(next);
      }
    }
    near_.resize(places_.size());
    tbb::parallel_for(std::size_t{0}, places_.size(),
                      [&](std::size_t i) { near_[i] = near_of(level, places_[i]); });
  }

  // Null where the parent is none of them.
  const Near<Distance>* find(const Place& place) const {
    const auto found = index_.find(place);
    return found == index_.end() ? nullptr : &near_[found->second];
  }

 private:
  struct PlaceHash {
    std::size_t operator()(const Place& place) const {
      std::uint64_t hash = 0;
      for (const std::int64_t x : place) {
        hash = (hash ^ static_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
      }
      return hash;
    }
  };
  std::unordered_map<Place, std::size_t, PlaceHash> index_;
  std::vector<Place> places_;
  std::vector<Near<Distance>> near_;
};

// The non-free cells of a parent.
template <class Level>
BrickMask held_cells(const Level& level, std::uint32_t parent) {
  BrickMask held;
  const Entries& entries = level.entries(parent);
  for (unsigned n = 0; n < kNodeEntries; ++n) {
    if (!is_free(entries[n])) set(held, n);
  }
  return held;
}

// Steps to a neighbour (of 26) after which the held cells have reached all 512.
int reach_of(BrickMask held) {
  int steps = 0;
  for (; held != full_mask(); ++steps) {
    for (const int side : {4, 2, 0}) held = held | shifted(held, side) | shifted(held, side + 1);
  }
  return steps;
}

// A cube of distances: a parent's 8x8x8 cells and `margin` more on each side.
template <class Distance>
class DistanceField {
 public:
  void resize(int margin) {
    margin_ = margin;
    width_ = 8 + 2 * margin;
    border_ = width_ * width_;  // room for steps beyond both ends
    for (auto* cells : {&cells_, &least_, &next_}) {
      cells->assign(static_cast<std::size_t>(width_ * width_ * width_ + 2 * border_),
                    kFar<Distance>);
    }
  }
  Distance& at(int x, int y, int z) {
    return cells_[static_cast<std::size_t>(
        border_ + ((x + margin_) * width_ + y + margin_) * width_ + z + margin_)];
  }

  // Every cell becomes at most `edge` more than the least of its neighbours. Along the field's own
  // border that goes wrong, for the margin's outermost layer the first time, one layer more each
  // time: the middle stays right for `margin` times.
  void spread(Distance edge) {
    take_least(cells_, least_, 1);
    take_least(least_, next_, width_);
    take_least(next_, least_, width_ * width_);
    const auto count = static_cast<std::size_t>(width_ * width_ * width_);
    Distance* cell = cells_.data() + border_;
    const Distance* least = least_.data() + border_;
    for (std::size_t i = 0; i < count; ++i) {
      const Distance reached = least[i] > kFar<Distance> - edge
                                   ? kFar<Distance>
                                   : static_cast<Distance>(least[i] + edge);
      cell[i] = std::min(cell[i], reached);
    }
  }

 private:
  void take_least(const std::vector<Distance>& from, std::vector<Distance>& to, int step) const {
    const Distance* in = from.data() + border_;
    Distance* out = to.data() + border_;
    for (int i = 0; i < width_ * width_ * width_; ++i) {
      out[i] = std::min(in[i], std::min(in[i - step], in[i + step]));
    }
  }

  int margin_ = 0, width_ = 0, border_ = 0;
  std::vector<Distance> cells_, least_, next_;
};

// The distances of all cells of a parent that holds something, into its free entries.
template <class Level>
void fill_entries(const Level& level, const NearMap<Level>& near_map, const Place& place,
                  Entries& entries) {
  using Distance = typename Level::Distance;
  const int margin = reach_of(held_cells(level, level.parent(place[0], place[1], place[2])));
  thread_local DistanceField<Distance> field;
  field.resize(margin);
  for (unsigned direction = 0; direction < kDirections; ++direction) {
    const Offset d = offset_of(direction);
    const Place next = {place[0] + d.x, place[1] + d.y, place[2] + d.z};
    const Near<Distance>* near = near_map.find(next);
    const bool solid = near == nullptr && !is_free(level.parent(next[0], next[1], next[2]));
    for_each_place(direction, margin, [&](int x, int y, int z, unsigned n) {
      field.at(x, y, z) = near != nullptr ? (*near)[n] : solid ? Distance{0} : kFar<Distance>;
    });
  }
  for (int step = 0; step < margin; ++step) field.spread(static_cast<Distance>(Level::kEdge));
  for_each_place(kSelf, 0, [&](int x, int y, int z, unsigned n) {
    if (is_free(entries[n])) entries[n] = uniform_entry(0, field.at(x, y, z));
  });
}

template <class Level>
void fill_level(const Level& level, const std::vector<Place>& parents,
                const std::vector<Entries*>& entries) {
  const NearMap<Level> near_map(level, parents);
  tbb::parallel_for(std::size_t{0}, parents.size(),
                    [&](std::size_t i) { fill_entries(level, near_map, parents[i], *entries[i]); });
}

// How near a node's or block's non-free voxels come to its sides.
template <class Level>
std::vector<NodeNearness> nearness_of_parents(const Level& level, std::size_t count) {
  std::vector<NodeNearness> nearness(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const auto parent = static_cast<std::uint32_t>(i);
    const Entries& entries = level.entries(parent);
    nearness[i] =
        combined(held_cells(level, parent), Level::kEdge, [&](unsigned n, unsigned direction) {
          return is_uniform(entries[n]) ? 0u
                                        : level.nearness(parent, entries[n])->towards(direction);
        });
  });
  return nearness;
}

// The distances of free blocks, over the whole directory: two sweeps, each block looking at the 13
// neighbours that the sweep has passed. A shortest way of diagonal steps goes forward first and
// backward then, so that two sweeps find it.
class DirectoryDistances {
 public:
  DirectoryDistances(BuiltTree& tree, const std::vector<NodeNearness>& of_upper)
      : tree_(tree), of_upper_(of_upper), distances_(tree.directory.size(), kUnknown) {}

  void fill_entries() {
    for_each_block(false, [&](const Place& at, std::size_t i) { distances_[i] = near(at, i); });
    for_each_block(false, [&](const Place& at, std::size_t i) { look_back(at, i, 0, kSelf); });
    for_each_block(
        true, [&](const Place& at, std::size_t i) { look_back(at, i, kSelf + 1, kDirections); });
    for (std::size_t i = 0; i < distances_.size(); ++i) {
      std::uint32_t& entry = tree_.directory[i];
      if (!is_free(entry)) continue;
      entry =
          uniform_entry(0, distances_[i] == kUnknown ? 0 : std::min(distances_[i], kMaxClearance));
    }
  }

 private:
  static constexpr std::uint32_t kUnknown = UINT32_MAX;  // as long as nothing was found

  template <class F>
  void for_each_block(bool backward, F&& f) const {
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
    std::uint32_t least = kUnknown;
    for (unsigned direction = 0; direction < kDirections; ++direction) {
      const Offset d = offset_of(direction);
      const std::uint32_t entry = tree_.block(at[0] + d.x, at[1] + d.y, at[2] + d.z);
      if (is_free(entry)) continue;
      least = std::min(least, is_uniform(entry) ? 1 : of_upper_[entry].towards(direction) + 1);
    }
    return least;
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
  const std::vector<NodeNearness>& of_upper_;
  std::vector<std::uint32_t> distances_;
};

}  // namespace

void add_clearance(BuiltTree& tree) {
  std::vector<Place> node_places(tree.lower.size()), block_places(tree.upper.size());
  for (std::size_t i = 0; i < tree.directory.size(); ++i) {
    if (is_uniform(tree.directory[i])) continue;
    const auto index = static_cast<std::int64_t>(i);
    const Place block = {index / tree.dims[2] / tree.dims[1], index / tree.dims[2] % tree.dims[1],
                         index % tree.dims[2]};
    block_places[tree.directory[i]] = block;
    const Entries& entries = tree.upper[tree.directory[i]];
    for (unsigned n = 0; n < kNodeEntries; ++n) {
      if (is_uniform(entries[n])) continue;
      node_places[entries[n]] = {block[0] * 8 + (n >> 6), block[1] * 8 + (n >> 3 & 7),
                                 block[2] * 8 + (n & 7)};
    }
  }
  std::vector<Entries*> lower, upper;
  for (BuiltNode& node : tree.lower) lower.push_back(&node.entries);
  for (Entries& entries : tree.upper) upper.push_back(&entries);

  const BrickLevel bricks{tree};
  const auto of_lower = nearness_of_parents(bricks, tree.lower.size());
  const NodeLevel nodes{tree, of_lower};
  const auto of_upper = nearness_of_parents(nodes, tree.upper.size());
  fill_level(bricks, node_places, lower);
  fill_level(nodes, block_places, upper);
  DirectoryDistances(tree, of_upper).fill_entries();
}

}  // namespace forcelayer
