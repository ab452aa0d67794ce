#include "runtime/voxrun/session.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "formats/command/command.h"
#include "formats/command/progress_line.h"
#include "formats/command/provenance.h"
#include "formats/command/report.h"
#include "formats/command/text.h"
#include "formats/path/path_file.h"
#include "runtime/guard/seat.h"
#include "runtime/loop/loop.h"
#include "runtime/loop/servo.h"
#include "runtime/machine/real_time.h"
#include "runtime/run/baked_files.h"
#include "runtime/run/derive_parameters.h"
#include "runtime/run/limits.h"
#include "runtime/run/start_check.h"
#include "runtime/stream/pose_sender.h"
#include "runtime/stream/recording.h"
#include "runtime/voxrun/device_choice.h"
#include "runtime/voxrun/frame_sinks.h"
#include "runtime/voxrun/report.h"
#include "runtime/voxrun/scenes.h"
#include "runtime/voxrun/trace_writer.h"
#include "runtime/voxrun/verdict.h"

namespace forcelayer::voxrun {
namespace {

constexpr std::size_t kRingFrames = 1 << 14;  // 16 s of a stalled disk at 1 kHz

// Everything that a run needs, in the order in which it is built.
struct Session {
  Session(const Options& options, std::atomic<int>& of_stop, bool& of_began)
      : facts(options), stop(of_stop), began(of_began) {}

  RunFacts facts;
  std::atomic<int>& stop;
  bool& began;
  RunRequest request;  // the options', as device or recording have it
  std::optional<stream::Recording> recording;
  ChosenDevice device;  // none in a replay
  AfterTrip after_trip = AfterTrip::kRearm;
  std::uint32_t clutch_buttons = 0;
  std::unique_ptr<loop::InputSource> input;
  stream::ReplayInput* replay = nullptr;  // the input, where it is one
  std::optional<Run> run;
  std::optional<Scenes> scenes;  // of the run
  std::optional<loop::Guide> guide;
  State start;
  Status missed_scene;  // of --scene-next, by a file that could not be used

