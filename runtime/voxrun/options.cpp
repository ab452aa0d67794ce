#include "runtime/voxrun/options.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

#include "formats/command/arguments.h"
#include "formats/digest/file_digest.h"
#include "runtime/voxrun/device_text.h"
#include "runtime/voxrun/settings.h"

namespace forcelayer::voxrun {
namespace {

using command::about;

constexpr double kLongestPullM = 1000;  // five and a half hours

command::Bounds bounds_of(const Range& range) { return {range.smallest, range.largest}; }

Error usage(std::string_view where, std::string_view what, std::string_view mend) {
  return {ErrorCode::kUsage, "", where, what, mend};
}

Status read_pose(const char* option, const std::string& text, Pose& pose) {
  const auto parsed = command::parse_pose(text);
  if (!parsed) return about(option, parsed.error());
  const auto& [p, q] = *parsed;
  pose = {{p[0], p[1], p[2]}, glm::dquat(q[0], q[1], q[2], q[3])};
  return {};
}

}  // namespace

Status check_scene_change(const Options& options, const char* asked_by) {
  if (options.as_fast_as_possible) {
    return usage(asked_by, "needs a clock: a scene is read while the run goes on",
                 "leave out --as-fast-as-possible");
  }
  if (!options.record.empty() || !options.replay.empty()) {
    return usage(asked_by, "has no place in a recording, which is of one scene",
                 "leave out --record and --replay");
  }
  return {};
}

OptionParser::OptionParser(CLI::App& app) : app_(app) {
  command::add_required(app, "scene", texts_.scene, "the scene, a .vox file");
  command::add_required(app, "part", texts_.part, "the moving part, a .pshell file");
  add_device_options(app, texts_.device);
  command::add_text(app, "--duration", texts_.duration,
                    "how long to run, like 10s or 2min, to 10000h; default: as long as --motion");
  command::add_number(app, "--rate", options_.run.rate_hz, "frames a second", bounds_of(kRatesHz));
  command::add_count(app, "--threads", options_.run.threads,
                     "threads of the contact query, default 1", static_cast<int>(kThreads.smallest),
                     static_cast<int>(kThreads.largest));
  command::add_text(app, "--model", texts_.model,
                    "dynamic model: default, or paper for the method of 1999");
  command::add_text(app, "--force", texts_.force,
                    "force field: tangent-plane, level or distance; default: the model's own");
  command::add_flag(app, "--as-fast-as-possible", options_.as_fast_as_possible,
                    "no clock: every frame follows the last at once");
  command::add_text(app, "--motion", options_.motion, "CSV of hand poses for the sim device");
  command::add_text(app, "--pull", texts_.pull,
                    "x,y,z: instead of --motion: the hand rests for 0.3 s and then pulls the part "
                    "straight by this displacement, such as 0,0,60mm, at 5 cm/s or in two seconds");
  command::add_choice(
      app, "--hand", options_.hand, {"firm", "loose"},
      "a simulated hand that feels the sim device: firm or loose; --motion is then where "
      "it wants to be; default: a hand that feels nothing");
  command::add_text(
      app, "--start", texts_.start,
      "world_from_part at the start: x,y,z[,qw,qx,qy,qz]; default: the hand's, else 0,0,0m");
  command::add_text(
      app, "--seat", texts_.seat,
      "world_from_part where the part is installed: it may touch there what it touches, "
      "until it has left those objects (where it starts)");
  command::add_text(app, "--grip", texts_.grip,
                    "handle_from_part, in the same format: the origin of the handle is where the "
                    "hand holds the part; default: the origin of the part's frame");
  command::add_text(app, "--world-from-device", texts_.world_from_device,
                    "place of the device; default 0,0,0m");
  command::add_number(
      app, "--motion-scale", options_.run.placement.motion_scale,
      "scene meters a meter of the device; the hand feels the scene's force times that",
      bounds_of(kMotionScales));
  command::add_texts(
      app, "--fail-on", texts_.fail_on, ',',
      "penetration (in any case), contact (but in the seat), outside (of the map), seat (not left) "
      "or held (off --motion, or short of the end of --pull): end with status 6 where it "
      "happened; repeatable");
  command::add_texts(
      app, "--scene-next", texts_.scene_next, '\n',
      "FILE or FILE@TIME: a .vox file that follows the scene while the run goes on, at "
      "that time (2.5s), or at the button or SIGUSR1; the force fades out and in; "
      "repeatable");
  command::add_text(
      app, "--guide", options_.guide,
      "a path of the part, as of voxplan, that leads the hand: a weak spring to it and "
      "along it, until it is switched off");
  command::add_texts(
      app, "--expect", texts_.expect, ',',
      "SHA-256 that a baked file may have, as sha256sum and voxinfo print it; scene and "
      "part must both be among those given; repeatable");
  command::add_text(app, "--json", options_.json, "write a report");
  command::add_text(app, "--trace", options_.trace, "write a CSV line a frame");
  command::add_text(app, "--save-path", options_.save_path,
                    "write the part's path, a CSV for voxcheck");
  command::add_text(app, "--record", options_.record, "write a recording for --replay");
  command::add_text(app, "--replay", options_.replay,
                    "repeat a recording bit for bit, in place of a device");
  command::add_flag(app, "--on-new-scene", options_.on_new_scene,
                    "of a recording replay the inputs alone, on another bake");
  command::add_text(app, "--udp", options_.udp,
                    "send the pose stream to [HOST:]PORT[@RATE], RATE datagrams a second, default "
                    "60 (1 to 100000)");
  command::add_flag(app, "--without-guarantee", options_.run.without_guarantee,
                    "start even where no separation is guaranteed");
  command::add_choice(
      app, "--after-trip", texts_.after_trip, {"end", "wait", "rearm"},
      "when the output had to go to zero: end the run, wait for the clutch, or (sim) "
      "rearm; the default is end, for sim and replay rearm");
  command::add_flag(app, "--quiet", options_.quiet, "no report on the terminal");
  add_settings(app, texts_.settings);
}

Status OptionParser::read_texts(Options& options) const {
  if (!texts_.duration.empty()) {
    const auto seconds = command::parse_duration(texts_.duration);
    if (!seconds) return about("--duration", seconds.error());
    if (!(*seconds > 0)) return usage("--duration", "must be above zero", "");
    options.duration_s = *seconds;
  }
  if (const std::size_t at = options.udp.find('@'); at != std::string::npos) {
    const auto rate_hz =
        command::parse_number(std::string_view(options.udp).substr(at + 1), bounds_of(kRatesHz));
    if (!rate_hz) return about("--udp", rate_hz.error());
    options.udp_rate_hz = *rate_hz;
    options.udp.resize(at);
  }
  if (!texts_.model.empty()) {
    const auto model = parse_model(texts_.model);
    if (!model) return usage("--model", "'" + texts_.model + "' is not a model", "see --help");
    options.run.model = *model;
  }
  if (!texts_.force.empty()) {
    options.run.force = parse_force(texts_.force);
    if (!options.run.force) {
      return usage("--force", "'" + texts_.force + "' is not a force field", "see --help");
    }
  }
  if (!texts_.start.empty()) {
    options.start.world_from_part.emplace();
    if (Status s = read_pose("--start", texts_.start, *options.start.world_from_part); !s) return s;
  }
  if (!texts_.seat.empty()) {
    options.start.world_from_seat.emplace();
    if (Status s = read_pose("--seat", texts_.seat, *options.start.world_from_seat); !s) return s;
  }
  if (!texts_.grip.empty()) {
    options.start.handle_from_part.emplace();
    if (Status s = read_pose("--grip", texts_.grip, *options.start.handle_from_part); !s) return s;
  }
  if (command::is_given(app_, "--expect")) {
    auto digests = digest::parse_digests(texts_.expect);
    if (!digests) return about("--expect", digests.error());
    options.run.expected_sha256 = std::move(*digests);
  }
  if (texts_.world_from_device.empty()) return {};
  return read_pose("--world-from-device", texts_.world_from_device,
                   options.run.placement.world_from_device);
}

Status OptionParser::read_fail_on(Options& options) const {
  constexpr std::pair<std::string_view, FailOn> kKinds[] = {{"penetration", kFailOnPenetration},
                                                            {"contact", kFailOnContact},
                                                            {"outside", kFailOnOutside},
                                                            {"seat", kFailOnSeat},
                                                            {"held", kFailOnHeld}};
  std::string_view rest = texts_.fail_on;
  while (!rest.empty()) {
    const std::string_view word = rest.substr(0, rest.find(','));
    std::uint32_t bit = 0;
    for (const auto& [name, kind] : kKinds) {
      if (name == word) bit = kind;
    }
    if (bit == 0) {
      return usage("--fail-on", "'" + std::string(word) + "' is nothing that a run is checked for",
                   "give penetration, contact, outside, seat or held");
    }
    options.fail_on |= bit;
    rest.remove_prefix(std::min(rest.size(), word.size() + 1));
  }
  return {};
}

Status OptionParser::read_safety(Options& options) const {
  if (texts_.after_trip == "end") options.after_trip = AfterTrip::kEnd;
  if (texts_.after_trip == "wait") options.after_trip = AfterTrip::kWait;
  if (texts_.after_trip == "rearm") options.after_trip = AfterTrip::kRearm;
  return {};
}

// "FILE" or "FILE@TIME"; a file may have an @ in its name.
Status OptionParser::read_scenes(Options& options) const {
  double last_s = 0;
  std::string_view rest = texts_.scene_next;
  while (!rest.empty()) {
    const std::string_view text = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), text.size() + 1));
    NextScene next{std::string(text), {}};
    const std::size_t at = text.rfind('@');
    const auto time_s = command::parse_duration(text.substr(std::min(at, text.size() - 1) + 1));
    if (at != std::string_view::npos && time_s) {
      next = {std::string(text.substr(0, at)), *time_s};
      if (*time_s < last_s) {
        return usage("--scene-next", "'" + std::string(text) + "' comes before the one before it",
                     "give the scenes in the order of their times");
      }
      last_s = *time_s;
    }
    options.scene_next.push_back(std::move(next));
  }
  return {};
}

