#include "formats/audit/code_rules.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include "formats/audit/layer_distance.h"

namespace forcelayer::voxmap_audit {
namespace {

constexpr double kRoundingVoxels = 1e-9;  // of the header's doubles

using Codes = std::uint8_t;

constexpr std::array<Step, kSteps> near_steps() {
  std::array<Step, kSteps> steps{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  std::size_t count = 3;
  for (int x = 0; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        const bool half = x > 0 || (x == 0 && (y > 0 || (y == 0 && z > 0)));
        const bool shortest = x % 2 != 0 || y % 2 != 0 || z % 2 != 0;
        if (half && shortest && x * x + y * y + z * z > 1) steps[count++] = {x, y, z};
      }
    }
  }
  return steps;
}

// Sixteen codes at once, in loops that compilers leave as they are written.
using Lanes [[gnu::vector_size(16)]] = Codes;

Lanes load(const Codes* codes) {
  Lanes lanes;
  std::memcpy(&lanes, codes, sizeof lanes);
  return lanes;
}
Lanes larger(Lanes a, Lanes b) { return a > b ? a : b; }
Lanes smaller(Lanes a, Lanes b) { return a > b ? b : a; }
Lanes apart(Lanes a, Lanes b) { return larger(a, b) - smaller(a, b); }

// The largest of the first `count`.
Codes max_lane(Lanes lanes, int count = 16) {
  Codes codes[16];
  std::memcpy(codes, &lanes, sizeof codes);
  return *std::max_element(codes, codes + count);
}

// The most by which neighbors along an axis differ, in all of the cube. `step` is from one to the
// next, `count` bytes have a next one, and `in_row` of a row.
Codes max_along(const CodeCube& cube, int step, int count, int in_row) {
  Lanes largest{};
  for (const Codes* row = cube.data(); row < cube.data() + count; row += CodeCube::kRow) {
    largest = larger(largest, apart(load(row), load(row + step)));
  }
  return max_lane(largest, in_row);
}

}  // namespace

const std::array<Step, kSteps> kNearSteps = near_steps();

CodeRules::CodeRules(const VoxmapHeader& h)
    : zero_(static_cast<std::uint32_t>(h.distance_zero_code)),
      quantum_(h.distance_quantum_m / h.voxel_size_m) {
  const double n = force_layers(std::min(force_layer_voxels(h), 1e3));
  const double radius = interior_radius_m(h) / h.voxel_size_m;
  for (std::uint32_t code = 0; code < 256; ++code) {
    const double smallest = min_distance_m(h, code) / h.voxel_size_m - kRoundingVoxels;
    const double largest = max_distance_m(h, code) / h.voxel_size_m + kRoundingVoxels;
    // In the order of VoxelValue: the steps from the interior that the value stands for.
    beside_value_[0][code] = largest >= layer_distance_voxels(radius, n + 1);
    beside_value_[1][code] = smallest < radius;
    beside_value_[2][code] = largest >= layer_distance_voxels(radius, 0) &&
                             smallest <= max_layer_distance_voxels(radius, n);
    beside_value_[3][code] = largest >= layer_distance_voxels(radius, n) &&
                             smallest <= max_layer_distance_voxels(radius, n + 1);
    nearest_[code] = smallest > 0 ? smallest : largest < 0 ? -largest : 0;
    farthest_[code] = std::max(std::abs(smallest), std::abs(largest));
  }
  // 13.5: of two neighbors on opposite sides.
  for (std::size_t code = 0; code < 256; ++code) {
    squared_[code] = nearest_[code] * nearest_[code];
    max_squared_[code] = 2 * (farthest_[code] * farthest_[code] + 1) + kRoundingVoxels;
  }
  near_steps_ = static_cast<std::uint32_t>(std::min(1 / quantum_, 255.0));
  find_limits();
  find_leaps();
  find_descent();
}

