#include "runtime/voxcheck/report.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/command/report.h"
#include "formats/command/text.h"
#include "runtime/voxcheck/hosts.h"
#include "runtime/voxcheck/missing_faces.h"
#include "runtime/voxcheck/object_names.h"
#include "runtime/voxcheck/words.h"

namespace forcelayer::voxcheck {
namespace {

using clearance::CheckedMoment;
using clearance::CheckResult;
using clearance::Violation;
using command::text;
using Json = nlohmann::ordered_json;

constexpr std::size_t kListed = 5;  // violations on the terminal

double ceil_nm_in_mm(double length_m) { return std::ceil(length_m * 1e9) / 1e6; }

// Depths that were found, rounded down: they are no more than the true ones.
std::string meeting_text(const Report& report, const ExactViolation& exact) {
  const std::string name = escaped(object_name(report.scene, exact.worst.object));
  std::string line = exact.inside ? "all of the part is inside" : "the surfaces meet";
  if (exact.inside && !name.empty()) line += " of " + name;
  if (exact.depth_m > 0) line += text(", at least %.3f mm deep", floor_mm(exact.depth_m));
  if (exact.inside || name.empty()) return line;
  return line + (exact.depth_m > 0 ? " in " : ": ") + name;
}

std::string exact_text(const Report& report, const ExactViolation& exact) {
  if (!exact.graze) return text("%.3f mm exact", 1e3 * exact.worst.exact_m);
  return text("a graze, %.6f mm exact and %.6f mm of deviations and rounding",
              1e3 * exact.worst.exact_m, ceil_nm_in_mm(report.exact->margin_m));
}

// In its seat a part is known by its shell points, to either side of which the covering radius is
// not looked at.
double narrowest_felt_m(const Report& report) { return 2 * report.part.header().covering_radius_m; }

const ExactSeat* exact_seat(const Report& report, std::uint32_t object) {
  if (!report.exact) return nullptr;
  for (const ExactSeat& seat : report.exact->seat) {
    if (seat.object == object) return &seat;
  }
  return nullptr;
}

std::string pushed_text(const Report& report, const Violation& v) {
  const std::string object = escaped(object_name(report.scene, v.worst.object));
  if (exact_of(report, v) == nullptr) {
    return text("pushed %.3f mm deeper into %s than it is seated, ", 1e3 * v.depth_m,
                object.c_str()) +
           place_text(v.worst);
  }
  const ExactSeat* seat = exact_seat(report, v.worst.object);
  if (const ExactViolation& exact = *exact_of(report, v); exact.graze) {
    return text(
               "too close to call: in its seat at least %.6f and at most %.6f mm deep in %s, and "
               "%.6f mm are allowed, ",
               1e3 * v.depth_m, ceil_nm_in_mm(exact.max_depth_m), object.c_str(),
               1e3 * seat->allowed_m) +
           place_text(v.worst);
  }
  return text("pushed %.3f mm deep into %s, %.3f mm where it is installed and %.3f mm allowed, ",
              1e3 * v.depth_m, object.c_str(), 1e3 * seat->installed_m, 1e3 * seat->allowed_m) +
         place_text(v.worst);
}

std::string unsettled_text(const Report& report, const Violation& v) {
  const std::string object = escaped(object_name(report.scene, v.worst.object));
  if (report.exact) {
    return "not settled: in its seat it meets " + object +
           ", and both meshes are open and have no inside; accept with --felt-seat";
  }
  return text(
      "not settled: in its seat, features of %s narrower than %.2f mm are not felt; settle "
      "with --exact, or accept with --felt-seat",
      object.c_str(), ceil_mm(narrowest_felt_m(report)));
}

std::string inside_text(const Report& report, const Violation& v) {
  const std::string object = escaped(object_name(report.scene, v.worst.object));
  return (object.empty() ? "an object" : object) + " lies inside the part";
}

// One violation, from its time on.
std::string violation_text(const Report& report, const Violation& v) {
  std::string line = text("%.3f to %.3f s: ", v.from_s, v.to_s);
  if (v.pushed_into_seat) return line + pushed_text(report, v);
  if (v.unsettled_seat) return line + unsettled_text(report, v);
  if (v.object_inside) return line + inside_text(report, v) + ", " + place_text(v.worst);
  if (v.worst.beyond_side)
    return line +
           text("%.3f mm to a cropped side of the scene, beyond which nothing is known, ",
                floor_mm(v.clearance_m)) +
           place_text(v.worst);
  if (const ExactViolation* exact = exact_of(report, v)) {
    if (exact->meets()) return line + meeting_text(report, *exact) + ", " + place_text(v.worst);
    return line + exact_text(report, *exact) + to_object(report.scene, v.worst.object) + ", " +
           place_text(v.worst);
  }
  return line +
         text("%.3f mm proven%s%s, ", floor_mm(v.clearance_m), max_text(v.worst).c_str(),
              to_object(report.scene, v.worst.object).c_str()) +
         place_text(v.worst);
}

std::string seat_text(const Report& report) {
  if (report.result.seated.empty()) return "";
  // The meshes may be as far away as required where the files do not prove it.
  const auto& objects = report.result.seat_objects;
  std::string line =
      objects.empty() ? "in its seat" : "seated on " + listed_names(report.scene, objects);
  const char* from = " from";
  for (const auto& stretch : report.result.seated) {
    line += text("%s %.3f to %.3f s", from, stretch.from_s, stretch.to_s);
    from = " and from";
  }
  return line + "; else ";
}

// Whether the meshes tell of each object of the seat how deep the part goes into it.
bool is_seat_settled(const Report& report) {
  return report.exact && std::all_of(report.exact->seat.begin(), report.exact->seat.end(),
                                     [](const ExactSeat& seat) { return seat.settled; });
}

// The objects that the part overlaps where it is installed, by more than deviations and rounding.
std::vector<std::string> overlap_texts(const Report& report) {
  std::vector<std::string> texts;
  if (!report.exact) return texts;
  for (const ExactSeat& seat : report.exact->seat) {
    if (seat.installed_m <= report.exact->margin_m) continue;
    texts.push_back(text("where it is installed the part overlaps %s by %.3f mm",
                         escaped(object_name(report.scene, seat.object)).c_str(),
                         1e3 * seat.installed_m));
  }
  return texts;
}

// How deep the part goes into the objects of its seat, as far as that is known.
std::string seat_depth_text(const Report& report) {
  if (report.result.seated.empty()) return "";
  if (!is_seat_settled(report)) {
    return text(
        "  in its seat it may pass through features of those objects narrower than %.2f mm\n",
        ceil_mm(narrowest_felt_m(report)));
  }
  const auto& seats = report.exact->seat;
  const auto deeper = [](const ExactSeat& seat) { return seat.deepest_m - seat.installed_m; };
  std::string overlaps;
  for (const std::string& overlap : overlap_texts(report)) overlaps += "  " + overlap + "\n";
  const auto deepest = std::max_element(
      seats.begin(), seats.end(),
      [&](const ExactSeat& a, const ExactSeat& b) { return deeper(a) < deeper(b); });
  if (deepest == seats.end()) return "";
  return overlaps + text(
                        "  in its seat %.3f mm deeper than installed are allowed; deepest found "
                        "%.3f mm deeper, into "
                        "%s\n",
                        1e3 * (deepest->allowed_m - deepest->installed_m),
                        1e3 * std::max(0.0, deeper(*deepest)),
                        escaped(object_name(report.scene, deepest->object)).c_str());
}

// The meshes see all objects.
double hidden_within_m(const Report& report) {
  if (report.exact) return 0;
  return voxcheck::hidden_within_m(report.scene, report.result, report.options.allow);
}

// The measurement of a stretch in the seat; null without --exact, and where no object counts.
const ExactMoment* exact_in_seat(const Report& report, std::size_t stretch) {
  if (!report.exact || stretch >= report.exact->seated.size()) return nullptr;
  const ExactMoment& nearest = report.exact->seated[stretch].nearest;
  return nearest.exact_m < kNothingM ? &nearest : nullptr;
}

// A line for each stretch in the seat.
std::string seat_ways_text(const Report& report) {
  std::string lines;
  for (std::size_t n = 0; n < report.result.seated.size(); ++n) {
    const ExactMoment* exact = exact_in_seat(report, n);
    lines += seat_way_text(report.scene, report.result, n,
                           exact != nullptr ? std::optional(exact->exact_m) : std::nullopt);
  }
  return lines;
}

// Whether nothing is wrong but that a seat is not settled.
bool is_only_unsettled(const CheckResult& result) {
  return !result.clear() && std::all_of(result.violations.begin(), result.violations.end(),
                                        [](const Violation& v) { return v.unsettled_seat; });
}

std::string min_text(const Report& report) {
  const CheckResult& r = report.result;
  const char* const outside = r.seated.empty() ? "" : "outside of its seat ";
  if (report.exact && report.exact->smallest.exact_m < kNothingM) {
    return text("least clearance %s%.3f mm exact%s, ", outside,
                1e3 * report.exact->smallest.exact_m,
                to_object(report.scene, r.smallest.object).c_str()) +
           place_text(r.smallest);
  }
  if (r.at_least) {
    return text("%sat least %.3f mm, nothing is nearer", outside, floor_mm(r.clearance_m));
  }
  return text("least proven clearance %s%.3f mm%s%s, ", outside, floor_mm(r.clearance_m),
              max_text(r.smallest).c_str(), to_object(report.scene, r.smallest.object).c_str()) +
         place_text(r.smallest);
}

void add_exact(Json& json, const ExactMoment& moment) {
  const bool any = moment.exact_m < kNothingM;
  json["exact_m"] = any ? Json(moment.exact_m) : Json(nullptr);
  json["object_point_m"] = any ? Json(moment.scene_m) : Json(nullptr);
}

Json seat_depths_json(const Report& report) {
  Json list = Json::array();
  for (const ExactSeat& seat : report.exact->seat) {
    list.push_back({{"object", object_name(report.scene, seat.object)},
                    {"gap_m", seat.gap_m},
                    {"installed_m", seat.installed_m},
                    {"deepest_m", seat.deepest_m},
                    {"allowed_m", seat.allowed_m},
                    {"settled", seat.settled}});
  }
  return list;
}

Json violation_json(const Report& report, const Violation& v) {
  Json json{{"from_s", v.from_s}, {"to_s", v.to_s}};
  json.update(moment_json(report.scene, v.worst, v.clearance_m));
  json["beyond_cropped_side"] = v.worst.beyond_side;
  json["pushed_into_seat"] = v.pushed_into_seat;
  json["seat_not_settled"] = v.unsettled_seat;
  json["object_inside"] = v.object_inside;
  if (v.pushed_into_seat || v.depth_m > 0) json["depth_m"] = v.depth_m;
  if (const ExactViolation* exact = exact_of(report, v)) {
    if (v.depth_m > 0) json["max_depth_m"] = exact->max_depth_m;
    add_exact(json, exact->worst);
    json["graze"] = exact->graze;
    json["inside"] = exact->inside;
  }
  return json;
}

// A violation in a few words.
std::string gist_of(const Report& report, const Violation& v) {
  if (v.unsettled_seat) return "its seat is not settled";
  if (v.object_inside) return inside_text(report, v);
  if (v.pushed_into_seat) {
    const ExactViolation* measured = exact_of(report, v);
    const bool is_close = measured != nullptr && measured->graze;
    return (is_close ? "too close to call in " : "pushed too deep into ") +
           escaped(object_name(report.scene, v.worst.object));
  }
  if (v.worst.beyond_side) return "beside a cropped side of the scene";
  const ExactViolation* exact = exact_of(report, v);
  const std::string to = to_object(report.scene, v.worst.object);
  if (exact == nullptr) return text("%.3f mm proven", floor_mm(v.clearance_m)) + to;
  if (exact->inside) return "all of the part is inside";
  if (exact->meets()) return "the surfaces meet";
  if (exact->graze) return "a graze" + to;
  return text("%.3f mm exact", 1e3 * exact->worst.exact_m) + to;
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
std::string seat_mend(const Report& report, const PathRow& first, const PathRow& last) {
  if (report.options.world_from_seat) return "";
  const auto any = [&](const auto& is_so) {
    const auto& all = report.result.violations;
    return std::any_of(all.begin(), all.end(), [&](const Violation& v) {
      const ExactViolation* exact = exact_of(report, v);
      const bool is_inside = v.object_inside || (exact != nullptr && exact->inside);
      return !v.worst.beyond_side && !is_inside && is_so(v);
    });
  };
  const bool begins = any([&](const Violation& v) { return v.from_s <= first.time_s; });
  const bool ends = any([&](const Violation& v) { return v.to_s >= last.time_s; });
  if (!begins && !ends) return "";
  return text("if it is installed at the path's %s, give --seat ", begins ? "beginning" : "end") +
         seat_of(begins ? first : last);
}

// Whether nothing is too near, but only because nothing is near at all.
bool is_refused_as_far(const Report& report) {
  return report.options.fail_on == "far" &&
         is_never_near(report.result, report.part, report.options.allow);
}

constexpr const char* kFar = "the part is never near the scene";

std::string required_text(const Report& report) {
  return text("%.3f mm required", report.options.clearance_m * 1e3);
}

}  // namespace

const Violation& worst_of(const CheckResult& result) {
  return *std::min_element(result.violations.begin(), result.violations.end(),
                           [](const Violation& a, const Violation& b) {
                             if (a.unsettled_seat != b.unsettled_seat) return b.unsettled_seat;
                             if (a.worst.clearance_m != b.worst.clearance_m) {
                               return a.worst.clearance_m < b.worst.clearance_m;
                             }
                             return a.depth_m > b.depth_m;
                           });
}

const ExactViolation* exact_of(const Report& report, const Violation& v) {
  if (!report.exact) return nullptr;
  const auto number = static_cast<std::size_t>(&v - report.result.violations.data());
  return number < report.exact->violations.size() ? &report.exact->violations[number] : nullptr;
}

std::vector<std::string> picture_title(const Report& report) {
  const CheckResult& r = report.result;
  if (r.clear()) return {"clear: " + required_text(report), min_text(report)};
  return {"NOT clear: " + required_text(report), violation_text(report, worst_of(r))};
}

std::string verdict_text(const Report& report) {
  const CheckResult& r = report.result;
  std::string line = seat_text(report);
  if (r.clear()) {
    if (is_refused_as_far(report)) line = std::string("NOT clear: ") + kFar + "; else ";
    return line + "clear: " + required_text(report) + "; " + min_text(report) + "\n" +
           seat_ways_text(report) + seat_depth_text(report) + hidden_text(hidden_within_m(report));
  }
  if (is_only_unsettled(r)) {
    line = "NOT clear: its seat is not settled; " + line + "clear: " + required_text(report) +
           "; " + min_text(report) + "\n";
  } else {
    line += text("NOT clear: %s; %s in %zu stretch%s\n", required_text(report).c_str(),
                 report.exact ? "not kept" : "not proven", r.violations.size(),
                 r.violations.size() == 1 ? "" : "es");
  }
  for (std::size_t n = 0; n < std::min(kListed, r.violations.size()); ++n) {
    line += "  " + violation_text(report, r.violations[n]) + "\n";
  }
  if (r.violations.size() > kListed) {
    line += text("  and %zu more\n", r.violations.size() - kListed);
  }
  line += seat_ways_text(report);
  return is_only_unsettled(r)
             ? line
             : line + seat_depth_text(report) + hidden_text(hidden_within_m(report));
}

Json report_json(const Report& report) {
  const CheckResult& r = report.result;
  Json json;
  json["schema_version"] = 1;
  json["verdict"] = r.clear() && !is_refused_as_far(report) ? "clear" : "not clear";
  json["required_clearance_m"] = report.options.clearance_m;
  json["min_clearance"] = moment_json(report.scene, r.smallest, r.clearance_m);
  json["min_clearance"]["at_least"] = r.at_least;
  if (report.exact) {
    add_exact(json["min_clearance"], report.exact->smallest);
    json["exact"] = {{"deviations_and_rounding_m", report.exact->margin_m},
                     {"moments_measured", report.exact->moments}};
  }
  if (const double within_m = hidden_within_m(report); within_m > 0) {
    json["hidden_within_m"] = within_m;
  }
  json["missing_faces"] = missing_faces(report.scene, report.part);
  json["poses"] = r.poses;
  json["way_m"] = r.way_m;
  json["moments_tested"] = r.moments_tested;
  json["motions_subdivided"] = r.motions_subdivided;
  json["violations"] = Json::array();
  for (const Violation& v : r.violations) json["violations"].push_back(violation_json(report, v));
  json["seated"] = Json::array();
  for (std::size_t n = 0; n < r.seated.size(); ++n) {
    Json stretch = seated_json(report.scene, r.seated[n]);
    if (const ExactMoment* exact = exact_in_seat(report, n)) add_exact(stretch, *exact);
    json["seated"].push_back(stretch);
  }
  json["seat"] = Json::array();
  for (const std::uint32_t object : r.seat_objects) {
    json["seat"].push_back(object_name(report.scene, object));
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

Status write_curve(const Report& report) {
  std::string table = "from_s,to_s,clearance_m\n";
  for (const auto& piece : report.result.curve) {
    for (const double number : {piece.from_s, piece.to_s, piece.clearance_m}) {
      char digits[32];  // the shortest text that reads back as the same number
      table.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
      table += ',';
    }
    table.back() = '\n';
  }
  return command::write_text(report.options.csv, table);
}

Status write_junit(const Report& report) {
  const CheckResult& r = report.result;
  std::string gist;  // empty: clear
  if (is_refused_as_far(report)) gist = kFar;
  if (!r.clear()) gist = violation_text(report, worst_of(r));
  return command::write_text(
      report.options.junit,
      junit_text(report.options, gist.empty() ? TestEnd::kPassed : TestEnd::kFailed, gist,
                 verdict_text(report), report.read_s + report.check_s));
}

std::string github_lines(const Report& report) {
  std::string lines = warning_annotations(report.options);
  for (const Violation& v : report.result.violations) {
    lines += annotation(report.options, "error", "clearance",
                        required_text(report) + "; " + violation_text(report, v));
  }
  if (is_refused_as_far(report)) lines += annotation(report.options, "error", "clearance", kFar);
  for (const std::string& overlap : overlap_texts(report)) {
    lines += annotation(report.options, "warning", "overlap", overlap);
  }
  return lines;
}

Json code_quality_json(const Report& report) {
  Json list = warning_issues(report.options);
  for (const Violation& v : report.result.violations) {
    list.push_back(issue(report.options, "clearance", "major",
                         required_text(report) + "; " + violation_text(report, v)));
  }
  if (is_refused_as_far(report)) list.push_back(issue(report.options, "clearance", "major", kFar));
  for (const std::string& overlap : overlap_texts(report)) {
    list.push_back(issue(report.options, "overlap", "minor", overlap));
  }
  return list;
}

Status check_verdict(const Report& report, const PathRow& first, const PathRow& last) {
  if (is_refused_as_far(report)) {
    return Error{ErrorCode::kAnswerIsNo, report.options.path, "",
                 kFar + text(": at least %.3f mm", floor_mm(report.result.clearance_m)),
                 "check the units of the path, and whose path and part they are"};
  }
  if (report.result.clear()) return {};
  const Violation& worst = worst_of(report.result);
  return Error{ErrorCode::kAnswerIsNo, report.options.path, text("at %.3f s", worst.worst.time_s),
               required_text(report) + (report.exact ? ", but not kept: " : ", but not proven: ") +
                   gist_of(report, worst),
               seat_mend(report, first, last)};
}

}  // namespace forcelayer::voxcheck
