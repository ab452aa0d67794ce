// Small assemblies of boxes and rings that are taken apart: against intervals of whole numbers, and
// where the truth is known by construction. Paths are checked again by FCL.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "runtime/clearance/center_path.h"
#include "tests/support/pair_assembly.h"
#include "tests/support/places.h"
#include "tests/support/random_numbers.h"
#include "tests/support/sanitized.h"
#include "tests/support/scratch_folder.h"
#include "workbench/disassembly/disassembly.h"
#include "workbench/disassembly/straight_motions.h"
#ifdef FORCELAYER_TEST_FCL
#include "tests/stress/exact_distance.h"
#endif

namespace forcelayer::disassembly {
namespace {

using test::box_mesh;
using test::integer;
using test::moved;

constexpr double kUnitM = 0.01;  // a step of the lattice
constexpr double kClearanceM = 1e-3;

const Observer kNobody{[](const Parts&) { return std::vector<Step>(); },
                       [](const Parts&, const std::vector<Step>&, bool) {},
                       [](const std::string&, double) {}};

// A box of whole numbers.
struct Block {
  std::array<int, 3> low, high;
};

mesh::Mesh mesh_of(const Block& block) {
  std::array<double, 3> size{}, middle{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    size[axis] = kUnitM * (block.high[axis] - block.low[axis]);
    middle[axis] = kUnitM * (block.high[axis] + block.low[axis]) / 2;
  }
  return moved(box_mesh(size[0], size[1], size[2]), middle[0], middle[1], middle[2]);
}

// One mesh of several blocks.
mesh::Mesh joined(const std::vector<Block>& blocks) {
  mesh::Mesh mesh;
  for (const Block& block : blocks) {
    const mesh::Mesh piece = mesh_of(block);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), piece.vertices.begin(), piece.vertices.end());
    for (const mesh::Triangle& t : piece.triangles) {
      mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
  }
  return mesh;
}

pairs::AssemblyParts assembly_of(const std::vector<Block>& blocks) {
  pairs::AssemblyParts assembly;
  for (std::size_t n = 0; n < blocks.size(); ++n) {
    test::add_part(assembly, "block" + std::to_string(n), mesh_of(blocks[n]));
  }
  return assembly;
}

// Blocks that do not overlap; many of them touch.
std::vector<Block> random_blocks(test::Random& random, std::size_t count, int max_low = 5) {
  std::vector<Block> blocks;
  while (blocks.size() < count) {
    Block block;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      block.low[axis] = static_cast<int>(integer(random, 0, max_low));
      block.high[axis] = block.low[axis] + static_cast<int>(integer(random, 1, 3));
    }
    const bool overlaps = std::any_of(blocks.begin(), blocks.end(), [&](const Block& other) {
      bool meets = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        meets = meets && block.low[axis] < other.high[axis] && other.low[axis] < block.high[axis];
      }
      return meets;
    });
    if (!overlaps) blocks.push_back(block);
  }
  return blocks;
}

// Whether a block is in the way of another one that goes far along an axis: it overlaps the swept
// block, or touches it and did not touch the block as installed.
bool blocks_way(const Block& part, std::size_t axis, bool up, const Block& object) {
  Block swept = part;
  (up ? swept.high : swept.low)[axis] = up ? 100 : -100;
  bool touches_installed = true, touches = true, overlaps = true;
  for (std::size_t a = 0; a < 3; ++a) {
    touches_installed =
        touches_installed && part.low[a] <= object.high[a] && object.low[a] <= part.high[a];
    touches = touches && swept.low[a] <= object.high[a] && object.low[a] <= swept.high[a];
    overlaps = overlaps && swept.low[a] < object.high[a] && object.low[a] < swept.high[a];
  }
  return overlaps || (touches && !touches_installed);
}

bool blocks_way(const Block& part, const glm::dvec3& direction, const Block& object) {
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] != 0) {
      return blocks_way(part, static_cast<std::size_t>(axis), direction[axis] > 0, object);
    }
  }
  return true;
}

