// The command line of `forcelayer pairs`. Two programs compile it: forcelayer, for --help and wrong
// options, and forcelayer-pairs, which does the work.
#pragma once

#include <optional>
#include <string>

#include "formats/result.h"
#include "workbench/pairs/rules/requirement.h"

namespace CLI {
class App;
}  // namespace CLI

namespace forcelayer::pairs {

// The program that `forcelayer pairs` starts.
inline constexpr char kProgram[] = "forcelayer-pairs";

struct Options {
  std::string assembly, clearance, rules, units, json;
  Requirement otherwise;         // of pairs that no rule names
  std::optional<double> unit_m;  // --units
  bool quiet = false;
};

// Declares the options to CLI11. finish() reads what was parsed.
class OptionParser {
 public:
  explicit OptionParser(CLI::App& app);

  // Errors: kUsage.
  Result<Options> finish() const;

 private:
  Options options_;
};

}  // namespace forcelayer::pairs
