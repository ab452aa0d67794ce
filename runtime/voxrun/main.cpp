// voxrun: runs the haptic loop between a baked scene and a baked part.
#include <signal.h>
#include <string.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <string_view>

#include "formats/command/arguments.h"
#include "formats/command/command.h"
#include "formats/command/output_file.h"
#include "runtime/voxrun/doctor.h"
#include "runtime/voxrun/options.h"
#include "runtime/voxrun/session.h"

namespace {

std::atomic<int> stop_signal{0};
std::atomic<int> scene_signal{0};  // SIGUSR1: the next scene

extern "C" void stop_on_signal(int number) { stop_signal.store(number, std::memory_order_relaxed); }

extern "C" void ask_for_scene(int) { scene_signal.store(1, std::memory_order_relaxed); }

// The loop ends at its next tick, with the output at zero and every file written.
void end_loop_on_signals() {
  // Nobody reads what we say, or a trace meets a limit: no reason to let go of the motors.
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);
  struct sigaction next {};
  next.sa_handler = ask_for_scene;
  next.sa_flags = SA_RESTART;
  sigaction(SIGUSR1, &next, nullptr);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    action.sa_handler = stop_on_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second one ends the process
    sigaction(number, &action, nullptr);
  }
}

forcelayer::Status prepare_outputs(forcelayer::voxrun::Options& options) {
  using forcelayer::command::FileKind;
  std::vector<std::string> inputs = {options.run.scene.string(), options.run.part.string(),
                                     options.motion, options.replay, options.plugin};
  for (const auto& next : options.scene_next) inputs.push_back(next.path);
  const forcelayer::command::OutputFile outputs[] = {
      {"--json", &options.json, FileKind::kReport},
      {"--trace", &options.trace, FileKind::kTable},
      {"--save-path", &options.save_path, FileKind::kTable},
      {"--record", &options.record, FileKind::kRecording}};
  return forcelayer::command::prepare_outputs(outputs, inputs);
}

// voxrun doctor [...]: argv begins with "doctor".
int doctor(int argc, char** argv) {
  CLI::App app{"Says what of this machine stands in the way of a quiet loop, and how to mend it",
               "voxrun doctor"};
  forcelayer::voxrun::DoctorOptions options;
  app.add_option("--json", options.json, "write a report");
  forcelayer::command::add_number(app, "--clock", options.clock_s,
                                  "seconds for which the clock is measured; 0: not", {0, 3600});
  int status = 0;
  if (!forcelayer::command::parse_arguments(app, argc, argv, status)) return status;
  return forcelayer::command::run_command("voxrun doctor",
                                          [&] { return forcelayer::voxrun::run_doctor(options); });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "doctor") return doctor(argc - 1, argv + 1);
  CLI::App app{"Runs the haptic loop between a .vox scene and a .pshell part", "voxrun"};
  app.footer("voxrun doctor says what of this machine stands in the way of a quiet loop.");
  forcelayer::voxrun::OptionParser parser(app);
  int status = 0;
  if (!forcelayer::command::parse_arguments(app, argc, argv, status)) return status;
  end_loop_on_signals();
  status = forcelayer::command::run_command("voxrun", [&]() -> forcelayer::Status {
    auto options = parser.finish();
    if (!options) return options.error();
    if (forcelayer::Status s = prepare_outputs(*options); !s) return s;
    return forcelayer::voxrun::run_session(*options, stop_signal, scene_signal);
  });
  const int ended_by = stop_signal.load();
  if (status != 0 || ended_by <= 0) return status;
  std::fprintf(stderr, "voxrun: ended by signal %d (%s)\n", ended_by, strsignal(ended_by));
  return 128 + ended_by;
}
