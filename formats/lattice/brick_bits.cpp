#include "formats/lattice/brick_bits.h"

namespace forcelayer::lattice {
namespace {

// The reached cells of a plane and their open neighbors in it, two steps far.
std::uint64_t spread_in_plane(std::uint64_t reached, std::uint64_t open) {
  for (int step = 0; step < 2; ++step) {
    reached |= (reached << 8 | reached >> 8 | (reached & ~(kFirstColumn << 7)) << 1 |
                (reached & ~kFirstColumn) >> 1) &
               open;
  }
  return reached;
}

}  // namespace

// Sweeps up and down the planes until nothing more is reached. The next plane sees at once what a
// plane has gained.
BrickMask flooded(const BrickMask& seeds, const BrickMask& open) {
  BrickMask reached = seeds & open;
  std::uint64_t gained = 0;
  const auto visit = [&](std::size_t x, std::uint64_t beside) {
    const std::uint64_t before = reached.words[x];
    reached.words[x] = spread_in_plane(before | (beside & open.words[x]), open.words[x]);
    gained |= reached.words[x] ^ before;
  };
  do {
    gained = 0;
    visit(0, 0);
    for (std::size_t x = 1; x < 8; ++x) visit(x, reached.words[x - 1]);
    visit(7, 0);
    for (std::size_t x = 7; x-- > 0;) visit(x, reached.words[x + 1]);
  } while (gained != 0);
  return reached;
}

}  // namespace forcelayer::lattice
