#include "runtime/voxrun/verdict.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/command/text.h"
#include "runtime/model/simulation.h"

namespace forcelayer::voxrun {
namespace {

using command::text;
using command::VerdictKind;

using loop::FirstFrame;
using loop::LoopStatistics;

constexpr std::size_t kListed = 4;  // names in a line
constexpr double kFollowed = 0.98;  // of a pull: what a simulated hand's grip may give way
constexpr double kPulledN = 0.01;   // with which the hand still pulls at a part that is stopped

const char* ending(std::uint64_t count) { return count == 1 ? "" : "s"; }

unsigned long long printable(std::uint64_t count) { return count; }

// Adds the next of a list of objects.
void list(std::string& line, std::size_t at, const std::string& object) {
  if (at < kListed) line += (at == 0 ? "" : ", ") + object;
}

void end_list(std::string& line, std::size_t count) {
  if (count > kListed) line += text(" and %zu more", count - kListed);
}

// The object's name, or "the scene" where it has no names.
std::string printed(const Scenes& scenes, std::uint32_t object) {
  return object == 0 ? "the scene" : scenes.shown_name(object);
}

bool is_of_seat(const Scenes& scenes, std::uint32_t object) {
  for (const auto& of_seat : scenes.seat()) {
    if (of_seat.object == object) return true;
  }
  return false;
}

// "A, B" behind `before`: what the part pushed against in a frame. Empty where that has no number.
std::string named(const Scenes& scenes, const loop::TouchedInFrame& in_frame, const char* before,
                  bool with_seat) {
  std::string line;
  std::size_t count = 0;
  for (const TouchedObject& touched : in_frame) {
    if (touched.object == 0 || (!with_seat && is_of_seat(scenes, touched.object))) continue;
    if (count == 0) line = before;
    list(line, count++, printed(scenes, touched.object));
  }
  return line;
}

std::string against(const Scenes& scenes, const loop::TouchedInFrame& in_frame, bool with_seat) {
  return named(scenes, in_frame, ", against ", with_seat);
}

bool is_short(const std::optional<Pull>& pull) { return pull && pull->short_of_end(); }

// Something stops the part at the end of the run: it pushes against an object, or it stays where it
// is although a pull goes on. In the seat a motion may be refused without a contact with depth.
bool is_stopped(const std::optional<Pull>& pull, const LoopStatistics& s) {
  return s.touched_last[0].force_n > 0 || (is_short(pull) && s.force_last_n > kPulledN);
}

// "the hand pulled 60 mm, the part moved 37.1 mm" where it went less.
std::string pull_part(const std::optional<Pull>& pull) {
  if (!is_short(pull)) return "";
  return text("the hand pulled %.4g mm, the part moved %.3g mm", 1e3 * pull->led_m,
              1e3 * std::max(0.0, pull->went_m));
}

bool seat_open(const Scenes& scenes, const LoopStatistics& s) {
  return !scenes.seat().empty() && !s.guarantee_from_s;
}

std::uint64_t unproven_frames(const LoopStatistics& s) {
  return s.unproven_frames - std::min(s.unproven_frames, s.seated_frames);
}

// Points may have gone so far from a frame to the next that nothing is known of in between. The
// default model looks up where each half of a voxel leads.
bool is_too_fast(const Scenes& scenes, const LoopStatistics& s) {
  const Parameters& p = scenes.parameters();
  return p.model == Model::kPaper &&
         s.longest_shift_m + p.part_radius_m * s.longest_turn_rad > 0.5 * p.voxel_size_m;
}

// Frames in which the exact surfaces may have touched, although no point was in the interior.
bool is_doubtful(const Scenes& scenes, const LoopStatistics& s) {
  return s.frames == 0 || s.outside_map_frames > 0 ||
         (s.barred_frames > 0 && unproven_frames(s) > 0) || is_too_fast(scenes, s);
}

// The hand itself stayed behind, or the part while its scene changed: the rest of its way is not
// known.
bool is_unfinished(const Scenes& scenes, const std::optional<Pull>& pull, const LoopStatistics& s) {
  return is_short(pull) && !is_stopped(pull, s) && !seat_open(scenes, s);
}

std::string seat_part(const Scenes& scenes, const std::optional<Pull>& pull,
                      const LoopStatistics& s) {
  const std::string seat = seat_text(scenes, INFINITY);
  if (seat.empty()) return "";
  if (s.guarantee_from_s) {
    return text("seated on %s until %.3f s; then ", seat.c_str(), *s.guarantee_from_s);
  }
  if (s.seated_frames == 0) {
    return text("the part was never in its seat: no separation from %s is guaranteed; ",
                seat.c_str());
  }
  const std::string pulled = pull_part(pull);
  return text("the part did not leave its seat on %s, and no separation is guaranteed; %s%s%s%s; ",
              seat.c_str(), pulled.c_str(), pulled.empty() ? "" : ", ",
              is_stopped(pull, s) ? "held" : "nothing blocks the part",
              against(scenes, s.touched_last, true).c_str());
}

// A coordinate that would be printed as -0 is printed as 0.
double near_zero_mm(double m) { return std::round(1e5 * m) / 1e2 + 0.0; }

// The least clearance, rounded down.
std::string clearance_part(const Scenes& scenes, const LoopStatistics& s) {
  const auto& smallest = s.min_clearance;
  if (smallest.kind == ClearanceKind::kNone) return "no clearance is known";
  const std::string length = command::length_text(smallest.clearance_m);
  std::string part;
  if (smallest.kind == ClearanceKind::kAtLeast) {
    part = "clearance at least " + length + " (nothing was near enough to measure)";
  } else {
    part = text("least proven clearance %s%s%s at %.3f s, at x %.2f, y %.2f, z %.2f mm",
                length.c_str(), smallest.object != 0 ? " to " : "",
                scenes.shown_name(smallest.object).c_str(), smallest.time_s,
                near_zero_mm(smallest.point_m.x), near_zero_mm(smallest.point_m.y),
                near_zero_mm(smallest.point_m.z));
  }
  if (const std::uint64_t n = unproven_frames(s); n > 0) {
    part += text(", and unknown in %llu frame%s", printable(n), ending(n));
  }
  return part;
}

// The last words of a scripted motion.
std::string motion_part(const Scenes& scenes, const Outcome& outcome) {
  if (!outcome.motion) return "";
  const Followed& motion = *outcome.motion;
  if (motion.is_followed()) return is_short(outcome.pull) ? "" : "; the part followed the motion";
  constexpr double kDegrees = 180 / std::numbers::pi, kSaidRad = 0.01;
  return text(
      "; the part did not follow the motion: held back by up to %.3g mm%s at %.3f s%s",
      1e3 * motion.off_m,
      motion.off_rad > kSaidRad ? text(" and %.3g degrees", kDegrees * motion.off_rad).c_str() : "",
      motion.time_s, named(scenes, motion.touched, " by ", true).c_str());
}

// A motion that something holds the part off. A pull is held where it stops short of its end: on
// its way out the part may slide along its neighbors.
bool is_held(const Outcome& outcome) {
  if (is_short(outcome.pull)) return true;
  return !outcome.pull && outcome.motion && !outcome.motion->is_followed();
}

// The names of what the part pushed against in a frame.
std::vector<std::string> names_of(const Scenes& scenes, const loop::TouchedInFrame& in_frame) {
  std::vector<std::string> names;
  for (const TouchedObject& touched : in_frame) {
    if (touched.object != 0) names.push_back(scenes.object_text(touched.object));
  }
  return names;
}

// How deep the part overlaps an object of its seat for certain: a stored distance is interpolated
// between the centers of voxels, less than the half diagonal of a voxel away, and is rounded.
double certain_overlap_m(const Scenes& scenes, const guard::SeatObject& of_seat) {
  const model::Simulation& simulation = scenes.first().simulation();
  const VoxmapHeader& h = simulation.voxmap().header();
  const double off_m = std::numbers::sqrt3 / 2 * h.voxel_size_m + h.distance_quantum_m +
                       h.static_deviation_m + simulation.shell().header().part_deviation_m;
  return of_seat.overlap_m - off_m;
}

// Adds the objects that a part that comes out overlaps where it is installed in the first scene.
void add_overlaps(const Scenes& scenes, command::Verdict& verdict) {
  if (scenes.count() > 1) return;
  for (const guard::SeatObject& of_seat : scenes.seat()) {
    const double overlap_m = certain_overlap_m(scenes, of_seat);
    if (overlap_m <= 0) continue;
    verdict.overlapped.push_back(scenes.object_text(of_seat.object));
    verdict.overlap_m = std::max(verdict.overlap_m, overlap_m);
  }
  if (verdict.overlapped.empty()) return;
  verdict.kind = command::with_overlap(verdict.kind);
  verdict.advice = command::kOverlapAdvice;
}

// The premises that failed.
std::string doubt_text(const Scenes& scenes, const Outcome& outcome, const LoopStatistics& s) {
  if (s.frames == 0) return "no frame was run";
  std::string line;
  const auto add = [&](const std::string& doubt) { line += (line.empty() ? "" : "; ") + doubt; };
  if (outcome.scene_missed) add("a scene of --scene-next was never used");
  if (is_unfinished(scenes, outcome.pull, s)) {
    add(pull_part(outcome.pull) + ", and nothing blocks the part");
  }
  if (s.first_outside_map) {
    add(text(
        "the part was beyond a cropped side of the scene from %.3f s on; nothing is known there",
        s.first_outside_map->time_s));
  }
  if (s.barred_frames > 0) add("the part was nearer than the guard allows");
  if (is_too_fast(scenes, s)) add("the part moved more than half a voxel in a frame");
  return line;
}

// "stays 3.1 mm away or more (proven; nearest to B, at 2.204 s)"
std::string stays_text(const Scenes& scenes, const LoopStatistics& s) {
  const auto& smallest = s.min_clearance;
  if (smallest.kind == ClearanceKind::kNone) return "no distance is known";
  const std::string stays =
      "stays " + command::length_text(smallest.clearance_m) + " away or more (";
  if (smallest.kind == ClearanceKind::kAtLeast) return stays + "nothing is nearer)";
  return stays + "proven; nearest to " + printed(scenes, smallest.object) +
         text(", at %.3f s)", smallest.time_s);
}

}  // namespace

bool Pull::short_of_end() const { return went_m < kFollowed * led_m; }

std::string seat_text(const Scenes& scenes, double min_overlap_m) {
  std::string line;
  std::size_t count = 0;
  for (const auto& of_seat : scenes.seat()) {
    std::string object = printed(scenes, of_seat.object);
    if (of_seat.overlap_m > min_overlap_m) {
      object += text(" (%.3g mm inside)", 1000 * of_seat.overlap_m);
    }
    list(line, count++, object);
  }
  end_list(line, count);
  return line;
}

command::Verdict verdict_of(const Scenes& scenes, const Outcome& outcome, const LoopStatistics& s) {
  command::Verdict verdict;
  verdict.is_asked = false;
  verdict.scene_names = scenes.object_texts();
  const std::optional<Pull>& pull = outcome.pull;
  const bool open = seat_open(scenes, s);
  if (s.penetration_frames > 0) {
    verdict.kind = VerdictKind::kPenetrates;
    verdict.finding = text("in %llu of %llu frames a point is inside the scene",
                           printable(s.penetration_frames), printable(s.frames));
    if (s.first_penetration) {
      verdict.finding += text(", the first time at %.3f s", s.first_penetration->time_s) +
                         against(scenes, s.first_penetration->touched, true);
    }
  } else if (outcome.scene_missed || is_doubtful(scenes, s) || is_unfinished(scenes, pull, s)) {
    verdict.kind = VerdictKind::kUndecided;
    verdict.finding = doubt_text(scenes, outcome, s);
  } else if (open) {
    verdict.kind = VerdictKind::kDoesNotComeOut;
    verdict.finding = is_short(pull)
                          ? pull_part(pull)
                          : "the part is still installed on " + seat_text(scenes, INFINITY);
    if (is_stopped(pull, s)) verdict.blocked_by = names_of(scenes, s.touched_last);
    if (!is_stopped(pull, s)) verdict.finding += ", and nothing blocks the part";
  } else if (is_held(outcome)) {
    verdict.kind = VerdictKind::kHeld;
    const bool is_pulled = is_short(pull);
    verdict.finding =
        is_pulled ? pull_part(pull)
                  : text("the part is up to %.3g mm away from the scripted motion, at %.3f s",
                         1e3 * outcome.motion->off_m, outcome.motion->time_s);
    verdict.blocked_by = names_of(scenes, is_pulled ? s.touched_last : outcome.motion->touched);
  } else {
    const bool leaves = !scenes.seat().empty();
    verdict.kind = leaves ? VerdictKind::kComesOut : VerdictKind::kKeepsClearance;
    verdict.finding = (leaves ? text("the part leaves %s after %.3f s, and from then on ",
                                     seat_text(scenes, INFINITY).c_str(), *s.guarantee_from_s)
                              : std::string()) +
                      stays_text(scenes, s);
    add_overlaps(scenes, verdict);
  }
  return verdict;
}

const char* run_word(const command::Verdict& verdict) {
  switch (command::without_overlap(verdict.kind)) {
    case VerdictKind::kComesOut:
    case VerdictKind::kKeepsClearance:
      return "proven";
    case VerdictKind::kPenetrates:
      return "penetrated";
    case VerdictKind::kDoesNotComeOut:
      return "seated";
    case VerdictKind::kHeld:
      return "held";
    default:
      return "unknown";
  }
}

std::string verdict_text(const Scenes& scenes, const Outcome& outcome, const LoopStatistics& s) {
  const std::string first = command::sentence(verdict_of(scenes, outcome, s)) + "\n";
  if (s.frames == 0) return first;
  const std::optional<Pull>& pull = outcome.pull;
  std::string line = first + seat_part(scenes, pull, s);
  if (outcome.scene_missed) line += "a scene of --scene-next was never used; ";
  if (!seat_open(scenes, s) && is_short(pull)) {
    line += pull_part(pull) +
            (is_unfinished(scenes, pull, s) ? std::string(", nothing blocks the part")
                                            : against(scenes, s.touched_last, true)) +
            "; ";
  }
  if (s.first_outside_map) {
    line += text(
        "the part was beyond a cropped side of the scene in %llu frame%s, the first at %.3f s; ",
        printable(s.outside_map_frames), ending(s.outside_map_frames), s.first_outside_map->time_s);
  }
  if (s.barred_frames > 0) {
    line += text("in %llu frame%s the part was nearer than the guard allows; ",
                 printable(s.barred_frames), ending(s.barred_frames));
  }
  if (is_too_fast(scenes, s)) line += "points may have moved more than half a voxel in a frame; ";
  const std::string last = motion_part(scenes, outcome) + "\n";
  if (!s.first_penetration) {
    return line + clearance_part(scenes, s) + "; 0 penetration frames" + last;
  }
  return line +
         text("%llu penetration frame%s, the first at %.3f s%s", printable(s.penetration_frames),
              ending(s.penetration_frames), s.first_penetration->time_s,
              against(scenes, s.first_penetration->touched, true).c_str()) +
         last;
}

Status check_verdict(const Options& options, const Scenes& scenes, const Outcome& outcome,
                     const LoopStatistics& s) {
  const command::Verdict verdict = verdict_of(scenes, outcome, s);
  std::optional<double> first_s;
  std::string what;
  const auto see = [&](FailOn kind, const std::optional<FirstFrame>& first, const std::string& did,
                       bool with_seat) {
    if ((options.fail_on & kind) == 0 || !first || (first_s && *first_s <= first->time_s)) return;
    first_s = first->time_s;
    what = did.empty() ? command::gist(verdict) : did + against(scenes, first->touched, with_seat);
  };
  see(kFailOnPenetration, s.first_penetration, "", true);
  const bool seat_closed =
      s.guarantee_from_s && s.first_contact && s.first_contact->time_s >= *s.guarantee_from_s;
  see(kFailOnContact, s.first_contact, "the part touched the scene", seat_closed);
  see(kFailOnOutside, s.first_outside_map, "the part went beyond a cropped side of the scene",
      true);
  // In the words of the verdict, whatever it says of such a run.
  const bool fails_at_end = ((options.fail_on & kFailOnSeat) != 0 && seat_open(scenes, s)) ||
                            ((options.fail_on & kFailOnHeld) != 0 && is_held(outcome));
  if (!first_s && fails_at_end) what = command::gist(verdict);
  const bool needs_force =
      command::error_code(verdict.kind) == ErrorCode::kNeedsForce && !command::is_yes(verdict.kind);
  if (what.empty() && needs_force) {
    return command::exit_of(verdict, options.run.part.string());
  }
  if (what.empty()) return {};
  return Error{ErrorCode::kAnswerIsNo, options.run.part.string(),
               first_s ? text("at %.3f s", *first_s) : "at the end", what,
               options.trace.empty() ? "--trace shows every frame" : ""};
}

}  // namespace forcelayer::voxrun
