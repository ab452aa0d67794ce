// voxelize: bakes a static scene into a .vox file.
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "formats/command/arguments.h"
#include "formats/command/command.h"
#include "formats/command/help.h"
#include "formats/command/output_file.h"
#include "formats/command/progress_line.h"
#include "formats/command/quantity.h"
#include "formats/command/report.h"
#include "formats/command/version.h"
#include "formats/mesh/sandbox/trust_options.h"
#include "formats/mesh/scene.h"
#include "formats/mesh/step_support.h"
#include "formats/mesh/units.h"
#include "formats/mesh/up_axis.h"
#include "formats/path/path_file.h"
#include "voxelize/bake.h"
#include "voxelize/cache/cache_folder.h"
#include "voxelize/cache/mesh_source.h"
#include "voxelize/forecast.h"
#include "voxelize/limits/memory_limit.h"
#include "voxelize/listing.h"
#include "voxelize/plan.h"
#include "voxelize/provenance.h"
#include "voxelize/report.h"
#include "voxelize/size_text.h"
#include "voxelize/stopwatch.h"
#include "voxelize/sweep/swept_scene.h"
#include "voxelize/warnings.h"

namespace forcelayer::voxelize {
namespace {

// On the progress line: when reading ends and writing begins.
// Reading forecasts no time: how long the rest takes is not known before its end.
constexpr double kReadingDone = 0.09, kWritingDone = 0.95;

struct Arguments {
  std::vector<std::string> inputs;
  std::string output, json_path;
  std::string voxel_size, units, mesh_deviation, roi;
  std::string cache, shard, along;
  std::optional<std::uint32_t> layers;
  std::string kind = "full", standoff, range, compliance;
  mesh::TrustOptions trust;
  mesh::Up up = mesh::Up::kZ;
  std::vector<std::string> free_seeds, without;
  std::uint64_t missing_faces = 0;
  int threads = 0;
  bool narrow_passages = false;
  bool list = false;
  bool plan = false;
  bool quiet = false;
};

void declare(CLI::App& app, Arguments& arguments) {
  app.add_option(
         "INPUT", arguments.inputs,
         "mesh files, assemblies (FILE#Node, FILE#{Cover,Bolt*} for some nodes), folders, or a "
         "manifest (.json)")
      ->required();
  app.add_option("-o,--output", arguments.output, "the .vox file to write");
  app.add_option("--voxel-size", arguments.voxel_size,
                 "edge of a voxel, such as 5mm (default: the manifest's)");
  app.add_option("--units", arguments.units, command::kUnitsHelp);
  mesh::declare_up(app, arguments.up);
  app.add_option(
      "--layers", arguments.layers,
      "distance of the force layer from the surface, in layers of voxels, 0 to 30 (default 2)");
  app.add_option(
      "--standoff", arguments.standoff,
      "distance from the meshes at which the force begins, such as 11mm; 0.97 to 30 voxels. With "
      "--compliance, it must also be at least the last DEPTH of --compliance plus 0.87 voxels. It "
      "replaces --layers, and lets parts pass narrower gaps. It needs stored distances");
  app.add_option(
         "--kind", arguments.kind,
         "full (default): Euclidean layers and stored distances. lean: a smaller file without "
         "distances, so without exact forces and proven clearance. paper: the Chebyshev layers of "
         "the 1999 paper, without distances")
      ->check(CLI::IsMember({"full", "lean", "paper"}));
  app.add_option("--range", arguments.range,
                 "store distances down to this depth below the surface at which the force begins, "
                 "2 to 32 voxels (default 4 voxels)");
  app.add_option("--compliance", arguments.compliance,
                 "DEPTH:PRESSURE,...: how a soft surface presses back, such as 2mm:5kPa,6mm:40kPa "
                 "(default: the model's own stiffness)");
  app.add_option(
         "--free-seed", arguments.free_seeds,
         "x,y,z: a point whose surroundings are free, such as the inside of a cabin (repeatable)")
      ->allow_extra_args(false);
  app.add_option("--mesh-deviation", arguments.mesh_deviation,
                 "how far the meshes may lie from the true surfaces, such as 0.1mm (default 0)");
  app.add_option("--without", arguments.without,
                 "nodes of an assembly to leave out, with all nodes below them, or objects of a "
                 "manifest (repeatable). Write a node's name as in FILE#Node, and an object's name "
                 "as in the manifest")
      ->allow_extra_args(false);
  app.add_option(
         "--missing-faces", arguments.missing_faces,
         "accept up to this many lost faces (faces that give no triangles) in each STEP or IGES "
         "file (default 0); no guarantee covers them")
      ->check(CLI::Range(0, 1'000'000));
  app.add_option("--along", arguments.along,
                 "path (CSV of poses, or a trace): bake the space that the input sweeps along it");
  app.add_option("--roi", arguments.roi,
                 "x0,y0,z0,x1,y1,z1: the region to keep in the file (default: everything)");
  app.add_option("--cache", arguments.cache,
                 "folder of earlier results. Objects that did not change are taken from it");
  app.add_option("--shard", arguments.shard,
                 "I/N: bake the I-th of N shards of the objects into the cache, and write no file");
  arguments.trust.declare(app);
  app.add_flag("--narrow-passages", arguments.narrow_passages,
               "report which closed cavities would be open at half the voxel size (slow)");
  app.add_option("--threads", arguments.threads, "number of threads (default: all)")
      ->check(CLI::Range(1, 1024));
  app.add_flag("--list", arguments.list,
               "print the tree of each file, with the names for FILE# and --without; bake nothing");
  app.add_flag("--plan", arguments.plan,
               "print the cost and the narrowest gap that a part can pass, at this voxel size, at "
               "half and at a quarter of it; bake nothing");
  app.add_option("--json", arguments.json_path, "write a report to this file");
  app.add_flag("--quiet", arguments.quiet, "print nothing but errors");
}

void arrange(CLI::App& app) {
  command::set_version(app, mesh::kStepSupport);
  command::arrange_help(
      app,
      {{"Output", {"-o", "--list", "--plan", "--narrow-passages"}},
       {"Meshes", {"--units", "--up", "--without", "--missing-faces", "--mesh-deviation"}},
       {"The map",
        {"--voxel-size", "--layers", "--standoff", "--kind", "--range", "--compliance",
         "--free-seed", "--along", "--roi"}},
       {"Many bakes", {"--cache", "--shard", "--threads"}},
       {"Untrusted files", {"--sandbox", "--allow-outside"}}},
      "  voxelize bay.json --voxel-size 5mm --plan                 the cost of a voxel size\n"
      "  voxelize bay.json --voxel-size 5mm -o bay.vox             a scene of many files\n"
      "  voxelize --list gearbox.glb                               the parts of an assembly\n"
      "  voxelize gearbox.glb --without Cover --voxel-size 1mm -o opened.vox\n"
      "  voxelize part.obj --units mm --voxel-size 2mm --along lift.csv -o swept.vox");
}

Error usage(const char* option, const Error& error) {
  return {ErrorCode::kUsage, "", option, error.what, error.mend};
}

int threads_of(const Arguments& arguments) {
  return arguments.threads > 0
             ? arguments.threads
             : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

// The options of the command line, then those of the manifest.
Result<BakeOptions> options_of(const Arguments& arguments, const mesh::Scene& scene) {
  BakeOptions options;
  options.voxel_size_m = scene.voxel_size_m.value_or(0);
  if (!arguments.voxel_size.empty()) {
    const auto size = command::parse_length(arguments.voxel_size);
    if (!size) return usage("--voxel-size", size.error());
    options.voxel_size_m = *size;
  } else if (!scene.voxel_size_m) {
    return Error{ErrorCode::kUsage, "", "--voxel-size", "is missing",
                 "add it, for example --voxel-size 5mm"};
  }
  options.layers = arguments.layers.value_or(scene.layers.value_or(2));
  if (!arguments.standoff.empty()) {
    const auto standoff = command::parse_length(arguments.standoff);
    if (!standoff) return usage("--standoff", standoff.error());
    if (arguments.layers) {
      return Error{ErrorCode::kUsage, "", "--standoff",
                   "cannot be combined with --layers, because both set where the force begins",
                   "leave one of them out"};
    }
    if (arguments.kind != "full") {
      return Error{ErrorCode::kUsage, "", "--standoff",
                   "needs stored distances, because the guard uses them",
                   "leave out --kind, or use --layers"};
    }
    if (!(*standoff > 0)) {
      return Error{ErrorCode::kUsage, "", "--standoff", "must be above zero",
                   "use at least 0.97 voxels"};
    }
    options.standoff_m = *standoff;
    options.layers = 0;  // in place of the manifest's, too
  }
  if (arguments.kind == "paper") options.metric = Metric::kChebyshev;
  options.distances = arguments.kind == "full";
  if (options.standoff_m == 0 && options.metric == Metric::kEuclidean && options.layers == 0) {
    return Error{ErrorCode::kUsage, "", "--layers", "must be at least 1, except with --kind paper",
                 "use --layers 1 or more, or --kind paper"};
  }
  if (!arguments.range.empty()) {
    const auto range = command::parse_length(arguments.range);
    if (!range) return usage("--range", range.error());
    if (!stores_distances(options)) {
      return Error{ErrorCode::kUsage, "", "--range", "has no effect without stored distances",
                   "leave out --range or --kind"};
    }
    options.range_m = *range;
  }
  if (!arguments.compliance.empty()) {
    const auto compliance = parse_compliance(arguments.compliance);
    if (!compliance) return compliance.error();
    if (!stores_distances(options)) {
      return Error{ErrorCode::kUsage, "", "--compliance", "needs stored distances",
                   "leave out --kind"};
    }
    options.compliance = *compliance;
  }
  options.free_seeds_m = scene.free_seeds_m;
  for (const std::string& text : arguments.free_seeds) {
    const auto point = command::parse_point(text);
    if (!point) return usage("--free-seed", point.error());
    options.free_seeds_m.push_back(*point);
  }
  if (!arguments.mesh_deviation.empty()) {
    const auto deviation = command::parse_length(arguments.mesh_deviation);
    if (!deviation) return usage("--mesh-deviation", deviation.error());
    options.mesh_deviation_m = *deviation;
  }
  options.roi_m = scene.roi_m;
  if (!arguments.roi.empty()) {
    const auto roi = command::parse_box(arguments.roi);
    if (!roi) return usage("--roi", roi.error());
    options.roi_m = *roi;
  }
  // Always with a cache: a later bake may report them.
  options.find_cavities = !arguments.json_path.empty() || !arguments.cache.empty();
  options.find_narrow_passages = arguments.narrow_passages;
  for (const std::string& input : arguments.inputs) options.scene_name += input + "\n";
  options.threads = threads_of(arguments);
  return options;
}

// "I/N", 1 to N.
Result<mesh::SceneShard> shard_of(const Arguments& arguments) {
  mesh::SceneShard shard;
  if (arguments.shard.empty()) return shard;
  const std::string_view text = arguments.shard;
  const auto slash = text.find('/');
  const auto number = [](std::string_view digits, std::uint32_t& value) {
    const auto [end, failure] =
        std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return failure == std::errc{} && end == digits.data() + digits.size() && value > 0;
  };
  if (slash == std::string_view::npos || !number(text.substr(0, slash), shard.index) ||
      !number(text.substr(slash + 1), shard.count) || shard.index > shard.count) {
    return Error{ErrorCode::kUsage, "", "--shard", "'" + arguments.shard + "' is not I/N",
                 "write 1/4 to 4/4 for four shards"};
  }
  --shard.index;
  return shard;
}

// Checks the command line as far as it can be checked before a file is read.
Status check_early(const Arguments& arguments) {
  const bool is_shard = !arguments.shard.empty();
  if (is_shard && arguments.cache.empty()) {
    return Error{ErrorCode::kUsage, "", "--shard", "needs a cache for its results",
                 "add --cache FOLDER"};
  }
  if (is_shard && arguments.plan) {
    return Error{ErrorCode::kUsage, "", "--shard", "has no effect with --plan",
                 "leave out --shard"};
  }
  if (arguments.list && (is_shard || arguments.plan)) {
    return Error{ErrorCode::kUsage, "", "--list",
                 std::string("cannot be combined with ") + (is_shard ? "--shard" : "--plan"),
                 "leave one of them out"};
  }
  if (is_shard && !arguments.along.empty()) {
    return Error{ErrorCode::kUsage, "", "--along",
                 "cannot be combined with --shard, because all objects move about one center",
                 "leave one of them out"};
  }
  if (arguments.list && !arguments.along.empty()) {
    return Error{ErrorCode::kUsage, "", "--along", "has no effect with --list", "leave it out"};
  }
  const bool writes_file = !is_shard && !arguments.plan && !arguments.list;
  if (!writes_file && !arguments.output.empty()) {
    const char* const other = is_shard ? "--shard" : arguments.plan ? "--plan" : "--list";
    return Error{ErrorCode::kUsage, "", "--output", std::string("has no effect with ") + other,
                 "leave it out"};
  }
  if (writes_file && arguments.output.empty()) {
    return Error{ErrorCode::kUsage, "", "--output", "is missing", "add -o FILE.vox"};
  }
  if (const auto shard = shard_of(arguments); !shard) return shard.error();
  if (const auto reader = arguments.trust.reader(); !reader) return reader.error();
  mesh::Scene unknown;
  unknown.voxel_size_m = 1;  // a manifest may give it; a list needs none
  const auto options = options_of(arguments, unknown);
  if (!options) return options.error();
  return arguments.voxel_size.empty() ? Status() : check_options(*options);
}

std::vector<SceneObject> objects_of(const mesh::Scene& scene, cache::MeshSource& meshes,
                                    double voxel_size_m) {
  std::vector<SceneObject> objects;
  for (const mesh::MeshObject& part : scene.objects) {
    SceneObject& object = objects.emplace_back();
    object.name = part.name;
    object.world_from_mesh = part.world_from_mesh;
    object.free_seeds_m = part.free_seeds_m;
    object.deviation_m = part.deviation_m;
    object.read_mesh = [&] { return meshes.mesh(part); };
    const cache::MeshOutline& outline = meshes.outline(part);
    object.mesh_digest = outline.digest();
    object.triangle_count = outline.triangle_count;
    const double faces = outline.area * mesh::area_factors(part.world_from_mesh).mean;
    object.work =
        faces / (voxel_size_m * voxel_size_m) + static_cast<double>(outline.triangle_count);
  }
  return objects;
}

// Replaces the objects of the scene by the space that they sweep along --along.
Status sweep_objects(const Arguments& arguments, mesh::Scene& scene, cache::MeshSource& meshes,
                     const BakeOptions& options, command::ProgressLine& progress) {
  const auto rows = read_path(arguments.along, PathOf::kPart);
  if (!rows) return rows.error();
  const auto swept =
      sweep::sweep_scene(scene, meshes, *rows, options.voxel_size_m, !options.free_seeds_m.empty());
  if (!swept) {
    Error error = swept.error();
    if (error.file.empty()) error.file = arguments.along;
    return error;
  }
  if (!arguments.quiet) {
    progress.clear();
    std::printf("along %s: %llu poses, at most %.3g mm from the motion\n",
                escaped(arguments.along).c_str(), static_cast<unsigned long long>(swept->poses),
                swept->deviation_m * 1e3);
  }
  return {};
}

// Before the bake, so that a wrong unit is seen in time.
void print_size(const mesh::Scene& scene, const Forecast& forecast) {
  if (scene.objects.empty()) return;
  std::printf("scene: %zu object%s, %s\n", scene.objects.size(),
              scene.objects.size() == 1 ? "" : "s", size_text_m(forecast.box_m, 1).c_str());
  std::fflush(stdout);
}

void print_summary(const std::string& output, const Bake& bake, const BakeFacts& run) {
  const VoxmapHeader& h = bake.header;
  std::printf(
      "%s: %llu x %llu x %llu voxels of %g mm, %llu interior, %llu force layer, %llu proximity; "
      "%.1f MB in %.2f s\n",
      escaped(output).c_str(), static_cast<unsigned long long>(h.dims_voxels[0]),
      static_cast<unsigned long long>(h.dims_voxels[1]),
      static_cast<unsigned long long>(h.dims_voxels[2]), h.voxel_size_m * 1e3,
      static_cast<unsigned long long>(h.interior_voxels),
      static_cast<unsigned long long>(h.surface_voxels),
      static_cast<unsigned long long>(h.proximity_voxels),
      static_cast<double>(run.file_bytes) * 1e-6, run.total_s);
}

// A line for each cavity that is closed only because a gap is narrower than the voxels.
void print_narrow_passages(const Bake& bake) {
  constexpr int kMaxLines = 20;
  const double size_m = bake.header.voxel_size_m;
  int found = 0;
  for (const ObjectReport& object : bake.objects) {
    for (const fill::Cavity& cavity : object.cavities) {
      if (!cavity.opens_at_half_size || ++found > kMaxLines) continue;
      const auto& [i, j, k] = cavity.seed_voxel;
      const auto center_m = [&](std::int64_t n) { return (static_cast<double>(n) + 0.5) * size_m; };
      std::printf(
          "%s: a cavity of %.3g cm3 is closed only because a passage is narrower than %g mm; "
          "to open the cavity, halve the voxel size or give --free-seed %.9gm,%.9gm,%.9gm\n",
          escaped(object.name).c_str(),
          static_cast<double>(cavity.voxels) * std::pow(size_m * 1e2, 3), size_m * 1e3, center_m(i),
          center_m(j), center_m(k));
    }
  }
  if (found > kMaxLines) std::printf("... and %d more: see --json\n", found - kMaxLines);
  if (found == 0) std::printf("no closed cavity would be open at half the voxel size\n");
}

std::vector<std::string> warnings_of(const mesh::Scene& scene, const cache::MeshSource& meshes,
                                     const BakeOptions& options) {
  std::vector<std::string> warnings = all_warnings(scene, meshes.outlines(scene), options);
  if (options.cache != nullptr && options.cache->trouble()) {
    warnings.push_back("nothing was stored in the cache " + *options.cache->trouble());
  }
  return warnings;
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) command::print_warning(warning);
}

// The plan reads the meshes and does not use the cache.
Status print_plan(const Arguments& arguments, const mesh::Scene& scene, cache::MeshSource& meshes,
                  BakeOptions options) {
  options.cache = nullptr;
  std::vector<SceneObject> objects = objects_of(scene, meshes, options.voxel_size_m);
  std::vector<std::shared_ptr<const mesh::Mesh>> read;
  for (SceneObject& object : objects) {
    const auto mesh = object.read_mesh();
    if (!mesh) return mesh.error();
    object.mesh = read.emplace_back(*mesh).get();
  }
  const auto plan = plan_bakes(objects, options);
  if (!plan) return plan.error();
  std::vector<std::string> warnings = warnings_of(scene, meshes, options);
  if (arguments.units.empty()) {
    const Forecast forecast = forecast_of(scene, meshes.outlines(scene), options);
    const auto question = unit_question("the scene", forecast.box_m, forecast.largest_unit_m);
    if (question) warnings.push_back(*question);
  }
  if (!arguments.quiet) {
    print_warnings(warnings);
    std::fputs(table_of(*plan).c_str(), stdout);
  }
  if (arguments.json_path.empty()) return {};
  nlohmann::ordered_json report = report_of(*plan);
  report["warnings"] = warnings;
  return command::write_report(arguments.json_path, report);
}

void print_shard(const Arguments& arguments, const Bake& bake) {
  const auto found = std::count_if(bake.objects.begin(), bake.objects.end(),
                                   [](const ObjectReport& object) { return object.from_cache; });
  std::printf("shard %s: %zu objects, %zu baked, %zu found in %s\n", arguments.shard.c_str(),
              bake.objects.size(), bake.objects.size() - static_cast<std::size_t>(found),
              static_cast<std::size_t>(found), escaped(arguments.cache).c_str());
}

// --units, in meters.
Result<std::optional<double>> unit_of(const Arguments& arguments) {
  if (arguments.units.empty()) return std::optional<double>();
  const auto parsed = command::parse_unit(arguments.units);
  if (!parsed) return usage("--units", parsed.error());
  return std::optional<double>(*parsed);
}

Status print_list(const Arguments& arguments) {
  const auto unit = unit_of(arguments);
  if (!unit) return unit.error();
  mesh::ReadOptions options;
  options.without = arguments.without;
  options.allow_outside = arguments.trust.allow_outside;
  options.up = arguments.up;
  options.deflection_m = mesh::kDeflectionBySize;
  if (!arguments.voxel_size.empty()) {
    options.deflection_m = mesh::baked_deflection_m(*command::parse_length(arguments.voxel_size));
  }
  const auto listed = list_files(arguments.inputs, *unit, options, *arguments.trust.reader());
  if (!listed) return listed.error();
  if (!arguments.quiet) {
    print_warnings(listed->warnings);
    std::fputs(table_of(*listed).c_str(), stdout);
  }
  if (arguments.json_path.empty()) return {};
  return command::write_report(arguments.json_path, report_of(*listed));
}

Result<mesh::Scene> read_inputs(const Arguments& arguments, cache::MeshSource& meshes,
                                command::ProgressLine& progress) {
  const auto unit = unit_of(arguments);
  if (!unit) return unit.error();
  mesh::SceneReading reading;
  if (!arguments.voxel_size.empty()) {
    const auto size = command::parse_length(arguments.voxel_size);
    if (!size) return usage("--voxel-size", size.error());
    reading.voxel_size_m = *size;
  }
  const auto shard = shard_of(arguments);
  if (!shard) return shard.error();
  reading.shard = *shard;
  reading.allow_outside = arguments.trust.allow_outside;
  reading.missing_faces = arguments.missing_faces;
  reading.up = arguments.up;
  reading.without = arguments.without;
  reading.read_ahead = [&](std::span<const mesh::FileToRead> files) {
    meshes.read_ahead(files, limits::available_bytes() / 2);
  };
  reading.read = [&](const std::string& path, const mesh::ReadOptions& options) {
    return meshes.read(path, options);
  };
  reading.progress = [&](double done) { progress.show("reading", kReadingDone * done); };
  auto scene = mesh::read_scene(arguments.inputs, *unit, reading);
  if (scene && *unit &&
      std::all_of(arguments.inputs.begin(), arguments.inputs.end(), mesh::is_manifest)) {
    scene->warnings.push_back("--units is not used: a manifest states the units of its objects");
  }
  return scene;
}

Status voxelize(const Arguments& arguments) {
  if (Status checked = check_early(arguments); !checked) return checked;
  if (arguments.list) return print_list(arguments);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads_of(arguments)));
  Stopwatch clock;
  BakeFacts run;
  command::ProgressLine progress(arguments.quiet);
  progress.show("reading", 0);
  std::optional<cache::CacheFolder> cache;
  if (!arguments.cache.empty()) {
    auto folder = cache::CacheFolder::open(arguments.cache);
    if (!folder) return folder.error();
    cache.emplace(std::move(*folder));
  }
  cache::MeshSource meshes(cache ? &*cache : nullptr, *arguments.trust.reader());
  auto scene = read_inputs(arguments, meshes, progress);
  if (!scene) return scene.error();
  for (const std::string& warning : scene->warnings) command::note_warning(warning);
  auto options = options_of(arguments, *scene);
  if (!options) return options.error();
  options->cache = cache ? &*cache : nullptr;
  if (!arguments.along.empty()) {
    if (Status checked = check_options(*options); !checked) return checked;
    const Status swept = sweep_objects(arguments, *scene, meshes, *options, progress);
    if (!swept) return swept;
  }
  run.threads = options->threads;
  run.read_s = clock.lap_s();

