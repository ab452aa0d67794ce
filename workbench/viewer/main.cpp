// voxview: shows scenes, baked files and runs, on a screen or as a picture.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string_view>

#include "formats/command/arguments.h"
#include "formats/command/command.h"
#include "formats/command/help.h"
#include "formats/command/output_file.h"
#include "formats/command/report.h"
#include "formats/mesh/sandbox/sandbox.h"
#include "workbench/viewer/plan/keys.h"
#include "workbench/viewer/plan/options.h"
#include "workbench/viewer/plan/picture_plan.h"
#include "workbench/viewer/run/run_rows.h"
#include "workbench/viewer/screen.h"
#include "workbench/viewer/vtk/picture.h"
#include "workbench/viewer/vtk/window.h"

namespace forcelayer::viewer {
namespace {

constexpr double kListenS = 3;  // before a picture of a stream, unless the user says otherwise

bool takes_picture(const ViewOptions& options) {
  return !options.screenshot.empty() || !options.turntable.empty();
}

// Follows the stream for a while; the newest row, where one came.
std::optional<TraceRow> newest_row(PoseReceiver& receiver, double seconds, Pose& grip) {
  using Clock = std::chrono::steady_clock;
  std::optional<TraceRow> newest;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (Clock::now() < end) {
    receiver.wait(20);
    const auto datagram = receiver.newest();
    if (!datagram) continue;
    const bool first = !newest;
    newest = row_of(*datagram);
    if (first) grip = grip_of(*newest);
  }
  return newest;
}

// Plans a picture of the stream's newest row at the end of listening.
Status plan_live(const ViewOptions& options, const ViewScene& scene, PoseReceiver& receiver,
                 PicturePlan& plan) {
  Pose grip;
  const auto row = newest_row(receiver, options.duration_s.value_or(kListenS), grip);
  if (!row) {
    return Error{ErrorCode::kReadFailed, "", "--listen " + options.listen, "no pose was received",
                 "start voxrun with --udp and this port"};
  }
  Moment moment = moment_of(*row, grip);
  return add_moment(options, scene, {}, std::move(moment), plan);
}

Status take_picture(const ViewOptions& options, const ViewScene& scene, PicturePlan& plan,
                    RunFeed& feed) {
  if (feed.receiver) {
    if (Status live = plan_live(options, scene, *feed.receiver, plan); !live) return live;
  }
  if (!options.turntable.empty()) {
    if (Status movie = write_turntable(options.turntable, scene, plan); !movie) return movie;
  }
  if (options.screenshot.empty()) return {};
  if (Status written = write_picture(options.screenshot, scene, plan); !written) return written;
  return options.json.empty() ? Status{}
                              : command::write_report(options.json, report_of(plan, scene));
}

Status draw(const ViewOptions& options, const ViewScene& scene, RunFeed feed) {
  auto plan = plan_picture(options, scene, feed.rows);
  if (!plan) return plan.error();
  if (!options.listen.empty()) {
    auto receiver = listen_at(options.listen);
    if (!receiver) return receiver.error();
    feed.receiver = std::move(*receiver);
  }
  if (takes_picture(options)) return take_picture(options, scene, *plan, feed);
  if (const auto on = screen()) {
    plan->scale = options.scale.value_or(on->scale);
    plan->width = std::min(plan->width, on->width);
    plan->height = std::min(plan->height, on->height);
  }
  return show_window(scene, options, *plan, std::move(feed));
}

Status prepare_outputs(ViewOptions& options) {
  std::vector<std::string> inputs = options.inputs.inputs;
  inputs.insert(inputs.end(), {options.inputs.before, options.inputs.part, options.run});
  const command::OutputFile outputs[] = {
      {"--screenshot", &options.screenshot, command::FileKind::kPicture},
      {"--screenshot turntable", &options.turntable, command::FileKind::kPicture},
      {"--json", &options.json, command::FileKind::kReport},
      {"--frame-times", &options.frame_times, command::FileKind::kReport}};
  return command::prepare_outputs(outputs, inputs);
}

Status find_screen(const ViewOptions& options, char** argv) {
  const bool endless =
      !takes_picture(options) && options.frame_times.empty() && !options.duration_s;
  if (endless && !display_is_set()) {
    return Error{ErrorCode::kDeviceNotFound, "", "", "there is no display for a window",
                 "set DISPLAY, or give --screenshot FILE"};
  }
  return ensure_screen(argv);
}

Status run(const ViewOptionParser& parser, char** argv) {
  auto options = parser.finish();
  if (!options) return options.error();
  if (Status s = prepare_outputs(*options); !s) return s;
  if (takes_picture(*options)) command::exit_cleanly_on_signals();
  if (Status screen = find_screen(*options, argv); !screen) return screen;
  const auto scene = load_view_scene(options->inputs);
  if (!scene) return scene.error();
  for (const std::string& warning : scene->warnings) command::warn(warning, options->quiet);
  RunFeed feed;
  if (!options->run.empty()) {
    auto rows = read_run(options->run, scene->voxmap_path, scene->shell_path);
    if (!rows) return rows.error();
    feed.rows = std::move(*rows);
  }
  return draw(*options, *scene, std::move(feed));
}

}  // namespace
}  // namespace forcelayer::viewer

int main(int argc, char** argv) {
  if (const auto status = forcelayer::mesh::run_as_sandbox(argc, argv)) return *status;
  CLI::App app{
      "Shows meshes, baked files and runs: in a window, or with --screenshot as a picture. Without "
      "a "
      "display, pictures are drawn under xvfb-run.",
      "voxview"};
  using forcelayer::viewer::Program;
  const bool draws = argc > 1 && std::string_view(argv[1]) == "draw";
  const forcelayer::viewer::ViewOptionParser parser(app, draws ? Program::kDraw : Program::kView);
  std::string keys = "In the window:\n";
  for (const std::string_view line : forcelayer::viewer::kKeyLines)
    keys += (keys.back() == '\n' ? "  " : "\n  ") + std::string(line);
  app.footer(keys);
  forcelayer::command::arrange_help(
      app,
      {{"View", {"--part", "--compare", "--units", "--show", "--hide", "--only", "--cut"}},
       {"A run and the moment to show", {"--trace", "--at", "--listen", "--path", "--part-pose"}},
       {"The eye", {"--view-from"}},
       {"Output", {"--screenshot", "--size"}}},
      "  voxview bay.json bay.vox part.pshell --trace run.csv              a run, in a window\n"
      "  voxview bay.json bay.vox --cut 'y<0mm' --screenshot bay.png       a picture");
  int exit_code = 0;
  if (!forcelayer::command::parse_arguments(app, argc - draws, argv + draws, exit_code))
    return exit_code;
  return forcelayer::command::run_command("voxview",
                                          [&] { return forcelayer::viewer::run(parser, argv); });
}
