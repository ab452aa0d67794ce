#include "workbench/study/options.h"

#include <CLI/CLI.hpp>

#include "formats/command/arguments.h"
#include "formats/command/quantity.h"
#include "formats/file/named_file.h"

namespace forcelayer::study {
namespace {

Error usage(const char* option, std::string what, std::string mend) {
  return Error{ErrorCode::kUsage, "", option, std::move(what), std::move(mend)};
}

// Refuses wrong numbers before the first command runs.
Status check_numbers(const Options& options) {
  const struct {
    const char* option;
    const std::string& text;
    bool required;
  } lengths[] = {{"--voxel-size", options.voxel_size, true},
                 {"--clearance", options.clearance, true},
                 {"--range", options.range, false},
                 {"--seat-depth", options.seat_depth, false}};
  for (const auto& length : lengths) {
    if (length.text.empty() && !length.required) continue;
    const auto length_m = command::parse_length(length.text);
    if (!length_m) return command::about(length.option, length_m.error());
    if (*length_m < 0) return usage(length.option, "must not be negative", "");
  }
  if (!options.pull.empty()) {
    const auto way_m = command::parse_point(options.pull);
    if (!way_m) return command::about("--pull", way_m.error());
  }
  if (!options.seat.empty() && options.seat != "none") {
    const auto seat = command::parse_pose(options.seat);
    if (!seat) return command::about("--seat", seat.error());
  }
  if (!options.time.empty()) {
    const auto time_s = command::parse_duration(options.time);
    if (!time_s) return command::about("--time", time_s.error());
  }
  return {};
}

}  // namespace

OptionParser::OptionParser(CLI::App& study) {
  options_.clearance = "12.7mm";
  options_.seat = "0,0,0m";
  study.add_option("ASSEMBLY#PART", input_, "an assembly, and the part of it that is taken out")
      ->required();
  study.add_option("-o,--output", options_.folder, "folder that the study is written to")
      ->required();
  study.add_option("--voxel-size", options_.voxel_size, "edge of a voxel, such as 1mm")->required();
  study.add_option(
      "--range", options_.range,
      "how deep distances are kept, as of voxelize: for a part that lies deeper in its "
      "seat; default 4 voxels");
  study.add_option("--path", options_.path,
                   "the path to check: a CSV, a trace or a recording of voxrun");
  study.add_option("--pull", options_.pull,
                   "x,y,z: where a hand pulls the part to, in place of a path, such as 0,0,60mm");
  study.add_option("--time", options_.time,
                   "without --path and --pull: how long voxplan searches for a path; default 60s");
  command::add_count(study, "--seed", seed_,
                     "of the random numbers of that search, as of voxplan; default 1", 0,
                     1'000'000'000);
  study.add_option("--clearance", options_.clearance,
                   "that is required of the exact surfaces, default 12.7mm");
  study.add_option("--seat", options_.seat,
                   "installed pose of the part, world_from_part, or the word none; default 0,0,0m");
  study.add_option("--seat-depth", options_.seat_depth,
                   "how much deeper than installed the part may go into the objects of its seat, "
                   "beside the deviations of the meshes; default: 0");
  study.add_option("--allow", options_.allow, "an object that may be near; repeatable")
      ->allow_extra_args(false);
  study
      .add_option("--without", options_.without,
                  "other nodes that are left out of the scene; repeatable")
      ->allow_extra_args(false);
  command::add_count(study, "--missing-faces", missing_faces_,
                     "accept up to this many lost faces of a STEP or IGES file, as voxelize does",
                     0, 1'000'000);
  study.add_option("--units", options_.units,
                   "unit of the meshes (mm, cm, m, in, ...): needed where their format defines no "
                   "unit; replaces the unit that the format defines");
  study
      .add_option("--up", options_.up,
                  "y keeps the axes of glTF files, which are y up, as voxelize does (default z)")
      ->check(CLI::IsMember({"z", "y"}));
  study.add_flag("--files-alone", options_.files_alone,
                 "check without the meshes: what the baked files leave open stays open");
  study.add_flag("--sandbox", options_.sandbox,
                 "read each mesh file in a process of its own, as voxelize does");
  study.add_flag("--no-pictures", options_.no_pictures, "for a machine without voxview");
  study.add_option("--json", options_.json, "write a report");
  study.add_flag("--quiet", options_.quiet, "print nothing but errors");
}

Result<Options> OptionParser::finish() const {
  Options options = options_;
  if (seed_ != kSeed) options.seed = std::to_string(seed_);
  if (missing_faces_ > 0) options.missing_faces = std::to_string(missing_faces_);
  const NamedFile named = named_file(input_);
  if (named.path.empty() || named.nodes.empty() || named.nodes.front().empty()) {
    return usage("ASSEMBLY#PART", "'" + input_ + "' names no part",
                 "name it behind a #, as voxelize --list prints it");
  }
  options.assembly = named.path;
  options.node = named.nodes.front();
  if (!options.path.empty() && !options.pull.empty()) {
    return usage("--path", "and --pull exclude each other",
                 "give the path to check, or the displacement that the part is pulled by");
  }
  if (options.searches() && options.seat == "none") {
    return usage("--seat", "no seat and no path are given",
                 "give --path, or the seat that the part should leave");
  }
  if (Status sound = check_numbers(options); !sound) return sound.error();
  if (options.files_alone && !options.seat_depth.empty()) {
    return usage("--seat-depth", "is settled by the meshes", "leave out --files-alone");
  }
  if (options.seat == "none") options.seat.clear();
  return options;
}

}  // namespace forcelayer::study
