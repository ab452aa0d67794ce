// Steps and replays: forcelayer.Simulation and forcelayer.replay().
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <limits>
#include <map>

#include "forcelayer/pose_datagram.h"
#include "forcelayer/run.h"
#include "runtime/loop/handle_velocity.h"
#include "runtime/loop/loop_statistics.h"
#include "runtime/model/outcome_hash.h"
#include "runtime/model/simulation.h"
#include "runtime/python/files.h"
#include "runtime/stream/recording.h"
#include "runtime/stream/replay.h"

namespace forcelayer::python {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kFramesBetweenAsking = 64;  // whether Ctrl-C was pressed

using Vector = std::array<double, 3>;
using VelocityNumbers = std::array<double, 6>;  // linear (m/s), angular (rad/s), world axes
Vector numbers(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

// One frame as a row of an array.
struct FrameRow {
  double t_s;
  PoseNumbers world_from_handle, world_from_part;
  Vector force_n, torque_nm;
  double clearance_m, depth_m;
  Vector nearest_point_m;
  std::uint32_t nearest_object, interior, surface, proximity, contacts, guard_cuts, barred, seated,
      faults;
  bool measured, outside_map, seat_open, saturated;
};

FrameRow row_of_frame(const Frame& frame, const model::Simulation& simulation) {
  const StepReport& r = frame.result.report;
  FrameRow row{};
  row.t_s = frame.time_s;
  row.world_from_handle = pose_numbers(frame.input.world_from_handle);
  row.world_from_part = pose_numbers(simulation.world_from_part(r.world_from_center));
  row.force_n = numbers(frame.result.wrench.force_n);
  row.torque_nm = numbers(frame.result.wrench.torque_nm);
  row.measured = r.clearance_kind == ClearanceKind::kProven;
  row.clearance_m = r.clearance_kind == ClearanceKind::kNone ? kNan : r.clearance_m;
  row.nearest_point_m = numbers(row.measured ? r.nearest_point_m : glm::dvec3(kNan));
  row.nearest_object = row.measured ? r.nearest_object : 0;
  row.depth_m = r.depth_m;
  row.interior = r.interior, row.surface = r.surface, row.proximity = r.proximity;
  row.contacts = r.contacts, row.guard_cuts = r.guard_cuts, row.barred = r.barred;
  row.seated = r.seated, row.faults = r.faults;
  row.outside_map = r.outside_map != 0;
  row.seat_open = r.seat_open != 0;
  row.saturated = r.saturated != 0;
  return row;
}

std::string object_text(const Scene& scene, std::uint32_t object) {
  const std::string_view name = scene.map.object_name(object);
  return name.empty() ? "object " + std::to_string(object) : std::string(name);
}

py::object object_or_none(const Scene& scene, std::uint32_t object) {
  return object == 0 ? py::object(py::none()) : py::str(object_text(scene, object));
}

py::object min_clearance(const Scene& scene, const loop::LoopStatistics& s) {
  const auto& smallest = s.min_clearance;
  if (smallest.kind == ClearanceKind::kNone) return py::none();
  py::dict d;
  d["clearance_m"] = smallest.clearance_m;
  d["t_s"] = smallest.time_s;
  d["at_least"] = smallest.kind == ClearanceKind::kAtLeast;
  d["object"] = object_or_none(scene, smallest.object);
  if (smallest.kind == ClearanceKind::kProven) d["point_m"] = numbers(smallest.point_m);
  return d;
}

// The run so far, by the names of `voxrun --json`.
py::dict report_of(const Scene& scene, const loop::LoopStatistics& s, double rate_hz) {
  py::dict d;
  d["frames"] = s.frames;
  d["force_layer_frames"] = s.force_layer_frames;
  d["penetration_frames"] = s.penetration_frames;
  d["contact_frames"] = s.contact_frames;
  d["barred_frames"] = s.barred_frames;
  d["outside_map_frames"] = s.outside_map_frames;
  d["seated_frames"] = s.seated_frames;
  d["saturated_frames"] = s.saturated_frames;
  d["guard_cuts"] = s.guard_cuts;
  d["max_force_n"] = s.max_force_n;
  d["max_torque_nm"] = s.max_torque_nm;
  d["guarantee_from_s"] = s.guarantee_from_s;
  d["min_clearance"] = min_clearance(scene, s);
  py::list touched;
  for (const loop::TouchedTotal& total : s.touched.totals()) {
    py::dict entry;
    entry["name"] = object_text(scene, total.object);
    entry["seconds"] = static_cast<double>(total.frames) / rate_hz;
    entry["max_force_n"] = total.max_force_n;
    touched.append(entry);
  }
  d["touched_objects"] = touched;
  return d;
}

// The same bytes: a file that was replaced meanwhile is not mixed in.
Voxmap same_map(const Scene& scene) {
  return take(Voxmap::from_bytes(scene.map.bytes(), scene.path.string()));
}
Pshell same_shell(const Part& part) {
  return take(Pshell::from_bytes(part.shell.bytes(), part.path.string()));
}

Run open(const Scene& scene, const Part& part, RunRequest request) {
  request.scene = scene.path;
  request.part = part.path;
  return take(open_run(same_map(scene), same_shell(part), request));
}

}  // namespace

// Everything that evolves.
struct Evolving {
  State state;
  loop::HandleVelocity velocity;
};

// The same, and what was counted of it: tens of kilobytes.
struct Moment {
  Evolving evolving;
  loop::LoopStatistics statistics;
  const void* of = nullptr;  // the simulation
};

// forcelayer.Simulation.
class Stepper {
 public:
  Stepper(Scene& scene, Part& part, const RunRequest& request)
      : scene_(scene.shared_from_this()),
        part_(part.shared_from_this()),
        run_(open(scene, part, request)) {}

