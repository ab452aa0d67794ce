#include "runtime/voxcheck/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <thread>
#include <tuple>

#include "formats/command/arguments.h"
#include "formats/command/quantity.h"

namespace forcelayer::voxcheck {
namespace {

constexpr unsigned kMostThreads = 256;

}  // namespace

OptionParser::OptionParser(CLI::App& app) : clearance_("12.7mm") {
  options_.threads = std::clamp(std::thread::hardware_concurrency(), 1u, kMostThreads);
  app.add_option("scene", options_.scene, "the scene, a .vox file")->required();
  app.add_option("part", options_.part, "the moving part, a .pshell file")->required();
  app.add_option("path", options_.path,
                 "poses of the part over time: a CSV, a trace or a recording of voxrun")
      ->required();
  app.add_option("--clearance", clearance_, "that is required of the exact surfaces; 12.7mm");
  app.add_option("--seat", seat_,
                 "world_from_part where the part is installed, x,y,z[,qw,qx,qy,qz]: it may be near "
                 "the objects that it touches there, until it has left them, and at the path's end "
                 "again");
  app.add_option("--allow", options_.allow,
                 "an object that may be near, by its name or the end of it; * and ? match; "
                 "repeatable")
      ->allow_extra_args(false);
  app.add_option("--exact", options_.meshes,
                 "what the scene was baked from: settles with the meshes themselves what the files "
                 "leave open; repeatable")
      ->allow_extra_args(false);
  app.add_option("--part", options_.part_meshes, "and what the part was baked from; repeatable")
      ->allow_extra_args(false);
  app.add_option("--without", options_.without,
                 "nodes that the bake of the scene left out; repeatable")
      ->allow_extra_args(false);
  app.add_option("--units", options_.units,
                 "unit of meshes whose format defines none: mm, cm, m, in, ...");
  app.add_option("--part-units", options_.part_units, "unit of --part, if it differs");
  app.add_flag("--allow-outside", options_.allow_outside,
               "a manifest may name meshes outside its own folder");
  app.add_option("--threads", options_.threads, "that share the work; all; no answer depends on it")
      ->check(CLI::Range(1u, kMostThreads));
  app.add_option("--picture", options_.picture,
                 "draw the worst moment, PNG (by voxview; with the meshes of --exact)");
  app.add_option("--json", options_.json, "write a report");
  app.add_option("--csv", options_.csv, "write the clearance that is proven, over time");
  app.add_option("--junit", options_.junit, "write the verdict as a test result, JUnit XML");
  app.add_option("--code-quality", options_.code_quality,
                 "write violations as GitLab shows them at a change, JSON");
  app.add_flag("--github", options_.github,
               "print violations as GitHub shows them at a change, a line each");
  app.add_flag("--quiet", options_.quiet, "no report on the terminal");
}

Result<Options> OptionParser::finish() const {
  Options options = options_;
  const auto about = [](const char* option, Error error) {
    error.where = option;
    return error;
  };
  const auto clearance = command::parse_length(clearance_);
  if (!clearance) return about("--clearance", clearance.error());
  if (!(*clearance >= 0)) {
    return Error{ErrorCode::kUsage, "", "--clearance", "must not be negative", ""};
  }
  options.clearance_m = *clearance;
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
                 "is missing: both surfaces are needed",
                 "give --exact SCENE_MESHES --part PART_MESHES"};
  }
  if (options.meshes.empty() && !options.without.empty()) {
    return Error{ErrorCode::kUsage, "", "--without", "goes with --exact alone", "leave it out"};
  }
  if (!seat_.empty()) {
    const auto seat = command::parse_pose(seat_);
    if (!seat) return about("--seat", seat.error());
    const auto& [p, q] = *seat;
    options.world_from_seat = {{p[0], p[1], p[2]}, glm::dquat(q[0], q[1], q[2], q[3])};
  }
  return options;
}

}  // namespace forcelayer::voxcheck
