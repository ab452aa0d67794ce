#include "voxelize/tree/side_gaps.h"

#include <bit>

#include "formats/lattice/brick_bits.h"

namespace forcelayer::tree {
namespace {

// Bits y*8 + z of the rows and columns within n steps of the facing side: [(dy+1)*3 + (dz+1)][n].
struct FacingBits {
  std::array<std::array<std::uint64_t, 8>, 9> within{};

  constexpr FacingBits() {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dz = -1; dz <= 1; ++dz) {
        for (unsigned n = 0; n < 8; ++n) {
          std::uint64_t bits = 0;
          for (unsigned y = 0; y < 8; ++y) {
            for (unsigned z = 0; z < 8; ++z) {
              if (detail::behind(y, dy) <= n && detail::behind(z, dz) <= n)
                bits |= std::uint64_t{1} << (y * 8 + z);
            }
          }
          within[static_cast<std::size_t>((dy + 1) * 3 + dz + 1)][n] = bits;
        }
      }
    }
  }
};
constexpr FacingBits kFacing;

detail::Shells make_shells() {
  detail::Shells shells;
  for (unsigned direction = 0; direction < kDirections; ++direction) {
    const int dx = static_cast<int>(direction / 9) - 1,
              dy = static_cast<int>(direction / 3 % 3) - 1,
              dz = static_cast<int>(direction % 3) - 1;
    for (unsigned n = 0; n < 512; ++n) {
      const unsigned steps = std::max(
          {detail::behind(n >> 6, dx), detail::behind(n >> 3 & 7, dy), detail::behind(n & 7, dz)});
      set(shells[direction][steps], n);
    }
  }
  return shells;
}

}  // namespace

const detail::Shells detail::kShells = make_shells();

BrickGaps::BrickGaps(const lattice::BrickMask& non_free) {
  // The union of the planes within n steps of the far end along x, of all planes, and of the planes
  // within n steps of the near end: [dx + 1][n].
  std::array<std::array<std::uint64_t, 8>, 3> along_x;
  std::uint64_t from_low = 0, from_high = 0;
  for (std::size_t n = 0; n < 8; ++n) {
    along_x[2][n] = from_low |= non_free.words[n];
    along_x[0][n] = from_high |= non_free.words[7 - n];
  }
  along_x[1].fill(from_low);
  for (unsigned direction = 0; direction < kDirections; ++direction) {
    const auto& words = along_x[direction / 9];
    const auto& facing = kFacing.within[direction % 9];
    // Bisection for the least n within which a voxel lies.
    unsigned steps = (words[3] & facing[3]) != 0 ? 0 : 4;
    steps += (words[steps + 1] & facing[steps + 1]) != 0 ? 0 : 2;
    steps += (words[steps] & facing[steps]) != 0 ? 0 : 1;
    nibbles_[direction >> 4] |= std::uint64_t{steps} << 4 * (direction & 15);
  }
}

}  // namespace forcelayer::tree