  void start(const Doubles& world_from_part, const std::optional<Doubles>& world_from_handle,
             const std::optional<Doubles>& world_from_seat) {
    PartStart start;
    start.world_from_part =
        pose_of(row_of<7>(world_from_part, "world_from_part"), "world_from_part");
    require_idle();
    if (world_from_seat) {
      start.world_from_seat =
          pose_of(row_of<7>(*world_from_seat, "world_from_seat"), "world_from_seat");
    }
    const Pose handle =
        world_from_handle
            ? pose_of(row_of<7>(*world_from_handle, "world_from_handle"), "world_from_handle")
            : *start.world_from_part;
    moment_.reset();
    auto begun = std::make_shared<Moment>();
    begun->evolving.state = take(simulation().begin(start, handle));
    begun->of = this;
    begun->evolving.velocity.update(handle, dt_s());
    moment_ = std::move(begun);
  }

  // Holds the interpreter lock: a step is shorter than waiting for it again may be.
  py::object step(const Doubles& world_from_handle, const std::optional<Doubles>& velocity) {
    const PoseNumbers& handle = row_of<7>(world_from_handle, "world_from_handle");
    const VelocityNumbers* moving = velocity ? &row_of<6>(*velocity, "handle_velocity") : nullptr;
    require_start();
    require_idle();
    Evolving next = moment_->evolving;  // if a pose is invalid, nothing has happened
    Frame frame;
    if (!advance(next, handle, moving, frame)) check_done(0, "world_from_handle", kNoPose);
    moment_->evolving = next;
    moment_->statistics.count(frame);
    py::array_t<FrameRow> rows(1);
    *rows.mutable_data() = row_of_frame(frame, simulation());
    return py::reinterpret_steal<py::object>(PySequence_GetItem(rows.ptr(), 0));
  }

  py::array run(const Doubles& world_from_handle, const std::optional<Doubles>& velocity) {
    const auto handles = rows_of<7>(world_from_handle, "world_from_handle");
    std::span<const VelocityNumbers> velocities;
    if (velocity) velocities = rows_of<6>(*velocity, "handle_velocity");
    if (velocity && velocities.size() != handles.size()) {
      throw Failure({ErrorCode::kUsage, "", "handle_velocity",
                     "has " + std::to_string(velocities.size()) + " rows for " +
                         std::to_string(handles.size()) + " poses",
                     ""});
    }
    require_start();
    require_idle();
    auto rows = empty_rows<FrameRow>(handles.size());
    FrameRow* const out = rows.mutable_data();
    auto next = std::make_shared<Moment>(*moment_);  // if a pose is invalid, nothing has happened
    std::int64_t done = kAllDone;
    running_ = true;
    {
      const py::gil_scoped_release other_threads;
      done = frames(*next, handles, velocities, out);
    }
    running_ = false;
    check_done(done, "world_from_handle", kNoPose);
    moment_ = std::move(next);
    return rows;
  }

