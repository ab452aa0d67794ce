// The C interface: a Run behind a handle, its types as plain numbers.
#include "forcelayer/forcelayer.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>

#include "forcelayer/pose_datagram.h"
#include "forcelayer/run.h"
#include "formats/digest/file_digest.h"
#include "runtime/run/limits.h"

using namespace forcelayer;

struct forcelayer_runtime {
  Run run;
};

namespace {

Pose pose_from(const double numbers[7]) {
  std::array<double, 7> n{};
  std::copy_n(numbers, 7, n.begin());
  return pose_from_numbers(n);
}

// NULL: not given.
std::optional<Pose> optional_pose_from(const double* numbers) {
  if (numbers == nullptr) return {};
  return pose_from(numbers);
}

PartStart start_from(const double* world_from_part, const double* handle_from_part) {
  return {optional_pose_from(world_from_part), optional_pose_from(handle_from_part)};
}

glm::dvec3 vector_from(const double* v) { return {v[0], v[1], v[2]}; }

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

Result<Model> model_from(int model) {
  switch (model) {
    case FORCELAYER_MODEL_DEFAULT:
      return Model::kDefault;
    case FORCELAYER_MODEL_PAPER:
      return Model::kPaper;
    default:
      return Error{ErrorCode::kUsage, "", "model", "is not one of FORCELAYER_MODEL_...",
                   "take the options from forcelayer_default_options()"};
  }
}

Result<RunRequest> request_from(const char* scene, const char* part, const forcelayer_options& o) {
  const auto model = model_from(o.model);
  if (!model) return model.error();
  RunRequest request = default_run_request(scene, part);
  request.model = *model;
  request.rate_hz = o.rate_hz;
  DeviceCapabilities& device = request.device;
  device.max_force_n = o.max_force_n;
  device.max_torque_nm = o.max_torque_nm;
  device.max_stiffness_n_per_m = o.max_stiffness_n_per_m;
  device.max_stiffness_nm_per_rad = o.max_stiffness_nm_per_rad;
  device.damping_ns_per_m = o.damping_ns_per_m;
  device.damping_nms_per_rad = o.damping_nms_per_rad;
  device.delay_s = o.delay_s;
  device.workspace_radius_m = o.workspace_radius_m;
  device.senses_velocity = o.senses_velocity != 0;
  request.placement = {pose_from(o.world_from_device), o.motion_scale};
  request.stale_s = o.stale_s;
  request.max_speed_mps = o.max_speed_mps;
  request.max_turn_radps = o.max_turn_radps;
  request.without_guarantee = o.without_guarantee != 0;
  if (o.expected_sha256 != nullptr) {
    auto digests = digest::parse_digests(o.expected_sha256);
    if (!digests) return digests.error();
    request.expected_sha256 = std::move(*digests);
  }
  return request;
}

void put_vector(const glm::dvec3& v, double* out) {
  for (int axis = 0; axis < 3; ++axis) out[axis] = v[axis];
}

void put_pose(const Pose& pose, double* out) {
  const auto numbers = pose_numbers(pose);
  std::copy(numbers.begin(), numbers.end(), out);
}

void put_error(const std::string& line, char* error, size_t error_bytes) {
  if (error == nullptr || error_bytes == 0) return;
  const size_t length = std::min(line.size(), error_bytes - 1);
  std::memcpy(error, line.data(), length);
  error[length] = 0;
}

// Calls what may fail or throw, and writes down why it did. 0 on success.
template <typename Body>
int report_failure(char* error, size_t error_bytes, const Body& body) {
  try {
    const Status done = body();
    if (done) return 0;
    put_error(to_line(done.error()), error, error_bytes);
  } catch (const std::exception& failure) {
    put_error(failure.what(), error, error_bytes);
  }
  return 1;
}

}  // namespace

void forcelayer_default_options(forcelayer_options* options) {
  const RunRequest request;
  const DeviceCapabilities& device = request.device;
  *options = {};
  options->model = FORCELAYER_MODEL_DEFAULT;
  options->rate_hz = request.rate_hz;
  options->max_force_n = device.max_force_n;
  options->max_torque_nm = device.max_torque_nm;
  options->damping_ns_per_m = device.damping_ns_per_m;
  options->damping_nms_per_rad = device.damping_nms_per_rad;
  options->delay_s = device.delay_s;
  put_pose({}, options->world_from_device);
  options->motion_scale = request.placement.motion_scale;
  options->stale_s = request.stale_s;
  options->max_speed_mps = request.max_speed_mps;
  options->max_turn_radps = max_turn_radps(request);
}

