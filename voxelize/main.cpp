// voxelize: bakes a static scene into a .vox file.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "formats/command/command.h"
#include "formats/command/quantity.h"
#include "formats/mesh/scene.h"
#include "voxelize/bake.h"
#include "voxelize/plan.h"
#include "voxelize/provenance.h"
#include "voxelize/report.h"
#include "voxelize/warnings.h"

namespace forcelayer {
namespace {

struct Arguments {
  std::vector<std::string> inputs;
  std::string output, json_path;
  std::string voxel_size, units, mesh_deviation;
  std::optional<std::uint32_t> layers;
  std::vector<std::string> free_seeds;
  int threads = 0;
  bool plan = false;
  bool quiet = false;
};

void declare(CLI::App& app, Arguments& arguments) {
  app.add_option(
         "INPUT", arguments.inputs,
         "mesh files, assemblies (FILE.glb#Node for a sub-tree), folders, or a manifest (.json)")
      ->required();
  app.add_option("-o,--output", arguments.output, "the .vox file to write");
  app.add_option("--voxel-size", arguments.voxel_size, "edge of a voxel, such as 5mm");
  app.add_option("--units", arguments.units,
                 "unit of meshes whose format defines none: mm, cm, m, in, ...");
  app.add_option("--layers", arguments.layers,
                 "voxel layers by which the force layer is offset (default 2)");
  app.add_option(
      "--free-seed", arguments.free_seeds,
      "x,y,z of a point whose surroundings are free, such as the inside of a cabin (repeatable)");
  app.add_option("--mesh-deviation", arguments.mesh_deviation,
                 "how far the meshes may lie from the true surfaces, such as 0.1mm");
  app.add_option("--threads", arguments.threads, "threads (default: all)")
      ->check(CLI::Range(1, 1024));
  app.add_flag(
      "--plan", arguments.plan,
      "bake nothing: print what the voxel size, its half and its quarter would give and cost");
  app.add_option("--json", arguments.json_path, "write a report to this file");
  app.add_flag("--quiet", arguments.quiet, "print nothing but errors");
}

Error usage(const char* option, const Error& error) {
  return {ErrorCode::kUsage, "", option, error.what, error.mend};
}

// The options that the command line gives, over those of a manifest.
Result<BakeOptions> options_of(const Arguments& arguments, const Scene& scene) {
  BakeOptions options;
  options.voxel_size_m = scene.voxel_size_m.value_or(0);
  if (!arguments.voxel_size.empty()) {
    const auto size = parse_length(arguments.voxel_size);
    if (!size) return usage("--voxel-size", size.error());
    options.voxel_size_m = *size;
  } else if (!scene.voxel_size_m) {
    return Error{ErrorCode::kUsage, "", "--voxel-size", "is missing",
                 "add it, for example --voxel-size 5mm"};
  }
  options.layers = arguments.layers.value_or(scene.layers.value_or(2));
  options.free_seeds_m = scene.free_seeds_m;
  for (const std::string& text : arguments.free_seeds) {
    const auto point = parse_point(text);
    if (!point) return usage("--free-seed", point.error());
    options.free_seeds_m.push_back(*point);
  }
  if (!arguments.mesh_deviation.empty()) {
    const auto deviation = parse_length(arguments.mesh_deviation);
    if (!deviation) return usage("--mesh-deviation", deviation.error());
    options.mesh_deviation_m = *deviation;
  }
  options.threads = arguments.threads > 0
                        ? arguments.threads
                        : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  return options;
}

// Everything of the command line that can be checked before a file is read.
Status check_early(const Arguments& arguments) {
  if (arguments.plan && !arguments.output.empty()) {
    return Error{ErrorCode::kUsage, "", "--output", "has no meaning with --plan", "leave it out"};
  }
  if (!arguments.plan && arguments.output.empty()) {
    return Error{ErrorCode::kUsage, "", "--output", "is missing", "add -o FILE.vox"};
  }
  Scene unknown;
  unknown.voxel_size_m = 1;  // a manifest may give it
  const auto options = options_of(arguments, unknown);
  return options ? Status() : options.error();
}

class Clock {
 public:
  double total_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  double lap_s() {
    const double now_s = total_s(), lap_s = now_s - lap_start_s_;
    lap_start_s_ = now_s;
    return lap_s;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double lap_start_s_ = 0;
};

std::vector<SceneObject> objects_of(const Scene& scene) {
  std::vector<SceneObject> objects;
  for (const ScenePart& part : scene.parts) {
    objects.push_back({part.name, &scene.mesh_of(part), part.world_from_mesh, part.free_seeds_m,
                       part.deviation_m});
  }
  return objects;
}

void print_summary(const std::string& output, const Bake& bake, const RunFacts& run) {
  const VoxmapHeader& h = bake.header;
  std::printf(
      "%s: %llu x %llu x %llu voxels of %g mm, %llu interior, %llu force layer, %llu proximity; "
      "%.1f MB in %.2f s\n",
      output.c_str(), static_cast<unsigned long long>(h.dims_voxels[0]),
      static_cast<unsigned long long>(h.dims_voxels[1]),
      static_cast<unsigned long long>(h.dims_voxels[2]), h.voxel_size_m * 1e3,
      static_cast<unsigned long long>(h.interior_voxels),
      static_cast<unsigned long long>(h.surface_voxels),
      static_cast<unsigned long long>(h.proximity_voxels),
      static_cast<double>(run.file_bytes) * 1e-6, run.total_s);
}

Status print_plan(const Arguments& arguments, std::span<const SceneObject> objects,
                  const BakeOptions& options) {
  const auto plan = plan_bakes(objects, options);
  if (!plan) return plan.error();
  if (!arguments.quiet) std::fputs(table_of(*plan).c_str(), stdout);
  if (arguments.json_path.empty()) return {};
  return write_report(arguments.json_path, report_of(*plan));
}

Status voxelize(const Arguments& arguments) {
  if (Status checked = check_early(arguments); !checked) return checked;
  Clock clock;
  RunFacts run;
  ProgressLine progress(arguments.quiet);
  progress.show("reading", 0);
  std::optional<double> unit;
  if (!arguments.units.empty()) {
    const auto parsed = parse_unit(arguments.units);
    if (!parsed) return usage("--units", parsed.error());
    unit = *parsed;
  }
  const auto scene = read_scene(arguments.inputs, unit);
  if (!scene) return scene.error();
  auto options = options_of(arguments, *scene);
  if (!options) return options.error();
  run.threads = options->threads;
  run.read_s = clock.lap_s();

  options->progress = [&](const char* stage, double share) { progress.show(stage, 0.95 * share); };
  const std::vector<SceneObject> objects = objects_of(*scene);
  if (arguments.plan) {
    progress.clear();
    return print_plan(arguments, objects, *options);
  }
  const auto bake = forcelayer::bake(objects, *options);
  if (!bake) return bake.error();
  clock.lap_s();

  progress.show("writing", 0.95);
  const auto written =
      write_voxmap(arguments.output, bake->content(provenance_of(*scene, *options)));
  if (!written) return written.error();
  run.file_bytes = *written;
  run.write_s = clock.lap_s();
  run.total_s = clock.total_s();
  progress.clear();

  if (!arguments.quiet) {
    for (const std::string& warning : all_warnings(*scene, *options)) {
      std::fprintf(stderr, "voxelize: warning: %s\n", warning.c_str());
    }
    print_summary(arguments.output, *bake, run);
  }
  if (arguments.json_path.empty()) return {};
  return write_report(arguments.json_path, report_of(*bake, run));
}

int run(int argc, char** argv) {
  CLI::App app{"Bakes a static scene into the voxmap of a .vox file", "voxelize"};
  Arguments arguments;
  declare(app, arguments);
  int exit_code = 0;
  if (!parse_arguments(app, argc, argv, exit_code)) return exit_code;
  return run_command("voxelize", [&] { return voxelize(arguments); });
}

}  // namespace
}  // namespace forcelayer

int main(int argc, char** argv) {
  forcelayer::exit_cleanly_on_signals();
  return forcelayer::run(argc, argv);
}