  if (arguments.plan) {
    progress.clear();
    return print_plan(arguments, *scene, meshes, *options);
  }
  const std::vector<cache::MeshOutline> outlines = meshes.outlines(*scene);
  const Forecast forecast = forecast_of(*scene, outlines, *options);
  if (Status fits = check_forecast(forecast, *options, limits::available_bytes()); !fits)
    return fits;
  run.expected_thread_s = forecast.bake_s * std::max(1, options->threads);
  run.expected_bytes = forecast.memory_bytes;
  const bool is_shard = !arguments.shard.empty();
  std::vector<std::string> of_size;  // a shard does not know the whole scene
  for (const auto& warning :
       {forecast_warning(forecast, *options),
        is_shard ? std::nullopt
                 : mesh::small_size_warning("the scene", forecast.box_m, options->voxel_size_m)}) {
    if (warning) of_size.push_back(*warning);
  }
  if (!arguments.quiet) {
    progress.clear();
    print_size(*scene, forecast);
    print_warnings(of_size);
  }
  options->progress = [&](const char* stage, double done) {
    progress.show(stage, kReadingDone + (kWritingDone - kReadingDone) * done);
  };
  progress.reckon_from(kReadingDone);
  const std::vector<SceneObject> objects = objects_of(*scene, meshes, options->voxel_size_m);
  const auto bake =
      is_shard ? bake_shard(objects, *options) : forcelayer::voxelize::bake(objects, *options);
  if (!bake) return bake.error();
  clock.lap_s();

