// Shared by clearance_bench and path_bench: which families of scenes are judged, how far, and
// their options.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tests/stress/clearance_cases.h"

namespace forcelayer::bench {

struct FamilyChoice {
  FamilyChoice();

  std::size_t wanted = 100000;    // of all families together
  double generated_share = 0;     // of them; the other families share the rest
  std::vector<std::string> only;  // names; all where empty
  std::string models;             // folder of the shared models
};

// --family, --models, and `count` (--poses, --moments).
void add_options(CLI::App& app, const char* count, FamilyChoice& choice);

// Judges one scene of a family, keeps it, and says how many poses or moments were judged.
using JudgeScene = std::function<std::size_t(const stress::ClearanceFamily&, std::uint64_t seed)>;

// Whole scenes of each family, from seed 1 on, until there are enough. Families whose models are
// missing are named.
void judge_families(const FamilyChoice& choice, const JudgeScene& judge);

}  // namespace forcelayer::bench
