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
    return usage(asked_by, "needs real time, because the next scene is read during the run",
                 "leave out --as-fast-as-possible");
  }
  if (!options.record.empty() || !options.replay.empty()) {
    return usage(asked_by, "cannot be recorded or replayed: a recording has only one scene",
                 "leave out --record and --replay");
  }
  return {};
}

OptionParser::OptionParser(CLI::App& app) : app_(app) {
  command::add_required(app, "scene", texts_.scene, "the scene, a .vox file");
  command::add_required(app, "part", texts_.part, "the moving part, a .pshell file");
  add_device_options(app, texts_.device);
  command::add_text(app, "--duration", texts_.duration,
                    "duration of the run, such as 10s or 2min, at most 10000h; default: the "
                    "duration of --motion");
  command::add_count(app, "--threads", options_.run.threads,
                     "threads of the contact query, default 1", static_cast<int>(kThreads.smallest),
                     static_cast<int>(kThreads.largest));
  command::add_text(app, "--model", texts_.model,
                    "dynamic model: 'default', or 'paper' (the method of 1999)");
  command::add_text(app, "--force", texts_.force,
                    "force field: tangent-plane, level or distance; default: the model's own");
  command::add_flag(app, "--as-fast-as-possible", options_.as_fast_as_possible,
                    "run without a clock: each frame begins when the previous frame has ended");
  command::add_text(app, "--motion", options_.motion, "CSV of hand poses for the simulated hand");
  command::add_text(
      app, "--pull", texts_.pull,
      "x,y,z, such as 0,0,60mm: instead of --motion, the displacement by which the simulated hand "
      "pulls the part along a straight line. The hand first rests for 0.3 s. Its mean speed is "
      "then "
      "5 cm/s, or less if the pull would take less than two seconds");
  command::add_text(app, "--start", texts_.start,
                    "pose world_from_part at the start: x,y,z[,qw,qx,qy,qz]; default: the pose of "
                    "the hand, or 0,0,0m without a hand");
  command::add_text(app, "--seat", texts_.seat,
                    "pose world_from_part in which the part is installed. Until the part has left "
                    "the objects that it touches in this pose, it may touch them. Default: the "
                    "start pose");
  command::add_text(
      app, "--grip", texts_.grip,
      "pose handle_from_part: the part's pose relative to the handle. Default: 0,0,0m; with "
      "--start, the relative pose at the start");
  command::add_text(app, "--world-from-device", texts_.world_from_device,
                    "pose of the device in the scene; default 0,0,0m");
  command::add_texts(
      app, "--fail-on", texts_.fail_on, ',',
      "end with status 6 on one of these: penetration (always checked), contact (but not with "
      "objects of the seat until the part has left it), outside (the part went beyond a cropped "
      "side), seat (the part did not leave its seat) or held (the part did not follow --motion, or "
      "did not reach the end of --pull); repeatable");
  command::add_texts(
      app, "--scene-next", texts_.scene_next, '\n',
      "a .vox file that replaces the scene during the run. With FILE@TIME, at this time, such as "
      "2.5s. With FILE alone, when the scene button of --device is pressed, or at the signal "
      "SIGUSR1. The force fades out and in. Repeatable");
  command::add_text(
      app, "--guide", options_.guide,
      "a path of the part, such as a path that voxplan wrote. A weak spring pulls the "
      "hand to the path and along the path, until the guide is switched off");
  command::add_texts(app, "--expect", texts_.expect, ',',
                     "expected SHA-256 of a baked file, as sha256sum and voxinfo print it. Repeat "
                     "the option: one digest for the scene, one for the part");
  command::add_text(app, "--json", options_.json, "write a report to this file");
  command::add_text(app, "--trace", options_.trace, "write a CSV with one line for each frame");
  command::add_text(app, "--save-path", options_.save_path,
                    "write the part's path as a CSV for voxcheck");
  command::add_text(app, "--record", options_.record, "write a recording for --replay");
  command::add_text(app, "--replay", options_.replay,
                    "recording to repeat bit for bit, without a device. With inputs:FILE, only the "
                    "recording's inputs are repeated, on another bake");
  command::add_text(app, "--udp", options_.udp,
                    "send the pose stream to [HOST:]PORT[@RATE], RATE datagrams a second, default "
                    "60 (1 to 100000)");
  command::add_flag(app, "--without-guarantee", options_.run.without_guarantee,
                    "start even if no separation is guaranteed");
  command::add_choice(
      app, "--after-trip", texts_.after_trip, {"end", "wait", "rearm"},
      "after a trip, which sets the output to zero: end (the run ends), wait (until the clutch is "
      "pressed and released) or rearm (without the clutch; only for simulated hands). Default: "
      "rearm for sim and replays, otherwise end");
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
      return usage("--fail-on", "'" + std::string(word) + "' is not a condition",
                   "give one of: penetration, contact, outside, seat, held");
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
        return usage("--scene-next",
                     "'" + std::string(text) + "' has an earlier time than the previous scene",
                     "order the scenes by their times");
      }
      last_s = *time_s;
    }
    options.scene_next.push_back(std::move(next));
  }
  return {};
}

