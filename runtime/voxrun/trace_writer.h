// The trace: a CSV line a frame.
#pragma once

#include <string>

#include "forcelayer/frame.h"
#include "formats/file/atomic_file.h"
#include "formats/result.h"
#include "runtime/voxrun/scenes.h"

namespace forcelayer::voxrun {

// Its columns: docs/voxrun_report.md.
class TraceWriter {
 public:
  // `scenes` must outlive the writer.
  static Result<TraceWriter> create(const std::string& path, const Scenes& scenes);

  Status add(const Frame& frame);
  Status finish();

 private:
  TraceWriter(AtomicFile file, const Scenes& scenes) : file_(std::move(file)), scenes_(&scenes) {}
  Status flush();
  void put(double value);
  void put(std::int64_t value);
  void put(const Pose& pose);
  void put_name(std::uint32_t object);

  AtomicFile file_;
  const Scenes* scenes_;
  std::string text_;
};

}  // namespace forcelayer::voxrun
