#include "workbench/voxplan/report.h"

#include <nlohmann/json.hpp>

#include "formats/command/text.h"
#include "formats/path/path_edit.h"
#include "runtime/voxcheck/missing_faces.h"
#include "runtime/voxcheck/object_names.h"
#include "runtime/voxcheck/path_verdict.h"
#include "runtime/voxcheck/words.h"

namespace forcelayer::voxplan {
namespace {

using command::text;
using Json = nlohmann::ordered_json;

double hidden_within_m(const Report& report) {
  return voxcheck::hidden_within_m(report.problem.scene, report.plan.checked, report.options.allow);
}

std::optional<clearance::CenterPath> path_of(const Problem& problem, const Plan& plan) {
  if (!plan.search.found) return {};
  return clearance::CenterPath(plan.rows, problem.part);
}

voxcheck::CheckedPath checked_of(const Report& report) {
  return {report.problem.scene, report.problem.part, report.plan.rows, *report.path,
          *report.length,       report.plan.checked, nullptr,          report.options.clearance_m};
}

command::Verdict found_verdict(const Report& report) {
  const clearance::CheckResult& checked = report.plan.checked;
  command::Verdict verdict = voxcheck::verdict_of(checked_of(report));
  if (report.plan.exact) {
    voxcheck::add_overlaps(report.problem.scene, *report.plan.exact, verdict);
  }
  verdict.notes = voxcheck::bounds_texts(checked_of(report));
  verdict.notes.insert(verdict.notes.begin(), text("found in %.3g s", report.plan.search.seconds));
  if (!checked.seated.empty()) {
    verdict.notes.push_back(
        report.options.meshes.empty()
            ? "contact was checked with shell points only: voxcheck --exact checks it with the "
              "meshes"
            : "in contact, no surface passes through another: this was checked with the meshes");
  }
  if (const double within_m = hidden_within_m(report); within_m > 0) {
    verdict.notes.push_back(voxcheck::hidden_text(within_m) +
                            "; check the path with voxcheck --exact");
  }
  return verdict;
}

command::Verdict not_found_verdict(const Report& report) {
  const SearchResult& result = report.plan.search;
  command::Verdict verdict;
  verdict.kind = command::VerdictKind::kNoPathFound;
  verdict.required_m = report.options.clearance_m;
  verdict.scene_names = voxcheck::object_names(report.problem.scene);
  for (const std::uint32_t object : result.blocked_by) {
    verdict.blocked_by.push_back(voxcheck::object_name(report.problem.scene, object));
  }
  if (result.enclosed_by) {
    verdict.kind = command::VerdictKind::kDoesNotComeOut;
    verdict.finding = voxcheck::kEnclosed + std::string(", and moves at most ") +
                      command::at_most_text(result.out_m) + " straight along the axes x, y and z";
    return verdict;
  }
  verdict.finding = text("in %.3g s the search moved the part ", result.seconds) +
                    (result.out_m < 1e-6 ? "less than 0.001 mm"
                                         : "at most " + command::at_most_text(result.out_m)) +
                    " from its start";
  if (result.refused == 1) verdict.finding += ", and a path that was found could not be proven";
  if (result.refused > 1) {
    verdict.finding += text(", and %llu paths that were found could not be proven",
                            static_cast<unsigned long long>(result.refused));
  }
  if (!result.knows_blockers) {
    verdict.finding +=
        ", and the time limit (--time) ended before all objects that block it were known";
  }
  verdict.advice = "this does not prove that there is no path: try " +
                   std::string(result.is_out_of_time ? "a longer --time, " : "") +
                   "another --seed, a smaller --clearance or smaller voxels";
  return verdict;
}

}  // namespace

Report::Report(const Options& of_options, const Problem& of_problem, const Plan& of_plan)
    : options(of_options),
      problem(of_problem),
      plan(of_plan),
      path(path_of(of_problem, of_plan)),
      length(path ? std::optional(clearance::PathLength(*path, of_problem.part)) : std::nullopt),
      verdict(of_plan.search.found ? found_verdict(*this) : not_found_verdict(*this)) {}

Json report_json(const Report& report) {
  const SearchResult& result = report.plan.search;
  const clearance::CheckResult& checked = report.plan.checked;
  const Voxmap& scene = report.problem.scene;
  Json json;
  json["schema_version"] = 1;
  json["found"] = result.found;
  json.update(command::verdict_json(report.verdict));
  json["settled_by"] = report.options.meshes.empty() ? "files" : "meshes";
  json["missing_faces"] = voxcheck::missing_faces(report.problem.scene, report.problem.part);
  if (result.found) {
    json["path"] = report.options.path;
    json["rows"] = report.plan.rows.size();
    json["length_m"] = path_facts(report.plan.rows).length_m;
    json["duration_s"] = report.plan.rows.back().time_s;
    const voxcheck::CheckedPath checked_path = checked_of(report);
    json["min_clearance"] =
        voxcheck::moment_json(checked_path, checked.smallest, checked.clearance_m);
    json["min_clearance"]["at_least"] = checked.at_least;
    json["seat"] = Json::array();
    for (const std::uint32_t object : checked.seat_objects) {
      json["seat"].push_back(voxcheck::object_name(scene, object));
    }
    json["seated"] = Json::array();
    for (const auto& stretch : checked.seated) {
      json["seated"].push_back(voxcheck::seated_json(checked_path, stretch));
    }
    if (const double within_m = hidden_within_m(report); within_m > 0) {
      json["hidden_within_m"] = within_m;
    }
  } else {
    json["best"] = {{"out_m", result.out_m}, {"blocked_by", Json::array()}};
    for (const std::uint32_t object : result.blocked_by) {
      json["best"]["blocked_by"].push_back(voxcheck::object_name(scene, object));
    }
    // The columns of a path: t_s, x_m, y_m, z_m, qw, qx, qy, qz.
    json["best"]["path"] = Json::array();
    for (const PathRow& row : report.plan.rows) {
      const auto& [x, y, z] = row.position_m;
      const auto& [qw, qx, qy, qz] = row.orientation_wxyz;
      json["best"]["path"].push_back({row.time_s, x, y, z, qw, qx, qy, qz});
    }
  }
  json["poses_tested"] = result.poses_tested;
  json["refused"] = result.refused;
  json["out_of_time"] = result.is_out_of_time;
  json["seed"] = report.options.seed;
  json["threads"] = report.options.threads;
  json["seconds"] = {{"search", result.seconds}, {"total", report.plan.seconds}};
  return json;
}

}  // namespace forcelayer::voxplan