TEST(DisassemblyParts, StraightMotionsOfBlocksAreThoseOfIntervals) {
  int free = 0, blocked = 0;
  for (std::uint64_t seed = 1; seed <= 24; seed += test::seed_step(5)) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random random(seed);
    const auto blocks = random_blocks(random, 7);
    const pairs::AssemblyParts assembly = assembly_of(blocks);
    const PartShapes shapes(assembly, kClearanceM);
    StraightMotions motions(shapes);
    for (std::size_t part = 0; part < blocks.size(); ++part) {
      for (std::size_t d = 0; d < StraightMotions::kAxisDirections; ++d) {
        for (std::size_t object = 0; object < blocks.size(); ++object) {
          if (object == part) continue;
          const bool is_blocked = blocks_way(blocks[part], motions.direction(d), blocks[object]);
          EXPECT_EQ(motions.outcome(part, d, object),
                    is_blocked ? PairOutcome::kBlocked : PairOutcome::kFree)
              << part << " past " << object << " along direction " << d;
          (is_blocked ? blocked : free) += 1;
        }
      }
    }
  }
  EXPECT_GT(free, 200);
  EXPECT_GT(blocked, 200);
}

// Whether a part is blocked along an axis by an object.
using Blocks = std::function<bool(std::size_t part, std::size_t axis, bool up, std::size_t object)>;

Blocks by_intervals(const std::vector<Block>& blocks) {
  return [&](std::size_t part, std::size_t axis, bool up, std::size_t object) {
    return blocks_way(blocks[part], axis, up, blocks[object]);
  };
}

// Those of some parts that come out along axes alone, round by round; ascending. One part is left,
// and so is `base`.
Parts brute_out(std::size_t parts, const Blocks& blocks, std::optional<std::size_t> base = {}) {
  Parts out;
  for (bool changes = true; changes && out.size() + 1 < parts;) {
    changes = false;
    for (std::size_t part = 0; part < parts; ++part) {
      if (part == base || contains(out, part) || out.size() + 1 == parts) continue;
      bool is_free = false;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const bool up : {false, true}) {
          bool passes = true;
          for (std::size_t object = 0; object < parts; ++object) {
            if (object == part || contains(out, object)) continue;
            passes = passes && !blocks(part, axis, up, object);
          }
          is_free = is_free || passes;
        }
      }
      if (!is_free) continue;
      out.insert(std::lower_bound(out.begin(), out.end(), part), part);
      changes = true;
    }
  }
  return out;
}

// Each step keeps the rules beside what is still there, by intervals, where it is one straight leg
// along an axis.
void expect_steps_hold(const std::vector<Block>& blocks, const Outcome& outcome) {
  Parts present(blocks.size());
  for (std::size_t n = 0; n < present.size(); ++n) present[n] = n;
  for (const Step& step : outcome.steps) {
    if (!step.from.empty()) continue;
    ASSERT_TRUE(without(step.parts, present).empty());
    present = without(present, step.parts);
    if (step.rows.size() != 2) continue;
    const auto& end = step.rows.back().position_m;
    const glm::dvec3 way(end[0], end[1], end[2]);
    for (const std::size_t part : step.parts) {
      for (const std::size_t object : present) {
        EXPECT_FALSE(blocks_way(blocks[part], way, blocks[object]))
            << part << " past " << object << " along " << way.x << " " << way.y << " " << way.z;
      }
    }
  }
  EXPECT_EQ(present.size(), outcome.left.size() + 1);
}

// Where a step ends, the parts are outside of the box around all that is left there, so far along a
// direction of the last leg that they may go on without end: as "34 mm or more" says.
void expect_ways_go_on(const pairs::AssemblyParts& assembly, const std::vector<Step>& steps,
                       double clearance_m) {
  Parts all(assembly.parts.size());
  for (std::size_t n = 0; n < all.size(); ++n) all[n] = n;
  std::map<Parts, Parts> present_of{{{}, all}};  // by where parts are taken from
  for (const Step& step : steps) {
    Parts& present = present_of.try_emplace(step.from, step.from).first->second;
    present = without(present, step.parts);
    mesh::Box moved = mesh::empty_box(), rest = mesh::empty_box();
    for (const std::size_t part : step.parts) mesh::extend(moved, assembly.parts[part].box_m);
    for (const std::size_t part : present) mesh::extend(rest, assembly.parts[part].box_m);
    const auto &end = step.rows.back().position_m, &before = step.rows.end()[-2].position_m;
    bool is_beyond = present.empty();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double along = end[axis] - before[axis];
      if (along > 0) is_beyond |= moved.low[axis] + end[axis] >= rest.high[axis] + clearance_m;
      if (along < 0) is_beyond |= moved.high[axis] + end[axis] <= rest.low[axis] - clearance_m;
    }
    EXPECT_TRUE(is_beyond) << "part " << step.parts.front();
  }
}

