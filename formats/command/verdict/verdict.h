// The verdict of a command: one value, from which the terminal, every report and the exit status
// are written, so that no two of them can say different things.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/result.h"

namespace forcelayer::command {

enum class VerdictKind {
  // The answer is yes.
  kComesOut,        // it leaves the place where it is installed, and keeps the clearance from then
  kKeepsClearance,  // along the whole path
  kLeavesSeat,      // the same as the first, but the path ends between other objects
  kStaysInstalled,  // it collides with nothing, and touches its seat all along the path
  // The same of a part that overlaps something as installed: only force moves it.
  kComesOutWithOverlap,
  kKeepsClearanceWithOverlap,
  kLeavesWithOverlap,
  kStaysWithOverlap,
  // The answer is no, or not known.
  kTooNear,         // a distance is less than what is required
  kCollides,        // the surfaces meet, or one lies inside the other
  kDoesNotComeOut,  // the same, of a part that is installed where its path begins
  kTooCloseToCall,  // only deviations and rounding decide
  kUndecided,       // the inputs do not decide
  kNeverNear,       // nothing is near, and the caller asked that this is no success
  kNoPathFound,
  kHeld,        // something holds a moved part off its motion
  kPenetrates,  // a moved part was inside another one in at least one frame
  kRefused,     // a wrong command line or an unusable file: nothing was checked
};

inline constexpr VerdictKind kAllVerdictKinds[] = {VerdictKind::kComesOut,
                                                   VerdictKind::kKeepsClearance,
                                                   VerdictKind::kLeavesSeat,
                                                   VerdictKind::kStaysInstalled,
                                                   VerdictKind::kComesOutWithOverlap,
                                                   VerdictKind::kKeepsClearanceWithOverlap,
                                                   VerdictKind::kLeavesWithOverlap,
                                                   VerdictKind::kStaysWithOverlap,
                                                   VerdictKind::kTooNear,
                                                   VerdictKind::kCollides,
                                                   VerdictKind::kDoesNotComeOut,
                                                   VerdictKind::kTooCloseToCall,
                                                   VerdictKind::kUndecided,
                                                   VerdictKind::kNeverNear,
                                                   VerdictKind::kNoPathFound,
                                                   VerdictKind::kHeld,
                                                   VerdictKind::kPenetrates,
                                                   VerdictKind::kRefused};

// Whether the answer is yes, and no overlap as installed needs force.
bool is_yes(VerdictKind kind);
// Whether the answer is yes, with or without such an overlap.
bool passes(VerdictKind kind);
// A yes with such an overlap, and without; each other kind as it is.
VerdictKind with_overlap(VerdictKind kind);
VerdictKind without_overlap(VerdictKind kind);
// The error with which a command ends whose answer is not yes: kNeedsForce or kAnswerIsNo.
ErrorCode error_code(VerdictKind kind);

// "comes out", "too close to call" ...: the key `kind` of --json, and the first words of a
// sentence.
const char* to_text(VerdictKind kind);

// The kind that to_text() names; kUndecided for another word.
VerdictKind verdict_kind(std::string_view words);

// Lengths are shown rounded down. A distance that is measured between decimal coordinates may be
// less than its decimal number by far less than this, m, which is added first.
inline constexpr double kDecimalM = 1e-10;

// A distance between part and scene at one position of the path.
struct VerdictDistance {
  enum class Known {
    kNot,       // nothing is known
    kAtLeast,   // nothing was near enough to measure
    kProven,    // a lower bound
    kMeasured,  // between the meshes
  };
  Known known = Known::kNot;
  double distance_m = 0;
  std::string object;   // the nearest; empty: it has no name
  double along_m = 0;   // of the path, from its beginning
  double proven_m = 0;  // a lower bound of one that is measured
};

// A stretch of the path in which the part is in its seat.
struct VerdictSlide {
  double from_m = 0, to_m = 0;         // of the path
  std::vector<std::string> objects;    // that it touches, or may touch
  std::vector<std::string> passed;     // that it does not touch,
  double gap_m = 0;                    // and how near it comes to them
  std::vector<std::string> left = {};  // that it touches at one end alone,
  double left_within_m = 0;            // within so much of the path
};

// Where along the path a collision begins, and how: "contact", "too near" where the meshes are not
// at hand or, in a seat, "too deep".
struct VerdictBegin {
  double along_m = 0;
  const char* as = "too near";
};

struct Verdict {
  VerdictKind kind = VerdictKind::kUndecided;
  bool is_asked = true;  // whether a clearance was asked for and checked: not in a run
  double required_m = 0;
  std::string motion;  // "straight along +z"; empty: it does not move, or no path is known
  double path_m = 0;   // how long the path is
  std::vector<VerdictSlide> slides;
  std::vector<std::string> overlapped = {};  // objects that the installed part overlaps,
  double overlap_m = 0;                      // at least as deep
  VerdictDistance nearest;  // the least distance beside the slides; where the answer is no, there
  std::optional<VerdictBegin> begin;  // of a collision, which is worst at `nearest`
  std::string finding;    // what is wrong, or not decided, where a distance does not say it
  std::string unchecked;  // why there may be more that is wrong, or what a yes cannot rule out
  std::vector<std::string> blocked_by;        // objects, the most important first
  std::vector<std::string> scene_names = {};  // of all objects: sentences shorten names by them
  std::string advice;                         // what to do next
  std::vector<std::string> more;              // further stretches in which the answer is no
  std::vector<std::string> notes;             // lines for people behind the first
  std::vector<std::string> remarks;           // to be shown as warnings: overlaps as installed
};

// The name, and "[1]" where it is the first of several siblings of one name: beside "Bolt[2]".
std::string numbered_name(const std::string& name, std::span<const std::string> scene_names);

// The shortest end of a name, from a slash on, that no other name of the scene ends with:
// "Lid/Bolt" of "Engine/Lid/Bolt" beside "Engine/Block/Bolt". Commands know the object by it, too.
// The first of several siblings of one name gets its number: "Bolt[1]" beside "Bolt[2]". An end
// that is still long is cut: ".../Lid/Bolt". Without names of a scene, a name is only cut.
std::string short_name(const std::string& name, std::span<const std::string> scene_names);

// "12.7 mm": rounded down to three decimals, or to three digits of a small length: "0.0499 mm".
std::string length_text(double length_m);

// The same of two lengths that are compared: where they differ, their texts differ too.
std::pair<std::string, std::string> length_texts(double a_m, double b_m);

// The same, rounded up; of a length that is less than another one, the text is too.
std::string upper_length_text(double length_m, double than_m);

// An upper bound, rounded up; and the two bounds of a length that is not known, each rounded to its
// safe side: "at least 0.3 mm and at most 0.458 mm". No word of an upper bound that is not finite.
std::string at_most_text(double length_m);
std::string bounds_text(double at_least_m, double at_most_m);

// Whether less is proven of a distance than was measured, by more than it is searched for: of
// triangles that stand for a curved surface.
bool is_less_proven(double measured_m, double proven_m);

// The words of the answer and the direction, and the force without which the answer is no; without
// an end: the heading of a page or picture.
std::string heading(const Verdict& verdict);
// The rest of the sentence.
std::string explanation(const Verdict& verdict);

// The first sentence: comes out or not, in which direction, how far it slides on what, the least
// distance to what and where along the path, and what was required. Escaped, one line.
std::string sentence(const Verdict& verdict);

// The same without what goes well: for the line of an error.
std::string gist(const Verdict& verdict);

// The sentence and, indented, the notes: each a line.
std::string terminal_text(const Verdict& verdict);

// The keys of a report that hold the verdict: `verdict`, `kind`, `heading`, `sentence`,
// `required_clearance_m`, `direction`, `finding`, `blocked_by`.
nlohmann::ordered_json verdict_json(const Verdict& verdict);

// "clear" or "not clear": the key `verdict`.
const char* verdict_word(const Verdict& verdict);

// Whether a command that ends with this status, or with this error, has answered its question.
constexpr bool is_answer(int exit_status) {
  return exit_status == 0 || exit_status == 6 || exit_status == 7;
}
constexpr bool is_answer(ErrorCode code) { return is_answer(exit_status(code)); }

// The advice that goes with kNeedsForce.
inline constexpr char kOverlapAdvice[] = "if the overlap is intended, accept exit status 7";
// That for a seat in which cracks hide a depth of more than the required clearance.
inline constexpr char kCracksAdvice[] =
    "close the cracks of the meshes, or accept such a depth with --seat-depth";

// An error where the answer is not yes. `file` is what the verdict is about. Errors: error_code().
Status exit_of(const Verdict& verdict, const std::string& file);

}  // namespace forcelayer::command
