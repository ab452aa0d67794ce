// forcelayer: lists the commands, and makes a study of a part with them.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "formats/command/arguments.h"
#include "formats/command/command.h"
#include "formats/command/help.h"
#include "formats/command/output_file.h"
#include "formats/command/program.h"
#include "runtime/study/options.h"
#include "runtime/study/study.h"

namespace {

struct Listed {
  const char* name;
  const char* does;
};
constexpr Listed kCommands[] = {
    {"voxelize", "bakes the static scene into a .vox file"},
    {"pointshell", "bakes the part into a .pshell file"},
    {"voxinfo", "says what a baked file is; verifies, samples and exports it"},
    {"voxrun", "runs the haptic loop; voxrun doctor checks the machine"},
    {"voxcheck", "proves that a part keeps its clearance along a path"},
    {"voxplan", "finds a way for a part out of where it is installed"},
    {"voxview", "shows meshes, baked files and runs"},
};

void print_commands() {
  for (const Listed& command : kCommands) {
    const bool here = !forcelayer::command::program_path(command.name).empty();
    std::printf("  %-11s %s%s\n", command.name, command.does, here ? "" : " (not installed)");
  }
  std::puts("  forcelayer study: all of it, from an assembly to a page with a verdict");
  std::puts("Each has --help.");
}

}  // namespace

int main(int argc, char** argv) {
  using namespace forcelayer;
  if (argc == 1) {
    print_commands();
    return 0;
  }
  CLI::App app{"Lists the commands; makes a study of a part with them", "forcelayer"};
  CLI::App* const made = app.add_subcommand(
      "study", "bake scene and part, find, run or check a path, and write a page with the verdict");
  const study::OptionParser parser(*made);
  app.require_subcommand(1);
  made->footer(
      "Called again it goes on: what is finished and unchanged is not done again.\n"
      "Exit status 0: clear; 6: not clear, or the part does not come out.");
  command::arrange_help(
      *made,
      {{"What is asked",
        {"--voxel-size", "--path", "--pull", "--time", "--clearance", "--seat", "--seat-depth",
         "--allow"}},
       {"What is read", {"--without", "--units", "--sandbox"}},
       {"Output", {"--output", "--files-alone", "--no-pictures"}}},
      "  forcelayer study 'gearbox.glb#Pin' --voxel-size 1mm --clearance 1mm -o out\n"
      "  forcelayer study 'gearbox.glb#Pin' --voxel-size 1mm --pull 0,0,60mm -o pin\n"
      "  forcelayer study 'gearbox.glb#Cover' --without Lid --voxel-size 1mm --path out.csv -o "
      "cover");
  int status = 0;
  if (!command::parse_arguments(app, argc, argv, status)) return status;
  command::exit_cleanly_on_signals();
  return command::run_command("forcelayer", [&]() -> Status {
    auto options = parser.finish();
    if (!options) return options.error();
    const std::string inputs[] = {options->assembly, options->path};
    const command::OutputFile outputs[] = {{"--json", &options->json, command::FileKind::kReport}};
    if (Status s = command::prepare_outputs(outputs, inputs); !s) return s;
    return study::make_study(*options);
  });
}
