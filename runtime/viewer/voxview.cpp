// voxview: shows scenes, baked files and runs, on a screen or as a picture.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "formats/command/command.h"
#include "runtime/viewer/options.h"
#include "runtime/viewer/picture_plan.h"
#include "runtime/viewer/virtual_screen.h"
#include "runtime/viewer/vtk_picture.h"

namespace forcelayer {
namespace {

Status take_picture(const ViewOptions& options, const ViewScene& scene, char** argv) {
  const auto plan = plan_picture(options, scene);
  if (!plan) return plan.error();
  if (Status screen = ensure_screen(argv); !screen) return screen;
  if (Status written = write_picture(options.screenshot, scene, *plan); !written) return written;
  return options.json.empty() ? Status{} : write_report(options.json, report_of(*plan, scene));
}

Status run(const ViewOptionParser& parser, char** argv) {
  const auto options = parser.finish();
  if (!options) return options.error();
  const auto scene = load_view_scene(options->inputs);
  if (!scene) return scene.error();
  for (const std::string& warning : scene->warnings) {
    std::fprintf(stderr, "voxview: warning: %s\n", warning.c_str());
  }
  return take_picture(*options, *scene, argv);
}

}  // namespace
}  // namespace forcelayer

int main(int argc, char** argv) {
  CLI::App app{"Show scenes, baked files and runs", "voxview"};
  const forcelayer::ViewOptionParser parser(app);
  int exit_code = 0;
  if (!forcelayer::parse_arguments(app, argc, argv, exit_code)) return exit_code;
  return forcelayer::run_command("voxview", [&] { return forcelayer::run(parser, argv); });
}
