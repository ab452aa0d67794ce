#include "runtime/stream/recording.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <map>
#include <string>

#include "forcelayer/pose_datagram.h"

namespace forcelayer::stream {
namespace {

constexpr std::size_t kFlushFrames = 1024;

// Every number that the step computes with, by name.
struct NamedNumber {
  std::string_view name;
  double* value;
};

std::vector<NamedNumber> named_numbers(Parameters& p) {
  std::vector<NamedNumber> numbers = {{"rate_hz", &p.rate_hz},
                                      {"voxel_size_m", &p.voxel_size_m},
                                      {"part_radius_m", &p.part_radius_m},
                                      {"inertia_xx_kgm2", &p.inertia_kgm2[0][0]},
                                      {"inertia_yy_kgm2", &p.inertia_kgm2[1][1]},
                                      {"inertia_zz_kgm2", &p.inertia_kgm2[2][2]},
                                      {"inertia_xy_kgm2", &p.inertia_kgm2[0][1]},
                                      {"inertia_xz_kgm2", &p.inertia_kgm2[0][2]},
                                      {"inertia_yz_kgm2", &p.inertia_kgm2[1][2]}};
  for (const ParameterInfo& info : parameter_table()) {
    numbers.push_back({info.name, &(p.*(info.member))});
  }
  return numbers;
}

std::vector<RecordedParameter> recorded_parameters(Parameters p) {
  std::vector<RecordedParameter> recorded;
  for (const NamedNumber& number : named_numbers(p)) {
    RecordedParameter parameter{};
    std::copy(number.name.begin(), number.name.end(), parameter.name.begin());
    parameter.value = *number.value;
    recorded.push_back(parameter);
  }
  return recorded;
}

template <typename T>
std::span<const std::byte> bytes_of(const std::vector<T>& items) {
  return std::as_bytes(std::span(items));
}

template <typename T>
std::span<const std::byte> bytes_of(const T& item) {
  return std::as_bytes(std::span(&item, 1));
}

// Reads the parts of a recording one after the other.
class Reader {
 public:
  Reader(std::span<const std::byte> bytes, std::string name)
      : bytes_(bytes), name_(std::move(name)) {}

  Error error(ErrorCode code, std::string_view where, std::string_view what) const {
    return {code, name_, where, what, "record the run again"};
  }

  Result<RecordingHeader> header() const {
    RecordingHeader h{};
    if (bytes_.size() < sizeof h) {
      const auto shared = std::min(bytes_.size(), kRecordingMagic.size());
      const bool ours =
          shared == 0 || std::memcmp(bytes_.data(), kRecordingMagic.data(), shared) == 0;
      return error(ours ? ErrorCode::kTruncated : ErrorCode::kNotThisFormat, "header",
                   ours ? "is cut off" : "is not a recording of voxrun");
    }
    std::memcpy(&h, bytes_.data(), sizeof h);
    if (Status valid = check_header(h); !valid) return valid.error();
    return h;
  }

  Result<Parameters> parameters(const RecordingHeader& h) const {
    std::map<std::string, double, std::less<>> found;
    for (std::uint32_t i = 0; i < h.parameter_count; ++i) {
      RecordedParameter parameter{};
      std::memcpy(&parameter, bytes_.data() + sizeof h + i * sizeof parameter, sizeof parameter);
      if (parameter.name.back() != 0) {
        return error(ErrorCode::kFieldInvalid, "parameter " + std::to_string(i),
                     "has a name without an end mark");
      }
      found[parameter.name.data()] = parameter.value;
    }
    Parameters p;
    p.model = static_cast<Model>(h.model);
    p.force = static_cast<ForceKind>(h.force);
    p.braking = h.braking != 0;
    for (const NamedNumber& number : named_numbers(p)) {
      const auto at = found.find(number.name);
      if (at == found.end() || std::isnan(at->second)) {
        return error(ErrorCode::kFieldInvalid, "parameter " + std::string(number.name),
                     at == found.end() ? "is missing" : "is not a number");
      }
      *number.value = at->second;
    }
    p.inertia_kgm2[1][0] = p.inertia_kgm2[0][1];
    p.inertia_kgm2[2][0] = p.inertia_kgm2[0][2];
    p.inertia_kgm2[2][1] = p.inertia_kgm2[1][2];
    return check_parameters(p);
  }

