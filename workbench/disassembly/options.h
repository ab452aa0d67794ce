// The command line of `forcelayer disassemble`. Two programs compile it: forcelayer, for --help and
// wrong options, and forcelayer-disassemble, which does the work.
#pragma once

#include <optional>
#include <string>

#include "formats/command/quantity.h"
#include "formats/result.h"

namespace CLI {
class App;
}  // namespace CLI

namespace forcelayer::disassembly {

// The program that `forcelayer disassemble` starts.
inline constexpr char kProgram[] = "forcelayer-disassemble";

struct Options {
  std::string assembly, folder, target, rules, units, json;
  std::string clearance = command::kDefaultClearance, time;
  double required_m = 0;         // --clearance
  std::optional<double> max_s;   // --time
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

}  // namespace forcelayer::disassembly
