// Recording a run, and playing it again bit for bit.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "forcelayer/frame.h"
#include "formats/file/atomic_file.h"
#include "formats/file/file_bytes.h"
#include "formats/result.h"
#include "runtime/loop/input_source.h"
#include "runtime/model/simulation.h"
#include "runtime/stream/recording_format.h"

namespace forcelayer::stream {

// The facts of a run that hold for all its frames.
struct RecordedRun {
  Parameters parameters;
  State start;
  std::optional<Pose> world_from_seat;  // of the part's centroid frame
  DevicePlacement placement;
  std::uint64_t voxmap_checksum = 0, shell_checksum = 0;
};

RecordedRun describe_run(const model::Simulation& simulation, const State& start,
                         const DevicePlacement& placement);

// Writes a recording as the frames come. Not for the loop's thread. The file appears with finish();
// without it nothing is left behind.
class RecordingWriter {
 public:
  static Result<RecordingWriter> create(const std::filesystem::path& path);

  // Once, before the first frame. Does not touch the file: the loop is about to begin.
  void begin(const RecordedRun& run);

  Status add(const Frame& frame);
  // Not committed where Recording::open would refuse it for another reason than lost frames.
  Status finish(std::uint64_t lost_frames);

 private:
  explicit RecordingWriter(AtomicFile file) : file_(std::move(file)) {}
  Status flush();

  AtomicFile file_;
  std::vector<std::byte> head_;  // header and parameters, until they are written
  std::vector<RecordedFrame> pending_;
  std::uint64_t frames_ = 0;
};

// A recording, checked: every size, field and name.
class Recording {
 public:
  // Errors: file codes (1xx) and baked-file codes (4xx).
  static Result<Recording> open(const std::filesystem::path& path);

  // The same from bytes that are someone else's and stay; `name` is for errors.
  static Result<Recording> from_bytes(std::span<const std::byte> bytes, std::string name);

  // kFilesDoNotMatch where the run was made with other files.
  Status check_files(const Voxmap& voxmap, const Pshell& shell) const;

  const RecordedRun& run() const { return run_; }
  std::span<const RecordedFrame> frames() const { return frames_; }

 private:
  FileBytes file_;
  RecordedRun run_;
  std::span<const RecordedFrame> frames_;
  std::string name_;
};

// The error of a replay whose frame `first` is the first with another outcome. `name`: the
// recording's.
Error outcome_differs(const std::string& name, std::uint64_t first);

// The inputs of a recording, frame by frame. Counts the frames whose outcome differs from the
// recorded one.
class ReplayInput final : public loop::InputSource {
 public:
  // `recording` must outlive this.
  explicit ReplayInput(const Recording& recording) : recording_(recording) {}

  bool next(double time_s, double dt_s, StepInput& input) noexcept override;
  InputHealth health() const noexcept override { return health_; }
  void output(const Frame& frame) noexcept override;
  void silence() noexcept override {}
  const DevicePlacement& placement() const override { return recording_.run().placement; }

  std::uint64_t differing_frames() const { return differing_; }
  std::uint64_t first_difference() const { return first_difference_; }

 private:
  const Recording& recording_;
  InputHealth health_;
  std::size_t at_ = 0;
  std::uint64_t differing_ = 0;
  std::uint64_t first_difference_ = 0;
};

}  // namespace forcelayer::stream
