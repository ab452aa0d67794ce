#include "workbench/voxplan/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <thread>

#include "formats/command/arguments.h"
#include "formats/command/quantity.h"

namespace forcelayer::voxplan {
namespace {

using command::about;

constexpr unsigned kMaxThreads = 256;

Result<Pose> read_pose(const char* option, const std::string& text) {
  const auto read = command::parse_pose(text);
  if (!read) return about(option, read.error());
  const auto& [p, q] = *read;
  return Pose{{p[0], p[1], p[2]}, glm::dquat(q[0], q[1], q[2], q[3])};
}

}  // namespace

OptionParser::OptionParser(CLI::App& app)
    : clearance_(command::kDefaultClearance), seat_("0,0,0m"), time_("60s") {
  options_.threads = std::clamp(std::thread::hardware_concurrency(), 1u, kMaxThreads);
  app.add_option("scene", options_.scene, "the scene, a .vox file")->required();
  app.add_option("part", options_.part, "the moving part, a .pshell file")->required();
  app.add_option("-o,--output", options_.path, "the path, a CSV of poses of the part")->required();
  app.add_option(
      "--seat", seat_,
      "pose world_from_part in which the part starts, x,y,z[,qw,qx,qy,qz]; default 0,0,0m. Until "
      "the part has left the objects that it touches in this pose, it may be near them");
  app.add_option("--goal", goal_,
                 "target pose world_from_part; default: anywhere beside the scene, with the part's "
                 "box outside of the scene's box");
  app.add_option(
      "--clearance", clearance_,
      "required distance between the exact surfaces, proven along the path; default 1mm");
  app.add_option("--allow", options_.allow,
                 "object that the part may come near: its name, or the end of its name; * and ? "
                 "are wildcards; repeatable")
      ->allow_extra_args(false);
  meshes_.declare(
      app, options_,
      "the inputs from which the scene was baked; repeatable. A path is written only if the "
      "meshes prove its clearance (see voxcheck)");
  app.add_option("--time", time_,
                 "time limit of the search; default 60s. If the search finds a path, the check of "
                 "this path may take as long again");
  app.add_option("--seed", options_.seed,
                 "seed of the random numbers; another seed finds another path; default 1")
      ->check(CLI::Range(0u, 1000000000u));
  app.add_option("--threads", options_.threads,
                 "number of threads, default all; the number does not change the path")
      ->check(CLI::Range(1u, kMaxThreads));
  app.add_option("--json", options_.json, "write a report to this file");
  app.add_flag("--quiet", options_.quiet, "print nothing but errors");
}

Result<Options> OptionParser::finish() const {
  Options options = options_;
  const auto clearance = command::parse_length(clearance_);
  if (!clearance) return about("--clearance", clearance.error());
  if (!(*clearance >= 0)) {
    return Error{ErrorCode::kUsage, "", "--clearance", "must not be negative", ""};
  }
  options.clearance_m = *clearance;
  if (Status read = meshes_.finish(options); !read) return read.error();
  const auto time = command::parse_duration(time_);
  if (!time) return about("--time", time.error());
  options.max_s = *time;
  const auto seat = read_pose("--seat", seat_);
  if (!seat) return seat.error();
  options.world_from_seat = *seat;
  if (goal_.empty()) return options;
  const auto goal = read_pose("--goal", goal_);
  if (!goal) return goal.error();
  options.world_from_goal = *goal;
  return options;
}

}  // namespace forcelayer::voxplan
