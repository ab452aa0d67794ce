// Graphs of which part blocks which, against brute force over all subsets and all ways.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/random_numbers.h"
#include "workbench/disassembly/blocking_graph.h"

namespace forcelayer::disassembly {
namespace {

using test::integer;

using Motions = std::vector<std::vector<BlockedMotion>>;  // [parts]

Motions random_motions(test::Random& random, std::size_t parts) {
  Motions motions(parts);
  for (std::size_t part = 0; part < parts; ++part) {
    const auto directions = static_cast<std::size_t>(integer(random, 1, 3));
    for (std::size_t d = 0; d < directions; ++d) {
      BlockedMotion motion{d, {}};
      const std::int64_t density = integer(random, 1, 4);
      for (std::size_t other = 0; other < parts; ++other) {
        if (other != part && integer(random, 0, 9) < density) motion.blockers.push_back(other);
      }
      motions[part].push_back(motion);
    }
  }
  return motions;
}

// Whether the target comes out where no others than these are taken away, in any order.
bool comes_out(const Motions& motions, std::size_t target, const Parts& removable) {
  Parts gone;
  for (bool changes = true; changes;) {
    changes = false;
    for (std::size_t part = 0; part < motions.size(); ++part) {
      if (contains(gone, part) || (part != target && !contains(removable, part))) continue;
      const bool is_free = std::any_of(
          motions[part].begin(), motions[part].end(),
          [&](const BlockedMotion& motion) { return without(motion.blockers, gone).empty(); });
      if (!is_free) continue;
      if (part == target) return true;
      gone.insert(std::lower_bound(gone.begin(), gone.end(), part), part);
      changes = true;
    }
  }
  return false;
}

std::optional<std::size_t> brute_fewest(const Motions& motions, std::size_t target) {
  std::optional<std::size_t> fewest;
  for (std::size_t bits = 0; bits < (std::size_t{1} << motions.size()); ++bits) {
    Parts removable;
    for (std::size_t part = 0; part < motions.size(); ++part) {
      if ((bits >> part & 1U) != 0 && part != target) removable.push_back(part);
    }
    if (fewest && removable.size() >= *fewest) continue;
    if (comes_out(motions, target, removable)) fewest = removable.size();
  }
  return fewest;
}

TEST(DisassemblyGraph, RemovalsAreValidAndNoneCanBeLeftOut) {
  std::size_t found = 0, none = 0, fewest = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random random(seed);
    const auto parts = static_cast<std::size_t>(integer(random, 2, 9));
    const Motions motions = random_motions(random, parts);
    std::vector<int> asked(parts);
    const auto removals = fewest_removals(parts, 0, [&](std::size_t part) {
      ++asked[part];
      return motions[part];
    });
    EXPECT_LE(*std::max_element(asked.begin(), asked.end()), 1);
    const auto brute = brute_fewest(motions, 0);
    ASSERT_EQ(removals.has_value(), brute.has_value());
    if (!removals) {
      ++none;
      continue;
    }
    ++found;
    ASSERT_EQ(removals->back().part, 0u);
    Parts gone;
    for (const Removal& removal : *removals) {
      ASSERT_FALSE(contains(gone, removal.part));
      const BlockedMotion& motion = motions[removal.part][removal.direction];
      EXPECT_TRUE(without(motion.blockers, gone).empty());
      gone.insert(std::lower_bound(gone.begin(), gone.end(), removal.part), removal.part);
    }
    const Parts others = without(gone, {0});
    for (const std::size_t part : others) {
      EXPECT_FALSE(comes_out(motions, 0, without(others, {part}))) << "part " << part;
    }
    EXPECT_GE(others.size(), *brute);
    fewest += others.size() == *brute;
  }
  EXPECT_GT(found, 100u);
  EXPECT_GT(none, 10u);
  EXPECT_GE(10 * fewest, 9 * found);  // nearly always the fewest there are
}

TEST(DisassemblyGraph, ClosedGroupsAreThoseOfBruteForce) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random random(seed);
    const auto nodes = static_cast<std::size_t>(integer(random, 1, 8));
    std::vector<Parts> edges(nodes);
    std::vector<std::vector<bool>> reaches(nodes, std::vector<bool>(nodes));
    for (std::size_t a = 0; a < nodes; ++a) {
      reaches[a][a] = true;
      for (std::size_t b = 0; b < nodes; ++b) {
        if (a == b || integer(random, 0, 3) > 0) continue;
        edges[a].push_back(b);
        reaches[a][b] = true;
      }
    }
    for (std::size_t k = 0; k < nodes; ++k) {
      for (std::size_t a = 0; a < nodes; ++a) {
        for (std::size_t b = 0; b < nodes; ++b) {
          if (reaches[a][k] && reaches[k][b]) reaches[a][b] = true;
        }
      }
    }
    std::vector<Parts> expected;
    for (std::size_t a = 0; a < nodes; ++a) {
      Parts group;
      bool is_closed = true;
      for (std::size_t b = 0; b < nodes; ++b) {
        if (!reaches[a][b]) continue;
        group.push_back(b);
        is_closed = is_closed && reaches[b][a];
      }
      if (is_closed && group.front() == a) expected.push_back(group);
    }
    EXPECT_EQ(closed_groups(edges), expected);
  }
}

}  // namespace
}  // namespace forcelayer::disassembly