TEST(DisassemblyParts, BlocksComeApartAsByIntervals) {
  for (std::uint64_t seed = 1; seed <= 30; seed += test::seed_step(7)) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random random(seed);
    const auto blocks = random_blocks(random, 8);
    const pairs::AssemblyParts assembly = assembly_of(blocks);
    const Outcome outcome = take_apart(assembly, {kClearanceM, {}, {}}, kNobody);
    expect_steps_hold(blocks, outcome);
    expect_ways_go_on(assembly, outcome.steps, kClearanceM);
    std::size_t out = 0;
    for (const Step& step : outcome.steps) out += step.from.empty() ? step.parts.size() : 0;
    EXPECT_GE(out, brute_out(blocks.size(), by_intervals(blocks)).size());
    EXPECT_FALSE(outcome.is_out_of_time);
  }
}

// --- rules

// A file of rules, and which parts each row means, written down where its names are made.
struct RuleRow {
  Parts part, object;
  double required_m = 0;
  bool is_ignored = false;
};

Parts random_meant(test::Random& random, std::size_t parts, std::string& name) {
  const auto one = [&] {
    return static_cast<std::size_t>(integer(random, 0, static_cast<std::int64_t>(parts) - 1));
  };
  Parts meant;
  switch (integer(random, 0, 3)) {
    case 0:
      name = integer(random, 0, 1) == 0 ? "*" : "block?";
      for (std::size_t n = 0; n < parts; ++n) meant.push_back(n);
      return meant;
    case 1: {
      const std::size_t first = one(), second = one();
      name = "\"{block" + std::to_string(first) + ",block" + std::to_string(second) + "}\"";
      meant = {std::min(first, second), std::max(first, second)};
      return meant;
    }
    default:
      meant = {one()};
      name = "block" + std::to_string(meant[0]);
      return meant;
  }
}

// Required distances are none between two places of the lattice, so that rounding decides nothing.
std::vector<RuleRow> random_rules(test::Random& random, std::size_t parts, std::string& text) {
  const std::array<std::pair<const char*, double>, 5> cells = {
      {{"touch", 0}, {"ignore", -1}, {"3mm", 0.003}, {"13mm", 0.013}, {"25mm", 0.025}}};
  std::vector<RuleRow> rows;
  text = "part,object,clearance\n";
  for (auto count = integer(random, 1, 4); count > 0; --count) {
    RuleRow row;
    std::string part, object;
    row.part = random_meant(random, parts, part);
    row.object = random_meant(random, parts, object);
    const auto& [cell, required_m] = cells[static_cast<std::size_t>(integer(random, 0, 4))];
    row.is_ignored = required_m < 0;
    row.required_m = std::max(0.0, required_m);
    text += part + "," + object + "," + cell + "\n";
    rows.push_back(row);
  }
  return rows;
}

RuleRow rule_of(const std::vector<RuleRow>& rows, std::size_t a, std::size_t b) {
  for (const RuleRow& row : rows) {
    if (contains(row.part, a) && contains(row.object, b)) return row;
    if (contains(row.part, b) && contains(row.object, a)) return row;
  }
  return {{}, {}, kClearanceM, false};
}

double distance_m(const Block& a, const Block& b) {
  double squared = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int gap = std::max({0, b.low[axis] - a.high[axis], a.low[axis] - b.high[axis]});
    squared += gap * gap;
  }
  return kUnitM * std::sqrt(squared);
}

