#include "forcelayer/run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "formats/guard.h"
#include "runtime/loop/input_source.h"
#include "runtime/loop/loop_statistics.h"
#include "runtime/loop/servo.h"
#include "runtime/machine/real_time.h"
#include "runtime/machine/step_arithmetic.h"
#include "runtime/model/simulation.h"
#include "runtime/run/baked_files.h"
#include "runtime/run/derive_parameters.h"
#include "runtime/run/limits.h"
#include "runtime/run/separation.h"
#include "runtime/run/start_check.h"

namespace forcelayer {
namespace {

constexpr double kSizeRatioWarning = 100;  // units are the likely cause

// The pose with its quaternion made unit.
Result<Pose> checked_pose(Pose pose, const char* name) {
  const glm::dvec3& p = pose.position_m;
  const double length = glm::length(pose.orientation);
  if (glm::length(p) <= kFarthestM && std::isfinite(length) && length > 0) {
    pose.orientation /= length;
    return pose;
  }
  return Error{ErrorCode::kUsage, "", name, "is not a pose",
               "give a position of at most 1e9 m, and a quaternion that is not zero"};
}

Result<PartStart> checked_start(PartStart start) {
  const std::pair<std::optional<Pose>*, const char*> poses[] = {
      {&start.world_from_part, "world_from_part"},
      {&start.world_from_seat, "world_from_seat"},
      {&start.handle_from_part, "handle_from_part"}};
  for (const auto& [pose, name] : poses) {
    if (!*pose) continue;
    const auto checked = checked_pose(**pose, name);
    if (!checked) return checked.error();
    *pose = *checked;
  }
  return start;
}

// Whether a run can begin with this reading.
Status check_first_reading(const DeviceSample& first, const DeviceCapabilities& device) {
  if (!loop::is_pose(first.device_from_handle)) {
    return Error{ErrorCode::kUsage, "", "device_from_handle", "is not a pose",
                 "give finite x, y, z (m) and a quaternion of length 1"};
  }
  if (!first.present || !first.calibrated) {
    return Error{ErrorCode::kDeviceRefused, "", device.name,
                 first.present ? "is not calibrated" : "does not answer",
                 first.present ? "calibrate it and start again" : "check plug and power"};
  }
  return loop::check_workspace(device, first.device_from_handle);
}

void warn_of_sizes(const Voxmap& voxmap, const Pshell& shell, std::vector<std::string>& warnings) {
  const VoxmapHeader& map = voxmap.header();
  const PshellHeader& part = shell.header();
  if (part.covering_radius_m > map.voxel_size_m * std::sqrt(3.0) / 2 * 1.000001) {
    warnings.push_back(
        "the shell is coarser than the scene's voxels: small features may pass between the shell's "
        "points");
  }
  double extent_m = 0;
  for (const std::uint64_t dim : map.dims_voxels) {
    extent_m = std::max(extent_m, static_cast<double>(dim) * map.voxel_size_m);
  }
  const double part_m = 2 * part.bounding_radius_m;
  if (extent_m > 0 && part_m > 0 &&
      (part_m > kSizeRatioWarning * extent_m || extent_m > kSizeRatioWarning * part_m)) {
    warnings.push_back(
        "scene and part differ more than a hundredfold in size: check the units of both");
  }
}

// A scene and a part, ready to be stepped.
struct OpenedFiles {
  std::unique_ptr<model::Simulation> simulation;
  std::map<std::string, std::string> reasons;
  std::vector<std::string> warnings;
  SeparationGuarantee guarantee;
};

// The request's parameters: derived, unless they are those of a recording.
Result<Parameters> choose_parameters(const RunRequest& request, const Voxmap& voxmap,
                                     const Pshell& shell, OpenedFiles& opened) {
  if (request.recorded) return *request.recorded;
  if (request.device.actuated_axes == 0) {
    opened.warnings.push_back(request.device.name + " has no motors: no force will be felt");
  }
  auto derived = derive_parameters(request, voxmap, shell);
  if (!derived) return derived.error();
  opened.reasons = std::move(derived->reasons);
  opened.warnings.insert(opened.warnings.end(), derived->warnings.begin(), derived->warnings.end());
  return derived->values;
}

Result<OpenedFiles> prepare(Voxmap voxmap, Pshell shell, const RunRequest& request) {
  OpenedFiles opened;
  warn_of_sizes(voxmap, shell, opened.warnings);
  const auto parameters = choose_parameters(request, voxmap, shell, opened);
  if (!parameters) return parameters.error();
  query::QueryOptions query;
  query.threads = request.threads;
  auto simulation =
      model::Simulation::create(std::move(voxmap), std::move(shell), *parameters, query);
  if (!simulation) return simulation.error();
  opened.simulation = std::move(*simulation);
  const VoxmapHeader& scene = opened.simulation->voxmap().header();
  const PshellHeader& part = opened.simulation->shell().header();
  const double pose_error_m = opened.simulation->query().rounding_bound_m();
  const bool guarded =
      parameters->model == Model::kDefault && parameters->force == ForceKind::kDistance;
  const DistanceGuard guard{guarded ? guard_distance_m(scene) : 0,
                            opened.simulation->shell().surface_distance_terms()};
  opened.guarantee = separation_guarantee(scene, part, pose_error_m, guard);
  opened.simulation->set_guaranteed_m(opened.guarantee.tested_m.value_or(0));
  if (!request.without_guarantee) {
    const Status ensured =
        require_guarantee(scene, part, pose_error_m, guard, request.part.string());
    if (!ensured) return ensured.error();
  }
  return opened;
}

Result<OpenedFiles> open_files(const RunRequest& request) {
  auto voxmap = open_scene(request.scene, request.expected_sha256);
  if (!voxmap) return voxmap.error();
  auto shell = open_part(request.part, request.expected_sha256);
  if (!shell) return shell.error();
  return prepare(std::move(*voxmap), std::move(*shell), request);
}

// A device whose readings are handed over with each step.
class HandedOverDevice final : public devices::Device {
 public:
  explicit HandedOverDevice(const DeviceCapabilities& device) : capabilities_(device) {}
  const DeviceCapabilities& capabilities() const override { return capabilities_; }
  Status start() override { return {}; }
  DeviceSample read(double) noexcept override { return reading; }
  void write(const Wrench& device_wrench) noexcept override { wrench = device_wrench; }
  void stop() noexcept override { wrench = {}; }

