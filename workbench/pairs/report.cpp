#include "workbench/pairs/report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "formats/command/text.h"

namespace forcelayer::pairs {
namespace {

using command::VerdictKind;
using Json = nlohmann::ordered_json;

const std::string& name_of(const Answer& answer, std::uint32_t part) {
  return answer.assembly.parts[part].name.listed;
}

std::string shown_name(const Answer& answer, std::uint32_t part) {
  return answer.assembly.shown_name(part);
}

// The findings of one kind, the worst first.
std::vector<const PairFinding*> of_kind(const Findings& findings, VerdictKind kind) {
  std::vector<const PairFinding*> found;
  for (const PairFinding& finding : findings.by_rank) {
    if (finding.kind == kind) found.push_back(&finding);
  }
  return found;
}

// "1 of 36 pairs overlaps", "5 more are nearer": a count with its verb.
std::string counted(std::size_t count, const std::string& of, const char* one, const char* many) {
  return command::text("%zu", count) + of + " " + (count == 1 ? one : many);
}

// "Bolt 0.2 mm from Lid" or, of a pair that touches, "Bolt touches Lid".
std::string nearest_text(const Answer& answer, const PairFinding& finding) {
  const std::string first = shown_name(answer, finding.part),
                    second = shown_name(answer, finding.object);
  const bool touches =
      finding.measure.contact == Contact::kTouch || finding.measure.distance_m == 0;
  if (touches) return first + " touches " + second;
  const auto [distance, required] =
      command::length_texts(finding.measure.distance_m, finding.requirement.clearance_m);
  return first + " " + distance + " from " + second;
}

// "overlap, the deepest: Bolt[2] 0.41 mm into Housing"
std::string overlap_text(const Answer& answer, const PairFinding& worst, bool is_only) {
  return (is_only ? ": " : ", the deepest: ") + shown_name(answer, worst.part) + " " +
         (worst.measure.is_at_least ? "at least " : "") +
         command::length_text(worst.measure.depth_m) + " into " + shown_name(answer, worst.object);
}

// " than the required 1 mm", or " than required" where rules differ.
std::string required_text(const std::vector<const PairFinding*>& near) {
  const double required_m = near.front()->requirement.clearance_m;
  const bool is_one = std::all_of(near.begin(), near.end(), [&](const PairFinding* finding) {
    return finding->requirement.clearance_m == required_m;
  });
  return is_one ? " than the required " + command::length_text(required_m) : " than required";
}

// " of 36 pairs"
std::string pairs_text(std::uint64_t pairs) {
  return command::text(" of %llu pair%s", static_cast<unsigned long long>(pairs),
                       pairs == 1 ? "" : "s");
}

// The parts of a sentence, each after a semicolon but the first.
class Clauses {
 public:
  explicit Clauses(std::uint64_t pairs) : of_(pairs_text(pairs)) {}

  void add(std::size_t count, const char* one, const char* many, const std::string& more) {
    if (count == 0) return;
    text_ += (text_.empty() ? "" : "; ") +
             counted(count, text_.empty() ? of_ : " more", one, many) + more;
  }
  // About pairs that are no mistake.
  void remark(std::size_t count, const char* one, const char* many) {
    if (count > 0) text_ += "; " + counted(count, "", one, many);
  }
  void begin(const std::string& text) {
    if (text_.empty()) text_ = text;
  }
  std::string take() { return text_ + "."; }

 private:
  std::string of_, text_;
};

std::string found_text(const PairFinding& finding) {
  const PairMeasure& measure = finding.measure;
  switch (measure.contact) {
    case Contact::kOverlap:
      return "overlap " + std::string(measure.is_at_least ? "of at least " : "") +
             command::length_text(measure.depth_m);
    case Contact::kUndecided:
      return "undecided";
    case Contact::kClose:
      return "contact or overlap";
    case Contact::kTouch:
      return "contact";
    case Contact::kApart:
      break;
  }
  return command::length_texts(measure.distance_m, finding.requirement.clearance_m).first +
         " apart";
}

std::string requirement_text(const Requirement& requirement) {
  switch (requirement.kind) {
    case Requirement::Kind::kTouch:
      return "touch";
    case Requirement::Kind::kIgnore:
      return "ignore";
    case Requirement::Kind::kClearance:
      break;
  }
  return command::length_text(requirement.clearance_m);
}

std::string rule_text(const Answer& answer, const PairFinding& finding) {
  if (finding.rule < answer.rules.size()) {
    return command::text("line %zu", answer.rules[finding.rule].line);
  }
  const bool is_asked = answer.otherwise.kind == Requirement::Kind::kClearance;
  return is_asked ? "--clearance" : "default";
}

std::string place_text(const std::array<double, 3>& at_m) {
  std::string text;
  for (const double x : at_m) {
    text += (text.empty() ? "" : ", ") + command::text("%.6g", std::round(1e5 * x) / 1e2);
  }
  return text;
}

// Lines whose columns are as wide as their widest cell, two blanks apart.
std::string aligned(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths(rows.front().size());
  for (const auto& row : rows) {
    for (std::size_t n = 0; n < row.size(); ++n) widths[n] = std::max(widths[n], row[n].size());
  }
  std::string lines;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t n = 0; n < row.size(); ++n) {
      line += row[n];
      if (n + 1 < row.size()) line += std::string(widths[n] + 2 - row[n].size(), ' ');
    }
    lines += "  " + line + "\n";
  }
  return lines;
}

// The most important kind of all findings.
VerdictKind kind_of_all(const Answer& answer) {
  const auto& found = answer.findings.by_rank;
  if (!found.empty() && !found.front().is_kept()) return found.front().kind;
  return VerdictKind::kKeepsClearance;
}