// Whether a rule forbids that a block goes far along an axis past another one. The distance of two
// boxes along a straight path first falls and then rises: a block that begins nearer than required
// is free where it does not meet the other one, and another block is where the box that it sweeps
// stays as far away as is required.
bool breaks_rule(const RuleRow& rule, const Block& part, std::size_t axis, bool up,
                 const Block& object) {
  if (rule.is_ignored) return false;
  if (distance_m(part, object) <= rule.required_m) return blocks_way(part, axis, up, object);
  Block swept = part;
  (up ? swept.high : swept.low)[axis] = up ? 100 : -100;
  const double nearest_m = distance_m(swept, object);
  return nearest_m < rule.required_m || nearest_m == 0;
}

// The axis along which one straight leg leads; none of another path.
std::optional<std::pair<std::size_t, bool>> axis_of(const Step& step) {
  std::optional<std::pair<std::size_t, bool>> found;
  if (step.rows.size() != 2) return found;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double along_m = step.rows.back().position_m[axis];
    if (along_m == 0) continue;
    if (found) return std::nullopt;
    found = {axis, along_m > 0};
  }
  return found;
}

TEST(DisassemblyRules, AreThoseOfIntervalsInRandomFiles) {
  int free = 0, blocked = 0, steps = 0, ignored = 0;
  for (std::uint64_t seed = 1; seed <= 500; seed += test::seed_step(50)) {
    test::Random random(seed);
    const auto blocks = random_blocks(random, 4, 3);
    const pairs::AssemblyParts assembly = assembly_of(blocks);
    std::string text;
    const std::vector<RuleRow> rows = random_rules(random, blocks.size(), text);
    SCOPED_TRACE("seed " + std::to_string(seed) + "\n" + text);
    const test::ScratchFolder folder;
    std::ofstream(folder / "rules.csv") << text;
    const auto rules = pairs::read_rules(folder / "rules.csv");
    ASSERT_TRUE(rules) << to_line(rules.error());
    const auto breaks = [&](std::size_t part, std::size_t axis, bool up, std::size_t object) {
      return breaks_rule(rule_of(rows, part, object), blocks[part], axis, up, blocks[object]);
    };

    const PartShapes shapes(assembly, kClearanceM, *rules);
    StraightMotions motions(shapes);
    for (std::size_t part = 0; part < blocks.size(); ++part) {
      for (std::size_t d = 0; d < StraightMotions::kAxisDirections; ++d) {
        const std::size_t axis = 2 - d / 2;  // z first
        const bool up = d % 2 == 0;
        ASSERT_EQ(motions.direction(d)[static_cast<int>(axis)], up ? 1 : -1);
        for (std::size_t object = 0; object < blocks.size(); ++object) {
          if (object == part || (seed + part + object + d) % 3 != 0) continue;  // a third of all
          const bool is_free = motions.outcome(part, d, object) == PairOutcome::kFree;
          EXPECT_EQ(is_free, !breaks(part, axis, up, object)) << part << " past " << object;
          (is_free ? free : blocked) += 1;
        }
      }
    }

    const Outcome outcome = take_apart(assembly, {kClearanceM, {}, {}, *rules}, kNobody);
    expect_ways_go_on(assembly, outcome.steps, 0);
    Parts present(blocks.size());
    for (std::size_t n = 0; n < present.size(); ++n) present[n] = n;
    for (const Step& step : outcome.steps) {
      if (!step.from.empty()) continue;
      present = without(present, step.parts);
      const auto way = axis_of(step);
      for (const std::size_t part : step.parts) {
        for (const std::size_t object : present) {
          const bool is_ignored = rule_of(rows, part, object).is_ignored;
          ignored += is_ignored;
          if (is_ignored && step.parts.size() == 1) {
            EXPECT_FALSE(contains(step.touched, object));
          }
          if (way) {
            EXPECT_FALSE(breaks(part, way->first, way->second, object));
          }
        }
      }
      ++steps;
    }
    EXPECT_GE(blocks.size() - present.size(), brute_out(blocks.size(), breaks).size());
  }
  if (test::kSanitized) return;
  EXPECT_GT(free, 4000);
  EXPECT_GT(blocked, 1000);
  EXPECT_GT(steps, 1000);
  EXPECT_GT(ignored, 100);
}

