// forcelayer-disassemble: started by `forcelayer disassemble`, with the same arguments.
#include <errno.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <new>
#include <nlohmann/json.hpp>

#include "formats/command/arguments.h"
#include "formats/command/command.h"
#include "formats/command/output_file.h"
#include "formats/command/program.h"
#include "formats/command/progress_line.h"
#include "formats/command/report.h"
#include "formats/mesh/sandbox/sandbox.h"
#include "workbench/disassembly/disassembly.h"
#include "workbench/disassembly/folder.h"
#include "workbench/disassembly/options.h"
#include "workbench/disassembly/report.h"
#include "workbench/disassembly/target.h"

namespace forcelayer::disassembly {
namespace {

double steady_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Status disassemble(const Options& options) {
  const double begun_s = steady_s();
  std::vector<pairs::Rule> rules;
  if (!options.rules.empty()) {
    auto read = pairs::read_rules(options.rules);
    if (!read) return read.error();
    rules = std::move(*read);
  }
  command::ProgressLine line(options.quiet);
  line.show("reading", 0);
  const auto assembly = pairs::read_parts(options.assembly, options.unit_m);
  line.clear();
  if (!assembly) return assembly.error();
  for (const std::string& warning : assembly->scene.warnings) {
    command::warn(warning, options.quiet);
  }
  if (assembly->parts.size() < 2) {  // a reader refuses an assembly without any
    return Error{ErrorCode::kSceneInvalid, options.assembly, "",
                 "has only one part, so there is nothing to take apart",
                 "give an assembly; voxelize --list prints its parts"};
  }
  const std::vector<pairs::PartName> names = assembly->names();
  if (Status s = pairs::check_siblings(rules, names, options.rules); !s) return s;
  const pairs::RuleTable table(rules, names);
  for (const std::string& warning : table.warnings(options.rules)) {
    command::warn(warning, options.quiet);
  }
  Request request{options.required_m, {}, options.max_s, rules};
  if (!options.target.empty()) {
    auto target = target_parts(*assembly, options.target);
    if (!target) return command::about("--target", target.error());
    request.target = std::move(*target);
  }
  auto folder = Folder::open(options.folder, *assembly, request);
  if (!folder) return folder.error();
  Outcome so_far;
  Status written;
  std::size_t number = 0;
  Observer observer;
  observer.recall = [&](const Parts& present) { return folder->recall(present); };
  observer.progress = [&](const std::string& stage, double fraction) {
    line.show(stage, fraction);
  };
  observer.found = [&](const Parts& present, const std::vector<Step>& steps, bool is_known) {
    line.clear();
    for (const Step& step : steps) {
      if (!options.quiet) std::fputs(instruction(*assembly, step, ++number).c_str(), stdout);
    }
    std::fflush(stdout);
    if (written) written = folder->add(present, steps);
    // The file keeps later rounds that are known until more is found.
    if (written && !is_known) written = folder->write(so_far, false, steady_s() - begun_s);
  };
  command::stop_programs_on_signals();  // it ends in order, with what is known by then
  const Outcome outcome = take_apart(*assembly, request, observer);
  line.clear();
  if (written) written = folder->write(outcome, !outcome.is_out_of_time, steady_s() - begun_s);
  if (!written) return written;
  if (!options.quiet) {
    std::fputs(summary(*assembly, request, outcome).c_str(), stdout);
    std::fflush(stdout);
  }
  if (!options.json.empty()) {
    if (Status s = command::write_report(options.json, folder->sequence()); !s) return s;
  }
  return exit_of(*assembly, request, outcome, options.assembly);
}

int run(int argc, char** argv) {
  CLI::App app{"takes an assembly apart: in which order, and along which paths",
               "forcelayer disassemble"};
  const OptionParser parser(app);
  int status = 0;
  if (!command::parse_arguments(app, argc, argv, status)) return status;
  command::exit_cleanly_on_signals();
  status = command::run_command("forcelayer", [&]() -> Status {
    auto options = parser.finish();
    if (!options) return options.error();
    const std::string inputs[] = {options->assembly, options->rules};
    const command::OutputFile outputs[] = {{"--json", &options->json, command::FileKind::kReport}};
    if (Status s = command::prepare_outputs(outputs, inputs); !s) return s;
    try {
      return disassemble(*options);
    } catch (const std::bad_alloc&) {  // there is no voxel size to enlarge
      return Error{ErrorCode::kOutOfMemory, options->assembly, "", "out of memory",
                   "use a machine with more memory"};
    }
  });
  const int stopped = command::stop_signal();
  return stopped != 0 ? 128 + stopped : status;
}

}  // namespace
}  // namespace forcelayer::disassembly

int main(int argc, char** argv) {
  if (const auto status = forcelayer::mesh::run_as_sandbox(argc, argv)) return *status;
  // Warnings and reports name the command that the user typed.
  static char name[] = "forcelayer";
  program_invocation_short_name = name;
  return forcelayer::disassembly::run(argc, argv);
}
