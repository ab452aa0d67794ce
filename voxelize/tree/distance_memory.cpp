#include "voxelize/tree/distance_memory.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "formats/lattice/brick_bits.h"
#include "voxelize/cache/byte_pack.h"
#include "voxelize/cache/cache_versions.h"
#include "voxelize/tree/brick_cutter.h"

namespace forcelayer::tree {

struct DistanceMemory::Memo {
  cache::Digest key;
  std::uint32_t distances = 0, objects = 0;          // as in Kept
  std::uint32_t first_number = 0, number_count = 0;  // in numbers_
};

namespace {

constexpr const char* kKind = "distance";
constexpr std::uint32_t kVersion = 1;  // of the record; that of the distances is in the keys
constexpr int kNodeEdge = 64;

// The bricks of a mask tree in a node and around it. The side of a voxel is found from voxels that
// lie less than a brick outside the node.
class BricksAround {
 public:
  BricksAround(const masks::MaskTree& tree, const masks::Coord& origin) {
    for (int n = 0; n < 27; ++n) {
      const masks::Coord at = origin.offsetBy((n / 9 - 1) * kNodeEdge, (n / 3 % 3 - 1) * kNodeEdge,
                                              (n % 3 - 1) * kNodeEdge);
      auto& [node, is_full] = nodes_[static_cast<std::size_t>(n)];
      node = tree.probeConstNode<masks::LowerMaskNode>(at);
      is_full = node == nullptr && tree.isValueOn(at);
    }
  }

  // Appends the number and the bits of every brick that is not empty.
  void append(std::vector<std::uint64_t>& words) const {
    for (int x = -1; x <= 8; ++x) {
      for (int y = -1; y <= 8; ++y) {
        for (int z = -1; z <= 8; ++z) append_brick(x, y, z, words);
      }
    }
    words.push_back(UINT64_MAX);
  }

 private:
  struct Around {
    const masks::LowerMaskNode* node = nullptr;
    bool is_full = false;
  };

  void append_brick(int x, int y, int z, std::vector<std::uint64_t>& words) const {
    const auto third = [](int at) { return at < 0 ? 0 : at < 8 ? 1 : 2; };
    const auto& [node, is_full] =
        nodes_[static_cast<std::size_t>(third(x) * 9 + third(y) * 3 + third(z))];
    if (node == nullptr && !is_full) return;
    const auto number = static_cast<std::uint64_t>((x + 1) * 100 + (y + 1) * 10 + z + 1);
    const auto n = static_cast<openvdb::Index>((x & 7) << 6 | (y & 7) << 3 | (z & 7));
    if (node != nullptr && node->isChildMaskOn(n)) {
      const lattice::BrickMask mask = masks::brick_of(*node->getTable()[n].getChild());
      words.push_back(number);
      words.insert(words.end(), mask.words.begin(), mask.words.end());
    } else if (is_full || node->isValueMaskOn(n)) {
      words.push_back(number | std::uint64_t{1} << 32);
    }
  }

  std::array<Around, 27> nodes_;
};

// An element of a tree of objects under the numbers of this bake.
class Renumbering {
 public:
  Renumbering(std::span<const std::uint32_t> from, std::span<const std::uint32_t> to)
      : from_(from),
        to_(to),
        changes_(!std::equal(from.begin(), from.end(), to.begin(), to.end())) {}

  bool changes() const { return changes_; }

  void run(BuiltNode& node) const {
    for (std::uint32_t& entry : node.entries) {
      if (is_uniform(entry)) entry = uniform_entry(of(uniform_wide_value(entry)));
    }
    std::array<std::uint16_t, sizeof(Brick) / 2> numbers;
    for (Brick& part : node.bricks) {
      std::memcpy(numbers.data(), part.data(), sizeof part);
      for (std::uint16_t& number : numbers) number = static_cast<std::uint16_t>(of(number));
      std::memcpy(part.data(), numbers.data(), sizeof part);
    }
  }