// --- targets

// Blocks as they are, and turned so that no axis leads out: then along features.
TEST(DisassemblyParts, TargetsComeOutAsByIntervals) {
  int out = 0, before = 0;
  for (std::uint64_t seed = 1; seed <= 80; seed += test::seed_step(9)) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random random(seed);
    const auto blocks = random_blocks(random, 9, 4);
    const auto target = static_cast<std::size_t>(integer(random, 0, 8));
    const glm::dquat turn =
        seed % 2 == 0 ? glm::dquat(1, 0, 0, 0) : glm::normalize(glm::dquat(1, 0.2, 0.3, 0.1));
    pairs::AssemblyParts assembly;
    for (std::size_t n = 0; n < blocks.size(); ++n) {
      test::add_part(assembly, "block" + std::to_string(n),
                     moved(mesh_of(blocks[n]), Pose{{0, 0, 0}, turn}));
    }
    const Outcome outcome = take_apart(assembly, {kClearanceM, {target}, {}}, kNobody);
    expect_ways_go_on(assembly, outcome.steps, kClearanceM);
    std::size_t base = target == 0 ? 1 : 0;
    const auto volume = [&](std::size_t part) {
      const mesh::Box& box = assembly.parts[part].box_m;
      return (box.high[0] - box.low[0]) * (box.high[1] - box.low[1]) * (box.high[2] - box.low[2]);
    };
    for (std::size_t part = 0; part < blocks.size(); ++part) {
      if (part != target && volume(part) > volume(base)) base = part;
    }
    if (contains(brute_out(blocks.size(), by_intervals(blocks), base), target)) {
      EXPECT_TRUE(outcome.left.empty());
      ++out;
    }
    Parts present(blocks.size());
    for (std::size_t n = 0; n < present.size(); ++n) present[n] = n;
    for (const Step& step : outcome.steps) {
      if (!step.from.empty()) continue;
      present = without(present, step.parts);
      before += !contains(step.parts, target);
      if (step.rows.size() != 2) continue;
      const auto& end = step.rows.back().position_m;
      const glm::dvec3 way =
          glm::inverse(turn) * glm::normalize(glm::dvec3(end[0], end[1], end[2]));
      for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(way[axis]) < 1 - 1e-9) continue;
        for (const std::size_t part : step.parts) {
          for (const std::size_t object : present) {
            EXPECT_FALSE(blocks_way(blocks[part], static_cast<std::size_t>(axis), way[axis] > 0,
                                    blocks[object]));
          }
        }
      }
    }
    if (outcome.left.empty()) {
      EXPECT_FALSE(contains(present, target));
    }
  }
  if (test::kSanitized) return;
  EXPECT_GT(out, 20);
  EXPECT_GT(before, 10);
}

// A path that was found when a block had left already is led past it, where the target does not
// need it to leave.
TEST(DisassemblyParts, APathLeadsPastWhatNeedsNotLeave) {
  const Pose turned{{0, 0, 0}, glm::normalize(glm::dquat(1, 0.2, 0.3, 0.1))};
  const std::vector<Block> walls = {{{0, 0, 0}, {7, 7, 1}},
                                    {{0, 0, 1}, {1, 7, 9}},
                                    {{6, 0, 1}, {7, 7, 9}},
                                    {{1, 0, 1}, {6, 1, 9}},
                                    {{1, 6, 1}, {6, 7, 9}}};
  pairs::AssemblyParts assembly;
  test::add_part(assembly, "well", moved(joined(walls), turned));
  test::add_part(assembly, "target", moved(mesh_of({{1, 1, 1}, {6, 6, 3}}), turned));
  test::add_part(assembly, "above", moved(mesh_of({{1, 1, 3}, {6, 6, 5}}), turned));
  test::add_part(assembly, "beside", moved(mesh_of({{20, 20, 30}, {21, 21, 31}}), turned));
  const Outcome outcome = take_apart(assembly, {kClearanceM, {1}, {}}, kNobody);
  ASSERT_EQ(outcome.steps.size(), 2u);
  EXPECT_EQ(outcome.steps[0].parts, (Parts{2}));
  EXPECT_EQ(outcome.steps[1].parts, (Parts{1}));
  expect_ways_go_on(assembly, outcome.steps, kClearanceM);
}