const char* state_word(Contact contact) {
  switch (contact) {
    case Contact::kApart:
      return "apart";
    case Contact::kTouch:
      return "contact";
    case Contact::kOverlap:
      return "overlap";
    case Contact::kClose:
      return "contact or overlap";
    case Contact::kUndecided:
      break;
  }
  return "undecided";
}

Json json_of(const Answer& answer, const PairFinding& finding) {
  const PairMeasure& measure = finding.measure;
  Json json;
  json["part"] = name_of(answer, finding.part);
  json["object"] = name_of(answer, finding.object);
  json["kind"] = command::to_text(finding.kind);
  json["keeps_rule"] = finding.is_kept();
  json["found"] = state_word(measure.contact);
  json["distance_m"] = measure.distance_m;
  const bool is_deep = measure.contact == Contact::kOverlap;
  json["depth_m"] = is_deep ? Json(measure.depth_m) : Json(nullptr);
  json["depth_is_at_least"] = is_deep && measure.is_at_least;
  json["position_m"] = measure.at_m;
  json["margin_m"] = finding.margin_m + measure.crack_m;
  json["required"] = requirement_text(finding.requirement);
  json["required_clearance_m"] = finding.requirement.clearance_m;
  const bool has_rule = finding.rule < answer.rules.size();
  json["rule_line"] = has_rule ? Json(answer.rules[finding.rule].line) : Json(nullptr);
  json["doubt"] = measure.doubt.empty() ? Json(nullptr) : Json(measure.doubt);
  return json;
}

}  // namespace

std::string sentence(const Answer& answer) {
  const Findings& findings = answer.findings;
  const auto overlaps = of_kind(findings, VerdictKind::kCollides),
             near = of_kind(findings, VerdictKind::kTooNear),
             undecided = of_kind(findings, VerdictKind::kUndecided),
             close = of_kind(findings, VerdictKind::kTooCloseToCall),
             touching = of_kind(findings, VerdictKind::kStaysInstalled);
  Clauses clauses(findings.pairs);
  if (!overlaps.empty()) {
    clauses.add(overlaps.size(), "overlaps", "overlap",
                overlap_text(answer, *overlaps.front(), overlaps.size() == 1));
  }
  if (!near.empty()) {
    clauses.add(near.size(), "is nearer", "are nearer",
                required_text(near) + (near.size() == 1 ? ": " : ", the nearest: ") +
                    nearest_text(answer, *near.front()));
  }
  clauses.add(undecided.size(), "is undecided", "are undecided", ", because a mesh has no inside");
  clauses.add(close.size(), "is too close to call", "are too close to call", "");
  clauses.begin(findings.pairs == 1
                    ? "The only pair keeps its rule"
                    : command::text("All %llu pairs keep their rules",
                                    static_cast<unsigned long long>(findings.pairs)));
  clauses.remark(touching.size(), "touches as allowed", "touch as allowed");
  clauses.remark(findings.ignored, "is ignored", "are ignored");
  return clauses.take();
}

std::string table(const Answer& answer, std::size_t max_lines) {
  std::vector<std::vector<std::string>> rows{
      {"part", "object", "found", "required", "by", "at x, y, z (mm)"}};
  std::size_t broken = 0;
  std::vector<std::string> doubts;
  for (const PairFinding& finding : answer.findings.by_rank) {
    if (finding.is_kept() || ++broken > max_lines) continue;
    rows.push_back({shown_name(answer, finding.part), shown_name(answer, finding.object),
                    found_text(finding), requirement_text(finding.requirement),
                    rule_text(answer, finding), place_text(finding.measure.at_m)});
    if (!finding.measure.doubt.empty()) {
      doubts.push_back("  " + rows.back()[0] + " and " + rows.back()[1] + ": " +
                       finding.measure.doubt + "\n");
    }
  }
  if (broken == 0) return "";
  std::string text = aligned(rows);
  if (broken > max_lines) text += command::text("  and %zu more: see --json\n", broken - max_lines);
  for (const std::string& doubt : doubts) text += doubt;
  return text;
}

nlohmann::ordered_json report_of(const Answer& answer) {
  const Findings& findings = answer.findings;
  const VerdictKind kind = kind_of_all(answer);
  const auto count = [&](VerdictKind of) { return of_kind(findings, of).size(); };
  Json report;
  report["verdict"] = command::is_yes(kind) ? "clear" : "not clear";
  report["kind"] = command::to_text(kind);
  report["sentence"] = sentence(answer);
  report["required"] = requirement_text(answer.otherwise);
  report["parts"] = answer.assembly.parts.size();
  report["pairs"] = findings.pairs;
  report["ignored"] = findings.ignored;
  report["measured"] = findings.measured;
  report["overlapping"] = count(VerdictKind::kCollides);
  report["too_near"] = count(VerdictKind::kTooNear);
  report["undecided"] = count(VerdictKind::kUndecided);
  report["too_close_to_call"] = count(VerdictKind::kTooCloseToCall);
  report["touching_as_allowed"] = count(VerdictKind::kStaysInstalled);
  Json& found = report["found"] = Json::array();
  for (const PairFinding& finding : findings.by_rank) found.push_back(json_of(answer, finding));
  return report;
}

Status exit_of(const Answer& answer, const std::string& file) {
  const VerdictKind kind = kind_of_all(answer);
  if (command::is_yes(kind)) return {};
  const auto broken = std::count_if(answer.findings.by_rank.begin(), answer.findings.by_rank.end(),
                                    [](const PairFinding& finding) { return !finding.is_kept(); });
  return Error{ErrorCode::kAnswerIsNo, file, "",
               counted(static_cast<std::size_t>(broken), pairs_text(answer.findings.pairs),
                       "does not keep its rule", "do not keep their rules"),
               ""};
}

}  // namespace forcelayer::pairs
