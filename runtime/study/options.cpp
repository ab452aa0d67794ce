#include "runtime/study/options.h"

#include <CLI/CLI.hpp>

#include "formats/command/quantity.h"
#include "formats/file/named_file.h"

namespace forcelayer::study {

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
                   "the way that is checked: a CSV, a trace or a recording of voxrun");
  study.add_option("--pull", options_.pull,
                   "x,y,z: where a hand pulls the part to, in place of a path, such as 0,0,60mm");
  study.add_option("--time", options_.time,
                   "without --path and --pull: how long voxplan looks for a way out; default 60s");
  study.add_option("--seed", options_.seed,
                   "of the random numbers of that search, as of voxplan; default 1");
  study.add_option("--clearance", options_.clearance,
                   "that is required of the exact surfaces, default 12.7mm");
  study.add_option("--seat", options_.seat,
                   "where the part is installed, world_from_part, or none; default 0,0,0m");
  study.add_option("--seat-depth", options_.seat_depth,
                   "how much deeper than installed the part may go into the objects of its seat; "
                   "default: a quarter of a voxel and a step of the stored distances");
  study.add_option("--allow", options_.allow, "an object that may be near; repeatable")
      ->allow_extra_args(false);
  study
      .add_option("--without", options_.without,
                  "other nodes that are left out of the scene; repeatable")
      ->allow_extra_args(false);
  study.add_option("--missing-faces", options_.missing_faces,
                   "accept up to this many lost faces of a STEP or IGES file, as voxelize does");
  study.add_option("--units", options_.units,
                   "unit of the meshes (mm, cm, m, in, ...): needed where their format defines "
                   "none, overrides one that it defines");
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
  const auto usage = [](const char* option, std::string what, std::string mend) {
    return Error{ErrorCode::kUsage, "", option, std::move(what), std::move(mend)};
  };
  const NamedFile named = named_file(input_);
  if (named.path.empty() || named.nodes.empty() || named.nodes.front().empty()) {
    return usage("ASSEMBLY#PART", "'" + input_ + "' names no part",
                 "name it behind a #, as voxelize --list prints it");
  }
  options.assembly = named.path;
  options.node = named.nodes.front();
  if (!options.path.empty() && !options.pull.empty()) {
    return usage("--path", "and --pull exclude each other",
                 "give the way that is checked, or where the part is pulled to");
  }
  if (options.searches() && options.seat == "none") {
    return usage("--seat", "none, and no way that the part begins at",
                 "give --path, or the seat that it shall come out of");
  }
  for (const auto& [option, length] :
       {std::pair("--voxel-size", &options.voxel_size),
        std::pair("--clearance", &options.clearance), std::pair("--range", &options.range),
        std::pair("--seat-depth", &options.seat_depth)}) {
    if (length->empty() && (length == &options.range || length == &options.seat_depth)) continue;
    if (const auto read = command::parse_length(*length); !read) {
      return usage(option, read.error().what, read.error().mend);
    }
  }
  if (options.files_alone && !options.seat_depth.empty()) {
    return usage("--seat-depth", "is settled by the meshes", "leave out --files-alone");
  }
  if (options.seat == "none") options.seat.clear();
  return options;
}

}  // namespace forcelayer::study