  std::shared_ptr<Moment> moment() const {
    require_start();
    return std::make_shared<Moment>(*moment_);
  }
  void set_moment(const Moment& moment) {
    if (moment.of != this) {
      throw Failure({ErrorCode::kUsage, "", "moment", "belongs to another simulation", ""});
    }
    require_idle();
    moment_ = std::make_shared<Moment>(moment);
  }

  py::dict report() const {
    require_start();
    return report_of(*scene_, moment_->statistics, run_.parameters().rate_hz);
  }

  PoseNumbers world_from_part() const {
    require_start();
    return pose_numbers(simulation().world_from_part(moment_->evolving.state.world_from_center));
  }

  std::map<std::string, double> parameters() const {
    std::map<std::string, double> all;
    for (const ParameterInfo& info : parameter_table()) {
      all[std::string(info.name)] = run_.parameters().*(info.member);
    }
    all["rate_hz"] = run_.parameters().rate_hz;
    return all;
  }
  const Run& opened() const { return run_; }

 private:
  void require_start() const {
    if (moment_) return;
    throw Failure({ErrorCode::kUsage, "", "simulation", "has not been started",
                   "call start(world_from_part) first"});
  }
  // run() lets other threads go on, and what a signal calls.
  void require_idle() const {
    if (!running_) return;
    throw Failure({ErrorCode::kUsage, "", "simulation", "is running in another call",
                   "give each thread a simulation of its own"});
  }
  double dt_s() const { return 1 / run_.parameters().rate_hz; }
  model::Simulation& simulation() { return run_.simulation(); }
  const model::Simulation& simulation() const { return run_.simulation(); }

