#include "workbench/voxplan/report.h"

#include <algorithm>
#include <cmath>
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

constexpr double kAtOnceM = 1e-6;  // a shorter motion does not count

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

// "+z" of a direction along an axis.
std::string axis_text(const glm::dvec3& direction) {
  const int axis = direction.x != 0 ? 0 : direction.y != 0 ? 1 : 2;
  return std::string(direction[axis] > 0 ? "+" : "-") + "xyz"[axis];
}

// The straight ways that are seen to be blocked.
std::vector<StraightWay> blocked_ways(const SearchResult& result) {
  std::vector<StraightWay> ways = result.straight;
  std::erase_if(ways, [](const StraightWay& way) { return !std::isfinite(way.blocked_at_m); });
  return ways;
}

// That which is blocked last, of some.
const StraightWay& farthest_of(const std::vector<StraightWay>& ways) {
  return *std::max_element(
      ways.begin(), ways.end(),
      [](const StraightWay& a, const StraightWay& b) { return a.blocked_at_m < b.blocked_at_m; });
}

// "x, y and z" of all six ways, or "+x, -x and +z".
std::string axes_text(const std::vector<StraightWay>& ways) {
  if (ways.size() == 6) return "x, y and z";
  std::string line;
  for (std::size_t n = 0; n < ways.size(); ++n) {
    line += (n == 0 ? "" : n + 1 == ways.size() ? " and " : ", ") + axis_text(ways[n].direction);
  }
  return line;
}

// To a micrometer: what is seen at poses is not proven.
std::string straight_text(const StraightWay& way) {
  return command::length_text(std::round(1e6 * way.blocked_at_m) / 1e6);
}

std::string moved_text(double length_m) {
  return length_m < kAtOnceM ? "moved it by less than 0.001 mm"
                             : "moved no point by more than " + command::at_most_text(length_m);
}

// "straight along x, y and z it gets at most 0.25 mm far (along +z), and a search of 38 s found no
// other way"
std::string not_found_text(const SearchResult& result) {
  const std::string search = text("a search of %.3g s ", result.seconds);
  const std::vector<StraightWay> ways = blocked_ways(result);
  if (ways.empty()) return search + moved_text(result.out_m);
  const StraightWay& farthest = farthest_of(ways);
  const bool is_at_once = farthest.blocked_at_m < kAtOnceM;
  const bool is_moved = result.out_m > farthest.blocked_at_m + kAtOnceM;
  return "straight along " + axes_text(ways) + " it " +
         (is_at_once ? "is blocked at once"
                     : "gets at most " + straight_text(farthest) + " far (along " +
                           axis_text(farthest.direction) + ")") +
         ", and " + search + (is_moved ? moved_text(result.out_m) + " and " : "") +
         "found no other way";
}

// How far the part goes straight, and what it overlaps where it is installed.
std::vector<std::string> not_found_notes(const Voxmap& scene, const Plan& plan) {
  std::vector<std::string> notes;
  const std::vector<StraightWay> ways = blocked_ways(plan.search);
  if (!ways.empty() && farthest_of(ways).blocked_at_m >= kAtOnceM) {
    const StraightWay& farthest = farthest_of(ways);
    const std::string name = voxcheck::shown_name(scene, farthest.blocked_by.front());
    notes.push_back("it goes farthest straight along " + axis_text(farthest.direction) +
                    ": after " + straight_text(farthest) + ", " +
                    (name.empty() ? "the scene" : name) +
                    (farthest.clearance_m > 0 ? " is nearer than required" : " is in the way"));
  }
  constexpr std::size_t kAllWays = 6;
  const bool is_any = !plan.search.straight.empty();
  for (std::size_t n = 0; is_any && n < kAllWays; ++n) {
    glm::dvec3 direction(0);
    direction[static_cast<int>(n / 2)] = n % 2 == 0 ? 1 : -1;
    const auto way = std::ranges::find(plan.search.straight, direction, &StraightWay::direction);
    const bool is_known = way != plan.search.straight.end();
    if (is_known && (std::isfinite(way->blocked_at_m) || way->clearance_m > 0)) continue;
    notes.push_back("straight along " + axis_text(direction) +
                    (is_known ? " nothing was seen in the way, but no proof was found"
                              : " nothing was looked for, because the time was over"));
  }
  for (const StraightWay& way : plan.search.straight) {
    if (!(way.clearance_m > 0 && std::isfinite(way.clearance_m))) continue;
    notes.push_back("straight along " + axis_text(way.direction) +
                    " it meets nothing, but comes as near as " +
                    command::length_text(way.clearance_m) + " to " +
                    voxcheck::shown_name(scene, way.blocked_by.front()));
  }
  for (const auto& [object, depth_m] : plan.overlaps) {
    notes.push_back("where the part is installed, it overlaps " +
                    voxcheck::shown_name(scene, object) + " by at least " +
                    command::length_text(depth_m));
  }
  return notes;
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
  verdict.finding = not_found_text(result);
  if (result.refused == 1) verdict.finding += ", and a path that was found could not be proven";
  if (result.refused > 1) {
    verdict.finding += text(", and %llu paths that were found could not be proven",
                            static_cast<unsigned long long>(result.refused));
  }
  if (!result.knows_blockers && blocked_ways(result).empty()) {
    verdict.finding +=
        ", and the time limit (--time) ended before all objects that block it were known";
  }
  verdict.notes = not_found_notes(report.problem.scene, report.plan);
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
    json["best"]["straight"] = Json::array();
    for (const StraightWay& way : result.straight) {
      Json names = Json::array();
      for (const std::uint32_t object : way.blocked_by) {
        names.push_back(voxcheck::object_name(scene, object));
      }
      json["best"]["straight"].push_back(
          {{"direction", axis_text(way.direction)},
           {"blocked_at_m", std::isfinite(way.blocked_at_m) ? Json(way.blocked_at_m) : Json()},
           {"blocked_by", names}});
    }
    json["best"]["notes"] = report.verdict.notes;
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
