#include "runtime/voxcheck/path_source.h"

#include "formats/path/path_edit.h"
#include "runtime/run/baked_files.h"
#include "runtime/stream/replay.h"

namespace forcelayer::voxcheck {
namespace {

Result<std::vector<PathRow>> read_recording(const std::string& path, const std::string& scene,
                                            const std::string& part) {
  const auto recording = stream::Recording::open(path);
  if (!recording) return recording.error();
  auto voxmap = open_scene(scene);
  if (!voxmap) return voxmap.error();
  auto shell = open_part(part);
  if (!shell) return shell.error();
  const auto simulation =
      stream::recorded_simulation(*recording, std::move(*voxmap), std::move(*shell));
  if (!simulation) {
    Error error = simulation.error();
    if (error.code == ErrorCode::kFilesDoNotMatch) {
      error.mend =
          "check the recording with the files of its run, or save its path with voxrun --save-path";
    }
    return error;
  }
  std::vector<PathRow> rows;
  stream::replay_steps(*recording, **simulation, [&](const stream::ReplayedStep& step) {
    const Pose pose = (*simulation)->world_from_part(step.result.report.world_from_center);
    const auto& p = pose.position_m;
    const auto& q = pose.orientation;
    rows.push_back({step.time_s, {p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}});
  });
  if (rows.empty()) {
    return Error{ErrorCode::kFieldInvalid, path, "", "the recording has no frames", ""};
  }
  return rows;
}

}  // namespace

Result<std::vector<PathRow>> read_part_path(const PathSource& source, const Pshell& part) {
  const bool is_recording = stream::is_recording(source.path);
  auto rows = is_recording ? read_recording(source.path, source.scene, source.part)
                           : read_path(source.path, PathOf::kPart);
  if (!rows || !source.pivot_m) return rows;
  const auto& center = part.header().center_m;
  auto turned = turned_about(*rows, *source.pivot_m, {center[0], center[1], center[2]}, kPivotM);
  if (turned) return turned;
  Error error = turned.error();
  error.file = source.path, error.where = "--center";
  return error;
}

}  // namespace forcelayer::voxcheck