  Result<std::span<const RecordedFrame>> frames(const RecordingHeader& h) const {
    const std::size_t before = sizeof h + h.parameter_count * sizeof(RecordedParameter);
    RecordingTrailer trailer{};
    if (bytes_.size() < before + sizeof trailer) {
      return error(ErrorCode::kTruncated, "trailer", "is missing");
    }
    std::memcpy(&trailer, bytes_.data() + bytes_.size() - sizeof trailer, sizeof trailer);
    if (trailer.magic != kRecordingEndMagic) {
      return error(ErrorCode::kTruncated, "trailer", "is missing: the recording was cut off");
    }
    const std::size_t frame_bytes = bytes_.size() - before - sizeof trailer;
    if (frame_bytes % sizeof(RecordedFrame) != 0 ||
        frame_bytes / sizeof(RecordedFrame) != trailer.frame_count || trailer.reserved != 0) {
      return error(ErrorCode::kSectionInvalid, "trailer", "does not fit the number of frames");
    }
    if (trailer.lost_frames != 0) {
      return error(ErrorCode::kFieldInvalid, "trailer",
                   std::to_string(trailer.lost_frames) +
                       " frames were lost while recording, so the recording cannot be replayed");
    }
    return std::span(reinterpret_cast<const RecordedFrame*>(bytes_.data() + before),
                     static_cast<std::size_t>(trailer.frame_count));
  }

 private:
  Status check_header(const RecordingHeader& h) const {
    if (h.magic != kRecordingMagic) {
      return error(ErrorCode::kNotThisFormat, "header", "is not a recording of voxrun");
    }
    if (h.endian_tag != kRecordingEndianTag) {
      return error(ErrorCode::kWrongEndianness, "header", "was written on a big-endian machine");
    }
    if (h.major != kRecordingMajor) {
      return error(ErrorCode::kUnknownVersion, "header",
                   "has version " + std::to_string(h.major) + ", but this program reads version 2");
    }
    const bool sizes = h.header_bytes == sizeof h && h.frame_bytes == sizeof(RecordedFrame) &&
                       h.parameter_count <= kMaxRecordedParameters;
    const bool kinds = is_known_model(h.model) && is_known_force(h.force) && h.braking <= 1 &&
                       h.seat <= kSeatEntered;
    const bool zeros =
        std::all_of(h.reserved.begin(), h.reserved.end(), [](auto b) { return b == 0; });
    if (!sizes || !kinds || !zeros || !poses_valid(h) ||
        !check_range("", h.motion_scale, kMotionScales)) {
      return error(ErrorCode::kFieldInvalid, "header", "has a value that is out of range");
    }
    if (bytes_.size() < sizeof h + h.parameter_count * sizeof(RecordedParameter)) {
      return error(ErrorCode::kTruncated, "parameters", "are cut off");
    }
    return {};
  }

  static bool poses_valid(const RecordingHeader& h) {
    const auto valid = [](const std::array<double, 7>& n) {
      constexpr double kUnitTolerance = 1e-6;  // far above rounding, as the step's own
      return std::all_of(n.begin(), n.end(), [](double x) { return std::isfinite(x); }) &&
             std::abs(glm::length(pose_from_numbers(n).orientation) - 1) < kUnitTolerance;
    };
    return valid(h.world_from_center) && valid(h.handle_from_center) &&
           valid(h.world_from_device) && (h.seat == kSeatClosed || valid(h.world_from_seat));
  }

