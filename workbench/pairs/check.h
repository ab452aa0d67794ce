// Holds all pairs of an assembly against their rules.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "formats/command/verdict/verdict.h"
#include "workbench/pairs/assembly_parts.h"
#include "workbench/pairs/pair_check.h"
#include "workbench/pairs/rules/rules.h"

namespace forcelayer::pairs {

// A pair that is nearer than its rule asks, touches or overlaps.
struct PairFinding {
  std::uint32_t part = 0, object = 0;  // of an overlap: the part's surface is inside the object
  std::size_t rule = 0;                // number; the count of rules: none names the pair
  Requirement requirement;
  PairMeasure measure;
  double margin_m = 0;  // deviations and rounding of both, without cracks
  // kCollides, kTooNear, kUndecided, kTooCloseToCall; kept: kStaysInstalled of parts that touch
  command::VerdictKind kind = command::VerdictKind::kUndecided;
  bool is_kept() const { return command::is_yes(kind); }
};

struct Findings {
  std::uint64_t pairs = 0;           // of all parts
  std::uint64_t ignored = 0;         // of these, by rules
  std::uint64_t measured = 0;        // by triangles
  std::vector<PairFinding> by_rank;  // the worst first
};

// Whether a measured pair keeps a requirement. `rounding_m` is that part of the margin which no
// deviation explains.
command::VerdictKind kind_of(const PairMeasure& measure, const Requirement& requirement,
                             double margin_m, double rounding_m);

// All pairs of the assembly that are found. `progress` gets a fraction, from one thread.
Findings check_pairs(const AssemblyParts& assembly, std::span<const Rule> rules,
                     const RuleTable& table, const Requirement& otherwise,
                     const std::function<void(double)>& progress);

}  // namespace forcelayer::pairs
