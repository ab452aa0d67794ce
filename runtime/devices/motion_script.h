// A scripted hand: poses over time, read from a CSV file.
#pragma once

#include <filesystem>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/result.h"

namespace forcelayer::devices {

// world_from_handle at ascending times; between them positions go straight and orientations the
// short way round at constant speed, before the first and after the last they stand still.
class MotionScript {
 public:
  struct Row {
    double time_s;
    Pose world_from_handle;
  };

  // Reads a path (formats/path): of a trace the handle's. Errors: those of read_path().
  static Result<MotionScript> read(const std::filesystem::path& path);

  // A hand that holds still.
  static MotionScript still(const Pose& world_from_handle);

  // At least one row, times ascending, quaternions unit.
  explicit MotionScript(std::vector<Row> rows);

  Pose pose(double time_s) const noexcept;
  Twist velocity(double time_s) const noexcept;  // of the handle's origin, world axes
  double end_s() const { return rows_.back().time_s; }

 private:
  std::size_t segment(double time_s) const noexcept;  // row that begins it

  std::vector<Row> rows_;
};

}  // namespace forcelayer::devices