// Where the codes that a value allows are no interval, or none, no code is surely allowed.
void CodeRules::find_limits() {
  std::array<std::uint8_t, 4> smallest{255, 255, 255, 255}, largest{};
  for (std::size_t value = 0; value < 4; ++value) {
    const auto& allowed = beside_value_[value];
    const auto first = std::find(allowed.begin(), allowed.end(), true);
    const auto end = std::find(first, allowed.end(), false);
    if (first == end || std::find(end, allowed.end(), true) != allowed.end()) continue;
    smallest[value] = static_cast<std::uint8_t>(first - allowed.begin());
    largest[value] = static_cast<std::uint8_t>(end - allowed.begin() - 1);
  }
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::array<std::uint8_t, 4> lower, upper;
    for (std::size_t n = 0; n < 4; ++n) {
      lower[n] = smallest[byte >> (2 * n) & 3];
      upper[n] = largest[byte >> (2 * n) & 3];
    }
    std::memcpy(&min_of_four_[byte], lower.data(), 4);
    std::memcpy(&max_of_four_[byte], upper.data(), 4);
  }
}

// The distances of codes a and b on one side of the mesh differ by (|a - b| - 1) q at least, less
// the errors; of codes on either side by less. Codes on either side that differ by a voxel are half
// a voxel from the mesh, or one of them is nearer.
void CodeRules::find_leaps() {
  for (std::size_t n = 0; n < kSteps; ++n) {
    const double length = std::sqrt(kNearSteps[n].squared());
    const double codes = (length + kDistanceErrorVoxels) / quantum_;  // rounding is left out
    leap_[n] = static_cast<Codes>(std::min(codes, 254.0) + 1);
  }
}

// 13.5: the neighbor towards the mesh of a center at the distance d is at most
// sqrt(d^2 - 2 d / sqrt(3) + 1) from it. That is convex in d, so over a code's step it is largest
// at an end.
void CodeRules::find_descent() {
  const auto towards = [](double d) { return std::sqrt(d * d - 2 * d / std::sqrt(3.0) + 1); };
  max_towards_mesh_.fill(kMaxDistanceCode);
  int drop = 0;
  for (std::uint32_t code = zero_; code < kMaxDistanceCode; ++code) {
    const double largest = std::max(towards(nearest_[code]), towards(farthest_[code]));
    const double steps = std::floor((largest + kRoundingVoxels) / quantum_);
    const auto limit = static_cast<Codes>(std::min<double>(zero_ + steps, kMaxDistanceCode));
    max_towards_mesh_[code] = limit;
    drop = std::max(drop, static_cast<int>(code) - limit);
    floor_ = std::min(floor_, limit);
  }
  drop_ = static_cast<Codes>(drop);
}

bool CodeRules::beside_code(const Step& step, std::uint32_t a, std::uint32_t b) const {
  const int squared = step.squared();
  const double length = std::sqrt(squared);
  if (nearest_[a] > farthest_[b] + length || nearest_[b] > farthest_[a] + length) return false;
  if (squared > 1 || (a < zero_) == (b < zero_)) return true;
  // 13.5: of neighbors on either side of the mesh, one contains a point of it.
  constexpr double kLeeway = kDistanceErrorVoxels + kRoundingVoxels;
  const double half = std::sqrt(3.0) / 2 + kLeeway;
  return std::min(nearest_[a], nearest_[b]) <= half &&
         std::max(nearest_[a], nearest_[b]) <= half + 1;
}

bool CodeRules::surely_beside_values(const std::uint8_t* values, const BrickCodes& codes) const {
  BrickCodes smallest, largest;
  for (std::size_t i = 0; i < 128; ++i) {
    std::memcpy(&smallest[4 * i], &min_of_four_[values[i]], 4);
    std::memcpy(&largest[4 * i], &max_of_four_[values[i]], 4);
  }
  Codes wrong = 0;  // what differs from itself held to its limits
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const Codes held = std::min(std::max(codes[i], smallest[i]), largest[i]);
    wrong = static_cast<Codes>(wrong | (held ^ codes[i]));
  }
  return wrong == 0;
}