  Result<Parameters> check_parameters(const Parameters& p) const {
    const bool valid =
        p.mass_kg > 0 && p.voxel_size_m > 0 && p.part_radius_m > 0 && p.inertia_kgm2[0][0] > 0;
    if (!valid) return error(ErrorCode::kFieldInvalid, "parameters", "are out of range");
    if (Status s = check_recorded(p); !s) {
      return error(ErrorCode::kFieldInvalid, "parameter " + s.error().where, s.error().what);
    }
    if (p.model == Model::kPaper && p.force != ForceKind::kTangentPlane) {
      return error(ErrorCode::kFieldInvalid, "header",
                   "has a force field that the paper's model cannot use");
    }
    return p;
  }

  std::span<const std::byte> bytes_;
  std::string name_;
};

}  // namespace

RecordedRun describe_run(const model::Simulation& simulation, const State& start,
                         const DevicePlacement& placement) {
  return {simulation.parameters(),
          start,
          simulation.world_from_seat(),
          placement,
          simulation.voxmap().header().file.header_checksum,
          simulation.shell().header().file.header_checksum};
}

Result<RecordingWriter> RecordingWriter::create(const std::filesystem::path& path) {
  auto file = AtomicFile::create(path);
  if (!file) return file.error();
  return RecordingWriter(std::move(*file));
}

void RecordingWriter::begin(const RecordedRun& run) {
  const auto parameters = recorded_parameters(run.parameters);
  RecordingHeader h{};
  h.magic = kRecordingMagic;
  h.endian_tag = kRecordingEndianTag;
  h.major = kRecordingMajor;
  h.minor = kRecordingMinor;
  h.header_bytes = sizeof h;
  h.parameter_count = static_cast<std::uint32_t>(parameters.size());
  h.frame_bytes = sizeof(RecordedFrame);
  h.model = static_cast<std::uint32_t>(run.parameters.model);
  h.force = static_cast<std::uint32_t>(run.parameters.force);
  h.braking = run.parameters.braking ? 1 : 0;
  h.voxmap_checksum = run.voxmap_checksum;
  h.shell_checksum = run.shell_checksum;
  h.world_from_center = pose_numbers(run.start.world_from_center);
  h.handle_from_center = pose_numbers(run.start.handle_from_center);
  h.world_from_device = pose_numbers(run.placement.world_from_device);
  h.motion_scale = run.placement.motion_scale;
  if (run.world_from_seat) {
    h.world_from_seat = pose_numbers(*run.world_from_seat);
    h.seat = run.start.seat;
  }
  for (const auto& bytes : {bytes_of(h), bytes_of(parameters)}) {
    head_.insert(head_.end(), bytes.begin(), bytes.end());
  }
}

namespace {

std::uint32_t recorded_health(const InputHealth& health) {
  return static_cast<std::uint32_t>(health.trouble) | (health.clutch ? kRecordedClutch : 0u) |
         (health.output_held ? kRecordedOutputHeld : 0u) |
         (health.loop_late ? kRecordedLoopLate : 0u) | (health.swapping ? kRecordedSwapping : 0u) |
         static_cast<std::uint32_t>(std::lround(health.output_fall * kFallSteps))
             << kRecordedFallShift;
}

InputHealth health_of(const RecordedFrame& frame) {
  const std::uint32_t trouble = frame.health & kRecordedTroubleMask;
  InputHealth health;
  health.trouble =
      trouble < kInputTroubles ? static_cast<InputTrouble>(trouble) : InputTrouble::kDeviceLost;
  health.age_fraction = frame.age_fraction >= 0 && frame.age_fraction <= 1 ? frame.age_fraction : 1;
  health.clutch = (frame.health & kRecordedClutch) != 0;
  health.output_held = (frame.health & kRecordedOutputHeld) != 0;
  health.loop_late = (frame.health & kRecordedLoopLate) != 0;
  health.swapping = (frame.health & kRecordedSwapping) != 0;
  health.output_fall = static_cast<float>(frame.health >> kRecordedFallShift) / kFallSteps;
  return health;
}

}  // namespace

Status RecordingWriter::add(const Frame& frame) {
  const StepInput& in = frame.input;
  const auto& [v, w] = in.handle_velocity;
  pending_.push_back({pose_numbers(in.world_from_handle),
                      {v.x, v.y, v.z, w.x, w.y, w.z},
                      in.buttons,
                      in.valid,
                      frame.outcome_hash,
                      frame.health.age_fraction,
                      recorded_health(frame.health)});
  ++frames_;
  return pending_.size() < kFlushFrames ? Status{} : flush();
}

Status RecordingWriter::flush() {
  if (!head_.empty()) {
    if (Status written = file_.write(head_); !written) return written;
    head_.clear();
  }
  Status written = file_.write(bytes_of(pending_));
  pending_.clear();
  return written;
}

Status RecordingWriter::finish(std::uint64_t lost_frames) {
  if (Status written = flush(); !written) return written;
  const RecordingTrailer trailer{kRecordingEndMagic, frames_, lost_frames, 0};
  if (Status written = file_.write(bytes_of(trailer)); !written) return written;
  if (lost_frames > 0) return file_.commit();  // to be looked at: its reader names their count
  return file_.commit([](std::span<const std::byte> bytes, std::string_view name) -> Status {
    const auto recording = Recording::from_bytes(bytes, std::string(name));
    if (!recording) return recording.error();
    return {};
  });
}

Result<Recording> Recording::open(const std::filesystem::path& path) {
  auto file = FileBytes::read(path);
  if (!file) return file.error();
  auto recording = from_bytes(file->bytes(), path.string());
  if (recording) recording->file_ = std::move(*file);
  return recording;
}

Result<Recording> Recording::from_bytes(std::span<const std::byte> bytes, std::string name) {
  const Reader reader(bytes, name);
  const auto header = reader.header();
  if (!header) return header.error();
  const auto parameters = reader.parameters(*header);
  if (!parameters) return parameters.error();
  const auto frames = reader.frames(*header);
  if (!frames) return frames.error();
  Recording recording;
  recording.run_.parameters = *parameters;
  recording.run_.start.world_from_center = pose_from_numbers(header->world_from_center);
  recording.run_.start.handle_from_center = pose_from_numbers(header->handle_from_center);
  if (header->seat != kSeatClosed) {
    recording.run_.start.seat = header->seat;
    recording.run_.world_from_seat = pose_from_numbers(header->world_from_seat);
  }
  recording.run_.placement = {pose_from_numbers(header->world_from_device), header->motion_scale};
  recording.run_.voxmap_checksum = header->voxmap_checksum;
  recording.run_.shell_checksum = header->shell_checksum;
  recording.frames_ = *frames;
  recording.name_ = std::move(name);
  return recording;
}

Status Recording::check_files(const Voxmap& voxmap, const Pshell& shell) const {
  const bool scene = voxmap.header().file.header_checksum == run_.voxmap_checksum;
  const bool part = shell.header().file.header_checksum == run_.shell_checksum;
  if (scene && part) return {};
  return Error{ErrorCode::kFilesDoNotMatch, name_, scene ? ".pshell" : ".vox",
               "is not the file that the run was recorded with",
               "replay it with the files of that run"};
}

bool ReplayInput::next(double, double, StepInput& input) noexcept {
  if (at_ == recording_.frames().size()) return false;
  const RecordedFrame& frame = recording_.frames()[at_++];
  const auto& v = frame.handle_velocity;
  input.world_from_handle = pose_from_numbers(frame.world_from_handle);
  input.handle_velocity = {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  input.buttons = frame.buttons;
  input.valid = frame.valid;
  health_ = health_of(frame);
  return true;
}

Error outcome_differs(const std::string& name, std::uint64_t first) {
  return {ErrorCode::kInternal, name, "frame " + std::to_string(first),
          "the outcome differs from the recorded one",
          "replay it with the program that recorded it, on the same kind of machine"};
}

void ReplayInput::output(const Frame& frame) noexcept {
  if (frame.outcome_hash == recording_.frames()[at_ - 1].outcome_hash) return;
  if (differing_++ == 0) first_difference_ = frame.number;
}

}  // namespace forcelayer::stream
