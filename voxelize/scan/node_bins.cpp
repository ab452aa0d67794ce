#include "voxelize/scan/node_bins.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <unordered_map>

namespace forcelayer::scan {
namespace {

constexpr int kLog2NodeUnits = lattice::kSnapBits + 6;  // lattice units of a node's edge
constexpr std::size_t kChunkTriangles = 16384;          // a task

// The nodes that a run of consecutive triangles touches, and the pairs of node and triangle.
class ChunkBins {
 public:
  struct Entry {
    std::uint32_t node;  // index into `nodes`
    std::uint32_t triangle;
  };

  void add(const NodeIndex& node, std::uint32_t triangle) {
    // Not !=, which calls memcmp.
    if (nodes.empty() ||
        ((node[0] ^ last_node_[0]) | (node[1] ^ last_node_[1]) | (node[2] ^ last_node_[2])) != 0) {
      last_ = index_of(node);
      last_node_ = node;
    }
    ++counts[last_];
    entries.push_back({last_, triangle});
  }

  std::vector<NodeIndex> nodes;
  std::vector<std::uint64_t> counts;  // entries of each node; later: where its next entry goes
  std::vector<Entry> entries;

 private:
  std::uint32_t index_of(const NodeIndex& node) {
    const auto [found, is_new] = index_.try_emplace(node, static_cast<std::uint32_t>(nodes.size()));
    if (is_new) {
      nodes.push_back(node);
      counts.push_back(0);
    }
    return found->second;
  }

  std::unordered_map<NodeIndex, std::uint32_t, masks::IndexHash> index_;
  std::uint32_t last_ = 0;
  NodeIndex last_node_{};
};

// Adds the 26 nodes around each of `nodes` that lie in the box; each node once.
void add_neighbors(const NodeIndex& low, const NodeIndex& high, std::vector<NodeIndex>& nodes) {
  std::vector<NodeIndex> all;
  for (const NodeIndex& node : nodes) {
    for (int n = 0; n < 27; ++n) {
      const NodeIndex next{node[0] + n / 9 - 1, node[1] + n / 3 % 3 - 1, node[2] + n % 3 - 1};
      bool inside = true;
      for (std::size_t d = 0; d < 3; ++d) inside &= next[d] >= low[d] && next[d] <= high[d];
      if (inside) all.push_back(next);
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  nodes = std::move(all);
}

void add_spanning(ChunkBins& bins, const lattice::LatticeTriangle& triangle, std::uint32_t number,
                  const NodeIndex& low, const NodeIndex& high, int reach) {
  const std::int64_t span =
      (high[0] - low[0] + 1) * (high[1] - low[1] + 1) * (high[2] - low[2] + 1);
  // To draw the triangle in a node that it misses is cheaper than to find that out here.
  if (span <= (reach == 0 ? 4 : 8)) {
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) bins.add({x, y, z}, number);
      }
    }
    return;
  }
  constexpr int kLog2Node = 6;
  std::vector<NodeIndex> nodes;
  lattice::for_each_group(
      lattice::TriangleOverlap(triangle), kLog2Node,
      [&](const lattice::VoxelIndex& corner, const lattice::BrickMask& hit) {
        lattice::for_each_cell(hit, [&](std::int64_t x, std::int64_t y, std::int64_t z) {
          nodes.push_back({(corner[0] >> kLog2Node) + x, (corner[1] >> kLog2Node) + y,
                           (corner[2] >> kLog2Node) + z});
        });
      });
  if (reach > 0) add_neighbors(low, high, nodes);
  for (const NodeIndex& node : nodes) bins.add(node, number);
}

void bin_chunk(const SnappedObject& object, int reach, std::size_t first, std::size_t last,
               ChunkBins& bins) {
  bins.entries.reserve(last - first);
  for (std::size_t i = first; i < last; ++i) {
    const lattice::LatticeTriangle triangle = object.triangle(i);
    NodeIndex low, high;
    for (std::size_t d = 0; d < 3; ++d) {
      const auto [smallest, largest] =
          std::minmax({triangle[0][d], triangle[1][d], triangle[2][d]});
      low[d] = (smallest - reach * lattice::kSnapUnits) >> kLog2NodeUnits;
      high[d] = (largest + reach * lattice::kSnapUnits) >> kLog2NodeUnits;
    }
    if (low == high) {
      bins.add(low, static_cast<std::uint32_t>(i));
    } else {
      add_spanning(bins, triangle, static_cast<std::uint32_t>(i), low, high, reach);
    }
  }
}

// Every node of any chunk once, ascending; each chunk's counts become the places of its entries.
void place_entries(std::vector<ChunkBins>& chunks, NodeBins& bins) {
  for (const ChunkBins& chunk : chunks) {
    bins.nodes.insert(bins.nodes.end(), chunk.nodes.begin(), chunk.nodes.end());
  }
  std::sort(bins.nodes.begin(), bins.nodes.end());
  bins.nodes.erase(std::unique(bins.nodes.begin(), bins.nodes.end()), bins.nodes.end());

  bins.first.assign(bins.nodes.size() + 1, 0);
  std::vector<std::vector<std::uint32_t>> node_of(chunks.size());
  for (std::size_t c = 0; c < chunks.size(); ++c) {
    for (std::size_t i = 0; i < chunks[c].nodes.size(); ++i) {
      const auto found = std::lower_bound(bins.nodes.begin(), bins.nodes.end(), chunks[c].nodes[i]);
      node_of[c].push_back(static_cast<std::uint32_t>(found - bins.nodes.begin()));
      bins.first[node_of[c][i] + 1] += chunks[c].counts[i];
    }
  }
  for (std::size_t n = 0; n < bins.nodes.size(); ++n) bins.first[n + 1] += bins.first[n];

  std::vector<std::uint64_t> next(bins.first.begin(), bins.first.end() - 1);
  for (std::size_t c = 0; c < chunks.size(); ++c) {
    for (std::size_t i = 0; i < chunks[c].nodes.size(); ++i) {
      const std::uint64_t count = chunks[c].counts[i];
      chunks[c].counts[i] = next[node_of[c][i]];
      next[node_of[c][i]] += count;
    }
  }
}

}  // namespace

NodeBins bin_triangles(const SnappedObject& object, int reach, SpillFile* spill) {
  const std::size_t count = object.triangles.size();
  std::vector<ChunkBins> chunks((count + kChunkTriangles - 1) / kChunkTriangles);
  const auto touched = [spill](std::size_t bytes) {
    if (spill != nullptr) spill->touched(bytes);
  };
  tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t c) {
    const std::size_t first = c * kChunkTriangles, last = std::min(count, first + kChunkTriangles);
    bin_chunk(object, reach, first, last, chunks[c]);
    touched((last - first) * sizeof(lattice::LatticeTriangle));
  });

  NodeBins bins;
  place_entries(chunks, bins);
  if (spill == nullptr) {
    bins.own_triangles.resize(bins.first.back());
    bins.triangles = bins.own_triangles;
  } else {
    bins.triangles = spill->array<std::uint32_t>(bins.first.back());
  }
  tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t c) {
    for (const ChunkBins::Entry& entry : chunks[c].entries) {
      bins.triangles[chunks[c].counts[entry.node]++] = entry.triangle;
    }
    touched(chunks[c].entries.size() * sizeof(std::uint32_t));
  });
  return bins;
}

}  // namespace forcelayer::scan
