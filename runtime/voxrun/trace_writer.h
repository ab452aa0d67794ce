// The trace: a CSV line a frame.
#pragma once

#include <string>

#include "forcelayer/frame.h"
#include "formats/file/atomic_file.h"
#include "formats/result.h"
#include "runtime/model/simulation.h"

namespace forcelayer::voxrun {

// Its columns: trace.md.
class TraceWriter {
 public:
  // `simulation` must outlive the writer.
  static Result<TraceWriter> create(const std::string& path, const model::Simulation& simulation);

  Status add(const Frame& frame);
  Status finish();

 private:
  TraceWriter(AtomicFile file, const model::Simulation& simulation)
      : file_(std::move(file)), simulation_(&simulation) {}
  Status flush();
  void put(double value);
  void put(std::int64_t value);
  void put(const Pose& pose);
  void put_name(std::uint32_t object);

  AtomicFile file_;
  const model::Simulation* simulation_;
  std::string text_;
};

}  // namespace forcelayer::voxrun
