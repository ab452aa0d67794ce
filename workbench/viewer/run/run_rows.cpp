#include "workbench/viewer/run/run_rows.h"

#include <charconv>
#include <chrono>

#include "formats/path/path_edit.h"
#include "runtime/coupling/coupling.h"
#include "runtime/model/simulation.h"
#include "runtime/stream/replay.h"

namespace forcelayer::viewer {
namespace {

std::optional<RowClearance> clearance_of(ClearanceKind kind, double clearance_m,
                                         std::string_view object) {
  if (kind == ClearanceKind::kNone) return std::nullopt;
  return RowClearance{clearance_m, kind == ClearanceKind::kAtLeast, std::string(object)};
}

TraceRow row_of(const model::Simulation& simulation, const StepInput& input,
                const StepResult& result, const Pose& target) {
  const StepReport& report = result.report;
  TraceRow row;
  row.world_from_handle = input.world_from_handle;
  row.world_from_part = simulation.world_from_part(report.world_from_center);
  row.world_from_target = simulation.world_from_part(target);
  row.on_hand = result.wrench;
  row.points_proximity = report.proximity;
  row.points_surface = report.surface;
  row.points_interior = report.interior;
  row.contacts = report.contacts;
  row.guard_cuts = report.guard_cuts;
  row.clearance = clearance_of(report.clearance_kind, report.clearance_m,
                               simulation.voxmap().object_name(report.nearest_object));
  return row;
}

Result<std::vector<TraceRow>> replayed(const stream::Recording& recording,
                                       model::Simulation& simulation) {
  using Clock = std::chrono::steady_clock;
  std::vector<TraceRow> rows;
  auto before = Clock::now();
  stream::replay_steps(recording, simulation, [&](const stream::ReplayedStep& step) {
    const std::chrono::duration<double, std::nano> took = Clock::now() - before;
    const Pose target = coupling::coupling_target(step.state, step.input).world_from_center;
    rows.push_back(row_of(simulation, step.input, step.result, target));
    rows.back().time_s = step.time_s;
    rows.back().step_ns = took.count();
    before = Clock::now();
  });
  return rows;
}

// A path has no forces. Few rows may describe it, so poses between them are added: as many as a
// slider can show apart.
std::vector<TraceRow> rows_of(const std::vector<PathRow>& path,
                              const std::array<double, 3>& center_m) {
  constexpr double kShown = 500;
  const double duration_s = path.back().time_s - path.front().time_s;
  std::vector<TraceRow> rows;
  for (const PathRow& pose :
       duration_s > 0 ? resampled(path, duration_s / kShown, center_m) : path) {
    const auto& p = pose.position_m;
    const auto& q = pose.orientation_wxyz;
    TraceRow row;
    row.time_s = pose.time_s;
    row.world_from_part = {{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}};
    row.world_from_handle = row.world_from_part;
    row.world_from_target = row.world_from_part;
    rows.push_back(std::move(row));
  }
  return rows;
}

// A trace, or else a path of the part.
Result<std::vector<TraceRow>> read_table(const std::filesystem::path& path,
                                         const std::filesystem::path& shell) {
  auto trace = read_trace(path);
  if (trace || trace.error().code != ErrorCode::kNotThisFormat) return trace;
  const auto poses = read_path(path, PathOf::kPart);
  if (!poses) return trace;
  if (shell.empty()) return rows_of(*poses, {});
  const auto part = Pshell::open(shell);
  if (!part) return part.error();
  const auto& center_m = part->header().center_m;
  return rows_of(*poses, {center_m[0], center_m[1], center_m[2]});
}

}  // namespace

Result<std::vector<TraceRow>> read_run(const std::filesystem::path& path,
                                       const std::filesystem::path& voxmap,
                                       const std::filesystem::path& shell) {
  if (!stream::is_recording(path)) return read_table(path, shell);
  if (voxmap.empty() || shell.empty()) {
    return Error{ErrorCode::kUsage, path.string(), "",
                 "a recording can be shown only with its files",
                 "give the .vox and the .pshell too"};
  }
  auto recording = stream::Recording::open(path);
  if (!recording) return recording.error();
  auto map = Voxmap::open(voxmap);
  if (!map) return map.error();
  auto part = Pshell::open(shell);
  if (!part) return part.error();
  auto simulation = stream::recorded_simulation(*recording, std::move(*map), std::move(*part));
  if (!simulation) return simulation.error();
  auto rows = replayed(*recording, **simulation);
  if (rows && rows->empty()) {
    return Error{ErrorCode::kFieldInvalid, path.string(), "", "the recording has no frames", ""};
  }
  return rows;
}

Result<PoseReceiver> listen_at(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  const std::string address = colon == std::string::npos ? "127.0.0.1" : text.substr(0, colon);
  const std::string port = colon == std::string::npos ? text : text.substr(colon + 1);
  unsigned number = 0;
  const auto [end, code] = std::from_chars(port.data(), port.data() + port.size(), number);
  if (code != std::errc{} || end != port.data() + port.size() || number > 65535) {
    return Error{ErrorCode::kUsage, "", "--listen", "'" + text + "' is not a port number",
                 "write PORT or ADDRESS:PORT, like 7000"};
  }
  return PoseReceiver::open(static_cast<std::uint16_t>(number), address);
}

TraceRow row_of(const PoseDatagram& datagram) {
  const auto& f = datagram.force_n;
  const auto& t = datagram.torque_nm;
  TraceRow row;
  row.time_s = datagram.time_s;
  row.world_from_part = pose_from_numbers(datagram.world_from_part);
  row.world_from_handle = pose_from_numbers(datagram.world_from_handle);
  row.world_from_target = pose_from_numbers(datagram.world_from_target);
  row.on_hand = Wrench{{f[0], f[1], f[2]}, {t[0], t[1], t[2]}};
  row.points_proximity = datagram.points_proximity;
  row.points_surface = datagram.points_surface;
  row.points_interior = datagram.points_interior;
  row.contacts = datagram.contacts;
  row.guard_cuts = (datagram.flags & kPoseGuardCut) != 0 ? 1 : 0;
  row.clearance = clearance_of(static_cast<ClearanceKind>(datagram.clearance_kind),
                               datagram.clearance_m, object_name_of(datagram));
  return row;
}

}  // namespace forcelayer::viewer
