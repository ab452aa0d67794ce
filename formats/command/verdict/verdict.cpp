#include "formats/command/verdict/verdict.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "formats/command/text.h"

namespace forcelayer::command {
namespace {

using Known = VerdictDistance::Known;

constexpr std::size_t kListed = 5;          // objects in a sentence
constexpr std::size_t kListedBytes = 100;   // of their names, unless the first is longer
constexpr int kDecimals = 3, kDigits = 15;  // of millimeters
constexpr int kSignificant = 3;             // digits at least
constexpr double kSmallestM = 1e-9;         // a shorter length is rounding
// Twice what a least distance is searched for, m and as a fraction of it.
constexpr double kSearchedM = 2e-7, kSearchedFraction = 2e-5;

// Rounded down. A decimal number that is read from a command line stays as it was written: what a
// double adds to it lies six digits behind the last that is kept.
std::string cut_mm(double length_m, int decimals) {
  std::string digits = text("%.*f", decimals + 6, 1e3 * length_m);
  digits.resize(digits.size() - 6);
  digits.erase(digits.find_last_not_of('0') + 1);
  if (digits.back() == '.') digits.pop_back();
  return digits == "-0" ? "0" : digits;
}

// The decimals with which a length is shown: three, and more where the first digits are zeros.
int decimals_of(double length_m) {
  if (!(std::abs(length_m) >= kSmallestM)) return kDecimals;
  const int first = static_cast<int>(std::ceil(-std::log10(1e3 * std::abs(length_m)) - 1e-9));
  return std::clamp(first + kSignificant - 1, kDecimals, kDigits);
}

// No two doubles have the same: a thousand times one fits into a long double.
std::string all_digits(double length_m) { return text("%.21Lg mm", 1e3L * length_m); }

std::string printed(const Verdict& v, const std::string& object) {
  return object.empty() ? "the scene" : escaped(short_name(object, v.scene_names));
}

// "A", "A and B", "A, B and 3 more".
std::string listed(const Verdict& v, std::span<const std::string> objects) {
  std::size_t shown = 0, bytes = 0;
  while (shown < std::min(kListed, objects.size())) {
    bytes += printed(v, objects[shown]).size();
    if (shown > 0 && bytes > kListedBytes) break;
    ++shown;
  }
  std::string line;
  for (std::size_t n = 0; n < shown; ++n) {
    const bool is_last = n + 1 == objects.size();
    line += (n == 0 ? "" : is_last ? " and " : ", ") + printed(v, objects[n]);
  }
  if (objects.size() > shown) line += text(" and %zu more", objects.size() - shown);
  return line;
}

std::string capital(std::string line) {
  line.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(line.front())));
  return line;
}

// A position along the path, mm.
std::string short_mm(double along_m) { return cut_mm(std::round(1e4 * along_m) / 1e4, 1); }

// "after 51.6 of 60 mm"
std::string position_text(const Verdict& v, double along_m) {
  return "after " + short_mm(along_m) + " of " + short_mm(v.path_m) + " mm";
}

// "too near from 22 mm on, worst after 58.1 of 60 mm": the same of a collision.
std::string finding_position_text(const Verdict& v) {
  const std::string worst = position_text(v, v.nearest.along_m);
  if (!v.begin || short_mm(v.begin->along_m) == short_mm(v.nearest.along_m)) return worst;
  const std::string begin = short_mm(v.begin->along_m);
  return v.begin->as +
         (begin == "0" ? " from the start, worst " : " from " + begin + " mm on, worst ") + worst;
}

// Whether the part moves off what it touches, or onto it, and not along it: the whole clearance is
// gained, or lost, within this many times its length.
bool is_off_or_onto(const Verdict& v, const VerdictSlide& slide) {
  constexpr double kTimes = 2;
  const bool begins = slide.from_m <= 0, ends = slide.to_m >= v.path_m;
  return begins != ends && !(slide.objects.empty() && slide.left.empty()) &&
         slide.to_m - slide.from_m <= kTimes * v.required_m;
}

