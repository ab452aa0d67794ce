// voxrun-doctor: the program that `voxrun doctor` starts.
#include <CLI/CLI.hpp>

#include "formats/command/arguments.h"
#include "formats/command/command.h"
#include "formats/command/help.h"
#include "formats/command/output_file.h"
#include "runtime/doctor/doctor.h"

int main(int argc, char** argv) {
  using namespace forcelayer;
  CLI::App app{
      "Lists the settings of this machine that can disturb the 1000 Hz loop, and how to fix them",
      "voxrun doctor"};
  doctor::DoctorOptions options;
  app.add_option("--json", options.json, "write a report to this file");
  app.add_flag("--quiet", options.quiet, "no report on the terminal");
  command::add_number(app, "--clock", options.clock_s,
                      "measure the wake-up delay for this many seconds; 0 skips the measurement",
                      {0, 3600});
  command::arrange_help(app, {{"The measurement", {"--clock"}}},
                        "  voxrun doctor --json machine.json");
  int status = 0;
  if (!command::parse_arguments(app, argc, argv, status)) return status;
  command::exit_cleanly_on_signals();
  return command::run_command("voxrun doctor", [&]() -> Status {
    const command::OutputFile outputs[] = {{"--json", &options.json, command::FileKind::kReport}};
    if (Status s = command::prepare_outputs(outputs, {}); !s) return s;
    return doctor::run_doctor(options);
  });
}
