#include "workbench/disassembly/report.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <vector>

#include "formats/command/command.h"
#include "formats/command/text.h"
#include "formats/command/verdict/verdict.h"

namespace forcelayer::disassembly {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kListed = 3;

std::string direction_text(const glm::dvec3& direction) {
  constexpr double kStraight = 1e-6;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 own(0);
    own[axis] = direction[axis] < 0 ? -1 : 1;
    if (glm::length(direction - own) < kStraight) {
      return std::string(direction[axis] < 0 ? "-" : "+") + "xyz"[axis];
    }
  }
  return command::text("(%.3g, %.3g, %.3g)", direction.x, direction.y, direction.z);
}

// "A", "A and B", "A, B and 3 more"
std::string listed(const pairs::AssemblyParts& assembly, const Parts& parts) {
  std::string line;
  const std::size_t shown = std::min(kListed, parts.size());
  for (std::size_t n = 0; n < shown; ++n) {
    const bool is_last = n + 1 == parts.size();
    line += (n == 0 ? "" : is_last ? " and " : ", ") + assembly.shown_name(parts[n]);
  }
  if (parts.size() > shown) line += command::text(" and %zu more", parts.size() - shown);
  return line;
}

Json names_of(const pairs::AssemblyParts& assembly, const Parts& parts) {
  Json names = Json::array();
  for (const std::size_t part : parts) names.push_back(assembly.parts[part].name.listed);
  return names;
}

Json name_of(const pairs::AssemblyParts& assembly, const std::optional<std::size_t>& part) {
  return part ? Json(assembly.parts[*part].name.listed) : Json(nullptr);
}

// "Bolt[1]: 34 mm or more along +z (touches Cover; nearest: Housing, 0.0997 mm)"
std::string line_of(const pairs::AssemblyParts& assembly, const Step& step) {
  Parts touched = step.touched;
  for (const Overlap& overlap : step.overlaps) touched = without(touched, {overlap.object});
  std::string beside;
  const auto add = [&](const std::string& text) { beside += (beside.empty() ? "" : "; ") + text; };
  if (!touched.empty()) add("touches " + listed(assembly, touched));
  if (!step.ignored.empty()) add("ignores " + listed(assembly, step.ignored));
  if (step.nearest) {
    add("nearest: " + assembly.shown_name(*step.nearest) + ", " +
        command::length_text(step.distance_m + command::kDecimalM));
  }
  return listed(assembly, step.parts) + ": " + motion_text(step) +
         (beside.empty() ? "" : " (" + beside + ")");
}

bool needs_force(const Outcome& outcome) {
  return std::any_of(outcome.steps.begin(), outcome.steps.end(),
                     [](const Step& step) { return !step.overlaps.empty(); });
}

std::string sentence(const pairs::AssemblyParts& assembly, const Request& request,
                     const Outcome& outcome) {
  const std::size_t left = outcome.left.size(), parts = assembly.parts.size();
  const char* const force =
      needs_force(outcome) ? ", if force overcomes the overlaps as installed" : "";
  if (request.target.empty()) {
    if (left == 0) {
      return command::text("All %zu parts come apart%s.", parts, force);
    }
    const std::size_t off = parts - 1 - left;  // the base
    return command::text("%zu of %zu parts %s off ", off, parts - 1, off == 1 ? "comes" : "come") +
           (outcome.base ? assembly.shown_name(*outcome.base) : "the others") +
           command::text("; %zu %s left%s.", left, left == 1 ? "is" : "are",
                         outcome.is_out_of_time ? (", because " + end_text()).c_str() : "");
  }
  const std::string target = listed(assembly, request.target);
  if (left > 0) {
    return target + (outcome.is_out_of_time ? ": not found, because " + end_text() + "."
                                            : std::string(": no path out was found."));
  }
  Parts before;
  for (const Step& step : outcome.steps) {
    if (step.parts != request.target) {
      before.insert(before.end(), step.parts.begin(), step.parts.end());
    }
  }
  before = without(before, request.target);
  const std::string order = before.empty()
                                ? " comes out, and nothing needs to leave first"
                                : command::text(" comes out after %zu other part%s", before.size(),
                                                before.size() == 1 ? "" : "s");
  return target + order + force + ".";
}

}  // namespace

