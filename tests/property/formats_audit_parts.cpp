// The loops of the audit that look at many voxels at once, against one voxel at a time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>

#include "formats/audit/code_rules.h"
#include "formats/audit/contents.h"
#include "formats/audit/node_rows.h"
#include "tests/support/file_surgery.h"
#include "tests/support/golden_content.h"

namespace forcelayer::voxmap_audit {
namespace {

using Words = std::array<std::uint32_t, 32>;

std::uint32_t value_of(const Words& brick, std::uint32_t n) {
  return brick[n / 16] >> (2 * (n % 16)) & 3;
}

// Values at random, most of them free where `dense` is small.
Words random_brick(std::mt19937_64& random, unsigned dense) {
  Words brick{};
  for (std::uint32_t n = 0; n < 512; ++n) {
    if (random() % 100 < dense) brick[n / 16] |= (1 + random() % 3) << (2 * (n % 16));
  }
  return brick;
}

// The layers of free voxels between a brick and its neighbor in a direction.
int gap_of(const Words& brick, std::size_t towards) {
  const auto d = direction(towards);
  int smallest = 8;
  for (std::uint32_t n = 0; n < 512; ++n) {
    if (value_of(brick, n) == 0) continue;
    const int at[3] = {static_cast<int>(n >> 6), static_cast<int>(n >> 3 & 7),
                       static_cast<int>(n & 7)};
    int gap = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (d[axis] != 0) gap = std::max(gap, d[axis] < 0 ? at[axis] : 7 - at[axis]);
    }
    smallest = std::min(smallest, gap);
  }
  return smallest;
}

TEST(BrickFacts, CountsBoxAndGapsAreThoseOfTheVoxels) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 300; ++trial) {
    const Words brick = random_brick(random, trial == 0 ? 0 : 1u << trial % 7);
    const BrickFacts facts = facts_of(planes_of(brick.data()));
    std::array<std::uint16_t, 3> counts{};
    std::array<std::uint8_t, 3> low{8, 8, 8}, high{};
    for (std::uint32_t n = 0; n < 512; ++n) {
      if (value_of(brick, n) == 0) continue;
      ++counts[value_of(brick, n) - 1];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto at = static_cast<std::uint8_t>(n >> (6 - 3 * axis) & 7);
        low[axis] = std::min(low[axis], at);
        high[axis] = std::max<std::uint8_t>(high[axis], at + 1);
      }
    }
    EXPECT_EQ(facts.counts, counts) << trial;
    if (high[0] > 0) {
      EXPECT_EQ(facts.low, low) << trial;
      EXPECT_EQ(facts.high, high) << trial;
    }
    for (std::size_t d = 0; d < kDirections; ++d) {
      EXPECT_EQ(facts.gaps[d], d == kCenter && high[0] > 0 ? 0 : gap_of(brick, d))
          << trial << " " << d;
    }
  }
}

// A map of 27 nodes, some of them uniform, whose bricks are `bricks`.
struct Nodes {
  explicit Nodes(std::mt19937_64& random) {
    for (int i = 0; i < 40; ++i) bricks.push_back(random_brick(random, 1u << i % 7));
    for (const Words& brick : bricks) planes.push_back(planes_of(brick.data()));
    for (std::uint32_t n = 0; n < kDirections; ++n) {
      around[n] = random() % 4 == 0 ? uniform_entry(static_cast<std::uint32_t>(random() % 4)) : n;
      for (int i = 0; i < 512; ++i) {
        const bool uniform = random() % 3 == 0;
        entries.push_back(uniform ? uniform_entry(static_cast<std::uint32_t>(random() % 4),
                                                  static_cast<std::uint32_t>(random() % 2))
                                  : static_cast<std::uint32_t>(random() % bricks.size()));
      }
    }
    view.lower_nodes = entries.data();
    view.bricks = bricks[0].data();
  }

