#include "runtime/voxcheck/exact.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>

#include "formats/command/program.h"

namespace forcelayer::voxcheck {
namespace {

// Distances that differ by no more are the same: as closely as least distances are printed.
constexpr double kSameM = 1e-7;

using clearance::CheckedMoment;
using clearance::CheckResult;
using clearance::Violation;

bool is_any(const clearance::LeftOut& left_out) {
  return std::any_of(left_out.begin(), left_out.end(), [](std::uint8_t is) { return is != 0; });
}

// The moments of which the files tell most: the least clearance, and the worst of each violation.
std::vector<ProvenMoment> moments_of(const CheckResult& result, bool some_are_allowed) {
  std::vector<ProvenMoment> moments;
  const auto add = [&](const CheckedMoment& moment) {
    if (moment.beyond_side) return;
    const double max_m = std::isfinite(moment.max_m) ? moment.max_m : kNothingM;
    bool seated = false;
    for (const auto& stretch : result.seated) {
      seated |= moment.time_s >= stretch.from_s && moment.time_s <= stretch.to_s;
    }
    const double min_m = seated || some_are_allowed ? 0 : moment.clearance_m;
    moments.push_back({moment.time_s, min_m, max_m, seated});
  };
  add(result.smallest);
  for (const Violation& v : result.violations) {
    if (v.of_distance()) add(v.worst);
  }
  return moments;
}

// The files, the meshes and the required clearance.
ExactRequest request_of(const Options& options) {
  ExactRequest request;
  static_cast<PathSource&>(request) = options;
  name_meshes(options, request);
  request.required_m = options.clearance_m;
  request.quiet = options.quiet;
  return request;
}

ExactRequest request_of(const Options& options, const clearance::LeftOut& allowed,
                        const CheckResult& result) {
  ExactRequest request = request_of(options);
  request.min_s = result.smallest.time_s;
  if (std::isfinite(result.smallest.max_m) && !result.at_least) {
    request.max_m = result.smallest.max_m;
  }
  for (std::uint32_t object = 1; object < allowed.size(); ++object) {
    if (allowed[object] != 0) request.allowed.push_back(object);
  }
  request.seat = result.seat_objects;
  request.seat_depth_m = options.seat_depth_m;
  request.max_s = options.max_s;
  request.animation = options.animation;
  for (const auto& seated : result.seated) request.seated.push_back({seated.from_s, seated.to_s});
  if (options.world_from_seat) {
    const auto& [p, q] = *options.world_from_seat;
    request.seat_pose = {p.x, p.y, p.z, q.w, q.x, q.y, q.z};
  }
  const auto lies_in = [](const auto& piece, const auto& stretch) {
    return piece.from_s >= stretch.from_s && piece.to_s <= stretch.to_s;
  };
  // An object that does not count can hide another one from the files: what they prove then is not
  // believed.
  const bool some_are_allowed = is_any(allowed);
  for (const clearance::CurvePiece& piece : result.curve) {
    ProvenStretch stretch{piece.from_s, piece.to_s, piece.but_seat_m};
    for (const auto& v : result.violations) {
      stretch.too_near |= v.of_distance() && lies_in(piece, v);
    }
    for (const auto& seated : result.seated) stretch.seated |= lies_in(piece, seated);
    if (stretch.seated || some_are_allowed) {
      stretch.proven_m = 0;
      stretch.too_near = true;
    }
    // A stretch that is clear and cannot have the least distance need not be measured.
    if (!stretch.too_near && request.max_m && stretch.proven_m > *request.max_m) continue;
    request.stretches.push_back(stretch);
  }
  request.moments = moments_of(result, some_are_allowed);
  return request;
}

CheckedMoment checked(const ExactMoment& moment, double clearance_m, double margin_m) {
  const auto& p = moment.part_m;
  CheckedMoment checked;
  checked.clearance_m = clearance_m;
  checked.max_m = moment.exact_m + margin_m;
  checked.time_s = moment.time_s;
  checked.object = moment.object;
  checked.point_m = {p[0], p[1], p[2]};
  return checked;
}

// The first object of the seat that the meshes do not settle; null where they settle all.
const ExactSeat* first_open(const ExactAnswer& answer) {
  for (const ExactSeat& seat : answer.seat) {
    if (!seat.settled) return &seat;
  }
  return nullptr;
}

// Whether the meshes leave it open how deep the part goes into an object of its seat. All other
// objects are measured as they are.
bool is_open(const ExactAnswer& answer, std::uint32_t object) {
  return std::any_of(answer.seat.begin(), answer.seat.end(),
                     [&](const ExactSeat& seat) { return seat.object == object && !seat.settled; });
}

// The stretches in the seat as the meshes have them, each within one that the files found.
std::vector<clearance::SeatedStretch> seated_of(const ExactAnswer& answer,
                                                const clearance::CenterPath& path,
                                                bool some_are_allowed, const CheckResult& result) {
  std::vector<clearance::SeatedStretch> stretches;
  for (const ExactNearest& exact : answer.seated) {
    for (const clearance::SeatedStretch& found : result.seated) {
      if (exact.from_s < found.from_s || exact.to_s > found.to_s) continue;
      clearance::SeatedStretch seated = found;
      seated.from_s = exact.from_s;
      seated.to_s = exact.to_s;
      seated.travel_m = path.travel_m(path.at(exact.to_s)) - path.travel_m(path.at(exact.from_s));
      if (exact.nearest.exact_m < kNothingM) {
        if (some_are_allowed) seated.clearance_m = 0;
        seated.clearance_m = std::max(seated.clearance_m, exact.clearance_m);
        seated.nearest = checked(exact.nearest, seated.clearance_m, answer.margin_m);
      }
      stretches.push_back(seated);
      break;
    }
  }
  return stretches;
}

// The curve by the meshes where these know more, cut where the part leaves its seat.
void raise_curve(CheckResult& result) {
  std::vector<clearance::CurvePiece> pieces;
  for (clearance::CurvePiece piece : result.curve) {
    const double to_s = piece.to_s;
    while (true) {
      piece.to_s = to_s;
      double known_m = result.clearance_m;
      for (const clearance::SeatedStretch& seated : result.seated) {
        if (piece.from_s >= seated.from_s && piece.from_s < seated.to_s) {
          known_m = seated.clearance_m;
        }
        for (const double end_s : {seated.from_s, seated.to_s}) {
          if (end_s > piece.from_s) piece.to_s = std::min(piece.to_s, end_s);
        }
      }
      clearance::CurvePiece& raised = pieces.emplace_back(piece);
      raised.clearance_m = std::max(raised.clearance_m, known_m);
      if (piece.to_s >= to_s) break;
      piece.from_s = piece.to_s;
    }
  }
  result.curve = std::move(pieces);
}

void take(const ExactAnswer& answer, const clearance::CenterPath& path, bool some_are_allowed,
          CheckResult& result) {
  std::vector<Violation> violations;
  for (const ExactViolation& v : answer.violations) {
    Violation violation{v.from_s, v.to_s, v.clearance_m,
                        checked(v.worst, v.clearance_m, answer.margin_m)};
    violation.pushed_into_seat = v.pushed_into_seat;
    violation.depth_m = v.depth_m;
    violations.push_back(violation);
  }
  const bool is_stopped = !answer.stop.empty() && answer.stop[0].stage != ExactStop::kSmallest;
  if (is_stopped) {
    Violation rest;
    rest.from_s = rest.worst.time_s = answer.stop[0].settled_s;
    rest.to_s = path.time_s({path.poses() - 1, 0});
    rest.out_of_time = true;
    violations.push_back(rest);
  }
  for (Violation v : result.violations) {
    if (v.object_inside) violations.push_back(v);
    if (is_stopped) continue;
    if (v.pushed_into_seat && is_open(answer, v.worst.object)) violations.push_back(v);
    const ExactSeat* open = v.unsettled_seat ? first_open(answer) : nullptr;
    if (open == nullptr) continue;
    v.worst.object = open->object;
    violations.push_back(v);
  }
  result.violations = std::move(violations);
  const bool is_seated = !result.seated.empty();
  result.seated = seated_of(answer, path, some_are_allowed, result);
  const bool any_measured = answer.smallest.exact_m < kNothingM;
  if (!any_measured && answer.stop.empty()) return;  // no object counts
  // The files may prove more than the measured distance less the deviations.
  if (some_are_allowed || is_seated) result.clearance_m = 0;
  if (!any_measured) {
    result.clearance_m = std::max(result.clearance_m, answer.clearance_m);
    return;
  }
  result.clearance_m = std::max(result.clearance_m, answer.clearance_m);
  result.smallest = checked(answer.smallest, result.clearance_m, answer.margin_m);
  result.at_least = false;
  raise_curve(result);
}

// Adds those objects of the seat that are as far away as required where the part is installed, by
// the meshes: they may not come nearer along the path. Whether there are any: the path has to be
// checked again. One whose distance is exactly what is required is as far away; one that touches
// never is.
bool leave_out_far(const ExactAnswer& answer, double required_m, clearance::LeftOut& far_in_seat) {
  std::vector<std::uint32_t> far;
  for (const ExactSeat& seat : answer.seat) {
    // One that the scene does not name cannot be left out, and would be asked for without end.
    const bool is_named = seat.object != 0;
    const bool is_far = seat.gap_m >= required_m + answer.margin_m - kSameM && seat.gap_m > kSameM;
    if (is_named && is_far) far.push_back(seat.object);
  }
  far_in_seat = clearance::with_objects(std::move(far_in_seat), far);
  return !far.empty();
}

// The error of a seat that the files refuse, where the meshes, too, lie deeper in each other than
// distances are stored: the part starts elsewhere than where it is installed, or in another unit.
std::optional<Error> refused_seat(const Voxmap& scene, const CheckResult& checked,
                                  const ExactAnswer& answer) {
  if (!checked.seat_too_deep) return std::nullopt;
  const VoxmapHeader& h = scene.header();
  const double stored_m = h.distance_quantum_m * (h.distance_zero_code - 1);
  const bool is_deep = std::any_of(answer.seat.begin(), answer.seat.end(), [&](const auto& seat) {
    return !(seat.installed_m < stored_m);
  });
  return is_deep ? checked.seat_too_deep : std::nullopt;
}

}  // namespace

void name_meshes(const MeshOptions& options, ExactRequest& request) {
  request.meshes = options.meshes;
  request.part_meshes = options.part_meshes;
  request.without = options.without;
  request.unit_m = options.unit_m;
  request.part_unit_m = options.part_unit_m ? options.part_unit_m : options.unit_m;
  request.allow_outside = options.allow_outside;
  request.sandbox = options.sandbox;
}

Result<ExactAnswer> ask_program(const ExactRequest& request) {
  const auto end = command::run_program("voxcheck-exact", {}, text_of(request),
                                        command::ProgramOutput::kTaken, "forcelayer-tools");
  if (!end) return end.error();
  if (end->status != 0) {
    return Error{ErrorCode::kInternal, "", "--exact",
                 "voxcheck-exact ended with status " + std::to_string(end->status), ""};
  }
  return exact_answer(end->output);
}

Result<ExactCheckResult> check_with_meshes(const Voxmap& scene, const Pshell& part,
                                           const clearance::CenterPath& path,
                                           clearance::CheckRequest request, const Options& options,
                                           const AskExactly& ask) {
  request.seat_depth = clearance::SeatDepth::kOfMeshes;
  request.near_are_of_seat = true;
  const auto begun = std::chrono::steady_clock::now();
  while (true) {
    auto checked = clearance::check_path(scene, part, path, request);
    if (!checked) {
      Error error = checked.error();
      if (error.file.empty()) error.file = options.scene;
      return error;
    }
    ExactRequest question = request_of(options, request.allowed, *checked);
    if (question.max_s) {  // for all questions
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begun;
      *question.max_s = std::max(0.0, *question.max_s - spent.count());
    }
    auto answer = ask(question);
    if (!answer) return answer.error();
    if (auto refused = refused_seat(scene, *checked, *answer)) {
      if (refused->file.empty()) refused->file = options.scene;
      return *std::move(refused);
    }
    take(*answer, path, is_any(request.allowed), *checked);
    if (!leave_out_far(*answer, options.clearance_m, request.far_in_seat)) {
      return ExactCheckResult{std::move(*checked), std::move(*answer)};
    }
  }
}

Result<std::vector<RuleGroup>> groups_by_rules(const Options& options,
                                               const clearance::LeftOut& allowed,
                                               const AskExactly& ask,
                                               std::vector<std::string>& warnings) {
  ExactRequest request = request_of(options);
  request.rules = options.rules;
  const auto answer = ask(request);
  if (!answer) return answer.error();
  warnings.insert(warnings.end(), answer->warnings.begin(), answer->warnings.end());
  std::map<double, std::vector<std::uint32_t>, std::greater<>> objects;  // by distance
  clearance::LeftOut none(allowed.size(), 1);
  none[0] = 0;
  for (std::uint32_t object = 1; object < allowed.size(); ++object) {
    const ExactRule& rule = answer->rules.at(object - 1);
    if (!rule.ignored && allowed[object] == 0) objects[rule.required_m].push_back(object);
  }
  std::vector<RuleGroup> groups;
  for (const auto& [required_m, counted] : objects) {
    RuleGroup& group = groups.emplace_back(RuleGroup{required_m, none});
    for (const std::uint32_t object : counted) group.left_out[object] = 0;
  }
  if (groups.empty()) groups.push_back({options.clearance_m, none});
  return groups;
}

Status write_map(const Options& options, std::span<const RuleGroup> groups, const AskExactly& ask,
                 std::vector<std::string>& warnings) {
  ExactRequest request = request_of(options);
  request.map = options.map;
  request.max_s = options.max_s;
  request.required_m = groups.front().required_m;
  for (std::uint32_t object = 1; object < groups.front().left_out.size(); ++object) {
    const bool counts = std::ranges::any_of(
        groups, [&](const RuleGroup& group) { return group.left_out[object] == 0; });
    if (!counts) request.allowed.push_back(object);
  }
  const auto answer = ask(request);
  if (!answer) return answer.error();
  warnings.insert(warnings.end(), answer->warnings.begin(), answer->warnings.end());
  return {};
}

}  // namespace forcelayer::voxcheck