// A block between the foot and the finger of a hook, in a well: they come up only together, and
// the block leaves the hook sideways when they are out. There it is beside the hook alone.
TEST(DisassemblyParts, ATargetOfAGroupIsTakenFromTheGroup) {
  pairs::AssemblyParts assembly;
  test::add_part(assembly, "well",
                 joined({{{-4, -4, -1}, {10, 7, 0}},
                         {{-4, -4, 0}, {-1, 7, 6}},
                         {{7, -4, 0}, {10, 7, 6}},
                         {{-1, -4, 0}, {7, -1, 6}},
                         {{-1, 4, 0}, {7, 7, 6}}}));
  test::add_part(assembly, "left",
                 joined({{{0, 0, 0}, {6, 3, 1}}, {{0, 0, 1}, {2, 3, 3}}, {{0, 0, 3}, {4, 3, 4}}}));
  test::add_part(assembly, "right", joined({{{2, 0, 1}, {6, 3, 3}}}));
  const Outcome outcome = take_apart(assembly, {kClearanceM, {2}, {}}, kNobody);
  ASSERT_EQ(outcome.steps.size(), 2u);
  EXPECT_EQ(outcome.steps[0].parts, (Parts{1, 2}));
  EXPECT_TRUE(outcome.steps[0].from.empty());
  EXPECT_EQ(outcome.steps[1].parts, (Parts{2}));
  EXPECT_EQ(outcome.steps[1].from, (Parts{1, 2}));
  EXPECT_EQ(outcome.steps[1].touched, (Parts{1}));
  EXPECT_FALSE(outcome.steps[1].nearest);
  EXPECT_TRUE(outcome.left.empty());
}

// A target leaves behind the fewest parts: a block in a row is below those above it.
TEST(DisassemblyParts, OnlyWhatIsInTheWayOfATargetLeaves) {
  // A well of five walls, with three blocks on top of each other, and a block that is elsewhere.
  std::vector<Block> blocks = {
      {{0, 0, 0}, {7, 7, 1}}, {{0, 0, 1}, {1, 7, 9}}, {{6, 0, 1}, {7, 7, 9}},
      {{1, 0, 1}, {6, 1, 9}}, {{1, 6, 1}, {6, 7, 9}}, {{1, 1, 1}, {6, 6, 3}},
      {{1, 1, 3}, {6, 6, 5}}, {{1, 1, 5}, {6, 6, 7}}, {{20, 0, 0}, {21, 1, 1}}};
  pairs::AssemblyParts assembly;
  test::add_part(assembly, "well", joined({blocks.begin(), blocks.begin() + 5}));
  for (std::size_t n = 5; n < blocks.size(); ++n) {
    test::add_part(assembly, "block" + std::to_string(n), mesh_of(blocks[n]));
  }
  const auto removed = [&](const Parts& target) {
    Parts parts;
    for (const Step& step : take_apart(assembly, {kClearanceM, target, {}}, kNobody).steps) {
      parts.insert(parts.end(), step.parts.begin(), step.parts.end());
    }
    return parts;
  };
  EXPECT_EQ(removed({3}), (Parts{3}));
  EXPECT_EQ(removed({2}), (Parts{3, 2}));
  EXPECT_EQ(removed({1}), (Parts{3, 2, 1}));
  EXPECT_EQ(removed({4}), (Parts{4}));
  // Together, in one step.
  EXPECT_EQ(removed({1, 2}), (Parts{3, 1, 2}));
}

