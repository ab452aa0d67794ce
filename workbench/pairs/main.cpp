// forcelayer-pairs: started by `forcelayer pairs`, with the same arguments.
#include <errno.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <new>
#include <nlohmann/json.hpp>

#include "formats/command/arguments.h"
#include "formats/command/command.h"
#include "formats/command/output_file.h"
#include "formats/command/progress_line.h"
#include "formats/command/report.h"
#include "formats/mesh/sandbox/sandbox.h"
#include "workbench/pairs/check.h"
#include "workbench/pairs/options.h"
#include "workbench/pairs/report.h"

namespace forcelayer::pairs {
namespace {

Status check(const Options& options) {
  std::vector<Rule> rules;
  if (!options.rules.empty()) {
    auto read = read_rules(options.rules);
    if (!read) return read.error();
    rules = std::move(*read);
  }
  command::ProgressLine line(options.quiet);
  line.show("reading", 0);
  const auto assembly = read_parts(options.assembly, options.unit_m);
  line.clear();
  if (!assembly) return assembly.error();
  for (const std::string& warning : assembly->scene.warnings) {
    command::warn(warning, options.quiet);
  }
  if (assembly->parts.size() < 2) {  // a reader refuses an assembly without any
    return Error{ErrorCode::kSceneInvalid, options.assembly, "",
                 "has only one part, so there is no pair",
                 "give an assembly; voxelize --list prints its parts"};
  }
  const std::vector<PartName> names = assembly->names();
  if (Status s = check_siblings(rules, names, options.rules); !s) return s;
  const RuleTable table(rules, names);
  for (const std::string& warning : table.warnings(options.rules)) {
    command::warn(warning, options.quiet);
  }
  const Findings findings = check_pairs(*assembly, rules, table, options.otherwise,
                                        [&](double fraction) { line.show("measuring", fraction); });
  line.clear();
  const Answer answer{*assembly, rules, options.otherwise, findings};
  if (!options.quiet) {
    std::fputs((sentence(answer) + "\n" + pairs::table(answer)).c_str(), stdout);
    std::fflush(stdout);
  }
  if (!options.json.empty()) {
    if (Status s = command::write_report(options.json, report_of(answer)); !s) return s;
  }
  return exit_of(answer, options.assembly);
}

int run(int argc, char** argv) {
  CLI::App app{"finds overlaps and small distances between the parts of an assembly",
               "forcelayer pairs"};
  const OptionParser parser(app);
  int status = 0;
  if (!command::parse_arguments(app, argc, argv, status)) return status;
  command::exit_cleanly_on_signals();
  return command::run_command("forcelayer", [&]() -> Status {
    auto options = parser.finish();
    if (!options) return options.error();
    const std::string inputs[] = {options->assembly, options->rules};
    const command::OutputFile outputs[] = {{"--json", &options->json, command::FileKind::kReport}};
    if (Status s = command::prepare_outputs(outputs, inputs); !s) return s;
    try {
      return check(*options);
    } catch (const std::bad_alloc&) {  // there is no voxel size to enlarge
      return Error{ErrorCode::kOutOfMemory, options->assembly, "", "out of memory",
                   "use a machine with more memory"};
    }
  });
}

}  // namespace
}  // namespace forcelayer::pairs

int main(int argc, char** argv) {
  if (const auto status = forcelayer::mesh::run_as_sandbox(argc, argv)) return *status;
  // Warnings and reports name the command that the user typed.
  static char name[] = "forcelayer";
  program_invocation_short_name = name;
  return forcelayer::pairs::run(argc, argv);
}
