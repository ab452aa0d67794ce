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

OptionParser::OptionParser(CLI::App& app) : clearance_("12.7mm"), seat_("0,0,0m"), time_("60s") {
  options_.threads = std::clamp(std::thread::hardware_concurrency(), 1u, kMaxThreads);
  app.add_option("scene", options_.scene, "the scene, a .vox file")->required();
  app.add_option("part", options_.part, "the moving part, a .pshell file")->required();
  app.add_option("-o,--output", options_.path, "the path, a CSV of poses of the part")->required();
  app.add_option(
      "--seat", seat_,
      "world_from_part where it starts, x,y,z[,qw,qx,qy,qz]; default 0,0,0m. There it may be "
      "near the objects that it touches, until it has left them");
  app.add_option("--goal", goal_,
                 "target pose, world_from_part; default: anywhere beside the scene, with the "
                 "part's box outside of the scene's box");
  app.add_option("--clearance", clearance_,
                 "that is proven along the path, for the exact surfaces; default 12.7mm");
  app.add_option("--allow", options_.allow,
                 "an object that may be near, by its name or the end of it; * and ? match; "
                 "repeatable")
      ->allow_extra_args(false);
  meshes_.declare(app, options_,
                  "what the scene was baked from: only a path is taken that the meshes settle, as "
                  "by voxcheck --exact; repeatable");
  app.add_option("--time", time_, "after which the search is given up; default 60s");
  app.add_option("--seed", options_.seed,
                 "of its random numbers: another one, another path; default 1")
      ->check(CLI::Range(0u, 1000000000u));
  app.add_option("--threads", options_.threads,
                 "worker threads, default all; the path found does not depend on their number")
      ->check(CLI::Range(1u, kMaxThreads));
  options_.speed_mps = 0.1;
  command::add_number(app, "--speed", options_.speed_mps, "of the part along the path, m/s",
                      {1e-6, 1e3});
  app.add_option("--json", options_.json, "write a report");
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