forcelayer_runtime* forcelayer_open(const char* scene, const char* part,
                                    const forcelayer_options* options, char* error,
                                    size_t error_bytes) {
  forcelayer_runtime* runtime = nullptr;
  report_failure(error, error_bytes, [&]() -> Status {
    const auto request = request_from(scene, part, *options);
    if (!request) return request.error();
    auto run = open_run(*request);
    if (!run) return run.error();
    runtime = new forcelayer_runtime{std::move(*run)};
    return {};
  });
  return runtime;
}

int forcelayer_start(forcelayer_runtime* runtime, const double world_from_part[7],
                     const double handle_from_part[7], const forcelayer_reading* first, char* error,
                     size_t error_bytes) {
  return report_failure(error, error_bytes, [&] {
    return runtime->run.start(start_from(world_from_part, handle_from_part), sample_from(*first));
  });
}

int forcelayer_step(forcelayer_runtime* runtime, const forcelayer_reading* reading,
                    forcelayer_result* result) {
  *result = {};
  result->world_from_part[3] = 1;
  Run& run = runtime->run;
  if (!run.started()) return 1;
  const Wrench wrench = run.step(sample_from(*reading));
  put_vector(wrench.force_n, result->force_n);
  put_vector(wrench.torque_nm, result->torque_nm);
  put_pose(run.world_from_part(), result->world_from_part);
  const Frame& frame = run.frame();
  result->output = static_cast<uint32_t>(frame.output);
  result->contacts = frame.result.report.contacts;
  const StepReport& report = frame.result.report;
  result->interior = report.interior;
  result->clearance = static_cast<uint32_t>(report.clearance_kind);
  result->clearance_m = report.clearance_m;
  result->nearest_object = report.nearest_object;
  return 0;
}

void forcelayer_last_state(const forcelayer_runtime* runtime, forcelayer_state* state,
                           size_t state_bytes) {
  const Run& run = runtime->run;
  const Frame& frame = run.frame();
  const StepReport& report = frame.result.report;
  const bool tested = frame.input.valid == kInputValid && report.faults == 0;
  const forcelayer_state known = {run.guaranteed_m(), report.outside_map, report.barred,
                                  report.seat_open,   report.seated,      report.faults,
                                  tested ? 1u : 0u};
  std::memset(state, 0, state_bytes);
  std::memcpy(state, &known, std::min(state_bytes, sizeof known));
}

void forcelayer_guarantee(const forcelayer_runtime* runtime, double* tested_m, double* swept_m) {
  const SeparationGuarantee& guarantee = runtime->run.guarantee();
  *tested_m = guarantee.tested_m.value_or(0);
  *swept_m = guarantee.swept_m.value_or(0);
}

const char* forcelayer_warning(const forcelayer_runtime* runtime, uint32_t index) {
  const auto& warnings = runtime->run.warnings();
  return index < warnings.size() ? warnings[index].c_str() : nullptr;
}

void forcelayer_set_clutch(forcelayer_runtime* runtime, int pressed) {
  runtime->run.set_clutch(pressed != 0);
}

const char* forcelayer_object_name(const forcelayer_runtime* runtime, uint32_t object) {
  const std::string_view name = runtime->run.object_name(object);
  return name.empty() ? "" : name.data();  // a zero ends each in the file
}

const char* forcelayer_last_trip(const forcelayer_runtime* runtime) {
  return to_text(runtime->run.frame().last_trip);
}

int forcelayer_swap(forcelayer_runtime* runtime, const char* scene, const char* part,
                    const double world_from_part[7], const double handle_from_part[7],
                    double timeout_s, char* error, size_t error_bytes) {
  return report_failure(error, error_bytes, [&] {
    return runtime->run.swap(scene, part, start_from(world_from_part, handle_from_part), timeout_s);
  });
}

void forcelayer_close(forcelayer_runtime* runtime) { delete runtime; }
