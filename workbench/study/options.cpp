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
                 {"--seat-depth", options.seat_depth, false}};
  for (const auto& length : lengths) {
    if (length.text.empty() && !length.required) continue;
    if (&length.text == &options.voxel_size && options.is_auto()) continue;
    const auto length_m = command::parse_length(length.text);
    if (!length_m) return command::about(length.option, length_m.error());
    if (*length_m < 0) return usage(length.option, "must not be negative", "");
  }
  if (!options.center.empty()) {
    const auto center_m = command::parse_point(options.center);
    if (!center_m) return command::about("--center", center_m.error());
    if (options.path.empty()) return usage("--center", "has no effect without --path", "give both");
  }
  if (!options.pull.empty()) {
    const auto shift_m = command::parse_point(options.pull);
    if (!shift_m) return command::about("--pull", shift_m.error());
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
  options_.voxel_size = "auto";
  options_.clearance = command::kDefaultClearance;
  options_.seat = "0,0,0m";
  study.add_option("ASSEMBLY#PART", input_, "an assembly, and the part to take out of it")
      ->required();
  study.add_option("-o,--output", options_.folder, "folder for the study; --plan needs none");
  study.add_option("--voxel-size", options_.voxel_size,
                   "edge of a voxel, such as 1mm. Default: auto. With auto, the study chooses the "
                   "size from the part's size, the smallest gap beside the installed part, and "
                   "--time. It takes smaller voxels if the answer is undecided");
  study.add_option("--path", options_.path,
                   "the path to check: a CSV, a trace or a recording of voxrun");
  study.add_option("--center", options_.center,
                   "the part's point that moves in a straight line between two poses of --path, as "
                   "in voxcheck; default: the centroid");
  study.add_option("--pull", options_.pull,
                   "x,y,z, such as 0,0,60mm: instead of a path, the displacement by which a "
                   "simulated hand pulls "
                   "the part");
  study.add_option(
      "--time", options_.time,
      "time limit of the whole study. The study chooses the voxel size by it. A step that has "
      "begun "
      "to read meshes is finished. If smaller voxels are stopped, the answer of larger ones stays. "
      "Default: 120s, but the last check of a path is finished");
  study.add_option("--clearance", options_.clearance,
                   "required distance between the exact surfaces, default 1mm");
  study.add_option("--rules", options_.rules,
                   "a CSV file with the columns part,object,clearance, as in forcelayer pairs. "
                   "Where no row names part and object, --clearance counts. A search for a path "
                   "keeps the largest distance from all objects");
  study.add_option(
      "--seat", options_.seat,
      "pose world_from_part in which the part is installed, or the word none; default 0,0,0m");
  study.add_option(
      "--seat-depth", options_.seat_depth,
      "depth allowed in the objects of the seat, in addition to the depth of the installed part "
      "and the deviations of the meshes; default: 0");
  study.add_option("--allow", options_.allow, "an object that may be near; repeatable")
      ->allow_extra_args(false);
  study
      .add_option("--without", options_.without,
                  "other nodes to leave out of the scene; repeatable")
      ->allow_extra_args(false);
  command::add_count(
      study, "--missing-faces", missing_faces_,
      "accept up to this many lost faces (faces that give no triangles) in a STEP or IGES file, "
      "as in voxelize",
      0, 1'000'000);
  study.add_option("--units", options_.units, command::kUnitsHelp);
  study
      .add_option("--up", options_.up,
                  "y keeps glTF files y-up; z turns them to z-up, as in voxelize (default z)")
      ->check(CLI::IsMember({"z", "y"}));
  study.add_flag(
      "--files-alone", options_.files_alone,
      "check without the meshes. Where the baked files cannot decide, the answer is undecided");
  study.add_flag("--no-pictures", options_.no_pictures, "leave the pictures out of the page");
  study.add_flag("--sandbox", options_.sandbox,
                 "read each mesh file in a separate process, as in voxelize");
  study.add_flag(
      "--plan", options_.plan,
      "only measure the play of the installed part, and list voxel sizes with their cost");
  study.add_option("--json", options_.json, "write a report to this file");
  study.add_flag("--quiet", options_.quiet, "print nothing but errors");
  for (const CLI::Option* const option : study.get_options()) {
    for (const std::string& name : option->get_lnames()) options_.names.push_back("--" + name);
  }
}

Result<Options> OptionParser::finish() const {
  Options options = options_;
  if (missing_faces_ > 0) options.missing_faces = std::to_string(missing_faces_);
  const NamedFile named = named_file(input_);
  if (named.path.empty() || named.nodes.empty() || named.nodes.front().empty()) {
    return usage("ASSEMBLY#PART", "'" + input_ + "' does not name a part",
                 "write the part's name after a #, as voxelize --list prints it");
  }
  if (options.folder.empty() && !options.plan) {
    return usage("--output", "is required; see forcelayer study --help", "");
  }
  options.assembly = named.path;
  options.node = named.nodes.front();
  if (!options.path.empty() && !options.pull.empty()) {
    return usage("--path", "cannot be combined with --pull",
                 "give either the path to check, or the displacement by which the part is pulled");
  }
  if (options.searches() && options.seat == "none") {
    return usage("--seat", "no seat and no path are given",
                 "add --path, or the --seat that the part should leave");
  }
  if (Status sound = check_numbers(options); !sound) return sound.error();
  if (options.files_alone && !options.seat_depth.empty()) {
    return usage("--seat-depth", "needs the meshes", "leave out --files-alone");
  }
  if (options.files_alone && !options.rules.empty()) {
    return usage("--rules", "needs the meshes", "leave out --files-alone");
  }
  if (options.seat == "none") options.seat.clear();
  return options;
}

}  // namespace forcelayer::study