  // Value of a voxel, counted from the middle node: -64 to 127 along each axis.
  std::uint32_t value(int x, int y, int z) const {
    const auto part = [](int at) { return (at + 64) / 64; };
    const std::uint32_t node =
        around[static_cast<std::size_t>((part(x) * 3 + part(y)) * 3 + part(z))];
    if (is_uniform(node)) return uniform_value(node);
    const auto slot = [](int a, int b, int c) {
      return static_cast<std::uint32_t>((a & 7) * 64 + (b & 7) * 8 + (c & 7));
    };
    const std::uint32_t entry = entries[node * 512 + slot(x >> 3 & 7, y >> 3 & 7, z >> 3 & 7)];
    return is_uniform(entry) ? uniform_value(entry) : value_of(bricks[entry], slot(x, y, z));
  }

  std::vector<Words> bricks;
  std::vector<BrickPlanes> planes;
  std::vector<std::uint32_t> entries;
  Around around{};
  VoxmapView view;
};

TEST(NodeRows, AreTheVoxelsAndGrowAsTheyDo) {
  for (const std::int64_t margin : {1, 3, 11}) {
    std::mt19937_64 random(static_cast<std::uint64_t>(margin));
    const Nodes nodes(random);
    NodeRows rows(nodes.planes, nodes.view, margin);
    rows.fill(nodes.around);
    const auto in_set = [&](NodeRows::Set set, int x, int y, int z) {
      const std::uint32_t value = nodes.value(x, y, z);
      return set == NodeRows::kInterior      ? value == 1
             : set == NodeRows::kUpToSurface ? value == 1 || value == 2
                                             : value != 0;
    };
    for (const NodeRows::Set set :
         {NodeRows::kInterior, NodeRows::kUpToSurface, NodeRows::kUpToProximity}) {
      for (int i = 0; i < 3000; ++i) {
        const int x = static_cast<int>(random() % 64), y = static_cast<int>(random() % 64),
                  z = static_cast<int>(random() % 64);
        EXPECT_EQ(rows.plane(set, x)[y] >> z & 1, in_set(set, x, y, z));
      }
    }
    for (const std::int64_t steps : {std::int64_t{1}, margin}) {
      for (const NodeRows::Set set : {NodeRows::kInterior, NodeRows::kUpToSurface}) {
        const NodeRows::Rows& grown = rows.grown(set, steps);
        for (int i = 0; i < 300; ++i) {
          const int at[3] = {static_cast<int>(random() % 3 == 0 ? 63 : random() % 64),
                             static_cast<int>(random() % 64),
                             static_cast<int>(random() % 3 == 0 ? 0 : random() % 64)};
          const int reach = static_cast<int>(steps);
          bool near = false;
          for (int x = -reach; x <= reach && !near; ++x) {
            for (int y = -reach; y <= reach && !near; ++y) {
              for (int z = -reach; z <= reach && !near; ++z) {
                near = in_set(set, at[0] + x, at[1] + y, at[2] + z);
              }
            }
          }
          EXPECT_EQ(grown[static_cast<std::size_t>(at[0] * 64 + at[1])] >> at[2] & 1, near);
        }
      }
    }
  }
}

// A slope of any steepness; in one of three a code at random.
int code_of(const int (&slope)[3], int begin, int x, int y, int z) {
  return std::clamp(begin + slope[0] * x + slope[1] * y + slope[2] * z, 0, 255);
}

