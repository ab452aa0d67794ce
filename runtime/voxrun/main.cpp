// voxrun: runs the haptic loop between a baked scene and a baked part.
#include <signal.h>

#include <CLI/CLI.hpp>
#include <atomic>

#include "formats/command/command.h"
#include "runtime/voxrun/options.h"
#include "runtime/voxrun/session.h"

namespace {

std::atomic<int> stop_signal{0};

extern "C" void stop_on_signal(int number) { stop_signal.store(number, std::memory_order_relaxed); }

// The loop ends at its next tick, with the output at zero and every file written.
void end_loop_on_signals() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    action.sa_handler = stop_on_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second one ends the process
    sigaction(number, &action, nullptr);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Runs the haptic loop between a .vox scene and a .pshell part", "voxrun"};
  forcelayer::voxrun::OptionParser parser(app);
  int status = 0;
  if (!forcelayer::parse_arguments(app, argc, argv, status)) return status;
  end_loop_on_signals();
  status = forcelayer::run_command("voxrun", [&]() -> forcelayer::Status {
    const auto options = parser.finish();
    if (!options) return options.error();
    return forcelayer::voxrun::run_session(*options, stop_signal);
  });
  const int ended_by = stop_signal.load();
  return status == 0 && ended_by > 0 ? 128 + ended_by : status;
}