  ~Session() {
    if (device.device) device.device->stop();
  }
};

Status make_input(const Options& options, Session& session) {
  auto chosen = choose_device(options, session.stop);
  if (!chosen) {
    session.began = session.stop == 0;
    return chosen.error();
  }
  session.device = std::move(*chosen);
  session.input = std::make_unique<loop::DeviceInput>(
      *session.device.device, session.request.placement, input_limits(session.request));
  const DeviceCapabilities& known = session.device.device->capabilities();
  session.request.device = known;
  session.facts.capabilities = known;
  session.after_trip =
      options.after_trip.value_or(known.hardware ? AfterTrip::kEnd : AfterTrip::kRearm);
  if (known.hardware && options.as_fast_as_possible) {
    return Error{ErrorCode::kUsage, "", "--as-fast-as-possible",
                 "cannot be combined with " + known.name + ", which has a clock of its own", ""};
  }
  if (options.clutch_button) {
    session.clutch_buttons = 1u << *options.clutch_button;
  } else if (known.hardware) {
    session.clutch_buttons = 1;
  }
  return {};
}

Status open_recording(const Options& options, const Voxmap& voxmap, const Pshell& shell,
                      Session& session) {
  auto recording = stream::Recording::open(options.replay);
  if (!recording) return recording.error();
  if (options.on_new_scene) {
    session.facts.warnings.push_back("--replay: only the inputs of " + options.replay +
                                     " are used; the outcomes are not compared");
  } else if (Status same = recording->check_files(voxmap, shell); !same) {
    return same;
  }
  session.recording = std::move(*recording);
  auto replay = std::make_unique<stream::ReplayInput>(*session.recording);
  session.replay = replay.get();
  session.input = std::move(replay);
  session.request.placement = session.recording->run().placement;
  session.request.recorded = session.recording->run().parameters;
  session.after_trip = options.after_trip.value_or(AfterTrip::kRearm);
  return {};
}

void warn(const std::vector<std::string>& more, std::vector<std::string>& warnings) {
  warnings.insert(warnings.end(), more.begin(), more.end());
}

// Where a baked file was made without some of its faces, the guarantee says nothing about those.
void warn_of_missing_faces(const Options& options, const Run& run,
                           std::vector<std::string>& warnings) {
  const auto warn_of = [&](const std::filesystem::path& path, std::string_view provenance) {
    const std::string text = command::missing_faces_text(provenance);
    if (!text.empty()) warnings.push_back(path.string() + ": " + text);
  };
  warn_of(options.run.scene, run.simulation().voxmap().provenance());
  warn_of(options.run.part, run.simulation().shell().provenance());
}

// Registers the part where the hand is now.
Status take_hold(const Options& options, Session& session) {
  const auto device_from_handle = wait_for_pose(*session.device.device, session.stop);
  if (!device_from_handle) {
    session.began = session.stop == 0;
    return device_from_handle.error();
  }
  auto begun = session.run->simulation().begin(
      options.start, session.request.placement.world_from_handle(*device_from_handle));
  if (!begun) return begun.error();
  session.start = *begun;
  return {};
}

// The path that leads the hand.
Status make_guide(const Options& options, Session& session) {
  if (options.guide.empty()) return {};
  const auto rows = read_path(options.guide, PathOf::kPart);
  if (!rows) return rows.error();
  std::vector<Pose> world_from_center;
  for (const PathRow& row : *rows) {
    const auto& p = row.position_m;
    const auto& q = row.orientation_wxyz;
    world_from_center.push_back(session.run->simulation().world_from_center(
        {{p[0], p[1], p[2]}, glm::dquat(q[0], q[1], q[2], q[3])}));
  }
  loop::GuideLimits limits;
  if (options.guide_force_n) limits.force_n = *options.guide_force_n;
  limits.torque_nm = loop::kGuideLeverM * limits.force_n;
  const double scale = session.request.placement.motion_scale;
  session.guide.emplace(loop::GuidePath(world_from_center, limits, scale), limits, scale);
  return {};
}

// The files before the device: a file that is unusable is an error before a motor is on.
Status prepare_run(const Options& options, Session& session) {
  session.request = options.run;
  session.facts.device = options.device;
  auto voxmap = open_scene(options.run.scene, options.run.expected_sha256);
  if (!voxmap) return voxmap.error();
  auto shell = open_part(options.run.part, options.run.expected_sha256);
  if (!shell) return shell.error();
  for (const NextScene& next : options.scene_next) {
    if (auto later = Voxmap::open(next.path, Verify::kStructure); !later) return later.error();
  }
  const Status input = options.replay.empty() ? make_input(options, session)
                                              : open_recording(options, *voxmap, *shell, session);
  if (!input) return input;
  auto run = open_run(std::move(*voxmap), std::move(*shell), session.request);
  if (!run) return run.error();
  session.run = std::move(*run);
  session.scenes.emplace(*session.run, options.run.scene.string());
  if (Status led = make_guide(options, session); !led) return led;
  warn(session.run->warnings(), session.facts.warnings);
  warn_of_missing_faces(options, *session.run, session.facts.warnings);
  if (session.recording) {
    const stream::RecordedRun& recorded = session.recording->run();
    session.start = recorded.start;
    if (recorded.world_from_seat) {
      Status found = session.run->simulation().find_seat(*recorded.world_from_seat);
      if (!found) return found;
    }
    if (!options.on_new_scene) return {};
  } else if (Status held = take_hold(options, session); !held) {
    return held;
  }
  const model::Simulation& simulation = session.run->simulation();
  if (Status sound = check_start(simulation, session.start.world_from_center); !sound) {
    if (!options.run.without_guarantee) return sound;
    warn({sound.error().where + ": " + sound.error().what}, session.facts.warnings);
  }
  if (options.start.world_from_seat && simulation.seat().empty()) {
    warn({"the part touches nothing where it is installed (--seat)"}, session.facts.warnings);
  }
  const std::uint64_t touching = guard::points_in_seat(simulation.seat());
  if (const auto warning = part_in_scene_warning(simulation.voxmap(), simulation.shell(),
                                                 session.start.world_from_center, touching)) {
    warn({*warning}, session.facts.warnings);
  }
  const double arm_m = glm::length(session.start.handle_from_center.position_m);
  if (const auto warning = arm_warning(session.request, session.run->parameters(), arm_m)) {
    warn({*warning}, session.facts.warnings);
  }
  return {};
}

// A millionth of a frame more, so that 0.3 s at 1 kHz is 300 frames and not 301.
std::uint64_t frames_of(double seconds, const Session& session) {
  return static_cast<std::uint64_t>(std::ceil(seconds * session.run->parameters().rate_hz - 1e-6));
}

std::optional<double> motion_end_s(const Session& session) {
  const auto& motion = session.device.motion;
  return motion ? std::optional(motion->end_s()) : std::nullopt;
}

loop::LoopOptions loop_options(const Options& options, const Session& session,
                               const std::atomic<int>& stop) {
  loop::LoopOptions loop;
  loop.as_fast_as_possible = options.as_fast_as_possible;
  loop.stop = &stop;
  loop.stale_s = options.run.stale_s;
  loop.end_on_trip = session.after_trip == AfterTrip::kEnd;
  const auto seconds = options.duration_s ? options.duration_s : motion_end_s(session);
  if (seconds) loop.frames = frames_of(*seconds, session);
  return loop;
}

// Warns of things that were asked for and will not come about, because the run ends before.
void warn_of_early_end(const Options& options, const std::optional<std::uint64_t>& frames,
                       Session& session) {
  if (!frames) return;
  std::vector<std::string>& warnings = session.facts.warnings;
  if (const auto end_s = motion_end_s(session); end_s && *frames < frames_of(*end_s, session)) {
    warnings.push_back(options.pull_m ? "--duration: the run ends before --pull does, so it cannot "
                                        "show whether the part comes out"
                                      : "--duration: the run ends before --motion does");
  }
  for (const NextScene& next : options.scene_next) {
    if (!next.at_s || *frames > frames_of(*next.at_s, session)) continue;
    warnings.push_back(command::text("--scene-next: %s: the run ends before the time of this scene",
                                     next.path.c_str()));
  }
}

void print(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

void print_warnings(const RunFacts& facts, std::size_t first) {
  for (std::size_t i = first; i < facts.warnings.size(); ++i) {
    command::print_warning(facts.warnings[i]);
  }
}

// The files and the socket that frames go to while the loop runs.
struct FrameOutputs {
  const model::Simulation* simulation = nullptr;
  std::optional<TraceWriter> trace;
  std::optional<PathWriter> path;
  std::optional<stream::RecordingWriter> recording;
  std::optional<stream::PoseSender> poses;

  Status open(const Options& options, const Session& session) {
    if (!options.record.empty()) {
      auto writer = stream::RecordingWriter::create(options.record);
      if (!writer) return writer.error();
      recording.emplace(std::move(*writer));
    }
    if (!options.trace.empty()) {
      auto writer = TraceWriter::create(options.trace, *session.scenes);
      if (!writer) return writer.error();
      trace = std::move(*writer);
    }
    if (!options.save_path.empty()) {
      auto writer = PathWriter::create(options.save_path);
      if (!writer) return writer.error();
      path.emplace(std::move(*writer));
      simulation = &session.run->simulation();
    }
    if (!options.udp.empty()) {
      auto sender =
          stream::PoseSender::create(options.udp, session.run->simulation(), options.udp_rate_hz);
      if (!sender) return sender.error();
      poses.emplace(std::move(*sender));
    }
    return {};
  }

  Status add_to_path(const Frame& frame) {
    const Pose part = simulation->world_from_part(frame.result.report.world_from_center);
    const auto& p = part.position_m;
    const auto& q = part.orientation;
    return path->add({frame.time_s, {p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}});
  }

  std::vector<FrameSink> sinks() {
    std::vector<FrameSink> all;
    if (trace) all.push_back([this](const Frame& frame) { return trace->add(frame); });
    if (path) all.push_back([this](const Frame& frame) { return add_to_path(frame); });
    if (recording) all.push_back([this](const Frame& frame) { return recording->add(frame); });
    if (poses) {
      all.push_back([this](const Frame& frame) -> Status {
        poses->offer(frame);
        return {};
      });
    }
    return all;
  }

  Status finish(std::uint64_t lost_frames) {
    if (trace) {
      if (Status s = trace->finish(); !s) return s;
    }
    if (path) {
      if (Status s = path->finish(); !s) return s;
    }
    return recording ? recording->finish(lost_frames) : Status{};
  }
};

Status check_replay(const Session& session) {
  const bool compared = session.replay != nullptr && !session.facts.options.on_new_scene;
  if (!compared || session.replay->differing_frames() == 0) return {};
  return stream::outcome_differs(session.facts.options.replay, session.replay->first_difference());
}

bool is_of_device(TripCause cause) {
  return cause == TripCause::kDeviceLost || cause == TripCause::kFrozen ||
         cause == TripCause::kOutputHeld;
}

// A run that ends with the output tripped did not end well, and says so.
Status check_output(const RunFacts& facts) {
  if (!facts.ended_tripped) return {};
  // The device's own reason, where the trip is about the device.
  devices::DeviceTrouble trouble;
  if (is_of_device(facts.last_trip)) trouble = facts.device_trouble;
  char when[32];
  std::snprintf(when, sizeof when, "at %.3f s", facts.last_trip_s);
  return Error{ErrorCode::kDeviceFailed, facts.device, when,
               std::string("output set to zero: ") + to_text(facts.last_trip) +
                   (trouble.what.empty() ? "" : " (" + trouble.what + ")"),
               trouble.mend.empty() ? how_to_mend(facts.last_trip) : trouble.mend};
}

FrameSink progress_sink(const loop::LoopOptions& loop, command::ProgressLine& line) {
  return [frames = loop.frames, &line](const Frame& frame) -> Status {
    if (frames) line.show("running", static_cast<double>(frame.number) / double(*frames));
    return {};
  };
}

Status run_frames(const Options& options, Session& session, std::atomic<int>& next_scene,
                  loop::LoopStatistics& statistics) {
  FrameOutputs outputs;
  if (Status opened = outputs.open(options, session); !opened) return opened;
  const loop::LoopOptions loop = loop_options(options, session, session.stop);
  command::ProgressLine progress(options.quiet);
  auto sinks = outputs.sinks();
  OutputEvents events(session.clutch_buttons != 0);
  SceneChange change(options, session.request, *session.scenes, next_scene);
  sinks.push_back([&](const Frame& frame) -> Status {
    events.see(frame);
    for (const std::string& event : change.see(frame)) events.add(frame.time_s, event, true);
    return {};
  });
  std::optional<MotionWatch> motion;
  if (session.device.motion) {
    motion.emplace(*session.device.motion, session.request.placement.motion_scale);
    sinks.push_back([&](const Frame& frame) -> Status {
      motion->see(frame);
      return {};
    });
  }
  sinks.push_back(progress_sink(loop, progress));
  machine::SpscRing<Frame> ring(kRingFrames);
  FrameSinks frame_sinks(ring, std::move(sinks), session.stop);
  model::Simulation& simulation = session.run->simulation();
  const std::size_t warned = session.facts.warnings.size();
  // Once every other thread runs: the stack of a later one would count as locked, and may be
  // refused.
  if (!options.as_fast_as_possible) warn(session.run->make_real_time(), session.facts.warnings);
  print_warnings(session.facts, warned);
  const double stolen_s = machine::steal_seconds();
  // Again, and last: the hand moved on while the run was made ready, and held where it was, the
  // part would be torn to where it is.
  if (session.device.device) {
    if (Status held = take_hold(options, session); !held) return held;
  }
  if (outputs.recording) {
    outputs.recording->begin(
        stream::describe_run(simulation, session.start, session.request.placement));
  }
  loop::OutputLimits limits = output_limits(session.request, session.run->parameters());
  limits.rearm_alone = session.after_trip == AfterTrip::kRearm;
  loop::Servo servo(simulation, *session.input, session.start, limits);
  servo.set_clutch_buttons(session.clutch_buttons);
  if (session.guide) {
    servo.set_guide(&*session.guide, options.guide_button ? 1u << *options.guide_button : 0);
  }
  change.begin(servo);
  const long long begin_ns = machine::monotonic_ns();
  loop::run_loop(servo, loop, &ring, statistics);
  session.facts.steal_s = machine::steal_seconds() - stolen_s;
  session.facts.wall_s = static_cast<double>(machine::monotonic_ns() - begin_ns) / 1e9;
  if (options.pull_m && statistics.frames == loop.frames &&
      loop.frames >= frames_of(*motion_end_s(session), session)) {
    const glm::dvec3 went_m =
        statistics.part_last.position_m - session.start.world_from_center.position_m;
    const double led_m = glm::length(*options.pull_m);
    session.facts.outcome.pull = Pull{led_m, glm::dot(went_m, *options.pull_m) / led_m};
  }
  change.finish();
  const Voxmap& last = change.map() != nullptr ? *change.map() : simulation.voxmap();
  session.facts.scene_file_bytes = last.bytes().size();
  if (session.device.device) session.device.device->stop();
  if (Status drained = frame_sinks.finish(); !drained) return drained;
  if (statistics.frames == 0 && session.stop > 0) {  // a signal before the first frame
    session.began = false;
    return {};
  }
  if (motion) session.facts.outcome.motion = motion->followed();
  session.missed_scene = change.missed();
  session.facts.outcome.scene_missed = !session.missed_scene;
  session.facts.output_trips = servo.output().trips();
  if (session.device.device) {
    session.facts.device_trouble = session.device.device->trouble();
    session.facts.device_counters = session.device.device->counters();
  }
  session.facts.last_trip = servo.output().last_trip();
  session.facts.last_trip_s = events.last_trip_s();
  session.facts.events = events.events();
  session.facts.ended_tripped = servo.output().state() == OutputState::kTripped;
  return outputs.finish(statistics.dropped_frames);
}

}  // namespace

Status run_session(const Options& options, std::atomic<int>& stop, std::atomic<int>& next_scene,
                   bool& began) {
  Session session(options, stop, began);
  const auto statistics = std::make_unique<loop::LoopStatistics>();
  Status done = prepare_run(options, session);
  if (done) {
    warn_of_early_end(options, loop_options(options, session, stop).frames, session);
    if (!options.quiet) print(start_text(*session.scenes, session.facts));
    print_warnings(session.facts, 0);
    done = run_frames(options, session, next_scene, *statistics);
  }
  if (!began) return {};
  if (done && !options.quiet) {
    print(end_text(*session.scenes, session.facts, *statistics));
    print(verdict_text(*session.scenes, session.facts.outcome, *statistics));
  }
  if (done && !options.json.empty()) {
    auto report = report_json(*session.scenes, session.facts, *statistics);
    if (const int by_signal = stop; by_signal > 0) report["exit_status"] = 128 + by_signal;
    done = command::write_report(options.json, report);
  }
  if (done) done = check_output(session.facts);
  if (done) done = check_replay(session);
  if (done) done = check_verdict(options, *session.scenes, session.facts.outcome, *statistics);
  if (done) done = session.missed_scene;
  return done;
}

}  // namespace forcelayer::voxrun
