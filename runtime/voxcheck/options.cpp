#include "runtime/voxcheck/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <thread>

#include "formats/command/arguments.h"
#include "formats/command/quantity.h"
#include "formats/command/values.h"

namespace forcelayer::voxcheck {
namespace {

constexpr unsigned kMaxThreads = 256;

}  // namespace

OptionParser::OptionParser(CLI::App& app) : clearance_("12.7mm") {
  options_.threads = std::clamp(std::thread::hardware_concurrency(), 1u, kMaxThreads);
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
               "thin walls and rods are not felt; the report says how thin");
  app.add_option("--allow", options_.allow,
                 "an object that may be near, by its name or the end of it; * and ? match; "
                 "repeatable")
      ->allow_extra_args(false);
  command::add_choice(app, "--fail-on", options_.fail_on, {"far"},
                      "far: a part that is never near the scene is not clear either; the path may "
                      "be in another unit");
  meshes_.declare(app, options_,
                  "what the scene was baked from: settles with the meshes themselves what the "
                  "files leave open; repeatable");
  app.add_option("--threads", options_.threads,
                 "worker threads, default all; the answer does not depend on their number")
      ->check(CLI::Range(1u, kMaxThreads));
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
  if (Status read = meshes_.finish(options); !read) return read.error();
  if (!seat_.empty()) {
    const auto seat = command::parse_pose(seat_);
    if (!seat) return about("--seat", seat.error());
    const auto& [p, q] = *seat;
    options.world_from_seat = {{p[0], p[1], p[2]}, glm::dquat(q[0], q[1], q[2], q[3])};
  }
  return options;
}

}  // namespace forcelayer::voxcheck
