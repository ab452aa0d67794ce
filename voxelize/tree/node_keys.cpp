#include "voxelize/tree/node_keys.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <array>
#include <unordered_map>

#include "formats/lattice/brick_bits.h"
#include "voxelize/cache/cache_versions.h"
#include "voxelize/masks/voxel_box.h"

namespace forcelayer::tree {
namespace {

constexpr int kEdge = 64;

struct CoordHash {
  std::size_t operator()(const masks::Coord& c) const {
    return masks::IndexHash()({c.x(), c.y(), c.z()});
  }
};

using NodeDigests = std::unordered_map<masks::Coord, cache::Digest, CoordHash>;

constexpr cache::Digest kFreeNode{1, 0}, kSolidNode{2, 0};  // nodes without surface

class NodeKeys {
 public:
  explicit NodeKeys(const distance::LayerOffset& offset) : offset_(offset) {}

  std::vector<cache::Digest> run(const std::vector<masks::Coord>& origins) const {
    const NodeDigests contents = of_contents();
    // A node's voxels depend on G and I of the 27 nodes around it, its clearance on the voxels of
    // those. A node that the offset leaves out is uniform.
    const std::vector<cache::Digest> voxels = combined(origins, [&](const masks::Coord& node) {
      const auto found = contents.find(node);
      return found != contents.end() ? found->second : uniform(node);
    });
    NodeDigests of_voxels(origins.size());
    for (std::size_t i = 0; i < origins.size(); ++i) of_voxels.emplace(origins[i], voxels[i]);
    return combined(origins, [&](const masks::Coord& node) {
      const auto found = of_voxels.find(node);
      return found != of_voxels.end() ? found->second : uniform(node);
    });
  }

 private:
  cache::Digest uniform(const masks::Coord& node) const {
    return offset_.interior().isValueOn(node) ? kSolidNode : kFreeNode;
  }

  // G and I of every node that holds surface.
  NodeDigests of_contents() const {
    std::vector<const masks::LowerMaskNode*> nodes;
    for (auto upper = offset_.geometry().cbeginChildOn(); upper; ++upper) {
      for (auto node = upper->cbeginChildOn(); node; ++node) nodes.push_back(&*node);
    }
    std::vector<cache::Digest> digests(nodes.size());
    tbb::enumerable_thread_specific<std::vector<lattice::BrickMask>> buffers;
    tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) {
      std::vector<lattice::BrickMask>& buffer = buffers.local();
      buffer.clear();
      append(*nodes[i], buffer);
      const masks::Coord& origin = nodes[i]->origin();
      if (const auto* interior = offset_.interior().probeConstNode<masks::LowerMaskNode>(origin)) {
        append(*interior, buffer);
      } else if (offset_.interior().isValueOn(origin)) {
        buffer.push_back(lattice::full_mask());
      }
      digests[i] = cache::digest_of(std::as_bytes(std::span(buffer)));
    });
    NodeDigests result(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) result.emplace(nodes[i]->origin(), digests[i]);
    return result;
  }

  static void append(const masks::LowerMaskNode& node, std::vector<lattice::BrickMask>& buffer) {
    const lattice::BrickMask leaves = masks::mask_of(node.getChildMask());
    buffer.push_back(masks::mask_of(node.getValueMask()));
    buffer.push_back(leaves);
    lattice::for_each_set(leaves, [&](unsigned n) {
      buffer.push_back(masks::brick_of(*node.getTable()[n].getChild()));
    });
  }

  // The digest of the 27 nodes around each of `origins`.
  template <class DigestOf>
  std::vector<cache::Digest> combined(const std::vector<masks::Coord>& origins,
                                      const DigestOf& digest_at) const {
    std::vector<cache::Digest> result(origins.size());
    tbb::parallel_for(std::size_t{0}, origins.size(), [&](std::size_t i) {
      std::array<cache::Digest, 28> inputs;
      inputs[27] = {cache::kNodeCacheVersion,
                    static_cast<std::uint64_t>(offset_.layers()) << 32 |
                        static_cast<std::uint64_t>(offset_.force_layers())};
      for (int n = 0; n < 27; ++n) {
        inputs[static_cast<std::size_t>(n)] = digest_at(
            origins[i].offsetBy((n / 9 - 1) * kEdge, (n / 3 % 3 - 1) * kEdge, (n % 3 - 1) * kEdge));
      }
      result[i] = cache::digest_of(std::as_bytes(std::span(inputs)));
    });
    return result;
  }

  const distance::LayerOffset& offset_;
};

}  // namespace

std::vector<cache::Digest> node_keys(const distance::LayerOffset& offset,
                                     const std::vector<masks::Coord>& origins) {
  return NodeKeys(offset).run(origins);
}

}  // namespace forcelayer::tree
