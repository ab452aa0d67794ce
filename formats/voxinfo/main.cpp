// The voxinfo command: prints the facts of a baked file, verifies it, samples it at points, and
// exports it for other programs.
#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "formats/audit/voxmap_audit.h"
#include "formats/command/arguments.h"
#include "formats/command/command.h"
#include "formats/command/help.h"
#include "formats/command/output_file.h"
#include "formats/command/quantity.h"
#include "formats/command/report.h"
#include "formats/voxinfo/export.h"
#include "formats/voxinfo/facts.h"
#include "formats/voxinfo/path.h"
#include "formats/voxinfo/sample.h"

namespace forcelayer::voxinfo {
namespace {

Status flush_stdout() {
  std::cout.flush();
  if (std::cout) return {};
  return Error{ErrorCode::kWriteFailed, "", "standard output", "cannot be written", ""};
}

struct FactsRequest {
  std::string path, json_path;
  bool objects = false, quiet = false;
};

Status show_facts(const FactsRequest& request) {
  const auto file = open_baked_file(request.path, Verify::kStructure);
  if (!file) return file.error();
  std::vector<ObjectFacts> objects;
  if (request.objects) {
    const Voxmap* map = std::get_if<Voxmap>(&*file);
    if (!map) {
      return Error{ErrorCode::kUsage, request.path, "--objects", "a part has no objects",
                   "give a .vox file"};
    }
    auto counted = objects_of(*map, request.path);
    if (!counted) return counted.error();
    objects = std::move(*counted);
  }
  if (!request.json_path.empty()) {
    nlohmann::ordered_json report = report_of(*file);
    for (const ObjectFacts& object : objects) {
      report["objects"].push_back({{"name", std::string(object.name)}, {"voxels", object.voxels}});
    }
    if (Status s = command::write_report(request.json_path, report); !s) return s;
  }
  if (!request.quiet) {
    std::cout << summary_of(*file, request.path);
    std::uint32_t number = 0;
    for (const ObjectFacts& object : objects) {
      std::cout << "  object " << ++number << '\t' << object.voxels << " voxels\t"
                << escaped(object.name) << '\n';
    }
  }
  return flush_stdout();
}

// The facts that the audit has proven of this map.
std::string audited(const Voxmap& map) {
  std::string facts = "; counts, box, clearances and layers are correct";
  if (map.distances() != nullptr) facts += ", distances are plausible";
  if (map.objects() != nullptr) facts += ", objects exist";
  return facts;
}

Status verify_file(const std::string& path, bool quiet) {
  const auto file = open_baked_file(path, Verify::kStructureAndChecksums);
  if (!file) return file.error();
  const Voxmap* map = std::get_if<Voxmap>(&*file);
  if (map) {
    if (Status s = audit_voxmap(*map, path); !s) return s;
  }
  if (!quiet) {
    std::cout << escaped(path) << ": valid: structure and checksums are correct"
              << (map ? audited(*map) : "") << '\n';
  }
  return flush_stdout();
}

Status sample_file(const std::string& path, bool quiet) {
  const auto map = Voxmap::open(path);
  if (!map) return map.error();
  std::uint64_t outside_points = 0;
  const Status sampled = sample_voxmap(*map, std::cin, std::cout, outside_points);
  const Status flushed = flush_stdout();
  if (!sampled) return sampled;
  if (outside_points > 0) {
    command::warn(std::to_string(outside_points) +
                      " points are beyond a cropped side, where nothing is known",
                  quiet);
  }
  return flushed;
}

Status export_file(const std::string& path, const std::string& out, const std::string& offset) {
  std::optional<double> offset_m;
  if (!offset.empty()) {
    const auto parsed = command::parse_length(offset);
    if (!parsed) {
      return Error{ErrorCode::kUsage, "", "--offset", parsed.error().what, parsed.error().mend};
    }
    if (!(*parsed >= 0)) {
      return Error{ErrorCode::kUsage, "", "--offset", "must not be negative",
                   "give a distance that the surface keeps"};
    }
    offset_m = *parsed;
  }
  const auto file = open_baked_file(path, Verify::kStructure);
  if (!file) return file.error();
  return export_baked_file(*file, path, out, offset_m);
}

using Report = nlohmann::ordered_json;

// The outcome of a subcommand that is done, with its report where one is wanted.
Status reported(const Status& done, const std::string& json_path, const Report& report) {
  return done && !json_path.empty() ? command::write_report(json_path, report) : done;
}

int run(int argc, char** argv) {
  CLI::App app{"Shows, verifies, samples and exports .vox scenes and .pshell parts", "voxinfo"};
  std::string path, out, offset, json_path;
  bool quiet = false, objects = false;
  app.add_option("FILE", path, "the .vox or .pshell file to describe");
  app.add_option("--json", json_path, "write the facts to this file as JSON");
  app.add_flag("--objects", objects,
               "list a scene's objects, and how many voxels have each as nearest object");
  app.add_flag("--quiet", quiet, "print nothing but errors");
  app.require_subcommand(0, 1);
  auto* verify =
      app.add_subcommand("verify",
                         "check the structure, the checksums and the stated facts of a file. In a "
                         "scene, also check the voxel counts, the box and the clearances, and that "
                         "layers have no hole, each distance fits its voxel's value and the "
                         "distances around it, and each nearest object has a name");
  verify->add_option("FILE", path, "a .vox or .pshell file")->required();
  auto* sample =
      app.add_subcommand("sample",
                         "read lines `x y z` in meters. Print for each point the value of its "
                         "voxel (0 to 3) and, if the scene stores them, the smallest and largest "
                         "distance from the mesh in meters and the nearest object. If the line "
                         "ends with `hint`, the distance of this object was not measured, and "
                         "another object may be nearer");
  sample->add_option("FILE", path, "a .vox file")->required();
  auto* export_to = app.add_subcommand("export", "write a file in another format");
  export_to->add_option("FILE", path, "a .vox or .pshell file")->required();
  export_to
      ->add_option("OUT", out,
                   "of a scene, a .stl, .glb or .ply file with a closed surface around the solid, "
                   "or a .csv or .vdb file with the voxels. Of a part, a .ply file with the points")
      ->required();
  export_to->add_option("--offset", offset,
                        "distance that the surface also keeps from the solid, such as 5mm, for a "
                        "keep-out space (default 0)");
  PathRequest of_path;
  auto* path_command = app.add_subcommand(
      "path",
      "print the length of a path (a CSV of poses, or a trace). With -o, write the path again in "
      "meters and quaternions, resampled or reversed if you like");
  path_command->add_option("FILE", path, "a CSV of poses over time, or a trace of voxrun")
      ->required();
  path_command->add_option("-o,--output", of_path.output, "write the path to this CSV file");
  path_command->add_option("--resample", of_path.period,
                           "keep all rows, and add rows between them at this period, such as 1ms");
  path_command->add_option(
      "--part", of_path.shell,
      "measure the path of this .pshell part's centroid, instead of the path of the origin of its "
      "coordinates. Between rows the measured point moves in a straight line. In voxcheck this "
      "point is the centroid");
  path_command->add_flag("--reverse", of_path.reverse,
                         "reverse the path: from the last pose to the first");
  path_command->add_option("--json", json_path, "write the facts to this file as JSON");
  for (auto* subcommand : {verify, sample, export_to, path_command}) {
    subcommand->add_flag("--quiet", quiet, "print nothing but errors");
  }

  for (auto* subcommand : {verify, sample, export_to}) {
    subcommand->add_option("--json", json_path, "write a report to this file");
  }
  command::arrange_help(*verify, {}, "  voxinfo verify bay.vox --json verdict.json");
  command::arrange_help(*sample, {}, "  echo 0.1 0.2 0.3 | voxinfo sample bay.vox");
  command::arrange_help(
      *export_to, {{"The surface", {"--offset"}}},
      "  voxinfo export swept.vox swept.stl                  the space that a part needs\n"
      "  voxinfo export swept.vox keep_out.glb --offset 5mm  the same with 5 mm around it\n"
      "  voxinfo export part.pshell points.ply               the shell's points");
  command::arrange_help(
      *path_command, {{"The path", {"--resample", "--reverse", "--part"}}, {"Output", {"-o"}}},
      "  voxinfo path run.csv                               the length of the path\n"
      "  voxinfo path run.csv --reverse -o back.csv         the same path backward\n"
      "  voxinfo path run.csv --resample 10ms --part part.pshell -o fine.csv    more rows");
  command::arrange_help(
      app, {{"Output", {"--objects"}}},
      "  voxinfo bay.vox                              facts about the file\n"
      "  voxinfo verify bay.vox                       whether these facts are correct\n"
      "  echo 0.1 0.2 0.3 | voxinfo sample bay.vox    the scene at a point, in meters\n"
      "  voxinfo export bay.vox bay.stl               a file for other programs");
  int exit_code = 0;
  if (!command::parse_subcommands(app, argc, argv, exit_code)) return exit_code;
  return command::run_command("voxinfo", [&]() -> Status {
    const command::OutputFile outputs[] = {{"OUT", &out, command::FileKind::kExport},
                                           {"-o", &of_path.output, command::FileKind::kTable},
                                           {"--json", &json_path, command::FileKind::kReport}};
    const std::string inputs[] = {path, of_path.shell};
    if (Status s = command::prepare_outputs(outputs, inputs); !s) return s;
    if (*verify) return reported(verify_file(path, quiet), json_path, {{"valid", true}});
    if (*sample) return reported(sample_file(path, quiet), json_path, Report::object());
    if (*export_to) return reported(export_file(path, out, offset), json_path, {{"output", out}});
    if (*path_command) {
      of_path.path = path;
      of_path.json = json_path;
      of_path.quiet = quiet;
      if (Status s = handle_path(of_path); !s) return s;
      return flush_stdout();
    }
    if (path.empty()) {
      return Error{ErrorCode::kUsage, "", "", "no file given", "see voxinfo --help"};
    }
    return show_facts({path, json_path, objects, quiet});
  });
}

}  // namespace
}  // namespace forcelayer::voxinfo

int main(int argc, char** argv) {
  std::ios::sync_with_stdio(false);
  forcelayer::command::exit_cleanly_on_signals();
  return forcelayer::voxinfo::run(argc, argv);
}