std::string motion_text(const Step& step) {
  std::string line;
  for (std::size_t n = 1; n < step.rows.size(); ++n) {
    const auto &a = step.rows[n - 1].position_m, &b = step.rows[n].position_m;
    const glm::dvec3 way(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    const double length_m = glm::length(way);
    const char* const or_more = n + 1 == step.rows.size() ? " or more" : "";
    line += (line.empty() ? "" : ", then ") + command::length_text(length_m + command::kDecimalM) +
            or_more + " along " + direction_text(way / length_m);
  }
  return line;
}

std::string instruction(const pairs::AssemblyParts& assembly, const Step& step,
                        std::size_t number) {
  std::string text = command::text("%zu. ", number) + line_of(assembly, step) + "\n";
  for (const Overlap& overlap : step.overlaps) {
    text += "   overlaps " + assembly.shown_name(overlap.object) + " as installed, " +
            command::length_text(overlap.depth_m) + " deep\n";
  }
  if (step.hidden_overlap_m > 0) {
    text += "   a collision of up to " + command::at_most_text(step.hidden_overlap_m) +
            " is not ruled out, because the meshes have cracks\n";
  }
  return text;
}

std::string summary(const pairs::AssemblyParts& assembly, const Request& request,
                    const Outcome& outcome) {
  std::string text = sentence(assembly, request, outcome) + "\n";
  for (const Left& left : outcome.left) {
    text += "  left: " + assembly.shown_name(left.part) + ": " + left.reason;
    if (!left.blocked_by.empty()) text += "; blocked by " + listed(assembly, left.blocked_by);
    text += "\n";
  }
  return text;
}

Json step_json(const pairs::AssemblyParts& assembly, const Step& step) {
  Json json;
  json["parts"] = names_of(assembly, step.parts);
  json["instruction"] = line_of(assembly, step);
  json["clearance_m"] = step.nearest ? Json(step.clearance_m) : Json(nullptr);
  json["distance_m"] = step.nearest ? Json(step.distance_m) : Json(nullptr);
  json["nearest"] = name_of(assembly, step.nearest);
  json["path_length_m"] = step.length_m;
  json["settled_by"] = step.settled_by;
  json["touches"] = names_of(assembly, step.touched);
  json["ignores"] = names_of(assembly, step.ignored);
  Json& overlaps = json["overlaps"] = Json::array();
  for (const Overlap& overlap : step.overlaps) {
    overlaps.push_back(
        {{"object", assembly.parts[overlap.object].name.listed}, {"depth_m", overlap.depth_m}});
  }
  json["hidden_overlap_m"] = step.hidden_overlap_m;
  json["from"] = names_of(assembly, step.from);
  return json;
}

Json outcome_json(const pairs::AssemblyParts& assembly, const Request& request,
                  const Outcome& outcome) {
  Json json;
  json["sentence"] = sentence(assembly, request, outcome);
  json["required_clearance_m"] = request.required_m;
  Json& rules = json["rules"] = Json::array();
  for (const pairs::Rule& rule : request.rules) {
    const bool is_ignored = rule.requirement.kind == pairs::Requirement::Kind::kIgnore;
    rules.push_back(
        {{"part", rule.part},
         {"object", rule.object},
         {"required_clearance_m", is_ignored ? Json() : Json(rule.requirement.clearance_m)}});
  }
  json["target"] = request.target.empty() ? Json(nullptr) : names_of(assembly, request.target);
  json["steps"] = Json::array();
  Json& left = json["left"] = Json::array();
  for (const Left& one : outcome.left) {
    left.push_back({{"part", assembly.parts[one.part].name.listed},
                    {"reason", one.reason},
                    {"blocked_by", names_of(assembly, one.blocked_by)}});
  }
  json["base"] = name_of(assembly, outcome.base);
  json["out_of_time"] = outcome.is_out_of_time;
  return json;
}

Status exit_of(const pairs::AssemblyParts& assembly, const Request& request, const Outcome& outcome,
               const std::string& file) {
  if (outcome.left.empty() && !needs_force(outcome)) return {};
  std::string what = sentence(assembly, request, outcome);
  what.pop_back();
  if (outcome.left.empty()) {
    return Error{ErrorCode::kNeedsForce, file, "", what, command::kOverlapAdvice};
  }
  return Error{ErrorCode::kAnswerIsNo, file, "", what,
               !outcome.is_out_of_time       ? ""
               : request.target.empty()      ? "the same command continues from there"
               : command::stop_signal() == 0 ? "give a longer --time"
                                             : ""};
}

}  // namespace forcelayer::disassembly
