#include "voxelize/tree/sharing.h"

#include <tbb/parallel_for.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <bit>
#include <cstring>
#include <span>

namespace forcelayer::tree {
namespace {

// Finds equal records among many, in parallel. Records are dealt out by hash to buckets; a hash
// table for each bucket keeps the first record of every kind.
class FirstOfEqual {
 public:
  // `record(i)` is the memory of record i; all have `bytes` bytes.
  template <class Record>
  FirstOfEqual(std::size_t count, std::size_t bytes, const Record& record)
      : hashes_(count), first_(count) {
    tbb::parallel_for(std::size_t{0}, count,
                      [&](std::size_t i) { hashes_[i] = XXH3_64bits(record(i), bytes); });
    deal();
    tbb::parallel_for(std::size_t{0}, kBuckets, [&](std::size_t bucket) {
      search(bucket, [&](std::size_t a, std::size_t b) {
        return std::memcmp(record(a), record(b), bytes) == 0;
      });
    });
  }

  // The lowest number of a record equal to record i.
  std::uint32_t first(std::size_t i) const { return first_[i]; }

  // Numbers the different records in the order of their first; [i] is the number of record i's
  // kind. Returns how many there are.
  std::uint32_t number(std::vector<std::uint32_t>& numbers) const {
    numbers.resize(first_.size());
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < first_.size(); ++i) {
      numbers[i] = first_[i] == i ? next++ : numbers[first_[i]];
    }
    return next;
  }

 private:
  static constexpr std::size_t kBuckets = 64;
  static constexpr int kBucketShift = 58;

  // Sorts the records by bucket, ascending within each.
  void deal() {
    begin_.assign(kBuckets + 1, 0);
    for (const std::uint64_t hash : hashes_) ++begin_[(hash >> kBucketShift) + 1];
    for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) begin_[bucket + 1] += begin_[bucket];
    dealt_.resize(hashes_.size());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < hashes_.size(); ++i) {
      dealt_[next[hashes_[i] >> kBucketShift]++] = static_cast<std::uint32_t>(i);
    }
  }

  template <class Equal>
  void search(std::size_t bucket, const Equal& equal) {
    constexpr std::uint32_t kEmpty = UINT32_MAX;
    const std::span records(dealt_.data() + begin_[bucket], begin_[bucket + 1] - begin_[bucket]);
    const std::size_t mask = std::bit_ceil(2 * records.size() + 1) - 1;
    std::vector<std::uint32_t> table(mask + 1, kEmpty);
    for (const std::uint32_t i : records) {
      std::size_t slot = hashes_[i] & mask;
      while (table[slot] != kEmpty &&
             (hashes_[table[slot]] != hashes_[i] || !equal(table[slot], i))) {
        slot = (slot + 1) & mask;
      }
      if (table[slot] == kEmpty) table[slot] = i;
      first_[i] = table[slot];
    }
  }

  std::vector<std::uint64_t> hashes_;
  std::vector<std::uint32_t> first_, dealt_;
  std::vector<std::size_t> begin_;
};

struct BrickPlace {
  std::uint32_t node, brick;
};

// The different bricks. Entries of lower nodes become numbers of these.
std::vector<std::uint32_t> share_bricks(std::vector<BuiltNode>& nodes, std::uint32_t parts) {
  std::vector<std::uint32_t> first_brick(nodes.size() + 1, 0);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    first_brick[i + 1] =
        first_brick[i] + static_cast<std::uint32_t>(nodes[i].bricks.size()) / parts;
  }
  std::vector<BrickPlace> places(first_brick.back());
  tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) {
    for (std::uint32_t b = 0; b < nodes[i].bricks.size() / parts; ++b) {
      places[first_brick[i] + b] = {static_cast<std::uint32_t>(i), b};
    }
  });
  const std::size_t words = std::tuple_size_v<Brick> * parts;
  const auto brick = [&](std::size_t i) -> const Brick& {
    return nodes[places[i].node].bricks[std::size_t{places[i].brick} * parts];
  };
  const FirstOfEqual equal(places.size(), sizeof(Brick) * parts,
                           [&](std::size_t i) { return brick(i).data(); });
  std::vector<std::uint32_t> numbers;
  const std::uint32_t count = equal.number(numbers);

  std::vector<std::uint32_t> bricks(count * words);
  tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) {
    BuiltNode& node = nodes[i];
    for (std::uint32_t b = 0; b < node.bricks.size() / parts; ++b) {
      const std::uint32_t at = first_brick[i] + b;
      if (equal.first(at) != at) continue;
      std::memcpy(bricks.data() + numbers[at] * words, node.bricks[std::size_t{b} * parts].data(),
                  sizeof(Brick) * parts);
    }
    for (std::uint32_t& entry : node.entries) {
      if (!is_uniform(entry)) entry = numbers[first_brick[i] + entry];
    }
    node.bricks = {};
  });
  return bricks;
}

// The different nodes; `numbers` maps each to its number. `entries(i)` are the entries of node i.
template <class EntriesOf>
std::vector<std::uint32_t> share_nodes(std::size_t count, const EntriesOf& entries,
                                       std::vector<std::uint32_t>& numbers) {
  const FirstOfEqual equal(count, sizeof(Entries),
                           [&](std::size_t i) { return entries(i).data(); });
  std::vector<std::uint32_t> nodes(std::size_t{equal.number(numbers)} * kNodeEntries);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    if (equal.first(i) != i) return;
    std::memcpy(nodes.data() + std::size_t{numbers[i]} * kNodeEntries, entries(i).data(),
                sizeof(Entries));
  });
  return nodes;
}

}  // namespace

VoxelTree share_equal(BuiltTree&& built, std::vector<std::uint32_t>& lower_numbers) {
  VoxelTree tree;
  for (BuiltNode& node : built.lower) node.gaps = {};
  tree.bricks = share_bricks(built.lower, built.brick_parts);
  tree.lower_nodes = share_nodes(
      built.lower.size(), [&](std::size_t i) -> const Entries& { return built.lower[i].entries; },
      lower_numbers);
  for (Entries& entries : built.upper) {
    for (std::uint32_t& entry : entries) {
      if (!is_uniform(entry)) entry = lower_numbers[entry];
    }
  }
  std::vector<std::uint32_t> numbers;
  tree.upper_nodes = share_nodes(
      built.upper.size(), [&](std::size_t i) -> const Entries& { return built.upper[i]; }, numbers);
  tree.directory = std::move(built.directory);
  for (std::uint32_t& entry : tree.directory) {
    if (!is_uniform(entry)) entry = numbers[entry];
  }
  return tree;
}

}  // namespace forcelayer::tree
