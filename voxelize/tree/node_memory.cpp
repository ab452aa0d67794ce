#include "voxelize/tree/node_memory.h"

#include <algorithm>
#include <cstring>

#include "formats/lattice/brick_bits.h"
#include "voxelize/cache/byte_pack.h"

namespace forcelayer::tree {
namespace {

constexpr const char* kKind = "nodes";
constexpr std::uint32_t kVersion = 1;  // of the record; the nodes' own version is in their keys
constexpr std::size_t kBrickWords = std::tuple_size_v<Brick>;

static_assert(sizeof(NodeMemo) == 88);

bool is_child_below(std::uint32_t entry, std::size_t count) {
  return is_uniform(entry) || entry < count;
}

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
  lower_nodes_ = unpacker.list<std::uint32_t>();
  bricks_ = unpacker.list<std::uint32_t>();
  unpacker.expect_end();
  const std::size_t lower_count = lower_nodes_.size() / kNodeEntries;
  const std::size_t brick_count = bricks_.size() / kBrickWords;
  if (!std::all_of(lower_nodes_.begin(), lower_nodes_.end(),
                   [&](std::uint32_t entry) { return is_child_below(entry, brick_count); })) {
    throw cache::BadPack{};
  }
  index_.reserve(memos_.size());
  for (const NodeMemo& memo : memos_) {
    if (!is_child_below(memo.entry, lower_count)) throw cache::BadPack{};
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
  BuiltNode node;
  node.finished = true;
  node.node_gaps = memo.gaps;
  if (is_uniform(memo.entry)) {
    node.entries.fill(memo.entry);
    return node;
  }
  const auto entries = lower_nodes_.subspan(std::size_t{memo.entry} * kNodeEntries, kNodeEntries);
  node.bricks.reserve(static_cast<std::size_t>(std::count_if(
      entries.begin(), entries.end(), [](auto entry) { return !is_uniform(entry); })));
  for (unsigned n = 0; n < kNodeEntries; ++n) {
    node.entries[n] = entries[n];
    if (!is_free(entries[n])) set(node.held, n);
    if (is_uniform(entries[n])) continue;
    node.entries[n] = static_cast<std::uint32_t>(node.bricks.size());
    std::memcpy(node.bricks.emplace_back().data(),
                bricks_.data() + std::size_t{entries[n]} * kBrickWords, sizeof(Brick));
  }
  return node;
}

void NodeMemory::keep(const std::vector<NodeMemo>& nodes, const VoxelTree& tree) const {
  cache::BytePacker packer;
  packer.reserve(nodes.size() * sizeof(NodeMemo) +
                 (tree.lower_nodes.size() + tree.bricks.size()) * sizeof(std::uint32_t) + 64);
  packer.list(nodes);
  packer.list(tree.lower_nodes);
  packer.list(tree.bricks);
  cache_.keep(kKind, slot_, packer.bytes());
}

}  // namespace forcelayer::tree
