#include "runtime/voxcheck/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <thread>
#include <tuple>

#include "formats/command/arguments.h"
#include "formats/command/quantity.h"
#include "formats/command/values.h"

namespace forcelayer::voxcheck {
namespace {

constexpr unsigned kMostThreads = 256;

}  // namespace

OptionParser::OptionParser(CLI::App& app) : clearance_("12.7mm") {
  options_.threads = std::clamp(std::thread::hardware_concurrency(), 1u, kMostThreads);
  app.add_option("scene", options_.scene, "the scene, a .vox file")->required();
  app.add_option("part", options_.part, "the moving part, a .pshell file")->required();
  app.add_option(
         "path", options_.path,
         "poses of the part over time: a CSV, a trace or a recording of voxrun; from one to "
         "the next its centroid goes straight and it turns the short way round, both evenly")
      ->required();
  app.add_option("--clearance", clearance_,
                 "that is required of the exact surfaces, default 12.7mm");
  app.add_option("--seat", seat_,
                 "world_from_part where the part is installed, x,y,z[,qw,qx,qy,qz]: it may be near "
                 "the objects that it touches there, until it has left them, and at the path's end "
                 "again");
  app.add_flag("--felt-seat", options_.felt_seat,
               "a seat that no meshes settle is clear where shell points feel nothing, although "
               "features narrower than twice the covering radius are not felt");
  app.add_option(
      "--seat-depth", seat_depth_,
      "with --exact: how much deeper than installed the part may go into the objects that "
      "it is seated on, beside the deviations of the meshes; default: 0");
  app.add_option("--allow", options_.allow,
                 "an object that may be near, by its name or the end of it; * and ? match; "
                 "repeatable")
      ->allow_extra_args(false);
  command::add_choice(app, "--fail-on", options_.fail_on, {"far"},
                      "far: a part that is never near the scene is not clear either; the path may "
                      "be in another unit");
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
                 "unit of the meshes (mm, cm, m, in, ...): needed where their format defines no "
                 "unit; replaces the unit that the format defines");
  app.add_option("--part-units", options_.part_units, "unit of --part, if it differs");
  app.add_flag("--allow-outside", options_.allow_outside,
               "a manifest may name meshes outside its own folder");
  command::add_flag(app, "--sandbox", options_.sandbox,
                    "read each mesh file in a process of its own, as voxelize does; "
                    "--sandbox=memory=2GiB,time=30s sets its limits for a file");
  app.add_option("--threads", options_.threads,
                 "worker threads, default all; the answer does not depend on their number")
      ->check(CLI::Range(1u, kMostThreads));
  app.add_option("--picture", options_.picture,
                 "draw the worst moment, PNG (by voxview; with the meshes of --exact)");
  app.add_option("--json", options_.json, "write a report");
  command::name_value(
      command::add_texts(app, "--report", reports_, '\n',
                         "write a report for another program, repeatable: csv:FILE (the proven "
                         "clearance over time), junit:FILE (the verdict as a test result, XML), "
                         "gitlab:FILE (violations and warnings as GitLab shows them at a change, "
                         "JSON), or github (the same as GitHub shows them, a printed line each)"),
      "KIND:FILE");
  app.add_flag("--quiet", options_.quiet, "no report on the terminal");
}

Result<Options> OptionParser::finish() const {
  Options options = options_;
  using command::about;
  const command::ValueName reports[] = {{.name = "csv", .text = &options.csv},
                                        {.name = "junit", .text = &options.junit},
                                        {.name = "gitlab", .text = &options.code_quality},
                                        {.name = "github", .is_given = &options.github}};
  if (Status read = command::read_reports(reports_, reports); !read) return read.error();
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
  if (!seat_depth_.empty()) {
    const auto depth = command::parse_length(seat_depth_);
    if (!depth) return about("--seat-depth", depth.error());
    if (!(*depth >= 0)) {
      return Error{ErrorCode::kUsage, "", "--seat-depth", "must not be negative", ""};
    }
    options.seat_depth_m = *depth;
  }
  if (options.meshes.empty()) {
    for (const auto& [option, is_given] :
         {std::pair("--without", !options.without.empty()),
          std::pair("--seat-depth", options.seat_depth_m.has_value()),
          std::pair("--sandbox", !options.sandbox.empty())}) {
      if (is_given)
        return Error{ErrorCode::kUsage, "", option, "goes with --exact alone", "leave it out"};
    }
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
