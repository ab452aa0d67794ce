#include "formats/audit/code_rules.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "formats/audit/layer_distance.h"

namespace forcelayer::voxmap_audit {
namespace {

constexpr double kWriterErrorVoxels = 0.002;  // a code's distance may be lower than the true one
constexpr double kRoundingVoxels = 1e-9;      // of the header's doubles

using Codes = std::uint8_t;

// Steps from the mesh, of codes whose zero is `zero`.
void magnitudes(const Codes* codes, std::size_t count, Codes zero, Codes* to) {
  for (std::size_t i = 0; i < count; ++i) {
    const Codes steps = static_cast<Codes>(codes[i] - zero);
    to[i] = codes[i] < zero ? static_cast<Codes>(~steps) : steps;
  }
}

// The most by which a code of one differs from that of the other in its place.
Codes most_apart(const Codes* a, const Codes* b, std::size_t count) {
  Codes most = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Codes apart = static_cast<Codes>(std::max(a[i], b[i]) - std::min(a[i], b[i]));
    most = std::max(most, apart);
  }
  return most;
}

// 0 for the last of each row of 8 codes, else all bits.
constexpr std::array<Codes, 512> kInRow = [] {
  std::array<Codes, 512> in_row{};
  for (std::size_t i = 0; i < in_row.size(); ++i) in_row[i] = i % 8 == 7 ? 0 : 255;
  return in_row;
}();

}  // namespace

// Once a file, as the two below: small rather than fast.
[[gnu::cold]] CodeRules::CodeRules(const VoxmapHeader& h)
    : zero_(static_cast<std::uint8_t>(h.distance_zero_code)) {
  const double n = force_layers(std::min(force_layer_voxels(h), 1e3));
  const double radius = interior_radius_m(h) / h.voxel_size_m;
  std::array<double, 256> nearest{}, farthest{};  // of the unsigned distance, voxels
  for (std::uint32_t code = 0; code < 256; ++code) {
    const double least = least_distance_m(h, code) / h.voxel_size_m - kRoundingVoxels;
    const double most =
        most_distance_m(h, code) / h.voxel_size_m + kWriterErrorVoxels + kRoundingVoxels;
    // In the order of VoxelValue: the steps from the interior that the value stands for.
    beside_value_[0][code] = most >= layer_distance_voxels(radius, n + 1);
    beside_value_[1][code] = least < radius;
    beside_value_[2][code] =
        most >= layer_distance_voxels(radius, 0) && least <= most_layer_distance_voxels(radius, n);
    beside_value_[3][code] = most >= layer_distance_voxels(radius, n) &&
                             least <= most_layer_distance_voxels(radius, n + 1);
    nearest[code] = least > 0 ? least : most < 0 ? -most : 0;
    farthest[code] = std::max(std::abs(least), std::abs(most));
  }
  for (std::uint32_t a = 0; a < 256; ++a) {
    for (std::uint32_t b = 0; b < 256; ++b) {
      beside_code_[a][b] = nearest[a] <= farthest[b] + 1 && nearest[b] <= farthest[a] + 1;
    }
  }
  find_limits();
  find_leap();
}

// Where the codes that a value allows are no interval, or none, no code is surely allowed.
[[gnu::cold]] void CodeRules::find_limits() {
  std::array<std::uint8_t, 4> least{255, 255, 255, 255}, most{};
  for (std::size_t value = 0; value < 4; ++value) {
    const auto& allowed = beside_value_[value];
    const auto first = std::find(allowed.begin(), allowed.end(), true);
    const auto end = std::find(first, allowed.end(), false);
    if (first == end || std::find(end, allowed.end(), true) != allowed.end()) continue;
    least[value] = static_cast<std::uint8_t>(first - allowed.begin());
    most[value] = static_cast<std::uint8_t>(end - allowed.begin() - 1);
  }
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::array<std::uint8_t, 4> lower, upper;
    for (std::size_t n = 0; n < 4; ++n) {
      lower[n] = least[byte >> (2 * n) & 3];
      upper[n] = most[byte >> (2 * n) & 3];
    }
    std::memcpy(&least_of_four_[byte], lower.data(), 4);
    std::memcpy(&most_of_four_[byte], upper.data(), 4);
  }
}

[[gnu::cold]] void CodeRules::find_leap() {
  std::array<Codes, 256> codes, magnitude;
  for (std::size_t code = 0; code < 256; ++code) codes[code] = static_cast<Codes>(code);
  magnitudes(codes.data(), codes.size(), zero_, magnitude.data());
  int least_refused = 256;
  for (std::uint32_t a = 0; a < 256; ++a) {
    for (std::uint32_t b = 0; b < a; ++b) {
      if (!beside_code_[a][b]) {
        least_refused = std::min(least_refused, std::abs(magnitude[a] - magnitude[b]));
      }
    }
  }
  leap_ = std::min(least_refused - 1, 255);
}

bool CodeRules::surely_beside_values(const std::uint8_t* values, const BrickCodes& codes) const {
  BrickCodes least, most;
  for (std::size_t i = 0; i < 128; ++i) {
    std::memcpy(&least[4 * i], &least_of_four_[values[i]], 4);
    std::memcpy(&most[4 * i], &most_of_four_[values[i]], 4);
  }
  Codes wrong = 0;  // what differs from itself held to its limits
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const Codes held = std::min(std::max(codes[i], least[i]), most[i]);
    wrong = static_cast<Codes>(wrong | (held ^ codes[i]));
  }
  return wrong == 0;
}

bool CodeRules::surely_even(const BrickCodes& codes) const {
  if (leap_ < 0) return false;
  // One more than all, for the last one's neighbor.
  std::array<Codes, 513> m;
  magnitudes(codes.data(), codes.size(), zero_, m.data());
  m[512] = m[511];
  Codes most = most_apart(&m[0], &m[64], 448);
  for (std::size_t x = 0; x < 512; x += 64) {
    most = std::max(most, most_apart(&m[x], &m[x + 8], 56));
  }
  for (std::size_t i = 0; i < 512; ++i) {
    const int apart = std::max(m[i], m[i + 1]) - std::min(m[i], m[i + 1]);
    most = std::max(most, static_cast<Codes>(apart & kInRow[i]));
  }
  return most <= leap_;
}

bool CodeRules::surely_beside(const FaceCodes& a, const FaceCodes& b) const {
  if (leap_ < 0) return false;
  FaceCodes m, n;
  magnitudes(a.data(), a.size(), zero_, m.data());
  magnitudes(b.data(), b.size(), zero_, n.data());
  return most_apart(m.data(), n.data(), m.size()) <= leap_;
}

}  // namespace forcelayer::voxmap_audit
