#include "runtime/voxplan/report.h"
#include "runtime/voxcheck/missing_faces.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/command/text.h"
#include "formats/path/path_edit.h"
#include "runtime/voxcheck/object_names.h"

namespace forcelayer::voxplan {
namespace {

using command::text;
using Json = nlohmann::ordered_json;

constexpr std::size_t kListed = 5;  // objects on the terminal

std::string name_of(const Report& report, std::uint32_t object) {
  return escaped(voxcheck::object_name(report.problem.scene, object));
}

// Rounded down: a clearance must not be quoted larger than it is.
double floor_mm(double length_m) { return std::floor(length_m * 1e6) / 1e3; }

std::string names_of(const Report& report, const std::vector<std::uint32_t>& objects) {
  std::string line;
  for (std::size_t n = 0; n < objects.size(); ++n) {
    if (n == kListed) return line + text(" and %zu more", objects.size() - kListed);
    line += (n == 0 ? "" : ", ") + name_of(report, objects[n]);
  }
  return line;
}

std::string seat_text(const Report& report) {
  if (report.plan.checked.seated.empty()) return "";
  return text("; until %.3f s seated on ", report.plan.checked.seated.front().to_s) +
         names_of(report, report.plan.checked.seat_objects);
}

}  // namespace

std::string found_text(const Report& report) {
  const clearance::CheckResult& checked = report.plan.checked;
  const PathFacts facts = path_facts(report.plan.rows);
  std::string line =
      text("path found in %.3g s: %.4g mm long, %s %.3f mm", report.plan.search.seconds,
           1e3 * facts.way_m, checked.at_least ? "at least" : "proven clearance",
           floor_mm(checked.clearance_m));
  if (checked.least.object != 0) line += " to " + name_of(report, checked.least.object);
  line += seat_text(report) + "\n";
  if (checked.seated.empty()) return line;
  return line + "  its seat is felt by shell points alone: voxcheck --exact settles it\n";
}

std::string not_found_text(const Report& report) {
  const SearchResult& result = report.plan.search;
  std::string line =
      text("no path found in %.3g s (best: out to %.3g mm", result.seconds, 1e3 * result.out_m);
  if (!result.blocked_by.empty()) line += ", blocked by " + names_of(report, result.blocked_by);
  if (result.refused == 0) return line + ")";
  return line +
         text("; %llu that did not prove clear)", static_cast<unsigned long long>(result.refused));
}

Json report_json(const Report& report) {
  const SearchResult& result = report.plan.search;
  const clearance::CheckResult& checked = report.plan.checked;
  const auto named = [&](std::uint32_t object) {
    return object == 0 ? Json(nullptr) : Json(voxcheck::object_name(report.problem.scene, object));
  };
  Json json;
  json["schema_version"] = 1;
  json["found"] = result.found;
  json["required_clearance_m"] = report.options.clearance_m;
  json["missing_faces"] = voxcheck::missing_faces(report.problem.scene, report.problem.part);
  if (result.found) {
    json["path"] = report.options.path;
    json["rows"] = report.plan.rows.size();
    json["way_m"] = path_facts(report.plan.rows).way_m;
    json["duration_s"] = report.plan.rows.back().time_s;
    const auto& p = checked.least.point_m;
    json["least_clearance"] = {{"clearance_m", checked.clearance_m},
                               {"at_least", checked.at_least},
                               {"t_s", checked.least.time_s},
                               {"object", named(checked.least.object)},
                               {"point_m", {p.x, p.y, p.z}}};
    json["seat"] = Json::array();
    for (const std::uint32_t object : checked.seat_objects) json["seat"].push_back(named(object));
    json["seated"] = Json::array();
    for (const auto& stretch : checked.seated) {
      json["seated"].push_back({{"from_s", stretch.from_s}, {"to_s", stretch.to_s}});
    }
  } else {
    json["best"] = {{"out_m", result.out_m}, {"blocked_by", Json::array()}};
    for (const std::uint32_t object : result.blocked_by) {
      json["best"]["blocked_by"].push_back(named(object));
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
