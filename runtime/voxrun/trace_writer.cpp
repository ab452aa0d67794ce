#include "runtime/voxrun/trace_writer.h"

#include <charconv>
#include <span>

#include "runtime/model/simulation.h"

namespace forcelayer::voxrun {
namespace {

constexpr std::size_t kFlushBytes = 1 << 20;
constexpr const char* kHeader =
    "t_s,handle_x_m,handle_y_m,handle_z_m,handle_qw,handle_qx,handle_qy,handle_qz,"
    "part_x_m,part_y_m,part_z_m,part_qw,part_qx,part_qy,part_qz,"
    "force_x_n,force_y_n,force_z_n,torque_x_nm,torque_y_nm,torque_z_nm,"
    "points_proximity,points_surface,points_interior,contacts,depth_m,guard_cuts,step_ns,"
    "device_force_x_n,device_force_y_n,device_force_z_n,"
    "device_torque_x_nm,device_torque_y_nm,device_torque_z_nm,clearance_m,output,nearest_object\n";

}  // namespace

Result<TraceWriter> TraceWriter::create(const std::string& path, const Scenes& scenes) {
  auto file = AtomicFile::create(path);
  if (!file) return file.error();
  TraceWriter writer(std::move(*file), scenes);
  writer.text_ = kHeader;
  return writer;
}

// The shortest text that reads back as the same number.
void TraceWriter::put(double value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  text_.append(digits, end);
  text_ += ',';
}

void TraceWriter::put(std::int64_t value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  text_.append(digits, end);
  text_ += ',';
}

void TraceWriter::put(const Pose& pose) {
  for (int axis = 0; axis < 3; ++axis) put(pose.position_m[axis]);
  const glm::dquat& q = pose.orientation;
  for (const double value : {q.w, q.x, q.y, q.z}) put(value);
}

// A line a frame, whatever the name holds: escaped, and quoted where CSV asks for it.
void TraceWriter::put_name(std::uint32_t object) {
  const std::string name = escaped(scenes_->object_name(object));
  if (name.find_first_of(",\"") == std::string::npos) {
    text_ += name;
    return;
  }
  text_ += '"';
  for (const char c : name) {
    if (c == '"') text_ += '"';
    text_ += c;
  }
  text_ += '"';
}

Status TraceWriter::add(const Frame& frame) {
  const StepReport& report = frame.result.report;
  put(frame.time_s);
  put(frame.input.world_from_handle);
  put(scenes_->first().simulation().world_from_part(report.world_from_center));
  for (int axis = 0; axis < 3; ++axis) put(frame.result.wrench.force_n[axis]);
  for (int axis = 0; axis < 3; ++axis) put(frame.result.wrench.torque_nm[axis]);
  for (const std::uint32_t n :
       {report.proximity, report.surface, report.interior, report.contacts}) {
    put(std::int64_t{n});
  }
  put(report.depth_m);
  put(std::int64_t{report.guard_cuts});
  put(frame.step_ns);
  for (int axis = 0; axis < 3; ++axis) put(frame.device_wrench.force_n[axis]);
  for (int axis = 0; axis < 3; ++axis) put(frame.device_wrench.torque_nm[axis]);
  if (report.clearance_kind == ClearanceKind::kNone) {
    text_ += ',';
  } else {
    put(report.clearance_m);
  }
  put(static_cast<std::int64_t>(frame.output));
  put_name(report.nearest_object == 0 ? 0 : frame.objects_before + report.nearest_object);
  text_ += '\n';
  return text_.size() < kFlushBytes ? Status{} : flush();
}

Status TraceWriter::flush() {
  Status written = file_.write(std::as_bytes(std::span(text_)));
  text_.clear();
  return written;
}

Status TraceWriter::finish() {
  if (Status written = flush(); !written) return written;
  return file_.commit();
}

}  // namespace forcelayer::voxrun
