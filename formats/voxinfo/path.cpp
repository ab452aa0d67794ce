#include "formats/voxinfo/path.h"

#include <iostream>
#include <nlohmann/json.hpp>

#include "formats/command/command.h"
#include "formats/command/quantity.h"
#include "formats/command/report.h"
#include "formats/command/text.h"
#include "formats/path/path_edit.h"
#include "formats/pshell.h"

namespace forcelayer::voxinfo {
namespace {

constexpr double kShortestPeriodS = 1e-6;

std::string summary_of(const PathFacts& f, const std::string& path, const char* point) {
  using command::text;
  return text("%s: %zu poses from %.6g to %.6g s; %s travels %.6g m and turns %.6g rad\n",
              escaped(path).c_str(), f.poses, f.begin_s, f.end_s, point, f.length_m, f.turn_rad) +
         text("  largest step %.6g mm and %.6g rad; largest speed %.6g m/s\n", f.max_step_m * 1e3,
              f.max_turn_rad, f.max_mps) +
         text("  %s in %.6g, %.6g, %.6g to %.6g, %.6g, %.6g m\n", point, f.low_m[0], f.low_m[1],
              f.low_m[2], f.high_m[0], f.high_m[1], f.high_m[2]);
}

nlohmann::ordered_json report_of(const PathFacts& f, const std::array<double, 3>& center_m) {
  return {
      {"schema_version", 1},        {"poses", f.poses},           {"point_m", center_m},
      {"begin_s", f.begin_s},       {"end_s", f.end_s},           {"length_m", f.length_m},
      {"turn_rad", f.turn_rad},     {"max_step_m", f.max_step_m}, {"max_step_rad", f.max_turn_rad},
      {"max_speed_mps", f.max_mps}, {"low_m", f.low_m},           {"high_m", f.high_m}};
}

Status write_path(const std::vector<PathRow>& rows, const std::string& path) {
  auto writer = PathWriter::create(path);
  if (!writer) return writer.error();
  for (const PathRow& row : rows) {
    if (Status s = writer->add(row); !s) return s;
  }
  return writer->finish();
}

// The path as it is to be written.
Result<std::vector<PathRow>> edited(const PathRequest& request, std::vector<PathRow> rows,
                                    const std::array<double, 3>& center_m) {
  if (!request.period.empty()) {
    const auto period_s = command::parse_duration(request.period);
    if (!period_s) {
      Error error = period_s.error();
      error.where = "--resample";
      return error;
    }
    if (!(*period_s >= kShortestPeriodS)) {
      return Error{ErrorCode::kUsage, "", "--resample", "must be a microsecond or more", ""};
    }
    const double between = (rows.back().time_s - rows.front().time_s) / *period_s;
    if (between + static_cast<double>(rows.size()) >= static_cast<double>(kMaxPathRows)) {
      return Error{ErrorCode::kUsage, "", "--resample", "would make more than 100 million rows",
                   "give a longer period"};
    }
    rows = resampled(rows, *period_s, center_m);
  }
  return request.reverse ? reversed(rows) : rows;
}

}  // namespace

Status handle_path(const PathRequest& request) {
  auto rows = read_path(request.path, PathOf::kPart);
  if (!rows) return rows.error();
  if (request.output.empty() && (request.reverse || !request.period.empty())) {
    return Error{ErrorCode::kUsage, "", "-o", "no file for the new path is given",
                 "give -o OUT.csv"};
  }
  std::array<double, 3> center_m{};
  if (!request.shell.empty()) {
    const auto shell = Pshell::open(request.shell);
    if (!shell) return shell.error();
    center_m = shell->header().center_m;
  } else if (!request.period.empty() && path_facts(*rows).turn_rad > 0) {
    command::warn(
        "in the new rows the part's origin moves in straight lines, but voxcheck moves the part's "
        "centroid in straight lines; add --part to match voxcheck",
        request.quiet);
  }
  if (!request.output.empty()) {
    rows = edited(request, std::move(*rows), center_m);
    if (!rows) return rows.error();
    if (Status s = write_path(*rows, request.output); !s) return s;
  }
  const PathFacts facts = path_facts(*rows, center_m);
  if (!request.json.empty()) {
    if (Status s = command::write_report(request.json, report_of(facts, center_m)); !s) return s;
  }
  if (!request.quiet) {
    std::cout << summary_of(facts, request.output.empty() ? request.path : request.output,
                            request.shell.empty() ? "the frame's origin" : "the centroid");
  }
  return {};
}

}  // namespace forcelayer::voxinfo