  if (!is_shard) {
    progress.show("writing", kWritingDone);
    const auto written = write_voxmap(
        arguments.output, bake->content(provenance_of(*scene, meshes.outlines(*scene), *options)));
    if (!written) return written.error();
    run.file_bytes = *written;
    run.write_s = clock.lap_s();
  }
  run.total_s = clock.total_s();
  progress.clear();

  run.warnings = warnings_of(*scene, meshes, *options);
  if (options->roi_m && !is_shard && bake->header.dims_voxels[0] == 0) {
    run.warnings.push_back(
        "no object of the scene is in --roi or near it: check the unit of --roi");
  }
  if (!arguments.quiet) print_warnings(run.warnings);
  run.warnings.insert(run.warnings.end(), of_size.begin(), of_size.end());
  run.scene_box_m = forecast.box_m;
  if (!arguments.quiet) {
    is_shard ? print_shard(arguments, *bake) : print_summary(arguments.output, *bake, run);
    if (arguments.narrow_passages) print_narrow_passages(*bake);
  }
  if (arguments.json_path.empty()) return {};
  const auto facts = meshes.facts(*scene);
  if (!facts) return facts.error();
  return command::write_report(arguments.json_path, report_of(*bake, *scene, *facts, run));
}

int run(int argc, char** argv) {
  CLI::App app{"Bakes a static scene into the voxmap of a .vox file", "voxelize"};
  Arguments arguments;
  declare(app, arguments);
  arrange(app);
  int exit_code = 0;
  if (!command::parse_arguments(app, argc, argv, exit_code)) return exit_code;
  return command::run_command("voxelize", [&]() -> Status {
    const command::OutputFile outputs[] = {
        {"--output", &arguments.output, command::FileKind::kVoxmap},
        {"--json", &arguments.json_path, command::FileKind::kReport}};
    std::vector<std::string> inputs = arguments.inputs;
    if (!arguments.along.empty()) inputs.push_back(arguments.along);
    const Status prepared = command::prepare_outputs(outputs, inputs);
    return prepared ? voxelize(arguments) : prepared;
  });
}

}  // namespace
}  // namespace forcelayer::voxelize

int main(int argc, char** argv) {
  if (const auto status = forcelayer::mesh::run_as_sandbox(argc, argv)) return *status;
  forcelayer::command::exit_cleanly_on_signals();
  return forcelayer::voxelize::run(argc, argv);
}