// Two rings of a chain come apart only by way of each other: they leave together.
TEST(DisassemblyParts, LinksOfAChainLeaveTogetherAndStayLinked) {
  pairs::AssemblyParts assembly;
  const Block plate{{-6, -6, -5}, {6, 6, -4}};
  test::add_part(assembly, "plate", mesh_of(plate));
  const mesh::Mesh ring = test::ring_mesh(12, 0.02, 0.03, 0.006);
  test::add_part(assembly, "first", moved(ring, 0, 0, 0));
  const double half = std::sqrt(0.5);
  test::add_part(assembly, "second",
                 moved(ring, Pose{{0.025, 0, 0}, glm::dquat(half, half, 0, 0)}));
  const Outcome outcome = take_apart(assembly, {kClearanceM, {}, {}}, kNobody);
  ASSERT_EQ(outcome.steps.size(), 1u);
  EXPECT_EQ(outcome.steps[0].parts, (Parts{1, 2}));
  ASSERT_EQ(outcome.left.size(), 1u);
  EXPECT_EQ(outcome.left[0].blocked_by.size(), 1u);
  EXPECT_EQ(outcome.base, std::optional<std::size_t>(0));

  // One of them as a target has not come out while the other hangs on it; both together have, and
  // their step is told once.
  Observer observer = kNobody;
  std::size_t told = 0;
  observer.found = [&](const Parts&, const std::vector<Step>& steps, bool) {
    told += steps.size();
  };
  const Outcome one = take_apart(assembly, {kClearanceM, {1}, {}}, observer);
  EXPECT_TRUE(one.steps.empty());
  ASSERT_EQ(one.left.size(), 1u);
  EXPECT_EQ(one.left[0].part, 1u);
  EXPECT_EQ(told, 0u);
  const Outcome both = take_apart(assembly, {kClearanceM, {1, 2}, {}}, observer);
  ASSERT_EQ(both.steps.size(), 1u);
  EXPECT_EQ(both.steps[0].parts, (Parts{1, 2}));
  EXPECT_TRUE(both.left.empty());
  EXPECT_EQ(told, 1u);
}

// A part in a closed cage never comes out, whether it touches the cage or not.
TEST(DisassemblyParts, ACageNeverOpens) {
  for (const double size_m : {0.02, 0.04, 0.06}) {
    SCOPED_TRACE("size " + std::to_string(size_m));
    pairs::AssemblyParts assembly;
    mesh::Mesh cage = box_mesh(0.1, 0.1, 0.1);
    const mesh::Mesh cavity = box_mesh(0.06, 0.06, 0.06);
    for (const mesh::Vec3d& v : cavity.vertices) cage.vertices.push_back(v);
    for (const mesh::Triangle& t : cavity.triangles) {
      cage.triangles.push_back({t[0] + 8, t[2] + 8, t[1] + 8});
    }
    test::add_part(assembly, "cage", cage);
    test::add_part(assembly, "captive", box_mesh(size_m, size_m, size_m));
    test::add_part(assembly, "free", moved(box_mesh(0.01, 0.01, 0.01), 0.2, 0, 0));
    const Outcome outcome = take_apart(assembly, {kClearanceM, {}, {}}, kNobody);
    EXPECT_EQ(outcome.base, std::optional<std::size_t>(0));
    ASSERT_EQ(outcome.left.size(), 1u);
    EXPECT_EQ(outcome.left[0].part, 1u);
    EXPECT_EQ(outcome.left[0].blocked_by, (Parts{0}));
    const Outcome target = take_apart(assembly, {kClearanceM, {1}, {}}, kNobody);
    ASSERT_EQ(target.left.size(), 1u);
    EXPECT_TRUE(target.steps.empty());
  }
}

// A part that lies in the solid of another one, and meets no surface, comes out of it nowhere.
TEST(DisassemblyParts, APartInsideASolidDoesNotComeOut) {
  pairs::AssemblyParts assembly;
  test::add_part(assembly, "block", box_mesh(0.1, 0.1, 0.1));
  test::add_part(assembly, "buried", box_mesh(0.02, 0.02, 0.02));
  EXPECT_EQ(take_apart(assembly, {kClearanceM, {}, {}}, kNobody).left.size(), 1u);
}