// "leaves A within the first 2 mm and slides along B for the first 51.6 mm", or how near it passes
// them. Where the answer is no, other objects are named behind it, so this names none.
std::string slide_text(const Verdict& v, const VerdictSlide& slide) {
  const bool begins = slide.from_m <= 0, ends = slide.to_m >= v.path_m;
  const std::string length = short_mm(slide.to_m - slide.from_m) + " mm";
  if (!passes(v.kind)) {
    const std::string away =
        v.required_m > 0 ? length_text(v.required_m) + " away from its seat" : "free of its seat";
    if (begins && ends) return "never gets " + away;
    if (begins) return "gets " + away + " after " + length;
    return "is back in its seat for " + std::string(ends ? "the last " : "") + length;
  }
  std::string line;
  const bool is_short = is_off_or_onto(v, slide);
  if (!slide.left.empty() && !is_short) {
    line = (ends && !begins ? "reaches " : "leaves ") + listed(v, slide.left) + " within the " +
           (ends && !begins ? "last " : "first ") + short_mm(slide.left_within_m) + " mm";
  }
  std::vector<std::string> touched = slide.objects;
  if (is_short) touched.insert(touched.end(), slide.left.begin(), slide.left.end());
  if (!touched.empty()) {
    line += line.empty() ? "" : " and ";
    const bool are_overlapped =
        std::ranges::is_permutation(touched, v.overlapped) && touched.size() > 1;
    line += (!is_short ? "slides along "
             : begins  ? "leaves "
                       : "reaches ") +
            (are_overlapped ? "what it overlaps" : listed(v, touched));
  }
  if (!slide.passed.empty()) {
    line += std::string(line.empty() ? "" : " and ") + "passes " + listed(v, slide.passed) +
            " with a gap of " + length_text(slide.gap_m);
  }
  if (line.empty()) line = "is in its seat";
  if (begins && ends) return line + " for the whole path of " + length;
  return line + (is_short ? " within " : " for ") +
         (begins ? "the first "
          : ends ? "the last "
                 : "") +
         length;
}

// A slide that ends after the reason for a no has begun is left out.
std::string slides_text(const Verdict& v) {
  const bool is_somewhere = !passes(v.kind) && v.nearest.known != Known::kNot;
  const double reason_m = v.begin ? v.begin->along_m : is_somewhere ? v.nearest.along_m : INFINITY;
  std::string line;
  for (const VerdictSlide& slide : v.slides) {
    if (slide.to_m > reason_m) break;
    line += (line.empty() ? "" : " and ") + slide_text(v, slide);
  }
  return line;
}

// A distance that stands in a sentence: the proven one, where the answer is yes and less is proven
// than was measured.
double shown_m(const Verdict& v, const VerdictDistance& distance) {
  const bool is_less = passes(v.kind) && distance.known == Known::kMeasured &&
                       is_less_proven(distance.distance_m, distance.proven_m);
  return is_less ? distance.proven_m : distance.distance_m;
}

// "measured to Clip, after 51.6 of 60 mm"
std::string source_text(const Verdict& v, const VerdictDistance& distance) {
  if (distance.known == Known::kAtLeast) return "nothing is nearer";
  const bool is_measured =
      distance.known == Known::kMeasured && shown_m(v, distance) == distance.distance_m;
  return (is_measured ? "measured to " : "proven; nearest to ") + printed(v, distance.object) +
         ", " + position_text(v, distance.along_m);
}

// The distance, and in parentheses to what, where, and what was required.
std::string distance_text(const Verdict& v, const char* before, const char* behind) {
  const auto [distance, required] = length_texts(shown_m(v, v.nearest), v.required_m);
  return before + distance + behind + " (" + source_text(v, v.nearest) + "; " + required +
         " required)";
}

// The same of a finding in words.
std::string finding_text(const Verdict& v) {
  if (!v.is_asked) return v.finding;
  std::string line = v.finding;
  line += " (";
  if (v.nearest.known == Known::kNot)
    return line + length_text(v.required_m) + " of clearance required)";
  // A collision is one whatever distance was required.
  line += finding_position_text(v);
  return v.begin ? line + ")" : line + "; " + length_text(v.required_m) + " required)";
}

// The reason: a distance, or the finding.
std::string answer_text(const Verdict& v) {
  if (!v.finding.empty()) return finding_text(v);
  if (v.nearest.known == Known::kNot) return length_text(v.required_m) + " required";
  if (passes(v.kind)) return distance_text(v, "stays ", " away or more");
  return v.kind == VerdictKind::kNeverNear ? distance_text(v, "it stays ", " away or more")
                                           : distance_text(v, "comes as near as ", "");
}

