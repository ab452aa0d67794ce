#include "forcelayer/forcelayer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>

#include "forcelayer/pose_datagram.h"
#include "runtime/loop/callback_servo.h"
#include "runtime/machine/map_loss.h"
#include "runtime/machine/real_time.h"
#include "runtime/machine/step_arithmetic.h"
#include "runtime/run/baked_files.h"
#include "runtime/run/derive_parameters.h"
#include "runtime/run/separation.h"

using namespace forcelayer;

struct forcelayer_runtime {
  DeviceCapabilities device;
  DevicePlacement placement;
  double rate_hz = 1000;
  InputLimits input_limits;
  bool without_guarantee = false;
  double max_speed_mps = 5;
  std::unique_ptr<Simulation> simulation, next;
  std::unique_ptr<CallbackServo> servo;
};

namespace {

Pose pose_from(const double numbers[7]) {
  std::array<double, 7> n{};
  std::copy_n(numbers, 7, n.begin());
  return pose_from_numbers(n);
}

// The pose that `numbers` are, of whatever length its quaternion is.
Result<Pose> checked_pose(const double numbers[7], const char* name) {
  Pose pose = pose_from(numbers);
  const glm::dvec3& p = pose.position_m;
  const double length = glm::length(pose.orientation);
  if (std::isfinite(p.x + p.y + p.z) && std::isfinite(length) && length > 0) {
    pose.orientation /= length;
    return pose;
  }
  return Error{ErrorCode::kUsage, "", name, "is no pose", "give x y z in metres and qw qx qy qz"};
}

// The start of a part; NULL: not given.
Result<PartStart> checked_start(const double* world_from_part, const double* handle_from_part) {
  PartStart start;
  if (world_from_part != nullptr) {
    const auto pose = checked_pose(world_from_part, "world_from_part");
    if (!pose) return pose.error();
    start.world_from_part = *pose;
  }
  if (handle_from_part != nullptr) {
    const auto pose = checked_pose(handle_from_part, "handle_from_part");
    if (!pose) return pose.error();
    start.handle_from_part = *pose;
  }
  return start;
}

void put(const glm::dvec3& v, double* out) {
  for (int axis = 0; axis < 3; ++axis) out[axis] = v[axis];
}

glm::dvec3 vector_from(const double* v) { return {v[0], v[1], v[2]}; }

void report(const std::string& line, char* error, size_t error_bytes) {
  if (error == nullptr || error_bytes == 0) return;
  const size_t length = std::min(line.size(), error_bytes - 1);
  std::memcpy(error, line.data(), length);
  error[length] = 0;
}

DeviceSample sample_from(const forcelayer_reading& r) {
  DeviceSample sample;
  sample.device_from_handle = pose_from(r.device_from_handle);
  sample.velocity = {vector_from(r.linear_mps), vector_from(r.angular_radps)};
  sample.buttons = r.buttons;
  sample.fresh = r.fresh != 0;
  sample.present = r.present != 0;
  sample.calibrated = r.calibrated != 0;
  return sample;
}

Result<std::unique_ptr<Simulation>> load(const forcelayer_runtime& runtime, const char* scene,
                                         const char* part) {
  auto voxmap = open_scene(scene);
  if (!voxmap) return voxmap.error();
  auto shell = open_part(part);
  if (!shell) return shell.error();
  ParameterRequest request;
  request.force = usual_force(request.model, *voxmap);
  request.rate_hz = runtime.rate_hz;
  request.motion_scale = runtime.placement.motion_scale;
  const auto derived = derive_parameters(request, *voxmap, *shell, runtime.device);
  if (!derived) return derived.error();
  auto simulation = Simulation::create(std::move(*voxmap), std::move(*shell), derived->values);
  if (!simulation || runtime.without_guarantee) return simulation;
  const auto guarantee =
      separation_guarantee((*simulation)->voxmap().header(), (*simulation)->shell().header(),
                           (*simulation)->query().rounding_bound_m());
  if (Status s = require_guarantee(guarantee, part, "set without_guarantee"); !s) return s.error();
  return simulation;
}

// Runs what may fail or throw, on a host's thread; 0 on success.
template <typename Body>
int guarded(char* error, size_t error_bytes, const Body& body) {
  const StepArithmetic arithmetic;
  try {
    const Status done = body();
    if (done) return 0;
    report(to_line(done.error()), error, error_bytes);
  } catch (const std::exception& failure) {
    report(failure.what(), error, error_bytes);
  }
  return 1;
}

Status take_options(const forcelayer_options& o, forcelayer_runtime& runtime) {
  const bool sound = o.rate_hz > 0 && o.max_force_n >= 0 && o.max_torque_nm >= 0 &&
                     o.motion_scale > 0 && o.stale_s > 0 && o.max_speed_mps > 0;
  if (!sound) {
    return Error{ErrorCode::kUsage, "", "options", "have a number out of its range",
                 "begin with forcelayer_default_options()"};
  }
  DeviceCapabilities& d = runtime.device;
  d.name = "the device";
  d.max_force_n = o.max_force_n;
  d.max_torque_nm = o.max_torque_nm;
  d.max_stiffness_n_per_m = o.max_stiffness_n_per_m;
  d.max_stiffness_nm_per_rad = o.max_stiffness_nm_per_rad;
  d.damping_ns_per_m = o.damping_ns_per_m;
  d.damping_nms_per_rad = o.damping_nms_per_rad;
  d.delay_s = o.delay_s;
  d.workspace_radius_m = o.workspace_radius_m;
  d.senses_velocity = o.senses_velocity != 0;
  d.hardware = true;
  const auto world_from_device = checked_pose(o.world_from_device, "world_from_device");
  if (!world_from_device) return world_from_device.error();
  runtime.placement = {*world_from_device, o.motion_scale};
  runtime.rate_hz = o.rate_hz;
  runtime.without_guarantee = o.without_guarantee != 0;
  runtime.input_limits.stale_s = o.stale_s;
  runtime.max_speed_mps = o.max_speed_mps;
  return {};
}

// A run does not begin with a reading that cannot be used.
Status check_first(const forcelayer_runtime& runtime, const forcelayer_reading& first) {
  const Pose pose = pose_from(first.device_from_handle);
  if (!is_pose(pose)) {
    return Error{ErrorCode::kUsage, "", "device_from_handle", "is no pose",
                 "give x y z in metres and qw qx qy qz of length 1"};
  }
  if (first.present == 0 || first.calibrated == 0) {
    return Error{ErrorCode::kDeviceRefused, "", "the first reading",
                 first.present == 0 ? "is of a device that does not answer"
                                    : "is of a device that is not calibrated",
                 "begin once it answers and is calibrated"};
  }
  return check_workspace(runtime.device, pose);
}

}  // namespace