 private:
  std::uint32_t of(std::uint32_t number) const {
    const auto at = std::lower_bound(from_.begin(), from_.end(), number);
    if (at == from_.end() || *at != number) return number;  // 0
    return to_[static_cast<std::size_t>(at - from_.begin())];
  }

  std::span<const std::uint32_t> from_, to_;
  bool changes_;
};

}  // namespace

DistanceMemory::DistanceMemory(const cache::CacheFolder& cache, std::string_view scene,
                               double voxel_size_m, std::vector<cache::Digest> object_keys)
    : cache_(cache),
      object_keys_(std::move(object_keys)),
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

void DistanceMemory::read(std::span<const std::byte> bytes) {
  cache::ByteUnpacker unpacker(bytes);
  memos_ = unpacker.list<Memo>();
  numbers_ = unpacker.list<std::uint32_t>();
  distances_ = StoredNodes(unpacker, kDistanceBrickParts);
  objects_ = StoredNodes(unpacker, kObjectBrickParts);
  unpacker.expect_end();
  index_.reserve(memos_.size());
  for (const Memo& memo : memos_) {
    if (!distances_.has(memo.distances) || !objects_.has(memo.objects) ||
        std::uint64_t{memo.first_number} + memo.number_count > numbers_.size()) {
      throw cache::BadPack{};
    }
    index_.emplace(memo.key, &memo);
  }
}

cache::Digest DistanceMemory::key(const distance::DistanceCodes& distances,
                                  const masks::Coord& origin) const {
  thread_local std::vector<std::uint64_t> words;
  words.clear();
  BricksAround(distances.geometry(), origin).append(words);
  BricksAround(distances.interior(), origin).append(words);
  const distance::CodeScale& scale = distances.scale();
  cache::DigestBuilder digest;
  digest.value(cache::kDistanceCacheVersion).value(std::uint32_t{distances.tells_objects()});
  for (const double x : {scale.zero_force, scale.force_depth, scale.quantum}) digest.value(x);
  digest.value(scale.zero_code);
  for (const std::int64_t x : distances.node_at(origin)) digest.value(x);
  for (const std::uint32_t object : distances.objects_near(origin)) {
    digest.value(object_keys_[object].low).value(object_keys_[object].high);
  }
  return digest.bytes(std::as_bytes(std::span(words))).finish();
}

std::optional<MeasuredNode> DistanceMemory::find(const cache::Digest& key,
                                                 const distance::DistanceCodes& distances,
                                                 const masks::Coord& origin) const {
  ++asked_;
  const auto found = index_.find(key);
  if (found == index_.end()) return std::nullopt;
  const Memo& memo = *found->second;
  MeasuredNode node{distances_.node(memo.distances), {}};
  if (distances.tells_objects()) {
    const std::vector<std::uint32_t> numbers = distances.numbers_near(origin);
    if (numbers.size() != memo.number_count) return std::nullopt;
    node.objects = objects_.node(memo.objects);
    const Renumbering now(numbers_.subspan(memo.first_number, memo.number_count), numbers);
    if (now.changes()) now.run(node.objects);
  }
  ++found_;
  return node;
}

void DistanceMemory::keep(const std::vector<Kept>& nodes, const distance::DistanceCodes& distances,
                          const VoxelTree& distance_tree, const VoxelTree& object_tree) const {
  std::vector<Memo> memos;
  std::vector<std::uint32_t> numbers;
  memos.reserve(nodes.size());
  for (const Kept& node : nodes) {
    const std::vector<std::uint32_t> near = distances.numbers_near(node.origin);
    memos.push_back({node.key, node.distances, node.objects,
                     static_cast<std::uint32_t>(numbers.size()),
                     static_cast<std::uint32_t>(near.size())});
    numbers.insert(numbers.end(), near.begin(), near.end());
  }
  cache::BytePacker packer;
  packer.list(memos);
  packer.list(numbers);
  StoredNodes::keep(distance_tree, packer);
  StoredNodes::keep(object_tree, packer);
  cache_.keep(kKind, slot_, packer.bytes());
}

}  // namespace forcelayer::tree