bool CodeRules::surely_beside_codes(const CodeCube& cube) const {
  using Cube = CodeCube;
  const int along[3] = {max_along(cube, Cube::kPlane, Cube::kBytes - Cube::kPlane, Cube::kWidth),
                        max_along(cube, Cube::kRow, Cube::kBytes - Cube::kRow, Cube::kWidth),
                        max_along(cube, 1, Cube::kBytes, Cube::kWidth - 1)};
  // A step counts no more than its parts along the axes together: enough in front of most planes.
  const auto is_sure = [&](std::size_t n) {
    const auto [x, y, z] = kNearSteps[n];
    return std::abs(x) * along[0] + std::abs(y) * along[1] + std::abs(z) * along[2] <= leap_[n];
  };
  std::optional<ShiftedCubes> cubes;
  for (std::size_t n = 0; n < kSteps; ++n) {
    if (is_sure(n)) continue;
    if (!cubes) cubes.emplace(cube);
    const auto [dx, dy, dz] = kNearSteps[n];
    Lanes largest{};
    for (int x = 0; x < 8; ++x) {
      const Codes *const a = cubes->plane(x, 0, 0), *const b = cubes->plane(x + dx, dy, dz);
      for (int i = 0; i < 64; i += 16) largest = larger(largest, apart(load(a + i), load(b + i)));
    }
    if (max_lane(largest) > leap_[n]) return false;
  }
  return true;
}

bool CodeRules::surely_lead_to_mesh(const CodeCube& cube) const {
  constexpr int kRow = CodeCube::kRow, kPlane = CodeCube::kPlane;
  const Lanes drop = Lanes{} + drop_, floor = Lanes{} + floor_;
  const Lanes unmeasured = Lanes{} + static_cast<Codes>(kMaxDistanceCode), none{};
  Lanes largest{};  // by which the least of six neighbors is above the limit
  for (int x = 0; x < 8; ++x) {
    const Codes* c = cube.data() + (x + CodeCube::kHalo) * kPlane + CodeCube::kHalo * (kRow + 1);
    for (int y = 0; y < 8; ++y, c += kRow) {
      const Lanes codes = load(c);
      const Lanes smallest = smaller(
          smaller(smaller(load(c + 1), load(c - 1)), smaller(load(c + kRow), load(c - kRow))),
          smaller(load(c + kPlane), load(c - kPlane)));
      const Lanes limit = larger(larger(codes, drop) - drop, floor);
      const Lanes beyond = larger(smallest, limit) - limit;
      largest = larger(largest, codes == unmeasured ? none : beyond);
    }
  }
  return max_lane(largest, 8) == 0;
}

bool CodeRules::lie_between(const CodeCube& cube) const {
  constexpr int kRow = CodeCube::kRow, kPlane = CodeCube::kPlane;
  const Lanes zero = Lanes{} + static_cast<Codes>(zero_);
  const Lanes near = Lanes{} + static_cast<Codes>(near_steps_);
  std::array<Codes, CodeCube::kBytes + kRow> steps;
  for (int row = 0; row < CodeCube::kBytes; row += kRow) {
    const Lanes codes = load(cube.data() + row), beyond = codes - zero;
    const Lanes lanes = codes < zero ? ~beyond : beyond;
    std::memcpy(&steps[static_cast<std::size_t>(row)], &lanes, sizeof lanes);
  }
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      const int row =
          (x + CodeCube::kHalo) * kPlane + (y + CodeCube::kHalo) * kRow + CodeCube::kHalo;
      const Codes* const s = steps.data() + row;
      const Lanes own = load(s);
      const auto is_least = [&](int step) {
        return own <= smaller(load(s + step), load(s - step));
      };
      const auto wanted = (own < near) & (is_least(1) | is_least(kRow) | is_least(kPlane));
      std::uint64_t any;
      std::memcpy(&any, &wanted, sizeof any);
      while (any != 0) {
        const int z = std::countr_zero(any) / 8;
        any &= ~(std::uint64_t{255} << (8 * z));
        const Codes* const c = cube.data() + row + z;
        for (const int step : {1, kRow, kPlane}) {
          if (!may_lie_between(*c, c[step], c[-step])) return false;
        }
      }
    }
  }
  return true;
}

}  // namespace forcelayer::voxmap_audit
