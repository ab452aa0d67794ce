// Reads the trace CSV that voxrun writes, one row a frame (docs/voxrun_report.md).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/result.h"

namespace forcelayer::viewer {

// A frame's clearance, the proven distance between the surfaces of part and scene.
struct RowClearance {
  double clearance_m = 0;
  bool at_least = false;  // nothing was near enough to be measured
  std::string object;     // the nearest one; empty where it is not known
};

struct TraceRow {
  double time_s = 0;
  Pose world_from_handle;
  Pose world_from_part;
  std::optional<Pose> world_from_target;  // where the hand wants the part, if it was said
  std::optional<Wrench> on_hand;          // about the part's centroid, world axes; none of a path
  std::uint32_t points_proximity = 0, points_surface = 0, points_interior = 0;
  std::uint32_t contacts = 0;
  std::uint32_t guard_cuts = 0;
  double step_ns = 0;
  std::optional<RowClearance> clearance;  // none where nothing is proven
};

// Rows in file order. Columns are found by name, others are passed over. Errors: kFileNotFound,
// kReadFailed, kNotThisFormat (no such header, or no row), kFieldInvalid with the line.
Result<std::vector<TraceRow>> read_trace(const std::filesystem::path& path);

// The row at or just before `time_s`; the first where all are later. `rows` must not be empty.
std::size_t row_at(const std::vector<TraceRow>& rows, double time_s);

// The rows that answer a run's questions: how near did the part come, and how hard was it pressed?
struct NotableRows {
  // The moment of the least clearance that is proven in any frame, as voxrun reports it: after the
  // seat, where the part starts in one. None where nothing was near enough to be measured.
  std::optional<std::size_t> min_clearance;
  // The moment of the greatest force on the hand, of rows with a contact where there are any:
  // braking and the part's mass are felt without one. None where nothing was felt.
  std::optional<std::size_t> strongest;

  // The one that is shown unless another is asked for; the first row where there is neither.
  std::size_t usual() const { return min_clearance.value_or(strongest.value_or(0)); }
  // "the least proven clearance" or "the strongest force"; empty for any other row.
  std::string_view name_of(std::size_t row) const;
};

NotableRows notable_rows(const std::vector<TraceRow>& rows);

}  // namespace forcelayer::viewer