// The same, and the objects behind it. The one that the finding names is not named twice.
std::string reason_text(const Verdict& v) {
  const std::string reason = answer_text(v) + (v.unchecked.empty() ? "" : "; " + v.unchecked);
  std::vector<std::string> others = v.blocked_by;
  const bool names_one = !v.finding.empty() && v.nearest.known != Known::kNot;
  if (names_one) std::erase(others, v.nearest.object);
  if (others.empty()) return reason;
  const bool also = others.size() < v.blocked_by.size();
  return reason + (also ? "; also blocked by " : "; blocked by ") + listed(v, others);
}

std::string head_of(const Verdict& v) {
  const VerdictKind kind = without_overlap(v.kind);
  if (kind == VerdictKind::kKeepsClearance && v.required_m == 0)
    return "passes without a collision";
  if (kind == VerdictKind::kStaysInstalled) return "is still in its seat";
  return to_text(kind);
}

// ", if force overcomes its overlap with A and B (at least 0.15 mm when installed)": without it
// the answer is no. A part that stays installed needs no force: it may stand still.
std::string overlap_text(const Verdict& v) {
  if (without_overlap(v.kind) == v.kind) return "";
  const bool stays = v.kind == VerdictKind::kStaysWithOverlap;
  return (stays ? ", and overlaps " : ", if force overcomes its overlap with ") +
         listed(v, v.overlapped) + " (at least " + length_text(v.overlap_m) + " when installed)";
}

// The first words of a sentence.
constexpr const char* kWords[] = {"comes out",
                                  "keeps the clearance",
                                  "leaves its seat",
                                  "stays in contact",
                                  "comes out with overlap",
                                  "keeps the clearance with overlap",
                                  "leaves its seat with overlap",
                                  "stays in contact with overlap",
                                  "does not keep the clearance",
                                  "collides",
                                  "does not come out",
                                  "too close to call",
                                  "undecided",
                                  "never near the scene",
                                  "no path found",
                                  "is held",
                                  "penetrates",
                                  "refused"};
static_assert(std::size(kWords) == std::size(kAllVerdictKinds));

}  // namespace

bool is_yes(VerdictKind kind) {
  return kind == VerdictKind::kComesOut || kind == VerdictKind::kKeepsClearance ||
         kind == VerdictKind::kLeavesSeat || kind == VerdictKind::kStaysInstalled;
}

bool passes(VerdictKind kind) { return is_yes(without_overlap(kind)); }

VerdictKind with_overlap(VerdictKind kind) {
  switch (kind) {
    case VerdictKind::kComesOut:
      return VerdictKind::kComesOutWithOverlap;
    case VerdictKind::kKeepsClearance:
      return VerdictKind::kKeepsClearanceWithOverlap;
    case VerdictKind::kLeavesSeat:
      return VerdictKind::kLeavesWithOverlap;
    case VerdictKind::kStaysInstalled:
      return VerdictKind::kStaysWithOverlap;
    default:
      return kind;
  }
}

VerdictKind without_overlap(VerdictKind kind) {
  for (const VerdictKind yes : kAllVerdictKinds) {
    if (is_yes(yes) && with_overlap(yes) == kind) return yes;
  }
  return kind;
}

ErrorCode error_code(VerdictKind kind) {
  return passes(kind) ? ErrorCode::kNeedsForce : ErrorCode::kAnswerIsNo;
}

std::string numbered_name(const std::string& name, std::span<const std::string> scene_names) {
  const bool is_first =
      std::find(scene_names.begin(), scene_names.end(), name + "[2]") != scene_names.end();
  return is_first ? name + "[1]" : name;
}

