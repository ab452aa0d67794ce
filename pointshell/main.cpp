// The pointshell command: bakes the moving part, and proves a baked part again.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/command/arguments.h"
#include "formats/command/command.h"
#include "formats/command/help.h"
#include "formats/command/output_file.h"
#include "formats/command/progress_line.h"
#include "formats/command/provenance.h"
#include "formats/command/quantity.h"
#include "formats/command/report.h"
#include "formats/command/version.h"
#include "formats/mesh/reader.h"
#include "formats/mesh/step_support.h"
#include "formats/mesh/up_axis.h"
#include "formats/pshell.h"
#include "formats/pshell_writer.h"
#include "pointshell/bake.h"
#include "pointshell/cost.h"
#include "pointshell/part/parallel.h"
#include "pointshell/part/part_files.h"
#include "pointshell/report.h"
#include "pointshell/verify.h"

namespace forcelayer::pointshell {
namespace {

// The command line as typed.
struct Arguments {
  std::vector<std::string> inputs;
  std::string output, voxel_size, units, covering_radius, mesh_deviation, json;
  std::string method = "surface";
  mesh::TrustOptions trust;
  mesh::Up up = mesh::Up::kZ;
  std::vector<std::string> without;
  std::uint64_t missing_faces = 0;
  unsigned threads = 0;
  bool quiet = false;
  bool verify = false;
  std::string shell;  // verify: the .pshell file
};

void declare_reading(CLI::App& app, Arguments& arguments) {
  app.add_option(
         "--without", arguments.without,
         "nodes of an assembly to leave out, with all nodes below them (repeatable). Write a "
         "node's name as in FILE#Node")
      ->allow_extra_args(false);
  app.add_option(
         "--missing-faces", arguments.missing_faces,
         "accept up to this many lost faces (faces that give no triangles) in a STEP or IGES "
         "file (default 0); no guarantee covers them")
      ->check(CLI::Range(0, 1'000'000));
}

void declare_bake(CLI::App& app, Arguments& arguments) {
  app.add_option(
      "INPUT", arguments.inputs,
      "mesh files of one rigid part: stl, obj, ply, off, om, drc, gltf, glb; step and iges if "
      "built with OpenCASCADE. FILE#Node or FILE#{Cover,Bolt*} selects nodes of an assembly");
  app.add_option("-o,--output", arguments.output, "the .pshell file to write");
  app.add_option("--voxel-size", arguments.voxel_size,
                 "voxel size of the scene in which the part will move, such as 5mm");
  app.add_option("--units", arguments.units, command::kUnitsHelp);
  app.add_option("--method", arguments.method,
                 "surface (default), fast (less time, but more points), or voxel-centers (the "
                 "method of the 1999 paper)")
      ->check(CLI::IsMember({"surface", "fast", "voxel-centers"}));
  app.add_option(
      "--covering-radius", arguments.covering_radius,
      "every surface point is at most this far from a shell point (default: sqrt(3)/2 voxel)");
  app.add_option("--mesh-deviation", arguments.mesh_deviation,
                 "how far the mesh may be from the true part (default: 0)");
  declare_reading(app, arguments);
  mesh::declare_up(app, arguments.up);
  arguments.trust.declare(app);
  app.add_option("--threads", arguments.threads, "number of threads (default: all)")
      ->check(CLI::Range(1, 1024));
  app.add_option("--json", arguments.json, "write a machine-readable report to this file");
  app.add_flag("--quiet", arguments.quiet, "no progress line, no summary, no warnings");
}

void declare_verify(CLI::App& app, Arguments& arguments) {
  CLI::App* verify = app.add_subcommand("verify",
                                        "prove the covering radius and the losses of a shell "
                                        "again, from the shell and its meshes alone");
  verify->add_option("PART", arguments.shell, "the .pshell file")->required();
  verify->add_option("MESH", arguments.inputs, "the mesh files from which the part was baked")
      ->required();
  verify->add_option("--units", arguments.units, "unit of the meshes, as in the bake");
  declare_reading(*verify, arguments);
  arguments.trust.declare(*verify);
  verify->add_option("--json", arguments.json, "write a machine-readable report to this file");
  verify->add_flag("--quiet", arguments.quiet, "no summary, no warnings");
  command::arrange_help(*verify,
                        {{"Meshes", {"--units", "--without", "--missing-faces"}},
                         {"Untrusted files", {"--sandbox", "--allow-outside"}}},
                        "  pointshell verify part.pshell part.obj --units mm");
  verify->callback([&arguments] { arguments.verify = true; });
}

void arrange(CLI::App& app) {
  command::set_version(app, mesh::kStepSupport);
  command::arrange_help(
      app,
      {{"Output", {"-o"}},
       {"Meshes", {"--units", "--up", "--without", "--missing-faces", "--mesh-deviation"}},
       {"The shell", {"--voxel-size", "--method", "--covering-radius", "--threads"}},
       {"Untrusted files", {"--sandbox", "--allow-outside"}}},
      "  pointshell part.obj --units mm --voxel-size 5mm -o part.pshell\n"
      "  pointshell 'gearbox.glb#Cover' --voxel-size 1mm -o cover.pshell   a part of an assembly\n"
      "  pointshell verify part.pshell part.obj --units mm                 proves the shell again");
}

Error usage(std::string what, std::string mend) {
  return {ErrorCode::kUsage, "", "", std::move(what), std::move(mend)};
}

// A positive length, or `absent` where the option was not given.
Result<double> length_option(const std::string& text, const char* option, double absent,
                             bool zero_allowed) {
  if (text.empty()) return absent;
  const auto length = command::parse_length(text);
  if (!length) return command::about(option, length.error());
  if (*length < 0 || (*length == 0 && !zero_allowed)) {
    return zero_allowed
               ? usage(std::string(option) + " must not be negative", "use zero or more")
               : usage(std::string(option) + " must be a positive length", "use one such as 5mm");
  }
  if (!zero_allowed && (*length < kMinVoxelSizeM || *length > kMaxVoxelSizeM)) {
    return usage(std::string(option) + " is not between 1e-9 and 1e6 meters",
                 "check the number and the unit");
  }
  return *length;
}

Result<std::optional<double>> units_option(const std::string& text) {
  if (text.empty()) return std::optional<double>();
  const auto unit = command::parse_unit(text);
  if (!unit) return unit.error();
  return std::optional<double>(*unit);
}

Result<ShellOptions> bake_options(const Arguments& arguments) {
  ShellOptions options;
  if (arguments.inputs.empty()) return usage("no mesh given", "see pointshell --help");
  if (arguments.output.empty()) return usage("no output given", "add -o part.pshell");
  if (arguments.voxel_size.empty()) {
    return usage("no voxel size given", "add --voxel-size, for example --voxel-size 5mm");
  }
  const auto voxel = length_option(arguments.voxel_size, "--voxel-size", 0, false);
  if (!voxel) return voxel.error();
  if (!(*voxel >= kMinVoxelSizeM && *voxel <= kMaxVoxelSizeM)) {
    return usage("--voxel-size is not between 1e-9 and 1e6 meters",
                 "check the number and the unit");
  }
  const auto radius = length_option(arguments.covering_radius, "--covering-radius", 0, false);
  if (!radius) return radius.error();
  const auto deviation = length_option(arguments.mesh_deviation, "--mesh-deviation", 0, true);
  if (!deviation) return deviation.error();
  options.voxel_size_m = *voxel;
  options.covering_radius_m = *radius;
  options.mesh_deviation_m = *deviation;
  options.method =
      arguments.method == "voxel-centers" ? ShellMethod::kVoxelCenters : ShellMethod::kSurface;
  options.effort = arguments.method == "fast" ? sample::Effort::kFast : sample::Effort::kFull;
  options.threads = arguments.threads;
  if (options.method == ShellMethod::kVoxelCenters && options.covering_radius_m > 0) {
    return usage("--covering-radius has no effect with --method voxel-centers",
                 "the radius is always sqrt(3)/2 voxel; choose the voxel size instead");
  }
  return options;
}

// Prints and keeps the warnings of the reading. `voxel_size_m`: that the shell is made for.
Result<part::Part> load_part(const Arguments& arguments, double voxel_size_m, mesh::Up up,
                             std::vector<std::string>& warnings, command::ProgressLine& progress) {
  const auto units = units_option(arguments.units);
  if (!units) return units.error();
  const auto reader = arguments.trust.reader();
  if (!reader) return reader.error();
  mesh::ReadOptions options;
  options.deflection_m = mesh::baked_deflection_m(voxel_size_m);
  options.missing_faces = arguments.missing_faces;
  options.without = arguments.without;
  options.allow_outside = arguments.trust.allow_outside;
  options.up = up;
  options.progress = [&](const mesh::ReadingProgress& file) {
    progress.show("read", file.fraction_done);
  };
  auto files = part::read_part(arguments.inputs, *units, options, *reader);
  if (!files) return files.error();
  warnings = std::move(files->warnings);
  for (const std::string& warning : warnings) command::warn(warning, arguments.quiet);
  return std::move(files->part);
}

void print_summary(const Arguments& arguments, const BakedShell& shell, const part::Part& part) {
  const PshellHeader& header = shell.header;
  if (arguments.quiet) return;
  std::printf(
      "%s: %s (%s), proven covering radius %.6g mm (%.4f voxels), %.3f times the fewest points "
      "that could cover a flat surface of the same area\n",
      escaped(arguments.output).c_str(), mesh::counted(header.point_count, "point").c_str(),
      arguments.method.c_str(), 1e3 * header.covering_radius_m,
      header.covering_radius_m / header.voxel_size_m,
      points_over_bound(header, shell.covered_area_m2));
  std::printf(
      "if all points are 2 voxels or more from a scene, the whole surface is at least %.4g voxels "
      "away\n",
      surface_distance_bound_m(shell.surface_distance_terms(), 2 * header.voxel_size_m) /
          header.voxel_size_m);
  for (const NamedFile& file : mesh::unite_by_file(arguments.inputs)) {
    if (file.nodes.empty()) continue;
    std::printf("%s: pose 0,0,0 is the installed pose of the part in %s\n",
                escaped(arguments.output).c_str(), escaped(file.path).c_str());
  }
  const auto print_counted = [](std::uint64_t count, const char* singular, const char* what) {
    if (count > 0) {
      std::printf("%s %s %s\n", mesh::counted(count, singular).c_str(), count == 1 ? "is" : "are",
                  what);
    }
  };
  print_counted(shell.hidden_points, "point", "inside another body of the part and left out");
  print_counted(shell.orientation.flipped_triangles, "triangle", "reversed to face outward");
  print_counted(part.duplicate_triangles, "triangle", "repeated in the mesh and counted once");
  print_counted(
      shell.loose_triangles, "loose triangle",
      "left out of the volume (hidden, without area, or smaller than the covering radius)");
}

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Status bake_command(const Arguments& arguments) {
  const double started_s = now_s();
  const auto options = bake_options(arguments);
  if (!options) return options.error();
  command::ProgressLine progress(arguments.quiet);
  progress.show("read", 0);
  std::vector<std::string> warnings;
  auto part = load_part(arguments, options->voxel_size_m, arguments.up, warnings, progress);
  if (!part) return part.error();
  const std::string imprecise = part::precision_warning(*part, options->voxel_size_m);
  if (!imprecise.empty()) {
    warnings.push_back(imprecise);
    command::warn(imprecise, arguments.quiet);
  }
  const BakeCost expected = expected_cost(*part, *options);
  if (const std::string cost = cost_warning(expected, *options, *part); !cost.empty()) {
    progress.clear();
    warnings.push_back(cost);
    command::warn(cost, arguments.quiet);
  }
  const double read_s = now_s() - started_s;
  constexpr double kWritingFrom = 0.98;
  const BakeProgress show = [&](const std::string& stage, double fraction_done) {
    progress.show(stage, kWritingFrom * fraction_done);
  };
  auto shell = bake_shell(*part, *options, show, expected.seconds);
  if (!shell) return shell.error();
  for (const std::string& warning :
       {part::size_warning(*part, options->voxel_size_m), sheet_warning(*shell)}) {
    if (warning.empty()) continue;
    warnings.push_back(warning);
    progress.clear();
    command::warn(warning, arguments.quiet);
  }
  PshellContent content = shell->content();
  const std::string origin = provenance(*part, *options);
  content.provenance = origin;
  const double write_started_s = now_s();
  progress.show("write", kWritingFrom);
  const auto written = write_pshell(arguments.output, content);
  if (!written) return written.error();
  shell->stage_seconds.insert(shell->stage_seconds.begin(), {"read", read_s});
  shell->stage_seconds.push_back({"write", now_s() - write_started_s});
  print_summary(arguments, *shell, *part);
  if (arguments.json.empty()) return {};
  nlohmann::ordered_json report = bake_report(*shell, *options, *part);
  report["expected"] = {
      {"points", expected.points}, {"thread_s", expected.thread_s}, {"bytes", expected.bytes}};
  report["peak_rss_bytes"] = command::peak_rss_bytes();
  report["file_bytes"] = *written;
  report["threads"] = arguments.threads;
  report["warnings"] = warnings;
  return command::write_report(arguments.json, report);
}

Error open_surface(const Arguments& arguments, const Pshell& shell,
                   const certificate::CoveringProof& proof) {
  const certificate::Hole* deepest = &proof.holes.front();
  for (const certificate::Hole& hole : proof.holes) {
    if (hole.distance > deepest->distance) deepest = &hole;
  }
  const auto& center = shell.header().center_m;
  char what[200];
  std::snprintf(what, sizeof what,
                "the surface at x %.6g, y %.6g, z %.6g mm is not proven to be within the covering "
                "radius %.6g mm of a shell point",
                1e3 * (deepest->position.x + center[0]), 1e3 * (deepest->position.y + center[1]),
                1e3 * (deepest->position.z + center[2]), 1e3 * shell.header().covering_radius_m);
  return {ErrorCode::kFilesDoNotMatch, arguments.shell, "", what,
          "bake the part again from this mesh in this unit"};
}

Error lossy_surface(const Arguments& arguments, const Pshell& shell,
                    const certificate::LossProof& proof) {
  const auto& center = shell.header().center_m;
  char what[200];
  std::snprintf(what, sizeof what,
                "at (%.6g, %.6g, %.6g) m on the surface, the shell's points do not prove the "
                "losses that the file states",
                proof.open.x + center[0], proof.open.y + center[1], proof.open.z + center[2]);
  return {ErrorCode::kFilesDoNotMatch, arguments.shell, "", what,
          "bake the part again from this mesh in this unit"};
}

Status verify_command(const Arguments& arguments) {
  const double started_s = now_s();
  const auto shell = Pshell::open(arguments.shell, Verify::kStructureAndChecksums);
  if (!shell) return shell.error();
  std::vector<std::string> warnings;
  command::ProgressLine progress(arguments.quiet);
  const mesh::Up up = mesh::up_named(command::up_in(shell->provenance()));
  const auto part = load_part(arguments, shell->header().voxel_size_m, up, warnings, progress);
  progress.clear();
  if (!part) return part.error();
  const certificate::CoveringProof proof = verify_shell(*shell, *part);
  certificate::LossProof losses;
  if (proof.proven) losses = verify_losses(*shell, *part);
  if (!arguments.json.empty()) {
    const nlohmann::ordered_json report{{"proven", proof.proven && losses.proven},
                                        {"points", shell->header().point_count},
                                        {"covering_radius_m", shell->header().covering_radius_m},
                                        {"convex_radius_m", shell->header().convex_radius_m},
                                        {"convex_gap_m", shell->header().convex_gap_m},
                                        {"voxel_size_m", shell->header().voxel_size_m},
                                        {"triangles", part->input_triangles},
                                        {"certificate_pieces", proof.pieces},
                                        {"loss_pieces", losses.pieces},
                                        {"holes", proof.holes.size()},
                                        {"seconds", {{"total", now_s() - started_s}}},
                                        {"peak_rss_bytes", command::peak_rss_bytes()},
                                        {"warnings", warnings}};
    if (Status written = command::write_report(arguments.json, report); !written) return written;
  }
  if (!proof.proven) return open_surface(arguments, *shell, proof);
  if (!losses.proven) return lossy_surface(arguments, *shell, losses);
  if (!arguments.quiet) {
    std::printf(
        "%s: proven: every surface point is within %.6g mm of one of %llu shell points, and within "
        "%.6g mm of a convex combination of shell points (convex radius %.6g mm)\n",
        escaped(arguments.shell).c_str(), 1e3 * shell->header().covering_radius_m,
        static_cast<unsigned long long>(shell->header().point_count),
        1e3 * shell->header().convex_gap_m, 1e3 * shell->header().convex_radius_m);
  }
  return {};
}

}  // namespace
}  // namespace forcelayer::pointshell

int main(int argc, char** argv) {
  using namespace forcelayer;
  using namespace forcelayer::pointshell;
  if (const auto status = mesh::run_as_sandbox(argc, argv)) return *status;
  CLI::App app("Bakes the moving part of a haptic scene into a .pshell file", "pointshell");
  Arguments arguments;
  declare_bake(app, arguments);
  declare_verify(app, arguments);
  arrange(app);
  int exit_code = 0;
  if (!command::parse_subcommands(app, argc, argv, exit_code)) return exit_code;
  command::exit_cleanly_on_signals();
  return command::run_command("pointshell", [&]() -> Status {
    std::vector<std::string> inputs = arguments.inputs;
    inputs.push_back(arguments.shell);
    const command::OutputFile outputs[] = {
        {"--output", &arguments.output, command::FileKind::kPshell},
        {"--json", &arguments.json, command::FileKind::kReport}};
    if (Status s = command::prepare_outputs(outputs, inputs); !s) return s;
    Status done;
    part::with_threads(arguments.threads, [&] {
      done = arguments.verify ? verify_command(arguments) : bake_command(arguments);
    });
    return done;
  });
}
