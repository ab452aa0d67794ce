// forcelayer: lists the commands, makes a study of a part with them, checks pairs of parts, and
// takes assemblies apart.
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "formats/command/arguments.h"
#include "formats/command/command.h"
#include "formats/command/help.h"
#include "formats/command/output_file.h"
#include "formats/command/program.h"
#include "formats/command/verdict/verdict.h"
#include "workbench/disassembly/options.h"
#include "workbench/pairs/options.h"
#include "workbench/study/options.h"
#include "workbench/study/study.h"

namespace {

struct Listed {
  const char* name;
  const char* does;
};
constexpr Listed kCommands[] = {
    {"voxelize", "bakes the static scene into a .vox file"},
    {"pointshell", "bakes the part into a .pshell file"},
    {"voxinfo", "prints the facts of a baked file; verifies, samples and exports it"},
    {"voxrun", "runs the haptic loop; voxrun doctor checks the machine"},
    {"voxcheck", "proves that a part keeps its clearance along a path"},
    {"voxplan", "searches for a path that takes a part out of its installed position"},
    {"voxview", "shows meshes, baked files and runs"},
};

// A line for each command, with what it does and whether it is installed.
std::string command_lines() {
  std::string lines;
  for (const Listed& command : kCommands) {
    const bool here = !forcelayer::command::program_path(command.name).empty();
    char line[100];
    std::snprintf(line, sizeof line, "  %-11s %s%s\n", command.name, command.does,
                  here ? "" : " (not installed)");
    lines += line;
  }
  return lines +
         "  forcelayer study runs them on an assembly and writes a page with the verdict\n" +
         "  forcelayer pairs finds overlaps and small distances between the parts of an "
         "assembly\n" +
         "  forcelayer disassemble takes an assembly apart\n" + "Each command has --help.";
}

forcelayer::Status list_commands(std::string json, bool quiet) {
  using namespace forcelayer;
  const command::OutputFile outputs[] = {{"--json", &json, command::FileKind::kReport}};
  if (Status s = command::prepare_outputs(outputs, {}); !s) return s;
  if (!quiet) std::puts(command_lines().c_str());
  if (json.empty()) return {};
  nlohmann::ordered_json report;
  for (const Listed& command : kCommands) {
    nlohmann::ordered_json& listed = report["commands"].emplace_back();
    listed["name"] = command.name;
    listed["does"] = command.does;
    listed["installed"] = !command::program_path(command.name).empty();
  }
  return command::write_report(json, report);
}

// Has another program do the work of a subcommand, with the arguments behind its name and this
// standard input.
template <typename OptionParser>
int run_other(const char* subcommand, const char* program, const OptionParser& parser, int argc,
              char** argv) {
  using namespace forcelayer;
  int status = 0;
  const int failed = command::run_command("forcelayer", [&]() -> Status {
    const auto options = parser.finish();
    if (!options) return options.error();
    if (std::string_view(argv[1]) != subcommand) {
      return Error{
          ErrorCode::kUsage, "", argv[1], std::string("stands before the word ") + subcommand,
          std::string("write options behind it: forcelayer ") + subcommand + " ASSEMBLY [OPTIONS]"};
    }
    const std::vector<std::string> arguments(argv + 2, argv + argc);
    command::stop_programs_on_signals();
    const auto end = command::run_program(program, arguments, std::nullopt,
                                          command::ProgramOutput::kShown, "forcelayer-tools");
    if (!end) return end.error();
    // The program is ended by SIGTERM, whatever signal came.
    const int stopped = command::stop_signal();
    status = stopped != 0 && end->status == 128 + SIGTERM ? 128 + stopped : end->status;
    return {};
  });
  return failed != 0 ? failed : status;
}

// A file in the folder under a name that a study writes must be a study's.
forcelayer::Status check_folder(const forcelayer::study::Options& options) {
  using forcelayer::command::FileKind;
  constexpr std::pair<const char*, FileKind> kWritten[] = {
      {"scene.vox", FileKind::kVoxmap},    {"part.pshell", FileKind::kPshell},
      {"scene.json", FileKind::kReport},   {"part.json", FileKind::kReport},
      {"run.json", FileKind::kReport},     {"plan.json", FileKind::kReport},
      {"list.json", FileKind::kReport},    {"installed.json", FileKind::kReport},
      {"hand.json", FileKind::kReport},    {"rules.json", FileKind::kReport},
      {"installed.csv", FileKind::kTable}, {"path.csv", FileKind::kTable},
      {"straight.csv", FileKind::kTable},  {"trace.csv", FileKind::kTable},
      {"curve.csv", FileKind::kTable},     {"installed.png", FileKind::kPicture},
      {"worst.png", FileKind::kPicture}};
  for (const auto& [name, kind] : kWritten) {
    std::string path = (std::filesystem::path(options.folder) / name).string();
    std::error_code failure;
    if (!std::filesystem::exists(path, failure)) continue;
    if (std::filesystem::equivalent(path, options.path, failure)) continue;  // it is only read
    const forcelayer::command::OutputFile output[] = {{"--output", &path, kind}};
    if (auto s = forcelayer::command::check_outputs(output); !s) return s;
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  using namespace forcelayer;
  CLI::App app{
      "Lists the commands. 'forcelayer study' runs them to check a part of an assembly. "
      "'forcelayer pairs' checks all pairs of its parts, and 'forcelayer disassemble' takes it "
      "apart",
      "forcelayer"};
  CLI::App* const made = app.add_subcommand(
      "study", "bake scene and part; find, run or check a path; write a page with the verdict");
  const study::OptionParser parser(*made);
  CLI::App* const paired = app.add_subcommand(
      "pairs", "find overlaps and small distances between the parts of an assembly");
  const pairs::OptionParser pairs_parser(*paired);
  CLI::App* const taken_apart = app.add_subcommand(
      "disassemble", "take an assembly apart: in which order, and along which paths");
  const disassembly::OptionParser disassembly_parser(*taken_apart);
  app.require_subcommand(0, 1);
  std::string json;
  bool quiet = false;
  app.add_option("--json", json, "write the list of commands");
  app.add_flag("--quiet", quiet, "print nothing but errors");
  app.footer("The commands:\n" + command_lines());
  command::arrange_help(
      app, {},
      "  forcelayer                                                 lists the commands\n"
      "  forcelayer study 'gearbox.glb#Pin' --pull 0,0,60mm -o pin");
  made->footer(
      "The same command continues an earlier study. It skips finished steps whose inputs did not "
      "change.\n"
      "Exit status 0: clear; 6: not clear, or the part does not come out; 7: not clear without "
      "force,\n"
      "because the installed part overlaps a neighbor.");
  command::arrange_help(
      *made,
      {{"Question",
        {"--voxel-size", "--path", "--center", "--pull", "--time", "--clearance", "--rules",
         "--seat", "--seat-depth", "--allow"}},
       {"Meshes", {"--without", "--missing-faces", "--units", "--up", "--sandbox"}},
       {"Output", {"--output", "--plan", "--files-alone", "--no-pictures"}}},
      "  forcelayer study 'gearbox.glb#Pin' --clearance 1mm -o out\n"
      "  forcelayer study 'gearbox.glb#Pin' --pull 0,0,60mm -o pin\n"
      "  forcelayer study 'gearbox.glb#Cover' --without Lid --voxel-size 1mm --path out.csv -o "
      "cover");
  int status = 0;
  if (!command::parse_subcommands(app, argc, argv, status)) return status;
  command::exit_cleanly_on_signals();
  if (*paired) return run_other("pairs", pairs::kProgram, pairs_parser, argc, argv);
  if (*taken_apart) {
    return run_other("disassemble", disassembly::kProgram, disassembly_parser, argc, argv);
  }
  return command::run_command("forcelayer", [&]() -> Status {
    if (!*made) return list_commands(json, quiet);
    auto options = parser.finish();
    if (!options) return options.error();
    const std::string inputs[] = {options->assembly, options->path};
    const command::OutputFile outputs[] = {{"--json", &options->json, command::FileKind::kReport}};
    if (Status s = command::prepare_outputs(outputs, inputs); !s) return s;
    if (Status s = check_folder(*options); !s) return s;
    command::stop_programs_on_signals();
    command::share_warnings();  // several steps read the same meshes
    command::take_errors(options->names);
    const Status ended = study::make_study(*options);
    const int stopped = command::stop_signal();
    if (stopped == 0 || ended || command::is_answer(ended.error().code)) return ended;
    std::fprintf(
        stderr,
        "forcelayer: %s contains the finished steps; the same command continues from there\n",
        escaped(options->folder).c_str());
    command::end_on_signal(stopped);
  });
}