std::string short_name(const std::string& name, std::span<const std::string> scene_names) {
  constexpr std::size_t kMaxBytes = 64;
  const auto is_shared = [&](std::string_view end) {
    return std::any_of(scene_names.begin(), scene_names.end(), [&](const std::string& other) {
      return other != name && other.ends_with(end) &&
             (other.size() == end.size() || other[other.size() - end.size() - 1] == '/');
    });
  };
  std::size_t from = scene_names.empty() ? 0 : name.size();
  while (from > 0 && (from == name.size() || is_shared(std::string_view(name).substr(from)))) {
    const std::size_t slash = from < 2 ? std::string::npos : name.rfind('/', from - 2);
    from = slash == std::string::npos ? 0 : slash + 1;
  }
  std::string end = name.substr(from);
  end += numbered_name(name, scene_names).substr(name.size());
  if (end.size() <= kMaxBytes) return end;
  const std::size_t slash = end.find('/', end.size() - kMaxBytes);
  const std::size_t cut = slash != std::string::npos ? slash : end.rfind('/');
  return cut == std::string::npos ? end : "..." + end.substr(cut);
}

const char* to_text(VerdictKind kind) { return kWords[static_cast<std::size_t>(kind)]; }

VerdictKind verdict_kind(std::string_view words) {
  for (const VerdictKind kind : kAllVerdictKinds) {
    if (words == to_text(kind)) return kind;
  }
  return VerdictKind::kUndecided;
}

std::string length_text(double length_m) { return cut_mm(length_m, decimals_of(length_m)) + " mm"; }

std::string upper_length_text(double length_m, double than_m) {
  for (int decimals = decimals_of(length_m); decimals <= kDigits; ++decimals) {
    // Noise that a double adds to a decimal number does not round it up.
    const double scale = std::pow(10, decimals);
    const double mm = std::ceil(1e3 * length_m * scale * (1 - 1e-12)) / scale;
    if ((mm < 1e3 * than_m) == (length_m < than_m)) return cut_mm(mm / 1e3, decimals) + " mm";
  }
  return all_digits(length_m);
}

std::string at_most_text(double length_m) {
  return upper_length_text(length_m, std::numeric_limits<double>::infinity());
}

std::string bounds_text(double at_least_m, double at_most_m) {
  const std::string line = "at least " + length_text(at_least_m);
  return std::isfinite(at_most_m) ? line + " and at most " + at_most_text(at_most_m) : line;
}

std::pair<std::string, std::string> length_texts(double a_m, double b_m) {
  std::string a = length_text(a_m), b = length_text(b_m);
  for (int decimals = std::max(decimals_of(a_m), decimals_of(b_m)); a_m != b_m && a == b;
       ++decimals) {
    if (decimals > kDigits) return {all_digits(a_m), all_digits(b_m)};
    a = cut_mm(a_m, decimals) + " mm";
    b = cut_mm(b_m, decimals) + " mm";
  }
  return {a, b};
}

bool is_less_proven(double measured_m, double proven_m) {
  return proven_m < measured_m * (1 - kSearchedFraction) - kSearchedM;
}

std::string heading(const Verdict& v) {
  return capital(head_of(v)) + (v.motion.empty() ? "" : ", " + v.motion) + overlap_text(v);
}

std::string explanation(const Verdict& v) {
  std::string line = slides_text(v);
  if (!line.empty()) line += passes(v.kind) ? ", otherwise " : ", but ";
  return line + reason_text(v);
}

std::string sentence(const Verdict& v) { return heading(v) + ": " + explanation(v) + "."; }

std::string gist(const Verdict& v) { return head_of(v) + overlap_text(v) + ": " + reason_text(v); }

std::string terminal_text(const Verdict& v) {
  std::string lines = sentence(v) + "\n";
  for (const std::string& note : v.notes) lines += "  " + note + "\n";
  return lines;
}

const char* verdict_word(const Verdict& v) { return is_yes(v.kind) ? "clear" : "not clear"; }

nlohmann::ordered_json verdict_json(const Verdict& v) {
  nlohmann::ordered_json json;
  json["verdict"] = verdict_word(v);
  json["kind"] = to_text(v.kind);
  json["heading"] = heading(v);
  json["sentence"] = sentence(v);
  json["required_clearance_m"] = v.required_m;
  const auto or_null = [](const std::string& words) {
    return words.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(words);
  };
  json["direction"] = or_null(v.motion);
  json["finding"] = or_null(v.finding);
  json["blocked_by"] = v.blocked_by;
  return json;
}

Status exit_of(const Verdict& v, const std::string& file) {
  if (is_yes(v.kind)) return {};
  return Error{error_code(v.kind), file, "", gist(v), v.advice};
}

}  // namespace forcelayer::command