void forcelayer_default_options(forcelayer_options* options) {
  *options = {};
  options->rate_hz = 1000;
  options->max_force_n = 15;
  options->max_torque_nm = 0.1;
  options->damping_ns_per_m = 2;
  options->damping_nms_per_rad = 0.005;
  options->delay_s = 0.001;
  options->world_from_device[3] = 1;
  options->motion_scale = 1;
  options->stale_s = OutputLimits{}.stale_s;
  options->max_speed_mps = OutputLimits{}.max_speed_mps;
}

forcelayer_runtime* forcelayer_open(const char* scene, const char* part,
                                    const forcelayer_options* options, char* error,
                                    size_t error_bytes) {
  std::unique_ptr<forcelayer_runtime> runtime;
  const int failed = guarded(error, error_bytes, [&]() -> Status {
    runtime = std::make_unique<forcelayer_runtime>();
    if (Status s = take_options(*options, *runtime); !s) return s;
    auto simulation = load(*runtime, scene, part);
    if (!simulation) return simulation.error();
    runtime->simulation = std::move(*simulation);
    return {};
  });
  return failed != 0 ? nullptr : runtime.release();
}

int forcelayer_start(forcelayer_runtime* runtime, const double world_from_part[7],
                     const double handle_from_part[7], const forcelayer_reading* first, char* error,
                     size_t error_bytes) {
  return guarded(error, error_bytes, [&]() -> Status {
    const auto start = checked_start(world_from_part, handle_from_part);
    if (!start) return start.error();
    if (Status usable = check_first(*runtime, *first); !usable) return usable;
    runtime->servo.reset();
    // A swap that nobody waited for any more: the user wants what it brings.
    if (runtime->next) runtime->simulation = std::move(runtime->next);
    OutputLimits limits = output_limits(runtime->simulation->parameters());
    limits.stale_s = runtime->input_limits.stale_s;
    limits.max_speed_mps = runtime->max_speed_mps;
    runtime->servo =
        std::make_unique<CallbackServo>(*runtime->simulation, runtime->device, runtime->placement,
                                        *start, sample_from(*first), limits, runtime->input_limits);
    return {};
  });
}

