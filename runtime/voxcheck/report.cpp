#include "runtime/voxcheck/report.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/command/report.h"
#include "formats/command/text.h"
#include "formats/path/path_edit.h"
#include "runtime/voxcheck/missing_faces.h"
#include "runtime/voxcheck/object_names.h"
#include "runtime/voxcheck/words.h"

namespace forcelayer::voxcheck {
namespace {

using clearance::CheckResult;
using clearance::Violation;
using command::length_text;
using command::text;

constexpr std::size_t kListed = 5;  // violations on the terminal

using Json = nlohmann::ordered_json;

// In its seat a part is known by its shell points, to either side of which the covering radius is
// not looked at.
double narrowest_felt_m(const Report& report) {
  return 2 * report.checked.part.header().covering_radius_m;
}

// Whether the meshes tell of each object of the seat how deep the part goes into it.
bool is_seat_settled(const Report& report) {
  return report.exact && std::all_of(report.exact->seat.begin(), report.exact->seat.end(),
                                     [](const ExactSeat& seat) { return seat.settled; });
}

// The objects that the part overlaps where it is installed, for certain.
std::vector<std::string> overlap_texts(const Report& report) {
  std::vector<std::string> texts;
  if (!report.exact) return texts;
  for (const ExactSeat& seat : report.exact->seat) {
    if (!seat.overlaps()) continue;
    texts.push_back("where the part is installed, it overlaps " +
                    shown_name(report.checked.scene, seat.object) + " by at least " +
                    length_text(seat.installed_m) + "; the force that this takes is not computed");
  }
  return texts;
}

// The meshes see all objects.
double hidden_within_m(const Report& report) {
  if (report.exact) return 0;
  return voxcheck::hidden_within_m(report.checked.scene, report.checked.result,
                                   report.options.allow);
}

void add_exact(Json& json, const ExactMoment& moment) {
  const bool any = moment.exact_m < kNothingM;
  json["exact_m"] = any ? Json(moment.exact_m) : Json(nullptr);
  json["object_point_m"] = any ? Json(moment.scene_m) : Json(nullptr);
}

Json seat_depths_json(const Report& report) {
  Json list = Json::array();
  for (const ExactSeat& seat : report.exact->seat) {
    list.push_back({{"object", object_name(report.checked.scene, seat.object)},
                    {"shown_as", shown_name(report.checked.scene, seat.object)},
                    {"gap_m", seat.gap_m},
                    {"nearest_m", seat.nearest_m},
                    {"installed_m", seat.installed_m},
                    {"deepest_m", seat.deepest_m},
                    {"allowed_m", seat.allowed_m},
                    {"settled", seat.settled}});
  }
  return list;
}

Json violation_json(const Report& report, const Violation& v) {
  Json json = stretch_json(report.checked, v.from_s, v.to_s);
  json.update(moment_json(report.checked, v.worst, v.clearance_m));
  json["beyond_cropped_side"] = v.worst.beyond_side;
  json["pushed_into_seat"] = v.pushed_into_seat;
  json["seat_not_settled"] = v.unsettled_seat;
  json["object_inside"] = v.object_inside;
  if (v.out_of_time) json["out_of_time"] = true;
  if (v.pushed_into_seat || v.depth_m > 0) json["depth_m"] = v.depth_m;
  if (const ExactViolation* exact = exact_of(report.checked, v)) {
    if (v.depth_m > 0) json["max_depth_m"] = exact->max_depth_m;
    if (exact->contact_known) json["contact_from_m"] = along_m(report.checked, exact->contact_s);
    add_exact(json, exact->worst);
    json["graze"] = exact->graze;
    json["inside"] = exact->inside;
  }
  return json;
}

// As --seat takes it.
std::string seat_of(const PathRow& row) {
  const auto& p = row.position_m;
  const auto& q = row.orientation_wxyz;
  // Adding zero turns -0 to 0.
  std::string pose = text("%.9g,%.9g,%.9gm", p[0] + 0.0, p[1] + 0.0, p[2] + 0.0);
  if (std::max({std::abs(q[1]), std::abs(q[2]), std::abs(q[3])}) > 1e-9) {
    pose += text(",%.9g,%.9g,%.9g,%.9g", q[0], q[1], q[2], q[3]);
  }
  return pose;
}

// Where the part is too near at an end of its path, it may be installed there.
std::string seat_mend(const Report& report) {
  if (report.options.world_from_seat) return "";
  const auto any = [&](const auto& is_so) {
    const auto& all = report.checked.result.violations;
    return std::any_of(all.begin(), all.end(), [&](const Violation& v) {
      const ExactViolation* exact = exact_of(report.checked, v);
      const bool is_inside = v.object_inside || (exact != nullptr && exact->inside);
      return !v.worst.beyond_side && !is_inside && is_so(v);
    });
  };
  const PathRow &first = report.checked.rows.front(), &last = report.checked.rows.back();
  const bool begins = any([&](const Violation& v) { return v.from_s <= first.time_s; });
  const bool ends = any([&](const Violation& v) { return v.to_s >= last.time_s; });
  if (!begins && !ends) return "";
  return text("if the part is installed at the path's %s, give --seat ",
              begins ? "beginning" : "end") +
         seat_of(begins ? first : last);
}

// How bad an answer is: what collides first, then what is too near, then what is open. Of those
// that are yes, the one that leaves the part in its seat first.
int rank_of(command::VerdictKind kind) {
  using command::VerdictKind;
  switch (command::without_overlap(kind)) {
    case VerdictKind::kCollides:
    case VerdictKind::kDoesNotComeOut:
      return 0;
    case VerdictKind::kTooNear:
      return 1;
    case VerdictKind::kTooCloseToCall:
      return 2;
    case VerdictKind::kStaysInstalled:
      return 4;
    case VerdictKind::kLeavesSeat:
      return 5;
    case VerdictKind::kComesOut:
      return 6;
    case VerdictKind::kKeepsClearance:
      return 7;
    default:
      return 3;
  }
}

// How much farther apart than required, where that is known.
double slack_m(const command::Verdict& verdict) {
  return verdict.nearest.known == command::VerdictDistance::Known::kNot
             ? INFINITY
             : verdict.nearest.distance_m - verdict.required_m;
}

// Adds the answer about other objects to that of `verdict`.
void add_rule(const command::Verdict& other, command::Verdict& verdict) {
  const auto add = [](const std::vector<std::string>& more, std::vector<std::string>& list) {
    for (const std::string& one : more) {
      if (std::find(list.begin(), list.end(), one) == list.end()) list.push_back(one);
    }
  };
  verdict.notes.push_back("by another rule: " + command::sentence(other));
  add(other.remarks, verdict.remarks);
  add(other.blocked_by, verdict.blocked_by);
  if (!command::passes(other.kind)) verdict.more.push_back(command::gist(other));
  if (!command::passes(verdict.kind) || other.overlapped.empty()) return;
  verdict.kind = command::with_overlap(command::without_overlap(verdict.kind));
  verdict.advice = command::kOverlapAdvice;
  add(other.overlapped, verdict.overlapped);
  verdict.overlap_m = std::max(verdict.overlap_m, other.overlap_m);
}

// How deep the part goes into the objects of its seat, as far as that is known.
std::string seat_depth_text(const Report& report) {
  if (report.checked.result.seated.empty()) return "";
  if (!is_seat_settled(report)) {
    return text("in its seat, features narrower than %.2f mm are not seen%s",
                ceil_mm(narrowest_felt_m(report)), report.exact ? "" : "; the meshes show them");
  }
  const auto& seats = report.exact->seat;
  const auto deeper = [](const ExactSeat& seat) { return seat.deepest_m - seat.installed_m; };
  const auto deepest = std::max_element(
      seats.begin(), seats.end(),
      [&](const ExactSeat& a, const ExactSeat& b) { return deeper(a) < deeper(b); });
  if (deepest == seats.end()) return "";
  const double allowed_m = deepest->allowed_m - deepest->installed_m;
  const std::string object = shown_name(report.checked.scene, deepest->object);
  if (allowed_m < kRoundingM && deeper(*deepest) < kRoundingM) {
    return "in its seat, the part never goes deeper than installed";
  }
  // The deepest position of some moments is known. That none is deeper than allowed is proven.
  const std::string found = length_text(std::max(0.0, deeper(*deepest)));
  if (deeper(*deepest) <= allowed_m) {
    const std::string depth =
        deeper(*deepest) < kRoundingM
            ? ". No deeper position was found"
            : ". The deepest position found is " + found + " deeper than installed, in " + object;
    if (!report.options.seat_depth_m) {
      return "in its seat, the part goes no deeper than installed. This is proven to within " +
             command::at_most_text(allowed_m) + ", the deviations and cracks of the two meshes" +
             depth;
    }
    return "in its seat, the part goes at most " + command::at_most_text(allowed_m) +
           " deeper than installed; --seat-depth and the meshes' deviations allow this" + depth;
  }
  return "in its seat, the part goes at least " + found + " deeper into " + object +
         " than installed; " +
         (allowed_m < kRoundingM ? "no extra depth is allowed beyond rounding"
                                 : length_text(allowed_m) + " may be deviations of the meshes" +
                                       (deepest->has_seat_depth() ? " and --seat-depth" : ""));
}

// Where the part turns, its points travel along ways of different lengths.
std::string path_length_text(const CheckedPath& checked) {
  constexpr double kShownM = 1e-4;
  const auto& c = checked.part.header().center_m;
  const double whole_m = checked.length.whole_m();
  const double center_m = path_facts(checked.rows, {c[0], c[1], c[2]}).length_m;
  if (whole_m - center_m < kShownM) return "";
  return text(
      "positions along the path are travel of the part's fastest point, %.1f mm in all; its "
      "centroid travels %.1f mm",
      1e3 * whole_m, 1e3 * center_m);
}

// That of a path which ends before the part has left its seat.
std::string end_text(command::VerdictKind kind) {
  const bool stays = command::without_overlap(kind) == command::VerdictKind::kStaysInstalled;
  return stays ? "the path ends in the seat: whether the part comes out was not checked" : "";
}

std::string advice_of(const Report& report, const command::Verdict& verdict) {
  if (verdict.kind == command::VerdictKind::kNeverNear) {
    return "check the units of the path, and whether path, part and scene belong together";
  }
  if (report.checked.result.clear()) return verdict.advice;
  const Violation& worst = worst_of(report.checked);
  if (worst.out_of_time) return "give a longer --time, or check a part of the path";
  if (worst.unsettled_seat) {
    return report.exact ? "close all open edges of one of the two meshes and bake again, or accept "
                          "the seat with --felt-seat"
                        : "check the seat with --exact, or accept it with --felt-seat";
  }
  const std::string mend = seat_mend(report);
  if (!mend.empty()) return mend;
  const bool is_open = verdict.kind == command::VerdictKind::kUndecided;
  return is_open && !report.exact && !worst.worst.beyond_side
             ? "decide with --exact, or with smaller voxels"
             : "";
}

}  // namespace

command::Verdict verdict_of(const Report& report) {
  const CheckedPath& checked = report.checked;
  const CheckResult& r = checked.result;
  command::Verdict verdict = verdict_of(checked);
  if (report.is_far && report.options.fail_on == "far") {
    verdict.kind = command::VerdictKind::kNeverNear;
  }
  verdict.advice = advice_of(report, verdict);
  verdict.remarks = overlap_texts(report);
  auto& notes = verdict.notes;
  if (std::string line = end_text(verdict.kind); !line.empty()) notes.push_back(line);
  if (const auto object = enclosing_object(checked)) {
    notes.push_back(shown_name(checked.scene, *object) +
                    " encloses the part on all sides, so no other path leads out either");
  }
  // That of the sentence first.
  std::vector<const Violation*> listed;
  if (!r.clear()) listed.push_back(&worst_of(checked));
  for (const Violation& v : r.violations) {
    if (listed.size() < kListed && &v != listed.front()) listed.push_back(&v);
  }
  for (const Violation* const v : listed) notes.push_back(violation_text(checked, *v));
  if (r.violations.size() > kListed) {
    notes.push_back(text("and %zu more", r.violations.size() - kListed));
  }
  for (std::string& line : bounds_texts(checked)) notes.push_back(std::move(line));
  if (std::string line = path_length_text(checked); !line.empty()) {
    notes.push_back(std::move(line));
  }
  notes.insert(notes.end(), verdict.remarks.begin(), verdict.remarks.end());
  if (std::string line = seat_depth_text(report); !line.empty()) notes.push_back(std::move(line));
  if (const double within_m = hidden_within_m(report); within_m > 0) {
    notes.push_back(hidden_text(within_m) + "; the meshes show them");
  }
  if (const auto missing = missing_faces(checked.scene, checked.part); missing > 0) {
    notes.push_back(
        text("faces that could not be read: %llu of scene and part; the answer does not cover them",
             static_cast<unsigned long long>(missing)));
  }
  return verdict;
}

RulesVerdict verdict_of(std::span<const Report> reports) {
  std::vector<command::Verdict> verdicts;
  for (const Report& report : reports) verdicts.push_back(verdict_of(report));
  const auto worst =
      std::min_element(verdicts.begin(), verdicts.end(), [](const auto& a, const auto& b) {
        const int rank_a = rank_of(a.kind), rank_b = rank_of(b.kind);
        return rank_a != rank_b ? rank_a < rank_b : slack_m(a) < slack_m(b);
      });
  RulesVerdict all{static_cast<std::size_t>(worst - verdicts.begin()), *worst};
  for (const command::Verdict& other : verdicts) {
    if (&other != &*worst) add_rule(other, all.verdict);
  }
  return all;
}

std::vector<std::string> picture_title(const command::Verdict& verdict) {
  return {command::heading(verdict), command::explanation(verdict)};
}

// The least clearance of the whole path, stretches in which the answer is no included.
Json smallest_json(const Report& report) {
  const CheckResult& r = report.checked.result;
  const Violation* nearest = nullptr;
  for (const Violation& v : r.violations) {
    if (v.unsettled_seat || v.out_of_time || !(v.clearance_m < r.clearance_m)) continue;
    if (nearest == nullptr || v.clearance_m < nearest->clearance_m) nearest = &v;
  }
  if (!r.clear()) {  // of several that are as near, the one that the verdict names
    const Violation& worst = worst_of(report.checked);
    const bool is_known = !worst.unsettled_seat && !worst.out_of_time;
    const double min_m = nearest == nullptr ? r.clearance_m : nearest->clearance_m;
    if (is_known && worst.clearance_m <= min_m) nearest = &worst;
  }
  Json json = nearest == nullptr
                  ? moment_json(report.checked, r.smallest, r.clearance_m)
                  : moment_json(report.checked, nearest->worst, nearest->clearance_m);
  json["at_least"] = nearest == nullptr && r.at_least;
  if (nearest == nullptr && report.exact) {
    add_exact(json, report.exact->smallest);
  } else if (nearest != nullptr && exact_of(report.checked, *nearest) != nullptr) {
    add_exact(json, exact_of(report.checked, *nearest)->worst);
  }
  return json;
}

// The moment of which the sentence speaks.
Json told_json(const Report& report) {
  if (!report.checked.result.clear()) return smallest_json(report);
  const ToldMoment told = told_moment(report.checked);
  Json json = moment_json(report.checked, told.moment, told.moment.clearance_m);
  json["at_least"] = report.checked.result.at_least && told.exact == nullptr;
  if (told.exact != nullptr) add_exact(json, *told.exact);
  return json;
}

command::Subject subject_of(const Options& options) {
  return {"voxcheck", options.part, options.path};
}

Json report_json(const Report& report, const command::Verdict& verdict) {
  const CheckResult& r = report.checked.result;
  Json json;
  json["schema_version"] = 1;
  json.update(command::verdict_json(verdict));
  json["min_clearance"] = smallest_json(report);
  json["told_moment"] = told_json(report);
  if (report.exact) {
    json["exact"] = {{"deviations_and_rounding_m", report.exact->margin_m},
                     {"moments_measured", report.exact->moments}};
  }
  if (const double within_m = hidden_within_m(report); within_m > 0) {
    json["hidden_within_m"] = within_m;
  }
  json["missing_faces"] = missing_faces(report.checked.scene, report.checked.part);
  json["poses"] = r.poses;
  json["path_m"] = report.checked.length.whole_m();
  json["travel_m"] = r.travel_m;
  json["moments_tested"] = r.moments_tested;
  json["motions_subdivided"] = r.motions_subdivided;
  json["violations"] = Json::array();
  for (const Violation& v : r.violations) json["violations"].push_back(violation_json(report, v));
  json["seated"] = Json::array();
  for (std::size_t n = 0; n < r.seated.size(); ++n) {
    Json stretch = seated_json(report.checked, r.seated[n]);
    if (const ExactMoment* exact = exact_in_seat(report.checked, n)) add_exact(stretch, *exact);
    json["seated"].push_back(stretch);
  }
  json["seat"] = Json::array();
  for (const std::uint32_t object : r.seat_objects) {
    json["seat"].push_back(object_name(report.checked.scene, object));
  }
  if (!r.seated.empty()) {
    json["narrowest_felt_m"] = narrowest_felt_m(report);
    json["seat_settled"] = is_seat_settled(report);
  }
  if (report.exact && !report.exact->seat.empty()) json["seat_depths"] = seat_depths_json(report);
  json["threads"] = report.options.threads;
  json["seconds"] = {{"read", report.read_s},
                     {"check", report.check_s},
                     {"total", report.read_s + report.check_s}};
  return json;
}

Json rules_json(std::span<const Report> reports) {
  Json list = Json::array();
  const Voxmap& scene = reports.front().checked.scene;
  const auto names_of = [&](const auto& is_meant) {
    Json names = Json::array();
    for (std::uint32_t object = 1; object <= scene.header().object_count; ++object) {
      if (is_meant(object)) names.push_back(object_name(scene, object));
    }
    return names;
  };
  for (const Report& report : reports) {
    const command::Verdict verdict = verdict_of(report);
    const auto is_counted = [&](std::uint32_t object) { return (*report.left_out)[object] == 0; };
    list.push_back({{"required_clearance_m", verdict.required_m},
                    {"objects", names_of(is_counted)},
                    {"verdict", command::verdict_word(verdict)},
                    {"kind", command::to_text(verdict.kind)},
                    {"sentence", command::sentence(verdict)}});
  }
  Json ignored = names_of([&](std::uint32_t object) {
    return std::all_of(reports.begin(), reports.end(),
                       [&](const Report& report) { return (*report.left_out)[object] != 0; });
  });
  if (!ignored.empty()) {
    list.push_back({{"required_clearance_m", nullptr}, {"objects", std::move(ignored)}});
  }
  return list;
}

Status write_curve(const Report& report) {
  std::string table = "from_s,to_s,clearance_m,from_m,to_m\n";
  for (const auto& piece : report.checked.result.curve) {
    const double from_m = along_m(report.checked, piece.from_s);
    const double to_m = along_m(report.checked, piece.to_s);
    for (const double number : {piece.from_s, piece.to_s, piece.clearance_m, from_m, to_m}) {
      char digits[32];  // the shortest text that reads back as the same number
      table.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
      table += ',';
    }
    table.back() = '\n';
  }
  return command::write_text(report.options.csv, table);
}

}  // namespace forcelayer::voxcheck
