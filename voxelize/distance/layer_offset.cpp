#include "voxelize/distance/layer_offset.h"

#include <algorithm>
#include <bit>

#include "formats/lattice/brick_bits.h"
#include "voxelize/masks/node_rows.h"

namespace forcelayer::distance {
namespace {

constexpr int kEdge = 64;  // voxels of a node

// Adds the voxels of the halo that lie in the neighboring node (i, j, k), each -1, 0 or 1.
void add_node(const masks::LowerMaskNode& node, int i, int j, int k, NodeHalo& halo) {
  lattice::for_each_set(masks::mask_of(node.getChildMask()), [&](unsigned n) {
    const int x = i * kEdge + static_cast<int>(n >> 6) * 8 + halo.halo();
    const int y = j * kEdge + static_cast<int>(n >> 3 & 7) * 8 + halo.halo();
    const int z = k * kEdge + static_cast<int>(n & 7) * 8 + halo.halo();
    const int width = halo.width();
    if (x <= -8 || x >= width || y <= -8 || y >= width || z <= -8 || z >= width) return;
    const std::uint64_t* words = masks::words_of(*node.getTable()[n].getChild());
    for (int p = std::max(0, -x); p < std::min(8, width - x); ++p) {
      if (words[p] == 0) continue;
      masks::write_rows(words[p], halo.rows(x + p, k + 1) + y, n & 7, std::max(0, -y),
                        std::min(8, width - y));
    }
  });
}

void gather(const masks::MaskTree& geometry, const masks::Coord& origin, NodeHalo& halo) {
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      for (int k = -1; k <= 1; ++k) {
        const masks::Coord at = origin.offsetBy(i * kEdge, j * kEdge, k * kEdge);
        if (const auto* node = geometry.probeConstNode<masks::LowerMaskNode>(at)) {
          add_node(*node, i, j, k, halo);
        }
      }
    }
  }
}

openvdb::CoordBBox node_box(const masks::Coord& origin) {
  return openvdb::CoordBBox::createCube(origin, kEdge);
}

// Bits low..high of a row, each clamped to 0..63; none where the range misses the row.
std::uint64_t row_bits(int low, int high) {
  if (low > 63 || high < 0 || low > high) return 0;
  return lattice::kAllBits << std::max(low, 0) & lattice::kAllBits >> (63 - std::min(high, 63));
}

// Frees the node's voxels outside the box; counts the voxels that are left.
ValueCounts crop(const masks::Coord& origin, const openvdb::CoordBBox& box, NodeCodes& codes) {
  const masks::Coord low = box.min() - origin, high = box.max() - origin;
  const std::uint64_t z_bits = row_bits(low.z(), high.z());
  ValueCounts counts;
  for (int x = 0; x < kEdge; ++x) {
    for (int y = 0; y < kEdge; ++y) {
      const bool inside = x >= low.x() && x <= high.x() && y >= low.y() && y <= high.y();
      const std::uint64_t kept = inside ? z_bits : 0;
      std::uint64_t& l = codes.low[static_cast<std::size_t>(x * kEdge + y)];
      std::uint64_t& h = codes.high[static_cast<std::size_t>(x * kEdge + y)];
      l &= kept;
      h &= kept;
      counts.interior += static_cast<std::uint64_t>(std::popcount(l & ~h));
      counts.surface += static_cast<std::uint64_t>(std::popcount(h & ~l));
      counts.proximity += static_cast<std::uint64_t>(std::popcount(l & h));
    }
  }
  return counts;
}

}  // namespace

LayerOffset::LayerOffset(const masks::MaskTree& geometry, const masks::MaskTree& interior,
                         unsigned layers, unsigned force_layers, const masks::KeptBox& kept)
    : geometry_(geometry),
      interior_(interior),
      layers_(static_cast<int>(layers)),
      force_layers_(static_cast<int>(force_layers)),
      kept_(kept) {}

// Adds the nodes of solids that the border of the kept box cuts.
void LayerOffset::add_cut_solids(std::vector<masks::Coord>& origins) const {
  const masks::Coord low = kept_.box.min() >> 6, high = kept_.box.max() >> 6;
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      const bool border = x == low.x() || x == high.x() || y == low.y() || y == high.y();
      for (int z = low.z(); z <= high.z(); z += border || z == high.z() ? 1 : high.z() - low.z()) {
        const masks::Coord origin(x * kEdge, y * kEdge, z * kEdge);
        if (kept_.box.isInside(node_box(origin))) continue;
        if (interior_.probeConstNode<masks::LowerMaskNode>(origin) != nullptr) continue;
        if (interior_.isValueOn(origin)) origins.push_back(origin);
      }
    }
  }
}

std::vector<masks::Coord> LayerOffset::nodes() const {
  const int reach = layers_ + force_layers_;
  std::vector<masks::Coord> origins;
  for (auto upper = geometry_.cbeginChildOn(); upper; ++upper) {
    for (auto node = upper->cbeginChildOn(); node; ++node) {
      // The box of its bricks decides which neighbors it can reach.
      openvdb::CoordBBox box;
      lattice::for_each_set(masks::mask_of(node->getChildMask()), [&](unsigned n) {
        box.expand(openvdb::CoordBBox::createCube(masks::entry_origin(node->origin(), n, 8), 8));
      });
      box.expand(reach);
      box.intersect(kept_.box);
      for (int x = box.min().x() >> 6; x <= box.max().x() >> 6; ++x) {
        for (int y = box.min().y() >> 6; y <= box.max().y() >> 6; ++y) {
          for (int z = box.min().z() >> 6; z <= box.max().z() >> 6; ++z) {
            origins.emplace_back(x * kEdge, y * kEdge, z * kEdge);
          }
        }
      }
    }
  }
  if (kept_.cropped()) add_cut_solids(origins);
  std::sort(origins.begin(), origins.end());
  origins.erase(std::unique(origins.begin(), origins.end()), origins.end());
  return origins;
}

ValueCounts LayerOffset::codes(const masks::Coord& origin, NodeHalo& halo, NodeCodes& codes) const {
  masks::node_rows(interior_, origin, codes.low);
  halo.begin(layers_, force_layers_);
  gather(geometry_, origin, halo);
  const ValueCounts counts = offset_node(halo, codes);
  if (!kept_.cropped() || kept_.box.isInside(node_box(origin))) return counts;
  return crop(origin, kept_.box, codes);
}

}  // namespace forcelayer::distance
