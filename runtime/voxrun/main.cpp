// voxrun: runs the haptic loop between a baked scene and a baked part.
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "formats/command/arguments.h"
#include "formats/command/command.h"
#include "formats/command/help.h"
#include "formats/command/output_file.h"
#include "formats/command/version.h"
#include "formats/file/program_folder.h"
#include "runtime/query/query_kernel.h"
#include "runtime/voxrun/options.h"
#include "runtime/voxrun/session.h"

namespace {

std::atomic<int> stop_signal{0};   // the loop ends; also set where a frame cannot be written
std::atomic<int> scene_signal{0};  // SIGUSR1: the next scene

extern "C" void stop_on_signal(int number) {
  if (forcelayer::command::is_first_stop(number)) stop_signal = number;
}

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
    sigaction(number, &action, nullptr);
  }
}

forcelayer::Status prepare_outputs(forcelayer::voxrun::Options& options) {
  using forcelayer::command::FileKind;
  std::vector<std::string> inputs = {options.run.scene.string(),
                                     options.run.part.string(),
                                     options.motion,
                                     options.replay,
                                     options.plugin,
                                     options.guide};
  for (const auto& next : options.scene_next) inputs.push_back(next.path);
  const forcelayer::command::OutputFile outputs[] = {
      {"--json", &options.json, FileKind::kReport},
      {"--trace", &options.trace, FileKind::kTable},
      {"--save-path", &options.save_path, FileKind::kTable},
      {"--record", &options.record, FileKind::kRecording}};
  return forcelayer::command::prepare_outputs(outputs, inputs);
}

void arrange(CLI::App& app) {
  using namespace forcelayer;
  command::set_version(app, std::string("vectors ") + query::kernel_target());
  command::arrange_help(
      app,
      {{"Device", {"--device", "--motion", "--world-from-device", "--pull", "--after-trip"}},
       {"Part and scene",
        {"--start", "--seat", "--grip", "--without-guarantee", "--fail-on", "--scene-next",
         "--guide", "--expect"}},
       {"Loop",
        {"--duration", "--threads", "--as-fast-as-possible", "--model", "--force", "--set"}},
       {"Output", {"--trace", "--save-path", "--record", "--replay", "--udp"}}},
      "  voxrun bay.vox part.pshell --motion press.csv --trace run.csv   a scripted hand\n"
      "  voxrun bay.vox part.pshell --device hid --duration 10min        a hand on a device\n"
      "  voxrun opened.vox cover.pshell --motion lift.csv --fail-on penetration,seat\n"
      "  voxrun opened.vox cover.pshell --guide lift.csv --device sim:hand=loose --duration 30s\n"
      "  voxrun bay.vox part.pshell --replay run.flr                     repeats a run\n"
      "  voxrun doctor                                                   checks the machine");
}

// voxrun doctor [...] is a program of its own, beside this one: a loop does not carry it.
int start_doctor(char** argv) {
  const std::filesystem::path doctor = forcelayer::program_folder() / "voxrun-doctor";
  static char called[] = "voxrun";  // what its report calls the tool
  argv[0] = called;
  execv(doctor.c_str(), argv);  // returns where it failed
  return forcelayer::command::run_command("voxrun", [&]() -> forcelayer::Status {
    return forcelayer::Error{forcelayer::ErrorCode::kFileNotFound, doctor.string(), "",
                             std::string("cannot be started: ") + strerror(errno),
                             "install voxrun-doctor in the same folder as voxrun"};
  });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "doctor") return start_doctor(argv + 1);
  const auto made = forcelayer::command::make_app(
      "Runs the haptic loop between a .vox scene and a .pshell part", "voxrun",
      "voxrun doctor lists the settings of this machine that can disturb the 1000 Hz loop.");
  CLI::App& app = *made;
  forcelayer::voxrun::OptionParser parser(app);
  arrange(app);
  int status = 0;
  if (!forcelayer::command::parse_arguments(app, argc, argv, status)) return status;
  end_loop_on_signals();
  bool began = true;
  status = forcelayer::command::run_command("voxrun", [&]() -> forcelayer::Status {
    if (forcelayer::Status s = parser.finish(); !s) return s;
    if (forcelayer::Status s = prepare_outputs(parser.options()); !s) return s;
    return forcelayer::voxrun::run_session(parser.options(), stop_signal, scene_signal, began);
  });
  const int ended_by = stop_signal.load();
  if (status != 0 || ended_by <= 0) return status;
  std::fprintf(
      stderr, "voxrun: ended by signal %d (%s)%s\n", ended_by, strsignal(ended_by),
      began ? "; the output files contain the run up to this point" : " before the run began");
  return 128 + ended_by;
}