// An overlap as installed stays allowed, and is reported.
TEST(DisassemblyParts, AnOverlapAsInstalledIsReported) {
  pairs::AssemblyParts assembly;
  test::add_part(assembly, "block", box_mesh(0.1, 0.1, 0.1));
  test::add_part(assembly, "sunk", moved(box_mesh(0.02, 0.02, 0.02), 0, 0, 0.0595));
  const Outcome outcome = take_apart(assembly, {kClearanceM, {}, {}}, kNobody);
  ASSERT_EQ(outcome.steps.size(), 1u);
  ASSERT_EQ(outcome.steps[0].overlaps.size(), 1u);
  EXPECT_EQ(outcome.steps[0].overlaps[0].object, 0u);
  EXPECT_NEAR(outcome.steps[0].overlaps[0].depth_m, 0.0005, 1e-6);
}

// The parts that must leave before a target are found in no more time than it takes to take all
// apart.
TEST(DisassemblyParts, ATargetTakesNoLongerThanTheWholeAssembly) {
  const auto assembly =
      pairs::read_parts(test::source_path("sample_data/gearbox.glb"), std::nullopt);
  ASSERT_TRUE(assembly);
  const auto seconds_for = [&](const Parts& target) {  // of all cores
    const std::clock_t begun = std::clock();
    take_apart(*assembly, {kClearanceM, target, {}}, kNobody);
    return static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
  };
  Parts cover;
  for (std::size_t part = 0; part < assembly->parts.size(); ++part) {
    if (assembly->shown_name(part) == "Cover") cover.push_back(part);
  }
  ASSERT_EQ(cover.size(), 1u);
  EXPECT_LT(seconds_for(cover), 1.5 * seconds_for({}));
}

#ifdef FORCELAYER_TEST_FCL
// Each path of the gearbox at 500 poses, by FCL: what the part does not touch as installed it never
// touches, and what it has left stays as far away as is required.
TEST(DisassemblyParts, PathsOfTheGearboxKeepTheRulesByFcl) {
  const auto assembly =
      pairs::read_parts(test::source_path("sample_data/gearbox.glb"), std::nullopt);
  ASSERT_TRUE(assembly);
  const Outcome outcome = take_apart(*assembly, {kClearanceM, {}, {}}, kNobody);
  EXPECT_EQ(outcome.steps.size(), 8u);
  EXPECT_TRUE(outcome.left.empty());
  const auto world_mesh = [&](std::size_t part) {
    const exact::Surface surface = pairs::surface_of(assembly->scene, assembly->parts[part]);
    mesh::Mesh mesh;
    for (const glm::dvec3& v : surface.vertices_m) mesh.vertices.push_back({v.x, v.y, v.z});
    mesh.triangles = surface.triangles;
    return mesh;
  };
  const int poses = test::kSanitized ? 40 : 500;
  constexpr double kFclM = 1e-6;  // FCL's own error, and the rounding of a file's numbers
  Parts present(assembly->parts.size());
  for (std::size_t n = 0; n < present.size(); ++n) present[n] = n;
  for (const Step& step : outcome.steps) {
    present = without(present, step.parts);
    const clearance::CenterPath path(step.rows, glm::dvec3(0), 0);
    const double end_s = path.time_s({path.poses() - 1, 0});
    for (const std::size_t part : step.parts) {
      const mesh::Mesh own = world_mesh(part);
      for (const std::size_t object : present) {
        SCOPED_TRACE(assembly->shown_name(part) + " past " + assembly->shown_name(object));
        const stress::ExactDistance distance(world_mesh(object), own);
        const double installed_m = distance.at({});
        bool has_left = installed_m >= kClearanceM;
        double nearest_m = installed_m;
        for (int n = 1; n <= poses; ++n) {
          const Pose pose = path.world_from_center(path.at(end_s * n / poses));
          const double apart_m = distance.at(pose, 2 * kClearanceM);
          const double least_m = has_left ? kClearanceM - kFclM : installed_m > kFclM ? 1e-12 : 0;
          ASSERT_GE(apart_m, least_m) << "pose " << n;
          has_left = has_left || apart_m >= kClearanceM;
          nearest_m = std::min(nearest_m, apart_m);
        }
        EXPECT_TRUE(has_left);
        if (contains(step.touched, object)) continue;
        EXPECT_GE(nearest_m, std::min(step.clearance_m, 2 * kClearanceM) - kFclM);
      }
    }
  }
}
#endif

}  // namespace
}  // namespace forcelayer::disassembly