int forcelayer_step(forcelayer_runtime* runtime, const forcelayer_reading* reading,
                    forcelayer_result* result) {
  *result = {};
  result->world_from_part[3] = 1;
  if (runtime->servo == nullptr) return 1;
  const StepArithmetic arithmetic;
  const Wrench wrench = runtime->servo->call(sample_from(*reading));
  const Frame& frame = runtime->servo->frame();
  const StepReport& step = frame.result.report;
  put(wrench.force_n, result->force_n);
  put(wrench.torque_nm, result->torque_nm);
  const auto part =
      pose_numbers(runtime->servo->servo().simulation().world_from_part(step.world_from_center));
  std::copy(part.begin(), part.end(), result->world_from_part);
  result->output = static_cast<uint32_t>(frame.output);
  result->contacts = step.contacts;
  result->interior = step.interior;
  return 0;
}

void forcelayer_set_clutch(forcelayer_runtime* runtime, int pressed) {
  if (runtime->servo != nullptr) runtime->servo->servo().set_clutch(pressed != 0);
}

const char* forcelayer_last_trip(const forcelayer_runtime* runtime) {
  return to_text(runtime->servo != nullptr ? runtime->servo->frame().last_trip : TripCause::kNone);
}

int forcelayer_swap(forcelayer_runtime* runtime, const char* scene, const char* part,
                    const double world_from_part[7], const double handle_from_part[7],
                    double timeout_s, char* error, size_t error_bytes) {
  return guarded(error, error_bytes, [&]() -> Status {
    const auto start = checked_start(world_from_part, handle_from_part);
    if (!start) return start.error();
    if (runtime->servo == nullptr) {
      return Error{ErrorCode::kUsage, "", "forcelayer_swap", "before forcelayer_start()", ""};
    }
    Servo& servo = runtime->servo->servo();
    if (servo.swapping()) {
      return Error{ErrorCode::kUsage, "", "forcelayer_swap", "another swap is still waiting", ""};
    }
    // What a swap that timed out left behind is taken by now, and what it replaced is free.
    if (runtime->next) runtime->simulation = std::move(runtime->next);
    auto loaded = load(*runtime, scene, part);
    if (!loaded) return loaded.error();
    runtime->next = std::move(*loaded);
    if (!servo.request_swap(*runtime->next, *start)) {
      return Error{ErrorCode::kInternal, "", "forcelayer_swap", "is not possible now", ""};
    }
    const long long until_ns = monotonic_ns() + static_cast<long long>(timeout_s * 1e9);
    while (servo.swapping()) {
      if (monotonic_ns() > until_ns) {
        return Error{ErrorCode::kDeviceFailed, "", "forcelayer_swap",
                     "the servo thread has not taken it yet", "is forcelayer_step() called?"};
      }
      sleep_until_ns(monotonic_ns() + 1'000'000);
    }
    runtime->simulation = std::move(runtime->next);
    return {};
  });
}

void forcelayer_contain_map_loss(void) { contain_map_loss(); }

int forcelayer_check_files(void) { return check_mappings(); }

void forcelayer_close(forcelayer_runtime* runtime) { delete runtime; }
