#include "voxelize/tree/node_memory.h"

#include "voxelize/cache/byte_pack.h"

namespace forcelayer::tree {
namespace {

constexpr const char* kKind = "nodes";
constexpr std::uint32_t kVersion = 1;  // of the record; the nodes' own version is in their keys

static_assert(sizeof(NodeMemo) == 88);

}  // namespace

NodeMemory::NodeMemory(const cache::CacheFolder& cache, std::string_view scene, double voxel_size_m)
    : cache_(cache),
      slot_(cache::DigestBuilder()
                .text(kKind)
                .value(kVersion)
                .text(scene)
                .value(voxel_size_m)
                .finish()),
      entry_(cache.find(kKind, slot_)) {
  if (!entry_) return;
  try {
    read(entry_->bytes());
  } catch (const cache::BadPack&) {
    index_.clear();
  }
}

void NodeMemory::read(std::span<const std::byte> bytes) {
  cache::ByteUnpacker unpacker(bytes);
  memos_ = unpacker.list<NodeMemo>();
  nodes_ = StoredNodes(unpacker, 1);
  unpacker.expect_end();
  index_.reserve(memos_.size());
  for (const NodeMemo& memo : memos_) {
    if (!nodes_.has(memo.entry)) throw cache::BadPack{};
    index_.emplace(memo.key, &memo);
  }
}

const NodeMemo* NodeMemory::find(const cache::Digest& key) const {
  ++asked_;
  const auto found = index_.find(key);
  if (found == index_.end()) return nullptr;
  ++found_;
  return found->second;
}

BuiltNode NodeMemory::node(const NodeMemo& memo) const {
  BuiltNode node = nodes_.node(memo.entry);
  node.finished = true;
  node.node_gaps = memo.gaps;
  return node;
}

void NodeMemory::keep(const std::vector<NodeMemo>& nodes, const VoxelTree& tree) const {
  cache::BytePacker packer;
  packer.reserve(nodes.size() * sizeof(NodeMemo) +
                 (tree.lower_nodes.size() + tree.bricks.size()) * sizeof(std::uint32_t) + 64);
  packer.list(nodes);
  StoredNodes::keep(tree, packer);
  cache_.keep(kKind, slot_, packer.bytes());
}

}  // namespace forcelayer::tree