  DeviceSample reading;
  Wrench wrench;

 private:
  DeviceCapabilities capabilities_;
};

// The separation that was shown for the pose of the last frame.
class ShownSeparation {
 public:
  void see(const Frame& frame, double guaranteed_m) noexcept {
    const StepReport& report = frame.result.report;
    constexpr std::uint32_t kHeld =
        kFaultInvalidInput | kFaultNonFiniteInput | kFaultNonFiniteState;
    if ((report.faults & ~kHeld) != 0) {
      shown_m_ = 0;
    } else if (frame.input.valid == kInputClutched || report.faults != 0) {
      // No point was looked up: the counts say nothing.
      const Pose& pose = report.world_from_center;
      const bool same = frame.scene == scene_ && pose.position_m == tested_.position_m &&
                        pose.orientation == tested_.orientation;
      if (!same) shown_m_ = 0;
    } else {
      const bool holds =
          report.interior + report.outside_map + report.barred + report.seat_open + report.seated ==
          0;
      shown_m_ = holds ? guaranteed_m : 0;
      tested_ = report.world_from_center;
      scene_ = frame.scene;
    }
  }
  double shown_m() const noexcept { return shown_m_; }

 private:
  double shown_m_ = 0;
  Pose tested_;
  std::uint32_t scene_ = 0;
};

// The servo of a run between two calls of start().
struct StartedServo {
  StartedServo(model::Simulation& simulation, const RunRequest& request, const State& start)
      : device(request.device),
        input(device, request.placement, input_limits(request)),
        servo(simulation, input, start, output_limits(request, simulation.parameters())),
        stale_s(request.stale_s) {}

  Wrench step(const DeviceSample& reading) noexcept {
    const long long now_ns = machine::monotonic_ns();
    const double late_s = static_cast<double>(now_ns - last_ns) / 1e9 - servo.dt_s();
    if (last_ns != 0 && late_s > stale_s) servo.note_late();
    last_ns = now_ns;
    device.reading = reading;
    const bool helped = servo.wants_helpers();
    if (helped) servo.wake_helpers();
    servo.tick(frame);
    if (helped) servo.rest_helpers();
    separation.see(frame, servo.simulation().guaranteed_m());
    statistics.count(frame);
    return device.wrench;
  }

