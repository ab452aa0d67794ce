// The findings of `forcelayer pairs` in words, as a table and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "workbench/pairs/check.h"

namespace forcelayer::pairs {

// All that a report is written from.
struct Answer {
  const AssemblyParts& assembly;
  std::span<const Rule> rules;
  const Requirement& otherwise;
  const Findings& findings;
};

// "3 of 120 pairs overlap, the deepest: Bolt[2] 0.41 mm into Housing; 5 more are nearer than the
// required 1 mm." One line, escaped.
std::string sentence(const Answer& answer);

// A line for each finding, the worst first, of at most so many.
inline constexpr std::size_t kListedPairs = 20;
std::string table(const Answer& answer, std::size_t max_lines = kListedPairs);

// The keys of --json.
nlohmann::ordered_json report_of(const Answer& answer);

// An error where a pair does not keep its rule. Errors: kAnswerIsNo.
Status exit_of(const Answer& answer, const std::string& file);

}  // namespace forcelayer::pairs