// Codes that are surely allowed are allowed one by one; and codes that change slowly surely are.
TEST(CodeRules, WhatIsSureIsTrue) {
  const testing::AlignedBytes golden = testing::golden_file_bytes("v2_distances.vox");
  auto header = testing::read_at<VoxmapHeader>(golden.bytes(), 0);
  std::mt19937_64 random(5);
  int sure_pairs = 0, unsure_pairs = 0, sure_descents = 0, unsure_descents = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    header.distance_quantum_m = header.voxel_size_m / (1 + random() % 32);
    header.distance_zero_code = 1 + static_cast<int>(random() % 254);
    const CodeRules rules(header);
    const int slope[3] = {static_cast<int>(random() % 41) - 20, static_cast<int>(random() % 9) - 4,
                          static_cast<int>(random() % 3) - 1};
    const int begin = static_cast<int>(random() % 256);
    CodeCube cube;
    for (int x = -2; x < 10; ++x) {
      for (int y = -2; y < 10; ++y) {
        for (int z = -2; z < 10; ++z) {
          cube.set(x, y, z, static_cast<std::uint8_t>(code_of(slope, begin, x, y, z)));
        }
      }
    }
    const auto anywhere = [&] { return static_cast<int>(random() % 12) - 2; };
    if (trial % 3 == 0) {
      cube.set(anywhere(), anywhere(), anywhere(), static_cast<std::uint8_t>(random() % 256));
    }
    bool pairs = true, descents = true;
    BrickCodes codes;
    for (int n = 0; n < 512; ++n) {
      const int x = n >> 6, y = n >> 3 & 7, z = n & 7;
      const std::uint32_t code = cube.at(x, y, z);
      codes[static_cast<std::size_t>(n)] = static_cast<std::uint8_t>(code);
      for (const Step& step : kNearSteps) {
        pairs &= rules.beside_code(step, code, cube.at(x + step.x, y + step.y, z + step.z));
      }
      bool leads = false;
      for (const auto& [dx, dy, dz] :
           {Step{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
        leads |= rules.may_lead_to_mesh(code, cube.at(x + dx, y + dy, z + dz));
      }
      descents &= leads;
    }
    EXPECT_TRUE(pairs || !rules.surely_beside_codes(cube)) << trial;
    EXPECT_TRUE(descents || !rules.surely_lead_to_mesh(cube)) << trial;
    (rules.surely_beside_codes(cube) ? sure_pairs : unsure_pairs) += pairs;
    (rules.surely_lead_to_mesh(cube) ? sure_descents : unsure_descents) += descents;

    std::array<std::uint8_t, 128> values{};
    bool allowed = true;
    for (std::uint32_t n = 0; n < 512; ++n) {
      std::uint32_t value = 0;
      while (value < 3 && !rules.beside_value(value, codes[n])) ++value;
      if (trial % 5 == 0 && n == 77) value = static_cast<std::uint32_t>(random() % 4);
      values[n / 4] = static_cast<std::uint8_t>(values[n / 4] | value << (2 * (n % 4)));
      allowed &= rules.beside_value(value, codes[n]);
    }
    EXPECT_EQ(rules.surely_beside_values(values.data(), codes), allowed) << trial;
  }
  EXPECT_GT(sure_pairs, 500);
  EXPECT_LT(unsure_pairs, sure_pairs / 4);
  EXPECT_GT(sure_descents, 200);
  EXPECT_LT(unsure_descents, sure_descents);
}

// Section 13.5 in its own words: two voxels, and signs of face neighbors.
TEST(CodeRules, CodesBesideEachOtherAreThoseOfTheText) {
  const testing::AlignedBytes golden = testing::golden_file_bytes("v2_distances.vox");
  auto header = testing::read_at<VoxmapHeader>(golden.bytes(), 0);
  std::mt19937_64 random(8);
  std::array<int, 2> answers{};
  for (int trial = 0; trial < 40; ++trial) {
    const double q = 1.0 / static_cast<double>(1 + random() % 32);
    header.distance_quantum_m = header.voxel_size_m * q;
    header.distance_zero_code = 1 + static_cast<int>(random() % 254);
    const CodeRules rules(header);
    const auto zero = static_cast<std::uint32_t>(header.distance_zero_code);
    const double infinite = std::numeric_limits<double>::infinity();
    const auto low = [&](std::uint32_t c) {
      return c == 0 ? -infinite : (static_cast<double>(c) - zero) * q - 1e-9;
    };
    const auto high = [&](std::uint32_t c) {
      return c == 255 ? infinite : (static_cast<double>(c) + 1 - zero) * q + 0.002 + 1e-9;
    };
    const auto l = [&](std::uint32_t c) {
      return low(c) <= 0 && high(c) >= 0 ? 0 : std::min(std::abs(low(c)), std::abs(high(c)));
    };
    const auto u = [&](std::uint32_t c) { return std::max(std::abs(low(c)), std::abs(high(c))); };
    for (int n = 0; n < 20000; ++n) {
      const Step step = kNearSteps[random() % kSteps];
      const auto a = static_cast<std::uint32_t>(random() % 256);
      const auto b = static_cast<std::uint32_t>(
          n % 2 == 0 ? random() % 256 : std::min<std::uint64_t>(255, a + random() % 80));
      const double length = std::sqrt(step.x * step.x + step.y * step.y + step.z * step.z);
      bool allowed = l(a) <= u(b) + length && l(b) <= u(a) + length;
      if (length == 1 && (a < zero) != (b < zero)) {
        const double half = std::sqrt(3.0) / 2 + 0.002 + 1e-9;
        allowed &= std::min(l(a), l(b)) <= half && std::max(l(a), l(b)) <= 1 + half;
      }
      ASSERT_EQ(rules.beside_code(step, a, b), allowed) << trial << ": " << a << ' ' << b;
      ASSERT_EQ(rules.beside_code(step, b, a), allowed) << trial << ": " << b << ' ' << a;
      ++answers[allowed];
    }
  }
  EXPECT_GT(std::min(answers[0], answers[1]), 100'000);
}

// The steps that the rules look at: one of each pair, the shortest ones in 49 directions.
TEST(CodeRules, StepsAreEveryDirectionOnce) {
  std::set<std::array<int, 3>> seen;
  for (const auto& [x, y, z] : kNearSteps) {
    EXPECT_LE(std::max({std::abs(x), std::abs(y), std::abs(z)}), 2);
    EXPECT_EQ(std::gcd(std::gcd(x, y), z), 1);
    EXPECT_TRUE(seen.insert({x, y, z}).second);
    EXPECT_FALSE(seen.count({-x, -y, -z}));
  }
  EXPECT_EQ(seen.size(), kSteps);
}

// The codes of each of 27 bricks stand where their voxels are; and 64 of the shifted cubes too.
TEST(CodeCube, HoldsTheBricksAroundAndTheirShifts) {
  std::mt19937_64 random(6);
  std::array<BrickCodes, kDirections> bricks;
  CodeCube cube;
  for (std::size_t n = 0; n < kDirections; ++n) {
    for (std::uint8_t& code : bricks[n]) code = static_cast<std::uint8_t>(random());
    const Voxel d = direction(n);
    cube.put(static_cast<int>(d[0]), static_cast<int>(d[1]), static_cast<int>(d[2]), bricks[n]);
  }
  const auto expected = [&](int x, int y, int z) {
    const auto part = [](int at) { return static_cast<std::size_t>((at + 8) / 8); };
    return bricks[(part(x) * 3 + part(y)) * 3 + part(z)]
                 [static_cast<std::size_t>((x & 7) * 64 + (y & 7) * 8 + (z & 7))];
  };
  const ShiftedCubes cubes(cube);
  for (int x = -2; x < 10; ++x) {
    for (int y = -2; y < 10; ++y) {
      for (int z = -2; z < 10; ++z) EXPECT_EQ(cube.at(x, y, z), expected(x, y, z));
    }
    for (int dy = -2; dy <= 2; ++dy) {
      for (int dz = -2; dz <= 2; ++dz) {
        for (int i = 0; i < 64; ++i) {
          EXPECT_EQ(cubes.plane(x, dy, dz)[i], expected(x, i / 8 + dy, i % 8 + dz));
        }
      }
    }
  }
}

}  // namespace
}  // namespace forcelayer::voxmap_audit
