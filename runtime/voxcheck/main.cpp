// voxcheck: says whether a part keeps its clearance along a path, and proves it for the whole path.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "formats/command/arguments.h"
#include "formats/command/command.h"
#include "formats/command/help.h"
#include "formats/command/output_file.h"
#include "formats/command/progress_line.h"
#include "formats/command/report.h"
#include "formats/command/text.h"
#include "formats/command/version.h"
#include "formats/path/path_edit.h"
#include "runtime/clearance/path_check.h"
#include "runtime/query/query_kernel.h"
#include "runtime/run/baked_files.h"
#include "runtime/run/start_check.h"
#include "runtime/voxcheck/exact.h"
#include "runtime/voxcheck/failure_files.h"
#include "runtime/voxcheck/missing_faces.h"
#include "runtime/voxcheck/object_names.h"
#include "runtime/voxcheck/options.h"
#include "runtime/voxcheck/path_source.h"
#include "runtime/voxcheck/picture.h"
#include "runtime/voxcheck/report.h"
#include "runtime/voxcheck/words.h"

namespace forcelayer::voxcheck {
namespace {

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Status prepare_outputs(Options& options) {
  using command::FileKind;
  std::vector<std::string> inputs{options.scene, options.part, options.path};
  if (!options.rules.empty()) inputs.push_back(options.rules);
  inputs.insert(inputs.end(), options.meshes.begin(), options.meshes.end());
  inputs.insert(inputs.end(), options.part_meshes.begin(), options.part_meshes.end());
  const command::OutputFile outputs[] = {
      {"--json", &options.json, FileKind::kReport},
      {"--report animation", &options.animation, FileKind::kAnimation},
      {"--report map", &options.map, FileKind::kAnimation},
      {"--report csv", &options.csv, FileKind::kTable},
      {"--report picture", &options.picture, FileKind::kPicture},
      {"--report junit", &options.junit, FileKind::kExport},
      {"--report gitlab", &options.code_quality, FileKind::kReport}};
  if (Status s = command::prepare_outputs(outputs, inputs); !s) return s;
  check_failure_file("junit:", options.junit);
  check_failure_file("gitlab:", options.code_quality);
  return {};
}

// With --rules there are several reports, else one.
Status write_reports(std::span<const Report> reports) {
  const auto [told, verdict] = verdict_of(reports);
  const Report& report = reports[told];
  const Options& options = report.options;
  const command::Subject subject = subject_of(options);
  if (!options.quiet) std::cout << command::terminal_text(verdict);
  if (options.github) std::cout << command::annotations(subject, verdict);
  std::cout.flush();
  if (!options.json.empty()) {
    nlohmann::ordered_json json = report_json(report, verdict);
    if (report.left_out != nullptr) json["rules"] = rules_json(reports);
    if (Status s = command::write_report(options.json, json); !s) return s;
  }
  if (!options.csv.empty()) {
    if (Status s = write_curve(report); !s) return s;
  }
  // Before the two that tell of a failure in place of the verdict.
  if (!options.picture.empty()) {
    if (Status s = draw_picture(report, verdict); !s) return s;
  }
  if (!options.junit.empty()) {
    const std::string test = command::junit_text(subject, verdict, report.read_s + report.check_s);
    if (Status s = command::write_text(options.junit, test); !s) return s;
  }
  if (!options.code_quality.empty()) {
    const auto issues = command::issues(subject, verdict);
    if (Status s = command::write_report(options.code_quality, issues); !s) return s;
  }
  return options.fail_on == "nothing" ? Status() : command::exit_of(verdict, options.path);
}

// How far the end of the path that is nearer to the seat lies from it.
double off_seat_m(const Pose& world_from_seat, const Pshell& part,
                  const clearance::CenterPath& path) {
  const auto& c = part.header().center_m;
  const Pose in_seat = world_from_seat * Pose{{c[0], c[1], c[2]}, {1, 0, 0, 0}};
  const auto off_m = [&](std::size_t pose) {
    return path.travel_between_m(in_seat, path.world_from_center({pose, 0}));
  };
  return std::min(off_m(0), off_m(path.poses() - 1));
}

// How many times as far as the scene is across the path leads from the scene's middle.
double scenes_away(const Voxmap& scene, const Pshell& part, std::span<const PathRow> rows) {
  const VoxmapHeader& h = scene.header();
  const PathFacts facts = path_facts(rows, part.header().center_m);
  double across2 = 0, away2 = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double low_m = static_cast<double>(h.origin_voxel[axis]) * h.voxel_size_m;
    const double edge_m = static_cast<double>(h.dims_voxels[axis]) * h.voxel_size_m;
    const double middle_m = low_m + edge_m / 2;
    const double away_m =
        std::max(std::abs(facts.low_m[axis] - middle_m), std::abs(facts.high_m[axis] - middle_m));
    across2 += edge_m * edge_m;
    away2 += away_m * away_m;
  }
  return std::sqrt(away2 / across2);
}

// A check against the objects that must keep one distance: all of them, or a group of --rules.
struct GroupCheck {
  Options options;  // with the group's clearance
  clearance::CheckResult result;
  std::optional<ExactAnswer> exact;
};

// Warns of a seat that touches nothing, that is not on the path or that is the part itself, and of
// a path that passes because it is of another scene, or in another unit.
void warn_of_places(const Options& options, const Voxmap& scene, const Pshell& part,
                    std::span<const PathRow> rows, const clearance::CenterPath& path,
                    std::span<const GroupCheck> checks, bool is_far) {
  constexpr double kFarAway = 10;  // a path in meters that was meant in millimeters is farther
  const auto warn = [&](const std::string& text) { command::warn(text, options.quiet); };
  if (options.world_from_seat) {
    const double off_m = off_seat_m(*options.world_from_seat, part, path);
    const double reach_m = clearance::kSeatVoxels * scene.voxel_size_m();
    const bool any_seat = std::any_of(checks.begin(), checks.end(), [](const GroupCheck& check) {
      return !check.result.seat_objects.empty();
    });
    if (!any_seat) {
      warn("the part touches nothing where it is installed (--seat)");
    } else if (!(off_m < reach_m)) {
      warn(
          command::text("--seat: has no effect, because the path neither begins nor ends there: "
                        "the nearer end is %.4g mm away, and must be less than %.4g mm away",
                        1e3 * off_m, 1e3 * reach_m));
    }
    const auto& c = part.header().center_m;
    const Pose installed = *options.world_from_seat * Pose{{c[0], c[1], c[2]}, {1, 0, 0, 0}};
    if (const auto warning =
            part_in_scene_warning(scene, part, installed, checks.front().result.seat_points)) {
      warn(*warning);
    }
  }
  if (is_far) {
    warn(never_near_text("path"));
  } else if (const double times = scenes_away(scene, part, rows); times > kFarAway) {
    warn(
        command::text("the path leads away from the scene by %.0f times the scene's size: check "
                      "the unit of the path",
                      times));
  }
}

// Warns where it is the rows that are too few: between two of them all of the part may be elsewhere
// than here, by more than a tenth of what is required, or of a voxel where that is more. Less
// changes an answer by less than the slack that it has anyway.
void warn_of_wide_step(const Options& options, const Voxmap& scene, const Pshell& part,
                       const std::vector<PathRow>& rows) {
  const WideStep step = widest_step(rows, part.header().center_m);
  if (!(step.aside_m > std::max(options.clearance_m, scene.header().voxel_size_m) / 10)) return;
  command::warn(
      command::text(
          "between the rows at %.3f and %.3f s the part turns by %.3g degrees. voxcheck moves the "
          "centroid in a straight line, by %.3f mm. If the part's origin moves in a straight line "
          "instead, the checked positions are up to %.3f mm wrong; add rows in between, or "
          "give --center 0,0,0m",
          rows[step.row].time_s, rows[step.row + 1].time_s, glm::degrees(step.turn_rad),
          1e3 * step.shift_m, 1e3 * step.aside_m),
      options.quiet);
}

// Whether each object is of some group.
bool do_all_count(std::span<const RuleGroup> groups) {
  for (std::size_t object = 1; object < groups.front().left_out.size(); ++object) {
    const bool counts = std::any_of(groups.begin(), groups.end(), [&](const RuleGroup& group) {
      return group.left_out[object] == 0;
    });
    if (!counts) return false;
  }
  return true;
}

// Checks the path against the objects that are not left out.
Result<GroupCheck> check_group(const Options& options, const Voxmap& scene, const Pshell& part,
                               const clearance::CenterPath& path,
                               const clearance::LeftOut& left_out, command::ProgressLine& line) {
  const auto show = [&](double fraction) { line.show("checking the path", fraction); };
  const clearance::CheckRequest request{options.clearance_m,
                                        options.threads,
                                        left_out,
                                        options.world_from_seat,
                                        options.felt_seat,
                                        {},
                                        show};
  if (options.meshes.empty()) {
    auto checked = clearance::check_path(scene, part, path, request);
    line.clear();
    if (checked) return GroupCheck{options, std::move(*checked), std::nullopt};
    Error error = checked.error();
    if (error.file.empty()) error.file = options.scene;
    return error;
  }
  auto settled = check_with_meshes(scene, part, path, request, options, [&](const auto& asked) {
    line.clear();  // voxcheck-exact has its own
    return ask_program(asked);
  });
  line.clear();
  if (!settled) return settled.error();
  return GroupCheck{options, std::move(settled->checked), std::move(settled->exact)};
}

Status check(const Options& options) {
  const double begin_s = now_s();
  const auto scene = open_scene(options.scene);
  if (!scene) return scene.error();
  const auto part = open_part(options.part);
  if (!part) return part.error();
  warn_of_missing_faces(options.scene, *scene, options.part, *part, options.quiet);
  const auto allowed = named_objects(*scene, options.allow);
  if (!allowed) return allowed.error();
  const auto rows = read_part_path(options, *part);
  if (!rows) return rows.error();
  warn_of_wide_step(options, *scene, *part, *rows);
  const clearance::CenterPath path(*rows, *part);
  const double read_s = now_s();
  std::vector<RuleGroup> groups{{options.clearance_m, *allowed}};
  std::vector<std::string> warnings;
  if (!options.rules.empty()) {
    auto found = groups_by_rules(options, *allowed, ask_program, warnings);
    if (!found) return found.error();
    groups = std::move(*found);
  }
  command::ProgressLine line(options.quiet);
  std::vector<GroupCheck> checks;
  for (const RuleGroup& group : groups) {
    Options own = options;
    own.clearance_m = group.required_m;
    if (own.max_s) own.max_s = std::max(0.0, *own.max_s - (now_s() - read_s));
    if (!checks.empty()) own.animation.clear();  // of all objects: written once
    auto checked = check_group(own, *scene, *part, path, group.left_out, line);
    if (!checked) return checked.error();
    checks.push_back(std::move(*checked));
  }
  if (!options.map.empty()) {
    line.clear();
    Options own = options;
    if (own.max_s) own.max_s = std::max(0.0, *own.max_s - (now_s() - read_s));
    if (Status s = write_map(own, groups, ask_program, warnings); !s) return s;
  }
  const bool is_far =
      do_all_count(groups) && std::all_of(checks.begin(), checks.end(), [&](const GroupCheck& own) {
        return is_never_near(own.result, *part, options.allow);
      });
  warn_of_places(options, *scene, *part, *rows, path, checks, is_far);
  const clearance::PathLength length(path, *part);
  std::vector<Report> reports;
  for (std::size_t n = 0; n < checks.size(); ++n) {
    const auto& [own, result, exact] = checks[n];
    if (exact) warnings.insert(warnings.end(), exact->warnings.begin(), exact->warnings.end());
    const CheckedPath checked{
        *scene, *part, *rows, path, length, result, exact ? &*exact : nullptr, own.clearance_m};
    reports.push_back({own, checked, exact, read_s - begin_s, now_s() - read_s,
                       options.rules.empty() ? nullptr : &groups[n].left_out, is_far});
  }
  std::set<std::string> warned;  // each group reads the meshes
  for (const std::string& warning : warnings) {
    if (warned.insert(warning).second) command::warn(warning, options.quiet);
  }
  return write_reports(reports);
}

int run(int argc, char** argv) {
  CLI::App app{
      "Checks that a part keeps its clearance from a scene along a path, and proves it for the "
      "whole path",
      "voxcheck"};
  app.footer(
      "Exit status 0: clear; 6: not clear; 7: not clear without force, because the installed part\n"
      "overlaps a neighbor.");
  command::set_version(app, std::string("vectors ") + query::kernel_target());
  OptionParser parser(app);
  command::arrange_help(
      app,
      {{"Question",
        {"--clearance", "--rules", "--center", "--seat", "--felt-seat", "--seat-depth", "--allow",
         "--fail-on", "--threads"}},
       {"Meshes",
        {"--exact", "--part", "--without", "--units", "--part-units", "--allow-outside",
         "--sandbox", "--time"}},
       {"Output", {"--report"}}},
      "  voxcheck bay.vox part.pshell run.csv                      for 1 mm clearance\n"
      "  voxcheck bay.vox part.pshell path.csv --clearance 3mm --report junit:verdict.xml\n"
      "  voxcheck bay.vox part.pshell path.csv --exact bay.json --part part.obj --units mm");
  tell_failures_in(failure_files(parser.typed(), argc, argv), argc, argv);
  int status = 0;
  if (!command::parse_arguments(app, argc, argv, status)) return status;
  command::exit_cleanly_on_signals();
  return command::run_command("voxcheck", [&]() -> Status {
    auto options = parser.finish();
    if (!options) return options.error();
    if (Status s = prepare_outputs(*options); !s) return s;
    return check(*options);
  });
}

}  // namespace
}  // namespace forcelayer::voxcheck

int main(int argc, char** argv) { return forcelayer::voxcheck::run(argc, argv); }
