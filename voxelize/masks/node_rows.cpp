#include "voxelize/masks/node_rows.h"

#include "formats/lattice/brick_bits.h"

namespace forcelayer::masks {
namespace {

std::uint64_t read_rows(const std::uint64_t* rows, unsigned byte) {
  std::uint64_t word = 0;
  for (unsigned y = 0; y < 8; ++y) word |= (rows[y] >> (8 * byte) & 0xff) << (8 * y);
  return word;
}

}  // namespace

void node_rows(const MaskTree& tree, const Coord& origin, NodeRows& rows) {
  const auto* node = tree.probeConstNode<LowerMaskNode>(origin);
  if (node == nullptr) {
    rows.fill(tree.isValueOn(origin) ? lattice::kAllBits : 0);
    return;
  }
  rows.fill(0);
  const lattice::BrickMask leaves = mask_of(node->getChildMask());
  lattice::for_each_set(leaves | mask_of(node->getValueMask()), [&](unsigned n) {
    const std::uint64_t* words =
        test(leaves, n) ? words_of(*node->getTable()[n].getChild()) : nullptr;
    std::uint64_t* first = rows.data() + (n >> 6) * 8 * 64 + (n >> 3 & 7) * 8;
    for (int x = 0; x < 8; ++x) {
      write_rows(words == nullptr ? lattice::kAllBits : words[x], first + x * 64, n & 7);
    }
  });
}

std::unique_ptr<LowerMaskNode> node_of_rows(const NodeRows& rows, const Coord& origin) {
  auto node = std::make_unique<LowerMaskNode>(origin, false, false);
  for (unsigned column = 0; column < 64; ++column) {
    const std::uint64_t* first = rows.data() + (column >> 3) * 8 * 64 + (column & 7) * 8;
    std::uint64_t any = 0;
    for (unsigned n = 0; n < 64; ++n) any |= first[(n >> 3) * 64 + (n & 7)];
    for (unsigned z = 0; z < 8; ++z) {
      if ((any >> (8 * z) & 0xff) == 0) continue;
      lattice::BrickMask mask;
      for (unsigned x = 0; x < 8; ++x) mask.words[x] = read_rows(first + x * 64, z);
      const unsigned n = column << 3 | z;
      auto leaf = std::make_unique<MaskLeaf>(entry_origin(origin, n, 8), false);
      assign(*leaf, mask);
      node->addLeaf(leaf.release());
    }
  }
  return node;
}

}  // namespace forcelayer::masks
