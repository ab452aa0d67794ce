#include "runtime/voxcheck/mesh_options.h"

#include <CLI/CLI.hpp>
#include <tuple>
#include <utility>

#include "formats/command/arguments.h"
#include "formats/command/quantity.h"

namespace forcelayer::voxcheck {

void MeshOptionParser::declare(CLI::App& app, MeshOptions& options, const std::string& exact_help) {
  app.add_option("--exact", options.meshes, exact_help)->allow_extra_args(false);
  app.add_option("--part", options.part_meshes,
                 "the inputs from which the part was baked; repeatable")
      ->allow_extra_args(false);
  app.add_option("--without", options.without,
                 "nodes that were left out when the scene was baked; repeatable")
      ->allow_extra_args(false);
  app.add_option("--units", options.units, command::kUnitsHelp);
  app.add_option("--part-units", options.part_units, "unit of --part, if it differs from --units");
  app.add_flag("--allow-outside", options.allow_outside,
               "allow meshes outside the manifest's folder");
  command::add_flag(app, "--sandbox", options.sandbox,
                    "read each mesh file in a separate process, as in voxelize; "
                    "--sandbox=memory=2GiB,time=30s sets the limits for a file");
  app.add_option(
      "--seat-depth", seat_depth_,
      "with --exact: depth allowed in the objects of the seat, in addition to the depth of the "
      "installed part and the deviations of the meshes; default: 0");
}

Status MeshOptionParser::finish(MeshOptions& options) const {
  using command::about;
  for (const auto& [option, text, unit_m] :
       {std::tuple("--units", &options.units, &options.unit_m),
        std::tuple("--part-units", &options.part_units, &options.part_unit_m)}) {
    if (text->empty()) continue;
    const auto unit = command::parse_unit(*text);
    if (!unit) return about(option, unit.error());
    *unit_m = *unit;
  }
  if (options.meshes.empty() != options.part_meshes.empty()) {
    return Error{ErrorCode::kUsage, "", options.meshes.empty() ? "--exact" : "--part",
                 "is missing: the meshes of scene and part are both needed",
                 "give --exact SCENE_MESHES --part PART_MESHES"};
  }
  if (!seat_depth_.empty()) {
    const auto depth = command::parse_length(seat_depth_);
    if (!depth) return about("--seat-depth", depth.error());
    if (!(*depth >= 0)) {
      return Error{ErrorCode::kUsage, "", "--seat-depth", "must not be negative", ""};
    }
    options.seat_depth_m = *depth;
  }
  if (!options.meshes.empty()) return {};
  for (const auto& [option, is_given] :
       {std::pair("--without", !options.without.empty()),
        std::pair("--seat-depth", options.seat_depth_m.has_value()),
        std::pair("--sandbox", !options.sandbox.empty())}) {
    if (is_given) {
      return Error{ErrorCode::kUsage, "", option, "has no effect without --exact", "leave it out"};
    }
  }
  return {};
}

}  // namespace forcelayer::voxcheck