Status OptionParser::read_pull(Options& options) const {
  if (texts_.pull.empty()) return {};
  const auto way = command::parse_point(texts_.pull);
  if (!way) return about("--pull", way.error());
  options.pull_m = {(*way)[0], (*way)[1], (*way)[2]};
  const double length_m = glm::length(*options.pull_m);
  if (!(length_m > 0 && length_m <= kLongestPullM)) {
    return usage("--pull", "must not be zero, and at most 1000 m long", "write it like 0,0,60mm");
  }
  return {};
}

Status OptionParser::check(const Options& options) const {
  if (!options.scene_next.empty() || options.scene_button) {
    const char* const option = options.scene_button ? "--buttons scene" : "--scene-next";
    if (Status can = check_scene_change(options, option); !can) return can;
  }
  if (options.guide.empty() && (options.guide_button || options.guide_force_n)) {
    return usage(options.guide_button ? "--buttons guide" : "--set guide_force_n",
                 "has no effect without --guide", "give --guide, a path");
  }
  const bool simulated = options.device == "sim" || options.device == "replay";
  if (options.after_trip == AfterTrip::kRearm && !simulated) {
    return usage("--after-trip", "rearm is for simulated hands", "give end or wait");
  }
  if (!options.motion.empty() && options.device != "sim") {
    return usage("--motion", "is for the sim device", "leave out --device");
  }
  if (options.pull_m && (options.device != "sim" || !options.motion.empty())) {
    return usage("--pull", "is a motion of the sim device", "leave out --device and --motion");
  }
  if ((options.fail_on & kFailOnHeld) != 0 && !options.pull_m && options.motion.empty()) {
    return usage("--fail-on", "held needs a motion that the part should follow",
                 "give --motion or --pull, or leave held out");
  }
  if (!options.hand.empty() && options.device != "sim") {
    return usage("--hand", "is for the sim device", "leave out --device");
  }
  if (options.start.world_from_seat && options.run.model == Model::kPaper) {
    return usage("--seat", "is for --model default: the paper's has no seat", "leave it out");
  }
  if (options.on_new_scene && options.replay.empty()) {
    return usage("--on-new-scene", "requires --replay", "give both");
  }
  if (options.replay.empty()) {
    const bool endless = !options.duration_s && options.motion.empty() && !options.pull_m;
    if (options.as_fast_as_possible && endless) {
      return usage("--as-fast-as-possible", "would never end",
                   "give --duration, --motion or --pull");
    }
    return {};
  }
  const char* const fixed[] = {
      "--model",       "--force", "--rate", "--start", "--seat", "--grip", "--world-from-device",
      "--motion-scale"};
  for (const char* option : fixed) {
    if (command::is_given(app_, option)) {
      return usage(option, "is part of the recording", "leave it out with --replay");
    }
  }
  if (!options.run.settings.empty() || !options.run.braking) {
    return usage("--set", "names a parameter that the recording has", "leave it out with --replay");
  }
  return {};
}

Status OptionParser::finish() {
  Options& options = options_;
  options.run.scene = texts_.scene;
  options.run.part = texts_.part;
  if (Status read = read_device(texts_.device, options); !read) return read;
  if (!options.replay.empty()) {
    if (command::is_given(app_, "--device")) {
      return usage("--replay", "is in place of a device", "leave out --device");
    }
    options.device = "replay";
  }
  if (Status read = read_settings(texts_.settings, options); !read) return read;
  if (Status read = read_texts(options); !read) return read;
  if (Status read = read_safety(options); !read) return read;
  if (Status read = read_fail_on(options); !read) return read;
  if (Status read = read_scenes(options); !read) return read;
  if (Status read = read_pull(options); !read) return read;
  return check(options);
}

}  // namespace forcelayer::voxrun
