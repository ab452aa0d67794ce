// voxplan: finds a path for a part out of its seat, or to a pose, with a proven clearance.
#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>

#include "formats/command/arguments.h"
#include "formats/command/command.h"
#include "formats/command/help.h"
#include "formats/command/output_file.h"
#include "formats/command/progress_line.h"
#include "formats/command/report.h"
#include "formats/command/text.h"
#include "formats/command/version.h"
#include "formats/mesh/sandbox/sandbox.h"
#include "runtime/run/baked_files.h"
#include "runtime/voxcheck/exact.h"
#include "runtime/voxcheck/missing_faces.h"
#include "runtime/voxcheck/object_names.h"
#include "runtime/voxcheck/words.h"
#include "workbench/voxplan/options.h"
#include "workbench/voxplan/plan.h"
#include "workbench/voxplan/report.h"

namespace forcelayer::voxplan {
namespace {

Status write_path(const std::string& file, const std::vector<PathRow>& rows) {
  auto writer = PathWriter::create(file);
  if (!writer) return writer.error();
  for (const PathRow& row : rows) {
    if (Status s = writer->add(row); !s) return s;
  }
  return writer->finish();
}

voxcheck::ExactRequest mesh_request(const Options& options) {
  voxcheck::ExactRequest request;
  request.scene = options.scene;
  request.part = options.part;
  voxcheck::name_meshes(options, request);
  return request;
}

Status plan_for(const Options& options) {
  const auto scene = open_scene(options.scene);
  if (!scene) return scene.error();
  const auto part = open_part(options.part);
  if (!part) return part.error();
  voxcheck::warn_of_missing_faces(options.scene, *scene, options.part, *part, options.quiet);
  if (const double radius_m = part->header().covering_radius_m; radius_m > scene->voxel_size_m()) {
    command::warn(
        command::text(
            "the part's covering radius, %.3g mm, is larger than a voxel of the scene, %.3g mm, so "
            "less clearance can be proven; bake the part with --voxel-size %.3gmm",
            1e3 * radius_m, 1e3 * scene->voxel_size_m(), 1e3 * scene->voxel_size_m()),
        options.quiet);
  }
  const auto allowed = voxcheck::named_objects(*scene, options.allow);
  if (!allowed) return allowed.error();
  const Problem problem{*scene, *part, options.clearance_m,
                        options.world_from_seat * part_from_center(*part), *allowed};
  std::optional<exact::Meshes> meshes;
  if (!options.meshes.empty()) {
    auto read = exact::read_meshes(mesh_request(options), options.quiet);
    if (!read) return read.error();
    for (const std::string& warning : read->warnings) command::warn(warning, options.quiet);
    meshes = std::move(*read);
  }
  command::ProgressLine line(options.quiet);
  const auto planned =
      plan(problem, options, meshes ? &*meshes : nullptr, [&](double fraction, double out_m) {
        line.show(command::text("moved up to %.3g mm", 1e3 * out_m), fraction);
      });
  line.clear();
  if (!planned) {
    Error error = planned.error();
    if (error.file.empty()) error.file = options.scene;
    return error;
  }
  const Report report{options, problem, *planned};
  if (planned->search.found) {
    if (voxcheck::is_never_near(planned->checked, *part, options.allow)) {
      command::warn(voxcheck::never_near_text("seat"), options.quiet);
    }
    if (Status s = write_path(options.path, planned->rows); !s) return s;
    if (!options.quiet) std::cout << command::terminal_text(report.verdict) << std::flush;
  }
  if (!options.json.empty()) {
    if (Status s = command::write_report(options.json, report_json(report)); !s) return s;
  }
  return command::exit_of(report.verdict, options.part);
}

int run(int argc, char** argv) {
  CLI::App app{
      "Searches for a path that takes a part out of its installed position, or to a pose. The "
      "clearance is proven for the whole path",
      "voxplan"};
  app.footer(
      "Exit status 0: a path was found; 6: no path was found within --time; 7: a path was found, "
      "but\n"
      "it is not clear without force, because the installed part overlaps a neighbor.");
  command::set_version(app, "OMPL " FORCELAYER_OMPL_VERSION);
  OptionParser parser(app);
  command::arrange_help(
      app,
      {{"Question", {"--seat", "--goal", "--clearance", "--allow", "--seat-depth"}},
       {"Meshes",
        {"--exact", "--part", "--without", "--units", "--part-units", "--allow-outside",
         "--sandbox"}},
       {"Search", {"--time", "--seed", "--threads"}},
       {"Output", {"--output"}}},
      "  voxplan rest.vox pin.pshell --clearance 1mm -o out.csv        from the installed "
      "position\n"
      "  voxplan bay.vox part.pshell --seat 0.3m,0.2m,0.5m --goal 0.3m,0.2m,0.9m -o path.csv");
  int status = 0;
  if (!command::parse_arguments(app, argc, argv, status)) return status;
  command::exit_cleanly_on_signals();
  return command::run_command("voxplan", [&]() -> Status {
    auto options = parser.finish();
    if (!options) return options.error();
    const command::OutputFile outputs[] = {{"--output", &options->path, command::FileKind::kTable},
                                           {"--json", &options->json, command::FileKind::kReport}};
    std::vector<std::string> inputs{options->scene, options->part};
    inputs.insert(inputs.end(), options->meshes.begin(), options->meshes.end());
    inputs.insert(inputs.end(), options->part_meshes.begin(), options->part_meshes.end());
    if (Status s = command::prepare_outputs(outputs, inputs); !s) return s;
    return plan_for(*options);
  });
}

}  // namespace
}  // namespace forcelayer::voxplan

int main(int argc, char** argv) {
  if (const auto status = forcelayer::mesh::run_as_sandbox(argc, argv)) return *status;
  return forcelayer::voxplan::run(argc, argv);
}