  HandedOverDevice device;
  loop::DeviceInput input;
  loop::Servo servo;
  loop::LoopStatistics statistics;
  ShownSeparation separation;
  Frame frame;
  double stale_s;
  long long last_ns = 0;  // when the last step began
};

}  // namespace

struct Run::Parts {
  RunRequest request;
  OpenedFiles current;
  std::optional<OpenedFiles> next;  // of a swap; in use as well once the servo has taken it
  std::unique_ptr<StartedServo> started;

  // Frees the files that `next` replaced.
  void finish_swap() {
    if (!next) return;
    current = std::move(*next);
    next.reset();
  }
};

Run::Run(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Run::Run(Run&&) noexcept = default;
Run& Run::operator=(Run&&) noexcept = default;
Run::~Run() = default;

const Parameters& Run::parameters() const { return simulation().parameters(); }
const std::map<std::string, std::string>& Run::reasons() const { return parts_->current.reasons; }
const std::vector<std::string>& Run::warnings() const { return parts_->current.warnings; }
const SeparationGuarantee& Run::guarantee() const { return parts_->current.guarantee; }
model::Simulation& Run::simulation() { return *parts_->current.simulation; }
const model::Simulation& Run::simulation() const { return *parts_->current.simulation; }
std::unique_ptr<model::Simulation> Run::release_simulation() {
  parts_->started.reset();
  return std::move(parts_->current.simulation);
}

Status Run::start(const PartStart& start, const DeviceSample& first) {
  const machine::StepArithmetic arithmetic;
  Parts& parts = *parts_;
  const auto checked = checked_start(start);
  if (!checked) return checked.error();
  if (Status s = check_first_reading(first, parts.request.device); !s) return s;
  parts.started.reset();
  parts.finish_swap();  // one that nobody waits for any more: the user wants what it brings
  const Pose world_from_handle =
      parts.request.placement.world_from_handle(loop::made_unit(first.device_from_handle));
  const auto state = simulation().begin(*checked, world_from_handle);
  if (!state) return state.error();
  if (!parts.request.without_guarantee) {
    if (Status s = check_start(simulation(), state->world_from_center); !s) return s;
  }
  parts.started = std::make_unique<StartedServo>(simulation(), parts.request, *state);
  return {};
}

bool Run::started() const { return parts_->started != nullptr; }

Wrench Run::step(const DeviceSample& reading) noexcept {
  return started() ? parts_->started->step(reading) : Wrench{};
}

const Frame& Run::frame() const {
  static const Frame none;
  return started() ? parts_->started->frame : none;
}

double Run::guaranteed_m() const noexcept {
  return started() ? parts_->started->separation.shown_m() : 0;
}

Pose Run::world_from_part() const {
  if (!started()) return {};
  const loop::Servo& servo = parts_->started->servo;
  const bool stepped = parts_->started->statistics.frames > 0;
  return servo.simulation().world_from_part(stepped ? frame().result.report.world_from_center
                                                    : servo.state().world_from_center);
}

void Run::set_clutch(bool pressed) noexcept {
  if (started()) parts_->started->servo.set_clutch(pressed);
}

Status Run::swap(const std::filesystem::path& scene, const std::filesystem::path& part,
                 const PartStart& start, double timeout_s) {
  const machine::StepArithmetic arithmetic;
  Parts& parts = *parts_;
  const auto checked = checked_start(start);
  if (!checked) return checked.error();
  if (!started()) {
    return Error{ErrorCode::kUsage, "", "swap", "the run has not been started",
                 "start the run first"};
  }
  loop::Servo& servo = parts.started->servo;
  if (servo.swapping()) {
    return Error{ErrorCode::kUsage, "", "swap", "the files of an earlier swap are not in use yet",
                 "try again when they are in use"};
  }
  parts.finish_swap();  // one that timed out, and was taken since
  RunRequest request = parts.request;
  request.scene = scene;
  request.part = part;
  request.recorded.reset();
  auto opened = open_files(request);
  if (!opened) return opened.error();
  parts.next = std::move(*opened);
  model::Simulation& next = *parts.next->simulation;
  // Where the hand decides the place, it is not known yet, and the part has no seat there.
  const auto& seat = checked->world_from_seat ? checked->world_from_seat : checked->world_from_part;
  Status sound = seat ? next.find_seat(next.world_from_center(*seat)) : Status{};
  if (sound && checked->world_from_part && !request.without_guarantee) {
    sound = check_start(next, next.world_from_center(*checked->world_from_part));
  }
  if (!sound) {
    parts.next.reset();
    return sound.error();
  }
  if (!servo.request_swap(next, *checked)) {
    parts.next.reset();
    return Error{ErrorCode::kUsage, "", "swap", "the rate must stay the same", ""};
  }
  const long long until_ns = machine::monotonic_ns() + static_cast<long long>(timeout_s * 1e9);
  while (servo.swapping()) {
    if (machine::monotonic_ns() > until_ns) {
      return Error{ErrorCode::kDeviceFailed, "", "swap",
                   "the servo thread has not taken the new files yet",
                   "call step() once in each period"};
    }
    machine::sleep_until_ns(machine::monotonic_ns() + 1'000'000);
  }
  parts.finish_swap();
  return {};
}

RunStatistics Run::statistics() const {
  RunStatistics out;
  if (!started()) return out;
  const loop::LoopStatistics& seen = parts_->started->statistics;
  out.frames = seen.frames;
  out.force_layer_frames = seen.force_layer_frames;
  out.contact_frames = seen.contact_frames;
  out.penetration_frames = seen.penetration_frames;
  out.outside_map_frames = seen.outside_map_frames;
  out.seated_frames = seen.seated_frames;
  out.guarantee_from_s = seen.guarantee_from_s;
  out.guard_cuts = seen.guard_cuts;
  out.saturated_frames = seen.saturated_frames;
  out.faulty_frames = seen.faulty_frames;
  out.trips = parts_->started->servo.output().trips();
  out.max_force_n = seen.max_device_force_n;
  out.max_torque_nm = seen.max_device_torque_nm;
  out.generated_j = seen.generated_j;
  out.min_clearance_kind = seen.min_clearance.kind;
  out.min_clearance_m = seen.min_clearance.clearance_m;
  out.min_clearance_s = seen.min_clearance.time_s;
  const std::uint32_t before = parts_->started->servo.objects_before();
  const std::uint32_t object = seen.min_clearance.object;
  out.min_clearance_object = object > before ? object - before : 0;
  out.step_p50_ns = seen.step.quantile_ns(0.5);
  out.step_p99_ns = seen.step.quantile_ns(0.99);
  out.step_max_ns = seen.step.max_ns();
  return out;
}

std::string_view Run::object_name(std::uint32_t object) const {
  return simulation().voxmap().object_name(object);
}

std::vector<std::string> Run::make_real_time() {
  std::vector<std::string> warnings = machine::lock_memory();
  for (const auto& more :
       {machine::take_real_time_priority(), simulation().give_helpers_real_time_priority()}) {
    warnings.insert(warnings.end(), more.begin(), more.end());
  }
  return warnings;
}

DeviceCapabilities default_device() {
  DeviceCapabilities device;
  device.name = "the device";
  device.max_force_n = 15;
  device.max_torque_nm = 0.1;
  device.damping_ns_per_m = 2;
  device.damping_nms_per_rad = 0.005;
  device.delay_s = 0.001;
  device.hardware = true;
  return device;
}

RunRequest default_run_request(std::filesystem::path scene, std::filesystem::path part) {
  RunRequest request;
  request.scene = std::move(scene);
  request.part = std::move(part);
  return request;
}

Result<Run> open_run(const RunRequest& request) {
  auto voxmap = open_scene(request.scene, request.expected_sha256);
  if (!voxmap) return voxmap.error();
  auto shell = open_part(request.part, request.expected_sha256);
  if (!shell) return shell.error();
  return open_run(std::move(*voxmap), std::move(*shell), request);
}

Result<Run> open_run(Voxmap scene, Pshell part, const RunRequest& request) {
  const machine::StepArithmetic arithmetic;
  if (Status s = check_numbers(request); !s) return s.error();
  auto parts = std::make_unique<Run::Parts>();
  parts->request = request;
  const auto world_from_device =
      checked_pose(request.placement.world_from_device, "world_from_device");
  if (!world_from_device) return world_from_device.error();
  parts->request.placement.world_from_device = *world_from_device;
  auto opened = prepare(std::move(scene), std::move(part), parts->request);
  if (!opened) return opened.error();
  parts->current = std::move(*opened);
  return Run(std::move(parts));
}

}  // namespace forcelayer
