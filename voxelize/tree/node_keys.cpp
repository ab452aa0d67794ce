#include "voxelize/tree/node_keys.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <array>
#include <unordered_map>

#include "formats/lattice/brick_bits.h"
#include "voxelize/cache/cache_versions.h"
#include "voxelize/masks/voxel_box.h"

namespace forcelayer {
namespace {

constexpr int kEdge = 64;

struct CoordHash {
  std::size_t operator()(const Coord& c) const { return IndexHash()({c.x(), c.y(), c.z()}); }
};

using NodeDigests = std::unordered_map<Coord, Digest, CoordHash>;

constexpr Digest kFreeNode{1, 0}, kSolidNode{2, 0};  // nodes without surface

class NodeKeys {
 public:
  explicit NodeKeys(const LayerOffset& offset) : offset_(offset) {}

  std::vector<Digest> run(const std::vector<Coord>& origins) const {
    const NodeDigests contents = of_contents();
    // A node's voxels depend on G and I of the 27 nodes around it, its clearance on the voxels of
    // those. A node that the offset leaves out is uniform.
    const std::vector<Digest> voxels = combined(origins, [&](const Coord& node) {
      const auto found = contents.find(node);
      return found != contents.end() ? found->second : uniform(node);
    });
    NodeDigests of_voxels(origins.size());
    for (std::size_t i = 0; i < origins.size(); ++i) of_voxels.emplace(origins[i], voxels[i]);
    return combined(origins, [&](const Coord& node) {
      const auto found = of_voxels.find(node);
      return found != of_voxels.end() ? found->second : uniform(node);
    });
  }

 private:
  Digest uniform(const Coord& node) const {
    return offset_.interior().isValueOn(node) ? kSolidNode : kFreeNode;
  }

  // G and I of every node that holds surface.
  NodeDigests of_contents() const {
    std::vector<const LowerMaskNode*> nodes;
    for (auto upper = offset_.geometry().cbeginChildOn(); upper; ++upper) {
      for (auto node = upper->cbeginChildOn(); node; ++node) nodes.push_back(&*node);
    }
    std::vector<Digest> digests(nodes.size());
    tbb::enumerable_thread_specific<std::vector<BrickMask>> buffers;
    tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) {
      std::vector<BrickMask>& buffer = buffers.local();
      buffer.clear();
      append(*nodes[i], buffer);
      const Coord& origin = nodes[i]->origin();
      if (const auto* interior = offset_.interior().probeConstNode<LowerMaskNode>(origin)) {
        append(*interior, buffer);
      } else if (offset_.interior().isValueOn(origin)) {
        buffer.push_back(full_mask());
      }
      digests[i] = digest_of(std::as_bytes(std::span(buffer)));
    });
    NodeDigests result(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) result.emplace(nodes[i]->origin(), digests[i]);
    return result;
  }

  static void append(const LowerMaskNode& node, std::vector<BrickMask>& buffer) {
    const BrickMask leaves = mask_of(node.getChildMask());
    buffer.push_back(mask_of(node.getValueMask()));
    buffer.push_back(leaves);
    for_each_set(leaves,
                 [&](unsigned n) { buffer.push_back(brick_of(*node.getTable()[n].getChild())); });
  }

  // The digest of the 27 nodes around each of `origins`.
  template <class DigestOf>
  std::vector<Digest> combined(const std::vector<Coord>& origins, const DigestOf& digest_at) const {
    std::vector<Digest> result(origins.size());
    tbb::parallel_for(std::size_t{0}, origins.size(), [&](std::size_t i) {
      std::array<Digest, 28> inputs;
      inputs[27] = {kNodeCacheVersion, static_cast<std::uint64_t>(offset_.layers())};
      for (int n = 0; n < 27; ++n) {
        inputs[static_cast<std::size_t>(n)] = digest_at(
            origins[i].offsetBy((n / 9 - 1) * kEdge, (n / 3 % 3 - 1) * kEdge, (n % 3 - 1) * kEdge));
      }
      result[i] = digest_of(std::as_bytes(std::span(inputs)));
    });
    return result;
  }

  const LayerOffset& offset_;
};

}  // namespace

std::vector<Digest> node_keys(const LayerOffset& offset, const std::vector<Coord>& origins) {
  return NodeKeys(offset).run(origins);
}

}  // namespace forcelayer
