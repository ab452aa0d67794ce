#include "formats/audit/brick_facts.h"

#include <bit>
#include <cstring>

namespace forcelayer::voxmap_audit {
namespace {

// The bits of even places, side by side.
constexpr std::uint64_t even_bits(std::uint64_t bits) {
  bits &= 0x5555555555555555u;
  bits = (bits | bits >> 1) & 0x3333333333333333u;
  bits = (bits | bits >> 2) & 0x0f0f0f0f0f0f0f0fu;
  bits = (bits | bits >> 4) & 0x00ff00ff00ff00ffu;
  bits = (bits | bits >> 8) & 0x0000ffff0000ffffu;
  return (bits | bits >> 16) & 0xffffffffu;
}

std::uint16_t count(const std::array<std::uint64_t, 8>& words) {
  int sum = 0;
  for (const std::uint64_t word : words) sum += std::popcount(word);
  return static_cast<std::uint16_t>(sum);
}

// The layers of a word along y and z that are at most `depth` from the lower or the upper side.
struct Slabs {
  std::array<std::uint64_t, 8> y[2], z[2];  // [upper][depth]
};
constexpr Slabs kSlabs = [] {
  Slabs slabs;
  for (int depth = 0; depth < 8; ++depth) {
    const auto i = static_cast<std::size_t>(depth);
    for (std::size_t upper = 0; upper < 2; ++upper) slabs.y[upper][i] = slabs.z[upper][i] = 0;
    for (int bit = 0; bit < 64; ++bit) {
      const std::uint64_t one = std::uint64_t{1} << bit;
      const int y = bit / 8, z = bit % 8;
      if (y <= depth) slabs.y[0][i] |= one;
      if (7 - y <= depth) slabs.y[1][i] |= one;
      if (z <= depth) slabs.z[0][i] |= one;
      if (7 - z <= depth) slabs.z[1][i] |= one;
    }
  }
  return slabs;
}();

// Sets the tight box around the voxels that are not free; there is at least one.
void measure(const std::array<std::uint64_t, 8>& words, BrickFacts& facts) {
  unsigned x = 0, y = 0;
  std::uint64_t all = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    x |= static_cast<unsigned>(words[i] != 0) << i;
    all |= words[i];
  }
  for (std::size_t i = 0; i < 8; ++i) y |= static_cast<unsigned>((all >> (8 * i) & 0xff) != 0) << i;
  all |= all >> 32;
  all |= all >> 16;
  all |= all >> 8;
  const unsigned along[3] = {x, y, static_cast<unsigned>(all & 0xff)};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    facts.low[axis] = static_cast<std::uint8_t>(std::countr_zero(along[axis]));
    facts.high[axis] = static_cast<std::uint8_t>(std::bit_width(along[axis]));
  }
}

Gaps gaps_of(const std::array<std::uint64_t, 8>& words) {
  std::array<std::uint64_t, 8> x[2];  // [upper][depth]: all words that are at most so deep
  x[0][0] = words[0];
  x[1][0] = words[7];
  for (std::size_t depth = 1; depth < 8; ++depth) {
    x[0][depth] = x[0][depth - 1] | words[depth];
    x[1][depth] = x[1][depth - 1] | words[7 - depth];
  }
  Gaps gaps;
  for (std::size_t n = 0; n < kDirections; ++n) {
    const auto d = direction(n);
    std::uint8_t depth = 0;
    for (; depth < kBrickEdge; ++depth) {
      std::uint64_t near = d[0] == 0 ? x[0][7] : x[d[0] > 0][depth];
      if (d[1] != 0) near &= kSlabs.y[d[1] > 0][depth];
      if (d[2] != 0) near &= kSlabs.z[d[2] > 0][depth];
      if (near != 0) break;
    }
    gaps[n] = depth;
  }
  return gaps;
}

}  // namespace

BrickPlanes planes_of(const std::uint32_t* brick) {
  std::uint64_t low[16], high[16], words[16];
  std::memcpy(words, brick, sizeof words);
  for (std::size_t i = 0; i < 16; ++i) low[i] = even_bits(words[i]);
  for (std::size_t i = 0; i < 16; ++i) high[i] = even_bits(words[i] >> 1);
  BrickPlanes planes;
  for (std::size_t x = 0; x < 8; ++x) {
    planes.low[x] = low[2 * x] | low[2 * x + 1] << 32;
    planes.high[x] = high[2 * x] | high[2 * x + 1] << 32;
  }
  return planes;
}

BrickFacts facts_of(const BrickPlanes& planes) {
  std::array<std::uint64_t, 8> values[3], any;
  for (std::size_t x = 0; x < 8; ++x) {
    values[0][x] = planes.low[x] & ~planes.high[x];
    values[1][x] = planes.high[x] & ~planes.low[x];
    values[2][x] = planes.low[x] & planes.high[x];
    any[x] = planes.low[x] | planes.high[x];
  }
  BrickFacts facts;
  for (std::size_t value = 0; value < 3; ++value) facts.counts[value] = count(values[value]);
  facts.gaps = gaps_of(any);
  if (facts.counts[0] + facts.counts[1] + facts.counts[2] > 0) measure(any, facts);
  return facts;
}

}  // namespace forcelayer::voxmap_audit
