#include "formats/voxinfo/path.h"

#include <iostream>
#include <nlohmann/json.hpp>

#include "formats/command/command.h"
#include "formats/command/quantity.h"
#include "formats/command/text.h"
#include "formats/path/path_edit.h"
#include "formats/pshell.h"

namespace forcelayer::voxinfo {
namespace {

constexpr double kShortestPeriodS = 1e-6;

std::string summary_of(const PathFacts& f, const std::string& path) {
  using command::text;
  return text("%s: %zu poses from %.6g to %.6g s; a way of %.6g m and turns of %.6g rad in all\n",
              escaped(path).c_str(), f.poses, f.begin_s, f.end_s, f.way_m, f.turn_rad) +
         text("  between two poses at most %.6g mm and %.6g rad; at most %.6g m/s\n",
              f.most_step_m * 1e3, f.most_turn_rad, f.most_mps) +
         text("  the frame's origin in %.6g, %.6g, %.6g to %.6g, %.6g, %.6g m\n", f.low_m[0],
              f.low_m[1], f.low_m[2], f.high_m[0], f.high_m[1], f.high_m[2]);
}

nlohmann::ordered_json report_of(const PathFacts& f) {
  return {{"schema_version", 1},
          {"poses", f.poses},
          {"begin_s", f.begin_s},
          {"end_s", f.end_s},
          {"way_m", f.way_m},
          {"turn_rad", f.turn_rad},
          {"most_step_m", f.most_step_m},
          {"most_step_rad", f.most_turn_rad},
          {"most_speed_mps", f.most_mps},
          {"low_m", f.low_m},
          {"high_m", f.high_m}};
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
Result<std::vector<PathRow>> edited(const PathRequest& request, std::vector<PathRow> rows) {
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
    const double wanted = (rows.back().time_s - rows.front().time_s) / *period_s;
    if (wanted >= static_cast<double>(kMostPathRows)) {
      return Error{ErrorCode::kUsage, "", "--resample", "makes more than 100 million rows",
                   "give a longer period"};
    }
    std::array<double, 3> center_m{};
    if (!request.shell.empty()) {
      const auto shell = Pshell::open(request.shell);
      if (!shell) return shell.error();
      center_m = shell->header().center_m;
    }
    rows = resampled(rows, *period_s, center_m);
  }
  return request.reverse ? reversed(rows) : rows;
}

}  // namespace

Status handle_path(const PathRequest& request) {
  auto rows = read_path(request.path, request.of == "handle" ? PathOf::kHandle : PathOf::kPart);
  if (!rows) return rows.error();
  if (request.output.empty() && (request.reverse || !request.period.empty())) {
    return Error{ErrorCode::kUsage, "", "-o", "names no file for the new path", "give -o OUT.csv"};
  }
  if (!request.output.empty()) {
    rows = edited(request, std::move(*rows));
    if (!rows) return rows.error();
    if (Status s = write_path(*rows, request.output); !s) return s;
  }
  const PathFacts facts = path_facts(*rows);
  if (!request.json.empty()) {
    if (Status s = command::write_report(request.json, report_of(facts)); !s) return s;
  }
  if (!request.quiet) {
    std::cout << summary_of(facts, request.output.empty() ? request.path : request.output);
  }
  return {};
}

}  // namespace forcelayer::voxinfo