  // The next frame; false where `handle` is no pose, or `velocity` none. Without `velocity` it is
  // estimated.
  bool advance(Evolving& evolving, const PoseNumbers& handle, const VelocityNumbers* velocity,
               Frame& frame) {
    Pose pose = pose_from_numbers(handle);
    const double length = glm::length(pose.orientation);
    if (!std::isfinite(length) || !(length > 0)) return false;
    pose.orientation /= length;
    frame.number = evolving.state.frame;
    frame.time_s = static_cast<double>(frame.number) * dt_s();
    frame.input.world_from_handle = pose;
    frame.input.valid = kInputValid;
    if (velocity == nullptr) {
      frame.input.handle_velocity = evolving.velocity.update(pose, dt_s());
    } else {
      const VelocityNumbers& v = *velocity;
      frame.input.handle_velocity = {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
    }
    frame.result = simulation().step(evolving.state, frame.input, dt_s());
    return (frame.result.report.faults & kFaultNonFiniteInput) == 0;
  }

  std::int64_t frames(Moment& moment, std::span<const PoseNumbers> handles,
                      std::span<const VelocityNumbers> velocities, FrameRow* out) {
    Frame frame;
    for (std::size_t i = 0; i < handles.size(); ++i) {
      if (i % kFramesBetweenAsking == kFramesBetweenAsking - 1 && !nobody_interrupts()) {
        return kStopped;
      }
      if (!advance(moment.evolving, handles[i], velocities.empty() ? nullptr : &velocities[i],
                   frame)) {
        return static_cast<std::int64_t>(i);
      }
      moment.statistics.count(frame);
      out[i] = row_of_frame(frame, simulation());
    }
    return kAllDone;
  }

  std::shared_ptr<Scene> scene_;
  std::shared_ptr<Part> part_;
  Run run_;
  std::shared_ptr<Moment> moment_;
  bool running_ = false;  // read and written under the interpreter lock
};

// forcelayer.Replay.
struct Replay {
  py::array frames;
  py::dict report;
};

namespace {

// Ends a replay.
struct Interrupted {};

// The number of the first frame with another outcome than was recorded; none where all have it.
std::optional<std::size_t> replay_frames(model::Simulation& simulation,
                                         const stream::Recording& recording,
                                         loop::LoopStatistics& statistics, FrameRow* out) {
  std::optional<std::size_t> first_difference;
  Frame frame;
  stream::replay_steps(recording, simulation, [&](const stream::ReplayedStep& step) {
    const std::size_t i = frame.number;
    if (i % kFramesBetweenAsking == kFramesBetweenAsking - 1 && !nobody_interrupts()) {
      throw Interrupted();
    }
    frame.time_s = step.time_s;
    frame.input = step.input;
    frame.result = step.result;
    statistics.count(frame);
    out[i] = row_of_frame(frame, simulation);
    const bool same =
        model::outcome_hash(step.result, step.state) == recording.frames()[i].outcome_hash;
    if (!same && !first_difference) first_difference = i;
    ++frame.number;
  });
  return first_difference;
}

Replay replay(const Scene& scene, const Part& part, const std::filesystem::path& path) {
  const stream::Recording recording = take(stream::Recording::open(path));
  const auto simulation =
      take(stream::recorded_simulation(recording, same_map(scene), same_shell(part)));
  const auto statistics = std::make_unique<loop::LoopStatistics>();
  auto rows = empty_rows<FrameRow>(recording.frames().size());
  std::optional<std::size_t> differing;
  try {
    const py::gil_scoped_release other_threads;
    differing = replay_frames(*simulation, recording, *statistics, rows.mutable_data());
  } catch (const Interrupted&) {
    throw py::error_already_set();
  }
  if (differing) throw Failure(stream::outcome_differs(path.string(), *differing));
  return {rows, report_of(scene, *statistics, simulation->parameters().rate_hz)};
}

RunRequest request_of(const std::string& model, const std::optional<std::string>& force,
                      double rate_hz, const std::map<std::string, double>& settings,
                      bool without_guarantee) {
  RunRequest request;
  request.device.name = "the simulated device";
  const auto known = parse_model(model);
  if (!known) {
    throw Failure({ErrorCode::kUsage, "", "model", "'" + model + "' is not a model",
                   "use 'default' or 'paper'"});
  }
  request.model = *known;
  if (force) {
    request.force = parse_force(*force);
    if (!request.force) {
      throw Failure({ErrorCode::kUsage, "", "force", "'" + *force + "' is not a force field",
                     "use 'tangent-plane', 'level' or 'distance'"});
    }
  }
  request.rate_hz = rate_hz;
  request.settings = settings;
  request.without_guarantee = without_guarantee;
  return request;
}

py::dict guarantee_of(const SeparationGuarantee& guarantee) {
  py::dict d;
  d["tested_m"] = guarantee.tested_m;
  d["swept_m"] = guarantee.swept_m;
  return d;
}

}  // namespace

void bind_simulation(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(FrameRow, t_s, world_from_handle, world_from_part, force_n, torque_nm,
                       clearance_m, depth_m, nearest_point_m, nearest_object, interior, surface,
                       proximity, contacts, guard_cuts, barred, seated, faults, measured,
                       outside_map, seat_open, saturated);

  py::class_<Moment, std::shared_ptr<Moment>>(module, "Moment", R"(A saved state of a simulation.

Read it from Simulation.moment, and assign it there to go back to that state.

>>> simulation = forcelayer.Simulation(forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell"))
>>> simulation.start([0.2, 0.15, 0.3, 1, 0, 0, 0])
>>> isinstance(simulation.moment, forcelayer.Moment)
True
)");

  py::class_<Stepper>(module, "Simulation", R"(A part in a scene, moved by a hand, frame by frame.

`model`: "default", or "paper" for the method of 1999. `force`: "distance", "level" or
"tangent-plane"; None for the best that the scene's file allows. `settings`: a dict of physical
parameters, named as in `parameters`. Parameters not given are derived from voxel size, part and
rate. Files without a guarantee of separation are refused, unless `without_guarantee` is set.

The hand holds a simulated device of 15 N and 0.1 N m, as in the paper.

A frame lasts 1 / rate_hz seconds, whatever the clock says: the outcome depends on the arguments
alone, to the last bit.

>>> scene, part = forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell")
>>> simulation = forcelayer.Simulation(scene, part, settings={"mass_kg": 0.05})
>>> simulation.start([0.2, 0.15, 0.3, 1, 0, 0, 0])
>>> frame = simulation.step([0.2, 0.15, 0.2999, 1, 0, 0, 0])
>>> frame["force_n"].tolist()  # free space has no force
[0.0, 0.0, 0.0]
>>> forcelayer.Simulation(scene, part, model="fast")
Traceback (most recent call last):
forcelayer.Error: model: 'fast' is not a model; use 'default' or 'paper'
)")
      .def(py::init([](Scene& scene, Part& part, const std::string& model,
                       const std::optional<std::string>& force, double rate_hz,
                       const std::map<std::string, double>& settings, bool without_guarantee) {
             return std::make_unique<Stepper>(
                 scene, part, request_of(model, force, rate_hz, settings, without_guarantee));
           }),
           given("scene"), given("part"), py::kw_only(), given("model") = "default",
           py::arg("force") = py::none(), given("rate_hz") = 1000.0,
           given("settings") = std::map<std::string, double>{}, given("without_guarantee") = false)
      .def("start", &Stepper::start, given("world_from_part"),
           py::arg("world_from_handle") = py::none(), py::arg("world_from_seat") = py::none(),
           R"(Places the part at rest, without force in the hand. Frames are counted from here on.

Poses are x y z (meters) and a quaternion qw qx qy qz. Without `world_from_handle`, the handle's
pose is the part's pose. A part that touches objects at `world_from_seat` (default:
`world_from_part`) is installed there: it may touch these objects until it has left them.

>>> simulation = forcelayer.Simulation(forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell"))
>>> simulation.start([0.2, 0.15, 0.3, 0, 0, 0, 0])
Traceback (most recent call last):
forcelayer.Error: world_from_part: is not a pose; give finite x, y, z (m) and a nonzero quaternion
)")
      .def("step", &Stepper::step, given("world_from_handle"),
           py::arg("handle_velocity") = py::none(),
           R"(Runs one frame: moves the hand, then the part.

`handle_velocity`: linear (m/s) and angular (rad/s), six numbers, world axes; None: estimated from
the poses, as for a device that does not sense velocity. Returns a row of run()'s array.

>>> simulation = forcelayer.Simulation(forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell"))
>>> simulation.step([0, 0, 0, 1, 0, 0, 0])
Traceback (most recent call last):
forcelayer.Error: simulation: has not been started; call start(world_from_part) first
)")
      .def("run", &Stepper::run, given("world_from_handle"),
           py::arg("handle_velocity") = py::none(),
           R"(Runs many frames. Takes the poses of the hand, shape (n, 7), one for each frame.

Returns a structured array with a row for each frame:

    t_s                 time since start()
    world_from_handle, world_from_part   x y z qw qx qy qz
    force_n, torque_nm  on the hand, in world axes; torque about the part's centroid (but the
                        report's "max_torque_nm" about the handle)
    clearance_m, measured, nearest_object, nearest_point_m   as in Scene.clearance()
    depth_m             depth of the deepest contact
    interior, surface, proximity, contacts, barred, seated   numbers of points
    guard_cuts          number of motions that the guard shortened
    faults              0: the frame has no fault; otherwise a sum of fault bits
    outside_map         True: a point lies beyond a side at which the scene was cropped
    seat_open           True: the part has not left its seat
    saturated           True: the virtual coupling is at its limit

If a pose is invalid, the simulation does not change. Other Python threads run meanwhile.

>>> import numpy
>>> simulation = forcelayer.Simulation(forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell"))
>>> simulation.start([0.2, 0.15, 0.3, 1, 0, 0, 0])
>>> path = numpy.tile([0.2, 0.15, 0.3, 1, 0, 0, 0], (100, 1))
>>> path[:, 2] -= numpy.linspace(0, 0.01, 100)
>>> frames = simulation.run(path)
>>> bool(frames["world_from_part"][-1, 2] < 0.3)
True
)")
      .def_property("moment", &Stepper::moment, &Stepper::set_moment,
                    R"(The complete state of the simulation. Assign a saved state to return to it.

>>> simulation = forcelayer.Simulation(forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell"))
>>> simulation.start([0.2, 0.15, 0.3, 1, 0, 0, 0])
>>> before = simulation.moment
>>> first = simulation.step([0.2, 0.15, 0.29, 1, 0, 0, 0])
>>> simulation.moment = before
>>> first.tobytes() == simulation.step([0.2, 0.15, 0.29, 1, 0, 0, 0]).tobytes()
True
)")
      .def_property_readonly(
          "report", &Stepper::report,
          R"(The report of the run since start(): a dict with the keys of `voxrun --json`;
docs/voxrun_report.md in the sources explains them.

"max_torque_nm" is a torque about the handle. A frame's "torque_nm" is about the part's centroid.
The two torques differ by the force times the arm from the handle to the centroid.

>>> simulation = forcelayer.Simulation(forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell"))
>>> simulation.start([0.2, 0.15, 0.3, 1, 0, 0, 0])
>>> simulation.report["frames"], simulation.report["penetration_frames"]
(0, 0)
)")
      .def_property_readonly("world_from_part", &Stepper::world_from_part,
                             R"(Where the part is: x y z qw qx qy qz.

>>> simulation = forcelayer.Simulation(forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell"))
>>> simulation.start([0.2, 0.15, 0.3, 1, 0, 0, 0])
>>> [round(x, 6) for x in simulation.world_from_part[:3]]
[0.2, 0.15, 0.3]
)")
      .def_property_readonly("parameters", &Stepper::parameters,
                             R"(The physical parameters in use, by name. A name ends with the unit.

>>> simulation = forcelayer.Simulation(forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell"))
>>> simulation.parameters["rate_hz"]
1000.0
)")
      .def_property_readonly(
          "reasons", [](const Stepper& s) { return s.opened().reasons(); },
          R"(A dict from parameter names to the rules that chose the values.

>>> scene, part = forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell")
>>> forcelayer.Simulation(scene, part, settings={"mass_kg": 0.05}).reasons["mass_kg"]
'set'
)")
      .def_property_readonly(
          "warnings", [](const Stepper& s) { return s.opened().warnings(); },
          R"(The warnings that `voxrun` would print.

>>> forcelayer.Simulation(forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell")).warnings
[]
)")
      .def_property_readonly(
          "guarantee", [](const Stepper& s) { return guarantee_of(s.opened().guarantee()); },
          R"(The distance in meters that is guaranteed between the exact surfaces.

A dict: "tested_m" is guaranteed in every frame, "swept_m" also between two frames. A value is None
if nothing is guaranteed. Nothing is guaranteed before "guarantee_from_s" of `report`, nor in frames
counted there as "penetration_frames", "barred_frames" or "outside_map_frames".

>>> simulation = forcelayer.Simulation(forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell"))
>>> simulation.guarantee["tested_m"] > simulation.guarantee["swept_m"] > 0
True
)");

  py::class_<Replay>(module, "Replay", R"(The result of replay().

>>> scene, part = forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell")
>>> forcelayer.replay(scene, part, "run.flr").frames.ndim
1
)")
      .def_readonly("frames", &Replay::frames, R"(A row for each frame, as from Simulation.run().

>>> scene, part = forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell")
>>> bool(forcelayer.replay(scene, part, "run.flr").frames["t_s"][0] == 0)
True
)")
      .def_readonly("report", &Replay::report,
                    R"(A dict with the keys of `voxrun --json`, like Simulation.report.

>>> scene, part = forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell")
>>> forcelayer.replay(scene, part, "run.flr").report["penetration_frames"]
0
)");

  module.def("replay", &replay, given("scene"), given("part"), given("recording"),
             R"(Repeats a recorded run (`voxrun --record FILE`) bit for bit.

The files must be those of the run. An outcome that differs from the recorded one is an error.
Other Python threads run meanwhile.

>>> scene, part = forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell")
>>> run = forcelayer.replay(scene, part, "run.flr")
>>> len(run.frames) == run.report["frames"]
True
>>> forcelayer.replay(scene, part, "bay.vox")
Traceback (most recent call last):
forcelayer.Error: bay.vox: header: is not a recording of voxrun; record the run again
)");
}

}  // namespace forcelayer::python
