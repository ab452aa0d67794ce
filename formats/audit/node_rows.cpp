#include "formats/audit/node_rows.h"

#include <algorithm>

namespace forcelayer::voxmap_audit {
namespace {

// Byte z of word y becomes byte y of word z.
void transpose(std::uint64_t (&words)[8]) {
  const auto exchange = [&](std::size_t a, std::size_t b, int shift, std::uint64_t mask) {
    const std::uint64_t differ = (words[a] >> shift ^ words[b]) & mask;
    words[a] ^= differ << shift;
    words[b] ^= differ;
  };
  for (std::size_t i = 0; i < 4; ++i) exchange(i, i + 4, 32, 0x00000000ffffffffu);
  for (const std::size_t i : {0u, 1u, 4u, 5u}) exchange(i, i + 2, 16, 0x0000ffff0000ffffu);
  for (const std::size_t i : {0u, 2u, 4u, 6u}) exchange(i, i + 1, 8, 0x00ff00ff00ff00ffu);
}

void merge(const std::uint64_t* from, std::uint64_t* into, std::int64_t count) {
  for (std::int64_t i = 0; i < count; ++i) into[i] |= from[i];
}

std::uint64_t full(std::uint32_t bit) { return bit != 0 ? ~std::uint64_t{0} : 0; }

}  // namespace

// 8 x 8 rows of a column of bricks, [x][y], as the two bits of the values.
struct NodeRows::ColumnRows {
  std::uint64_t low[8][8], high[8][8];
};

NodeRows::NodeRows(const std::vector<BrickPlanes>& planes, const VoxmapView& view,
                   std::int64_t margin)
    : planes_(planes), view_(view), margin_(margin), width_(kNode + 2 * margin) {
  for (auto& set : sets_) {
    for (Rows& rows : set) rows.resize(static_cast<std::size_t>(width_ * width_));
  }
  sets_[kUpToProximity][kBelow].clear();  // nobody asks
  sets_[kUpToProximity][kAbove].clear();
}

void NodeRows::fill(const Around& around) {
  for (auto& set : sets_) {
    for (const Along along : {kBelow, kMiddle, kAbove}) {
      if (holds_any_[along]) std::fill(set[along].begin(), set[along].end(), 0);
    }
  }
  holds_any_ = {};
  const std::int64_t outside = (margin_ + 7) / 8;  // columns of bricks
  for (std::int64_t x = -outside; x < 8 + outside; ++x) {
    for (std::int64_t y = -outside; y < 8 + outside; ++y) fill_column(around, x, y);
  }
}

const NodeRows::Rows& NodeRows::grown(Set set, std::int64_t steps) {
  const auto& [below, middle, above] = sets_[set];
  along_z_ = middle;
  for (std::int64_t step = 1; step <= steps; ++step) {
    for (std::size_t i = 0; i < middle.size(); ++i) {
      along_z_[i] |=
          middle[i] << step | middle[i] >> step | below[i] >> (64 - step) | above[i] << (64 - step);
    }
  }
  along_y_.assign(static_cast<std::size_t>(width_ * kNode), 0);
  for (std::int64_t x = -steps; x < kNode + steps; ++x) {
    for (std::int64_t step = -steps; step <= steps; ++step) {
      merge(&along_z_[index(x, step)], &along_y_[static_cast<std::size_t>((x + margin_) * kNode)],
            kNode);
    }
  }
  grown_.assign(static_cast<std::size_t>(kNode * kNode), 0);
  for (std::int64_t step = -steps; step <= steps; ++step) {
    merge(&along_y_[static_cast<std::size_t>((step + margin_) * kNode)], grown_.data(),
          kNode * kNode);
  }
  return grown_;
}

// The rows of the column of bricks (x, y); 0 to 7 are the node's own.
void NodeRows::fill_column(const Around& around, std::int64_t x, std::int64_t y) {
  const auto side = static_cast<std::uint32_t>(std::max<std::int64_t>(1, (margin_ + 7) / 8));
  const auto column = static_cast<std::size_t>(((x + 8) / 8 * 3 + (y + 8) / 8) * 3);
  for (const Along along : {kBelow, kMiddle, kAbove}) {
    if (around[column + along] == kFreeEntry) continue;
    const std::uint32_t first = along == kBelow ? 8 - side : 0;
    const std::uint32_t last = along == kAbove ? side - 1 : 7;
    ColumnRows rows;
    const std::int64_t begin = (x & 7) * 64 + (y & 7) * 8;
    if (!column_rows(around[column + along], begin, first, last, rows)) continue;
    holds_any_[along] = true;
    const std::int64_t last_x = std::min<std::int64_t>(8, kNode + margin_ - x * 8);
    for (std::int64_t i = std::max<std::int64_t>(0, -margin_ - x * 8); i < last_x; ++i) {
      store_rows(along, x * 8 + i, y * 8, rows.low[i], rows.high[i]);
    }
  }
}

// Stores those of the 8 rows from (x, y) on that the audit looks at.
void NodeRows::store_rows(Along along, std::int64_t x, std::int64_t y, const std::uint64_t* low,
                          const std::uint64_t* high) {
  const std::int64_t first = std::max<std::int64_t>(0, -margin_ - y);
  const std::int64_t last = std::min<std::int64_t>(8, kNode + margin_ - y);
  const std::size_t at = index(x, y + first);
  std::uint64_t* const interior = &sets_[kInterior][along][at];
  std::uint64_t* const to_surface = &sets_[kUpToSurface][along][at];
  for (std::int64_t j = first; j < last; ++j) {
    interior[j - first] = low[j] & ~high[j];
    to_surface[j - first] = low[j] ^ high[j];
  }
  if (along != kMiddle) return;
  for (std::int64_t j = first; j < last; ++j) {
    sets_[kUpToProximity][kMiddle][at + static_cast<std::size_t>(j - first)] = low[j] | high[j];
  }
}

// Bricks first to last of the column that begins with entry `begin` of a node; the others are
// free. False where all are.
bool NodeRows::column_rows(std::uint32_t node, std::int64_t begin, std::uint32_t first,
                           std::uint32_t last, ColumnRows& rows) const {
  std::uint32_t entries[8];
  bool uniform = true, free = true;
  for (std::uint32_t z = 0; z < 8; ++z) {
    entries[z] = z < first || z > last ? kFreeEntry
                 : is_uniform(node)
                     ? node
                     : view_.lower_nodes[std::int64_t{node} * kNodeEntries + begin + z];
    uniform &= is_uniform(entries[z]);
    free &= without_clearance(entries[z]) == kFreeEntry;
  }
  if (free) return false;
  for (std::size_t x = 0; x < 8; ++x) {
    std::uint64_t(&low)[8] = rows.low[x], (&high)[8] = rows.high[x];
    if (x > 0 && uniform) {
      std::copy(std::begin(rows.low[0]), std::end(rows.low[0]), low);
      std::copy(std::begin(rows.high[0]), std::end(rows.high[0]), high);
      continue;
    }
    for (std::uint32_t z = 0; z < 8; ++z) {
      const std::uint32_t entry = entries[z];
      low[z] = is_uniform(entry) ? full(uniform_value(entry) & 1) : planes_[entry].low[x];
      high[z] = is_uniform(entry) ? full(uniform_value(entry) & 2) : planes_[entry].high[x];
    }
    transpose(low);
    transpose(high);
  }
  return true;
}

}  // namespace forcelayer::voxmap_audit
