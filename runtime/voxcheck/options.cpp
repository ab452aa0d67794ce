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

OptionParser::OptionParser(CLI::App& app) : clearance_(command::kDefaultClearance) {
  options_.threads = std::clamp(std::thread::hardware_concurrency(), 1u, kMaxThreads);
  app.add_option("scene", options_.scene, "the scene, a .vox file")->required();
  app.add_option("part", options_.part, "the moving part, a .pshell file")->required();
  app.add_option(
         "path", options_.path,
         "poses of the part over time: a CSV, a trace or a recording of voxrun. Between "
         "two poses the centroid moves in a straight line and the part turns by the smaller "
         "angle, both at constant speed")
      ->required();
  app.add_option("--clearance", clearance_,
                 "required distance between the exact surfaces, default 1mm");
  app.add_option(
      "--rules", options_.rules,
      "with --exact: a CSV file with the columns part,object,clearance, as in forcelayer "
      "pairs. Where no row names part and object, --clearance counts");
  app.add_option(
      "--center", center_,
      "point x,y,z in the part's frame, such as 0,0,0m. Between two poses of the path, this point "
      "moves in a straight line and the part turns about it; default: the centroid");
  app.add_option(
      "--seat", seat_,
      "pose world_from_part in which the part is installed, x,y,z[,qw,qx,qy,qz]. At the "
      "beginning and at the end of the path, the part may be near the objects that it touches in "
      "this pose");
  app.add_flag("--felt-seat", options_.felt_seat,
               "accept a seat that is not settled, if no shell point goes deeper into an object "
               "than when installed. Shell points miss walls and rods that are thinner than the "
               "report states");
  app.add_option("--allow", options_.allow,
                 "object that the part may come near: its name, or the end of its name; * and ? "
                 "are wildcards; repeatable")
      ->allow_extra_args(false);
  command::add_choice(
      app, "--fail-on", options_.fail_on, {"far", "nothing"},
      "answers that get status 6. Default: the path is not clear. With far, also: the part is "
      "never "
      "near the scene, as with a path in a wrong unit. With nothing, every answer gets status 0");
  meshes_.declare(app, options_,
                  "the inputs from which the scene was baked. The meshes decide where the baked "
                  "files cannot; repeatable");
  app.add_option("--time", time_,
                 "with --exact: time after which the measurement ends, and the answer is "
                 "undecided; default: no limit");
  app.add_option("--json", options_.json, "write a report to this file");
  app.add_option("--threads", options_.threads,
                 "number of threads, default all; the number does not change the answer")
      ->check(CLI::Range(1u, kMaxThreads));
  command::name_value(
      command::add_texts(
          app, "--report", reports_, '\n',
          "write a report for another program: csv:FILE (the proven clearance over time), "
          "junit:FILE (the verdict as a test result, XML), gitlab:FILE (violations and warnings "
          "for a GitLab merge request, JSON), github (violations and warnings as lines that GitHub "
          "shows beside the path file), picture:FILE (the worst moment as a PNG, drawn by voxview "
          "with the meshes of --exact), animation:FILE (scene, part and motion as glTF, from the "
          "meshes of --exact) or map:FILE (the same, with the least distance along the path at "
          "each "
          "vertex, and colors for it); repeatable"),
      "KIND:FILE");
  app.add_flag("--quiet", options_.quiet, "no report on the terminal");
}

Result<Options> OptionParser::finish() const {
  Options options = options_;
  using command::about;
  const command::ValueName reports[] = {{.name = "csv", .text = &options.csv},
                                        {.name = "junit", .text = &options.junit},
                                        {.name = "gitlab", .text = &options.code_quality},
                                        {.name = "github", .is_given = &options.github},
                                        {.name = "picture", .text = &options.picture},
                                        {.name = "animation", .text = &options.animation},
                                        {.name = "map", .text = &options.map}};
  if (Status read = command::read_reports(reports_, reports); !read) return read.error();
  const auto clearance = command::parse_length(clearance_);
  if (!clearance) return about("--clearance", clearance.error());
  if (!(*clearance >= 0)) {
    return Error{ErrorCode::kUsage, "", "--clearance", "must not be negative", ""};
  }
  options.clearance_m = *clearance;
  if (Status read = meshes_.finish(options); !read) return read.error();
  if (!options.rules.empty() && options.meshes.empty()) {
    return Error{ErrorCode::kUsage, "", "--rules", "needs the meshes",
                 "add --exact SCENE_MESHES --part PART_MESHES"};
  }
  for (const auto& [report, file] : {std::pair("--report animation", &options.animation),
                                     std::pair("--report map", &options.map)}) {
    if (file->empty() || !options.meshes.empty()) continue;
    return Error{ErrorCode::kUsage, "", report, "needs the meshes",
                 "add --exact SCENE_MESHES --part PART_MESHES"};
  }
  if (!time_.empty()) {
    const auto time_s = command::parse_duration(time_);
    if (!time_s) return about("--time", time_s.error());
    if (options.meshes.empty()) {
      return Error{ErrorCode::kUsage, "", "--time", "has no effect without --exact",
                   "leave it out"};
    }
    options.max_s = *time_s;
  }
  if (!center_.empty()) {
    const auto center_m = command::parse_point(center_);
    if (!center_m) return about("--center", center_m.error());
    options.pivot_m = *center_m;
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