Status OptionParser::read_pull(Options& options) const {
  if (texts_.pull.empty()) return {};
  const auto pull = command::parse_point(texts_.pull);
  if (!pull) return about("--pull", pull.error());
  options.pull_m = {(*pull)[0], (*pull)[1], (*pull)[2]};
  const double length_m = glm::length(*options.pull_m);
  if (!(length_m > 0 && length_m <= kLongestPullM)) {
    return usage("--pull", "must be longer than zero and at most 1000 m", "write it like 0,0,60mm");
  }
  return {};
}

Status OptionParser::check(const Options& options) const {
  if (!options.scene_next.empty() || options.scene_button) {
    const char* const option = options.scene_button ? "--device scene" : "--scene-next";
    if (Status can = check_scene_change(options, option); !can) return can;
  }
  if (options.guide.empty() && (options.guide_button || options.guide_force_n)) {
    return usage(options.guide_button ? "--device guide" : "--set guide_force_n",
                 "has no effect without --guide", "add --guide with a path");
  }
  const bool simulated = options.device == "sim" || options.device == "replay";
  if (options.after_trip == AfterTrip::kRearm && !simulated) {
    return usage("--after-trip", "rearm is only for simulated hands", "use end or wait");
  }
  if (!options.motion.empty() && options.device != "sim") {
    return usage("--motion", "is only for the sim device", "leave out --device");
  }
  if (options.pull_m && (options.device != "sim" || !options.motion.empty())) {
    return usage("--pull", "is only for the sim device without --motion",
                 "leave out --device and --motion");
  }
  if ((options.fail_on & kFailOnHeld) != 0 && !options.pull_m && options.motion.empty()) {
    return usage("--fail-on", "'held' has no effect without --motion or --pull",
                 "add --motion or --pull, or leave out 'held'");
  }
  if (options.start.world_from_seat && options.run.model == Model::kPaper) {
    return usage("--seat", "is only for --model default: the paper's model has no seat",
                 "leave it out");
  }
  if (options.replay.empty()) {
    const bool endless = !options.duration_s && options.motion.empty() && !options.pull_m;
    if (options.as_fast_as_possible && endless) {
      return usage("--as-fast-as-possible", "the run would never end",
                   "add --duration, --motion or --pull");
    }
    return {};
  }
  const char* const fixed[] = {"--model", "--force", "--start",
                               "--seat",  "--grip",  "--world-from-device"};
  for (const char* option : fixed) {
    if (command::is_given(app_, option)) {
      return usage(option, "is part of the recording", "leave this option out with --replay");
    }
  }
  if (!options.run.settings.empty() || !options.run.braking) {
    return usage("--set", "sets a parameter that the recording already sets",
                 "leave this option out with --replay");
  }
  return {};
}

Status OptionParser::finish() {
  Options& options = options_;
  options.run.scene = texts_.scene;
  options.run.part = texts_.part;
  if (Status read = read_device(texts_.device, options); !read) return read;
  constexpr std::string_view kInputs = "inputs:";
  options.on_new_scene = options.replay.starts_with(kInputs);
  if (options.on_new_scene) options.replay.erase(0, kInputs.size());
  if (!options.replay.empty()) {
    if (command::is_given(app_, "--device")) {
      return usage("--replay", "replaces the device", "leave out --device");
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
