#include "workbench/voxplan/report.h"

#include <nlohmann/json.hpp>

#include "formats/command/text.h"
#include "formats/path/path_edit.h"
#include "runtime/voxcheck/missing_faces.h"
#include "runtime/voxcheck/object_names.h"
#include "runtime/voxcheck/words.h"

namespace forcelayer::voxplan {
namespace {

using command::text;
using Json = nlohmann::ordered_json;

std::string seat_text(const Report& report) {
  if (report.plan.checked.seated.empty()) return "";
  return text("; until %.3f s seated on ", report.plan.checked.seated.front().to_s) +
         voxcheck::listed_names(report.problem.scene, report.plan.checked.seat_objects);
}

double hidden_within_m(const Report& report) {
  return voxcheck::hidden_within_m(report.problem.scene, report.plan.checked, report.options.allow);
}

}  // namespace

std::string found_text(const Report& report) {
  const clearance::CheckResult& checked = report.plan.checked;
  std::string line =
      text("path found in %.3g s: %.4g mm long, %s %.3f mm", report.plan.search.seconds,
           1e3 * checked.way_m, checked.at_least ? "at least" : "proven clearance",
           voxcheck::floor_mm(checked.clearance_m));
  line +=
      voxcheck::to_object(report.problem.scene, checked.smallest.object) + seat_text(report) + "\n";
  for (std::size_t n = 0; n < checked.seated.size(); ++n) {
    line += voxcheck::seat_way_text(report.problem.scene, checked, n, {});
  }
  if (!checked.seated.empty()) {
    line += report.options.meshes.empty()
                ? "  its seat is felt by shell points alone: voxcheck --exact settles it\n"
                : "  the meshes settle it: in its seat no surface passes through another\n";
  }
  return line + voxcheck::hidden_text(hidden_within_m(report));
}

std::string not_found_text(const Report& report) {
  const SearchResult& result = report.plan.search;
  std::string line =
      text("no path found in %.3g s (best: out to %.3g mm", result.seconds, 1e3 * result.out_m);
  if (!result.blocked_by.empty()) {
    line += ", blocked by " + voxcheck::listed_names(report.problem.scene, result.blocked_by);
  }
  if (result.refused == 0) return line + ")";
  return line +
         text("; %llu that did not prove clear)", static_cast<unsigned long long>(result.refused));
}

Json report_json(const Report& report) {
  const SearchResult& result = report.plan.search;
  const clearance::CheckResult& checked = report.plan.checked;
  const Voxmap& scene = report.problem.scene;
  Json json;
  json["schema_version"] = 1;
  json["found"] = result.found;
  json["required_clearance_m"] = report.options.clearance_m;
  json["settled_by"] = report.options.meshes.empty() ? "files" : "meshes";
  json["missing_faces"] = voxcheck::missing_faces(report.problem.scene, report.problem.part);
  if (result.found) {
    json["path"] = report.options.path;
    json["rows"] = report.plan.rows.size();
    json["way_m"] = path_facts(report.plan.rows).way_m;
    json["duration_s"] = report.plan.rows.back().time_s;
    json["min_clearance"] = voxcheck::moment_json(scene, checked.smallest, checked.clearance_m);
    json["min_clearance"]["at_least"] = checked.at_least;
    json["seat"] = Json::array();
    for (const std::uint32_t object : checked.seat_objects) {
      json["seat"].push_back(voxcheck::object_name(scene, object));
    }
    json["seated"] = Json::array();
    for (const auto& stretch : checked.seated) {
      json["seated"].push_back(voxcheck::seated_json(scene, stretch));
    }
    if (const double within_m = hidden_within_m(report); within_m > 0) {
      json["hidden_within_m"] = within_m;
    }
  } else {
    json["best"] = {{"out_m", result.out_m}, {"blocked_by", Json::array()}};
    for (const std::uint32_t object : result.blocked_by) {
      json["best"]["blocked_by"].push_back(voxcheck::object_name(scene, object));
    }
  }
  json["poses_tested"] = result.poses_tested;
  json["refused"] = result.refused;
  json["seed"] = report.options.seed;
  json["threads"] = report.options.threads;
  json["seconds"] = {{"search", result.seconds}, {"total", report.plan.seconds}};
  return json;
}

}  // namespace forcelayer::voxplan
