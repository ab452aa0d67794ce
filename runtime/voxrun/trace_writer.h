// The trace: a CSV line a frame.
#pragma once

#include <string>

#include "formats/atomic_file.h"
#include "formats/result.h"
#include "runtime/frame.h"
#include "runtime/simulation.h"

namespace forcelayer::voxrun {

// Columns: t_s; handle pose; part pose (world_from_part, at which the counts hold); the wrench on
// the hand about the part's centroid in world axes, before the device's limits; counts; step_ns;
// the wrench that the device got, about the handle in device axes; the output's state (0 waiting,
// 1 armed, 2 tripped).
class TraceWriter {
 public:
  // `simulation` must outlive the writer.
  static Result<TraceWriter> create(const std::string& path, const Simulation& simulation);

  Status add(const Frame& frame);
  Status finish();

 private:
  TraceWriter(AtomicFile file, const Simulation& simulation)
      : file_(std::move(file)), simulation_(&simulation) {}
  Status flush();
  void put(double value);
  void put(std::int64_t value);
  void put(const Pose& pose);

  AtomicFile file_;
  const Simulation* simulation_;
  std::string text_;
};

}  // namespace forcelayer::voxrun
