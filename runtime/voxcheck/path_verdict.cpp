#include "runtime/voxcheck/path_verdict.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <tuple>

#include "formats/command/text.h"
#include "formats/path/path_edit.h"
#include "runtime/voxcheck/object_names.h"
#include "runtime/voxcheck/words.h"

namespace forcelayer::voxcheck {
namespace {

using clearance::CheckedMoment;
using clearance::CheckResult;
using clearance::Violation;
using command::kDecimalM;
using command::length_text;
using command::text;
using command::VerdictDistance;
using command::VerdictKind;
using Json = nlohmann::ordered_json;
using Known = command::VerdictDistance::Known;

const ExactSeat* exact_seat(const CheckedPath& checked, std::uint32_t object) {
  if (checked.exact == nullptr) return nullptr;
  for (const ExactSeat& seat : checked.exact->seat) {
    if (seat.object == object) return &seat;
  }
  return nullptr;
}

std::string name_of(const CheckedPath& checked, std::uint32_t object) {
  return object == 0 ? "the scene" : shown_name(checked.scene, object);
}

VerdictKind kind_of(const CheckedPath& checked, const Violation& v) {
  const ExactViolation* exact = exact_of(checked, v);
  if (v.out_of_time) return VerdictKind::kUndecided;
  if (v.object_inside) return VerdictKind::kCollides;
  if (v.pushed_into_seat) {
    return exact != nullptr && exact->graze ? VerdictKind::kTooCloseToCall : VerdictKind::kCollides;
  }
  if (v.unsettled_seat || v.worst.beyond_side) return VerdictKind::kUndecided;
  if (exact != nullptr) {
    if (exact->inside || exact->meets()) return VerdictKind::kCollides;
    return exact->graze ? VerdictKind::kTooCloseToCall : VerdictKind::kTooNear;
  }
  if (v.worst.max_m <= 0) return VerdictKind::kCollides;
  return v.worst.max_m < checked.required_m ? VerdictKind::kTooNear : VerdictKind::kUndecided;
}

int rank(VerdictKind kind) {
  switch (kind) {
    case VerdictKind::kCollides:
      return 0;
    case VerdictKind::kTooNear:
      return 1;
    case VerdictKind::kTooCloseToCall:
      return 2;
    default:
      return 3;
  }
}

// Depths that were found are rounded down: they are no more than the true ones.
std::string pushed_text(const CheckedPath& checked, const Violation& v) {
  const std::string object = name_of(checked, v.worst.object);
  const ExactViolation* exact = exact_of(checked, v);
  if (exact == nullptr) {
    return "goes at least " + length_text(v.depth_m) + " deeper into " + object +
           " than in the installed pose";
  }
  const ExactSeat* seat = exact_seat(checked, v.worst.object);
  const auto causes = [&] {
    return std::string(seat->overlaps() ? "overlap as installed and " : "") +
           "deviations of the meshes" + (seat->has_seat_depth() ? " and --seat-depth" : "");
  };
  if (exact->passes_wall) {
    return "may pass through a wall of " + object +
           " that is thinner than twice the allowed depth, " + length_text(seat->allowed_m);
  }
  if (exact->graze) {
    return "is " + length_text(v.depth_m) + " to " +
           command::upper_length_text(exact->max_depth_m, seat->allowed_m) + " deep in " + object +
           "; " + causes() + " (" + length_text(seat->allowed_m) + ") leave this undecided";
  }
  if (seat->allowed_m < kRoundingM && v.depth_m > 2 * kRoundingM) {
    return "goes " + length_text(v.depth_m) + " deep into " + object +
           ", which the installed part does not overlap";
  }
  const auto [depth, allowed] = command::length_texts(v.depth_m, seat->allowed_m);
  const std::string deep = "goes " + depth + " deep into " + object;
  return seat->overlaps() ? deep + ", which the installed part overlaps by at least " +
                                length_text(seat->installed_m)
                          : deep + ", of which " + causes() + " account for at most " + allowed;
}

// "34 mm of open edges, at x 0.00, y 0.00, z 10.00 mm"
std::string hole_text(const ExactHole& hole) {
  const auto& p = hole.place_m;
  return length_text(hole.edges_m) + " of open edges, " + place_text({p[0], p[1], p[2]});
}

// How near the files know the part to be to an object of its seat.
std::string files_know_text(const CheckedPath& checked, std::uint32_t number,
                            const std::string& object) {
  double max_m = INFINITY;
  for (const auto& seated : checked.result.seated) {
    if (seated.nearest.object == number) max_m = std::min(max_m, seated.nearest.max_m);
  }
  if (max_m <= 0) return "the part touches " + object;
  if (!std::isfinite(max_m)) return "the part may touch " + object;
  return "the part comes nearer than " + command::at_most_text(max_m) + " to " + object;
}

std::string unsettled_text(const CheckedPath& checked, const Violation& v) {
  const std::string object = name_of(checked, v.worst.object);
  if (checked.exact != nullptr) {
    const ExactSeat* seat = exact_seat(checked, v.worst.object);
    return "while the part touches " + object +
           ", overlap cannot be measured, because both meshes are open: the part has " +
           hole_text(seat->part_hole) + ", and " + object + " has " + hole_text(seat->object_hole);
  }
  return "in its seat " + files_know_text(checked, v.worst.object, object) +
         text(", and without meshes, features narrower than %.2f mm are not seen",
              ceil_mm(2 * checked.part.header().covering_radius_m));
}

std::string meeting_text(const CheckedPath& checked, const ExactViolation& exact) {
  const std::string name = name_of(checked, exact.worst.object);
  const std::string deep =
      exact.depth_m > 0 ? ", at least " + length_text(exact.depth_m) + " deep" : "";
  if (exact.inside) {
    return "all of the part is inside" + (exact.worst.object == 0 ? "" : " of " + name) + deep;
  }
  return "meets " + name + deep;
}

// "the time limit (--time) expired when contact with Housing was checked along 12.3 of 60.0 mm". A
// study gives a check only the rest of its time, so its user would not know the limit's figure.
std::string out_of_time_text(const CheckedPath& checked, const ExactStop& stop) {
  const std::string object = name_of(checked, stop.object);
  const std::string ended = "the time limit (--time) expired ";
  if (stop.stage == ExactStop::kInstalled) {
    return ended + "before the overlap of the installed part with " + object + " was measured";
  }
  if (stop.stage == ExactStop::kBlockers) {
    return ended + "before all objects that block the part were found";
  }
  if (stop.stage == ExactStop::kDepths) return ended + "before all depths were measured";
  const std::string what =
      stop.stage == ExactStop::kContact ? "contact with " + object : "the clearance";
  const double settled_m = along_m(checked, stop.settled_s);
  if (settled_m == 0) return ended + "before " + what + " was checked";
  return ended + "when " + what +
         text(" was checked along %.1f of %.1f mm", 1e3 * settled_m,
              1e3 * checked.length.whole_m());
}

// The finding of a violation, without its position.
std::string finding_text(const CheckedPath& checked, const Violation& v) {
  if (v.out_of_time) return out_of_time_text(checked, checked.exact->stop[0]);
  if (v.pushed_into_seat) return pushed_text(checked, v);
  if (v.unsettled_seat) return unsettled_text(checked, v);
  const std::string object = name_of(checked, v.worst.object);
  if (v.object_inside) return object + " lies inside the part";
  if (v.worst.beyond_side) {
    return "comes within " + command::length_texts(v.clearance_m, checked.required_m).first +
           " of a cropped side of the scene; nothing is known beyond that side";
  }
  if (const ExactViolation* exact = exact_of(checked, v)) {
    if (exact->meets()) return meeting_text(checked, *exact);
    constexpr double kRoundingM = 1e-9;
    const double off_m = std::abs(exact->worst.exact_m - checked.required_m);
    const std::string distance =
        exact->graze && off_m < kRoundingM
            ? length_text(exact->worst.exact_m)
            : command::length_texts(exact->worst.exact_m, checked.required_m).first;
    const std::string near = "comes within " + distance + " of " + object;
    if (!exact->graze) return near;
    // More digits than the distance is off what is required.
    return near + "; deviations and rounding (" +
           command::length_texts(checked.exact->margin_m, off_m).first + ") leave this undecided";
  }
  if (v.worst.max_m <= 0) return "goes into " + object;
  if (v.worst.max_m < checked.required_m) {
    return "comes within " + command::upper_length_text(v.worst.max_m, checked.required_m) +
           " of " + object + ", or nearer";
  }
  const std::string proven = command::length_texts(v.clearance_m, checked.required_m).first;
  if (!std::isfinite(v.worst.max_m))
    return "only a distance of " + proven + " to " + object + " is proven";
  return "is between " + proven + " and " +
         command::upper_length_text(v.worst.max_m, checked.required_m) + " away from " + object +
         ", and the baked files are not exact enough to decide";
}

// The objects that the part goes into, the one that it goes into deepest first, to the micrometer:
// depths that differ by rounding alone keep the order of the path.
std::vector<std::string> blockers(const CheckedPath& checked) {
  std::vector<std::pair<long long, std::uint32_t>> found;
  for (const Violation& v : checked.result.violations) {
    if (v.worst.object == 0 || kind_of(checked, v) != VerdictKind::kCollides) continue;
    const long long depth_um = std::llround(1e6 * v.depth_m);
    const auto same = std::find_if(found.begin(), found.end(), [&](const auto& other) {
      return other.second == v.worst.object;
    });
    if (same == found.end()) {
      found.emplace_back(depth_um, v.worst.object);
    } else {
      same->first = std::max(same->first, depth_um);
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::string> names;
  for (const auto& [depth_um, object] : found) {
    names.push_back(object_name(checked.scene, object));
  }
  return names;
}

VerdictDistance distance_of(const CheckedPath& checked, const CheckedMoment& moment,
                            const ExactMoment* exact, double proven_m) {
  VerdictDistance distance;
  const bool measured = exact != nullptr && exact->exact_m < kNothingM;
  distance.known = measured ? Known::kMeasured : Known::kProven;
  distance.distance_m = measured ? exact->exact_m : proven_m;
  distance.proven_m = proven_m;
  distance.object = object_name(checked.scene, moment.object);
  distance.along_m = along_m(checked, moment.time_s);
  return distance;
}

// From where on the part is too near the object without a break: the files cut a violation where
// the part leaves its seat.
double begins_s(const CheckedPath& checked, const Violation& v) {
  double from_s = v.from_s;
  const auto& all = checked.result.violations;
  const auto goes_before = [&](const Violation& other) {
    return other.worst.object == v.worst.object && other.of_distance() && other.from_s < from_s &&
           other.to_s >= from_s;
  };
  for (auto at = all.begin(); at != all.end();) {
    at = std::find_if(all.begin(), all.end(), goes_before);
    if (at != all.end()) from_s = at->from_s;
  }
  return from_s;
}

// From how far along the path on a violation blocks the part: where the meshes meet, from contact.
double begins_m(const CheckedPath& checked, const Violation& v) {
  const ExactViolation* exact = exact_of(checked, v);
  if (exact == nullptr && v.of_distance()) return along_m(checked, begins_s(checked, v));
  const bool is_contact = exact != nullptr && exact->contact_known;
  return along_m(checked, is_contact ? exact->contact_s : v.from_s);
}

command::VerdictBegin begin_of(const CheckedPath& checked, const Violation& v) {
  const ExactViolation* exact = exact_of(checked, v);
  const bool touches = exact != nullptr && exact->contact_known;
  const char* const as = v.pushed_into_seat ? "too deep" : touches ? "contact" : "too near";
  return {begins_m(checked, v), as};
}

// Whether the check ended before all was known that may block the part sooner.
bool may_be_blocked_before(const CheckedPath& checked, const Violation& worst) {
  if (checked.exact == nullptr || checked.exact->stop.empty()) return false;
  const ExactStop& stop = checked.exact->stop[0];
  if (stop.stage == ExactStop::kSmallest) return false;
  const bool has_seat = !checked.result.seat_objects.empty();  // which is looked at last
  return has_seat || stop.stage == ExactStop::kBlockers ||
         along_m(checked, stop.settled_s) < begins_m(checked, worst);
}

VerdictDistance smallest_of(const CheckedPath& checked) {
  const CheckResult& r = checked.result;
  VerdictDistance distance =
      distance_of(checked, r.smallest,
                  checked.exact != nullptr ? &checked.exact->smallest : nullptr, r.clearance_m);
  if (r.at_least && distance.known == Known::kProven) distance.known = Known::kAtLeast;
  if (distance.known == Known::kMeasured) distance.distance_m += kDecimalM;
  return distance;
}

// How near the part comes to the objects that are not of its seat, by the meshes.
VerdictDistance beyond_of(const CheckedPath& checked) {
  VerdictDistance distance;
  if (checked.exact == nullptr || checked.exact->beyond.exact_m >= kNothingM) return distance;
  const ExactMoment& beyond = checked.exact->beyond;
  distance.known = Known::kMeasured;
  distance.distance_m = beyond.exact_m + kDecimalM;
  distance.proven_m = checked.exact->beyond_clearance_m;
  distance.object = object_name(checked.scene, beyond.object);
  distance.along_m = along_m(checked, beyond.time_s);
  return distance;
}

std::vector<command::VerdictSlide> slides_of(const CheckedPath& checked) {
  std::vector<command::VerdictSlide> slides;
  for (std::size_t n = 0; n < checked.result.seated.size(); ++n) {
    const auto& stretch = checked.result.seated[n];
    command::VerdictSlide slide;
    slide.from_m = along_m(checked, stretch.from_s);
    slide.to_m = along_m(checked, stretch.to_s);
    slide.gap_m = INFINITY;
    for (const std::uint32_t object : checked.result.seat_objects) {
      const ExactSeat* const exact = exact_seat(checked, object);
      const bool is_passed = exact != nullptr && exact->nearest_m > kRoundingM;
      const double soon_m = exact != nullptr ? along_m(checked, exact->soon_s) : 0;
      const bool is_left = exact != nullptr && checked.required_m > 0 &&
                           exact->soon_m >= checked.required_m && slide.from_m <= soon_m &&
                           soon_m <= slide.to_m;
      (is_passed ? slide.passed
       : is_left ? slide.left
                 : slide.objects)
          .push_back(object_name(checked.scene, object));
      if (is_passed) slide.gap_m = std::min(slide.gap_m, exact->nearest_m + kDecimalM);
      if (is_left && !is_passed) {
        const bool begins = slide.from_m <= 0;
        slide.left_within_m = std::max(slide.left_within_m, begins ? soon_m : slide.to_m - soon_m);
      }
    }
    slides.push_back(std::move(slide));
  }
  return slides;
}

// Cracks make the depth in the seat less exact than distances are.
struct HiddenDepth {
  const ExactSeat* seat = nullptr;  // where they hide most; null: nowhere
  bool is_too_much = false;         // more than the required clearance and --seat-depth
};

HiddenDepth hidden_depth(const CheckedPath& checked) {
  HiddenDepth hidden;
  if (checked.exact == nullptr || checked.result.seated.empty()) return hidden;
  for (const ExactSeat& seat : checked.exact->seat) {
    if (seat.crack_m <= kRoundingM) continue;
    const double depth_m = seat.allowed_m - seat.installed_m - seat.margin_m;  // --seat-depth
    hidden.is_too_much |= seat.margin_m > std::max(checked.required_m, depth_m) + kRoundingM;
    if (hidden.seat == nullptr || seat.margin_m > hidden.seat->margin_m) hidden.seat = &seat;
  }
  return hidden;
}

std::string hidden_depth_text(const CheckedPath& checked, const ExactSeat& seat) {
  return "a collision with " + name_of(checked, seat.object) + " of up to " +
         command::at_most_text(seat.margin_m) + " is not ruled out, because the meshes have cracks";
}

// Said of a path that is one pose: of a search whose start is its goal, or of a check of a pose.
const std::string kStands = "the path does not move the part";

// Said of a path that leaves the seat, and ends before the part is outside of all.
const std::string kWayOn =
    "the path ends within the box around the other objects, and the way on from there was not "
    "checked";

// Where the part touches an object, or nearly so, and triangles that stand for curved surfaces do
// not show whether the two overlap. Empty: nowhere.
std::string hidden_overlap_text(const CheckedPath& checked) {
  if (checked.exact == nullptr || checked.result.seated.empty()) return "";
  const auto most_m = [](const ExactSeat& seat) {
    return seat.overlaps() ? 0 : seat.installed_m + seat.margin_m - seat.gap_m;
  };
  const auto& seats = checked.exact->seat;
  const auto most = std::max_element(
      seats.begin(), seats.end(),
      [&](const ExactSeat& a, const ExactSeat& b) { return most_m(a) < most_m(b); });
  if (most == seats.end() || most_m(*most) <= kRoundingM) return "";
  return "an installed overlap with " + name_of(checked, most->object) + " of up to " +
         command::at_most_text(most_m(*most)) +
         " is not ruled out, because triangles stand for curved surfaces";
}

// Whether the part ends, in part, within the box around the scene's surfaces, and not beyond them.
bool ends_in_scene_box(const CheckedPath& checked) {
  if (checked.exact != nullptr) return !checked.exact->ends_beyond_scene;
  const auto& h = checked.scene.header();
  const PshellView& shell = checked.part.view();
  const Pose end = checked.path.world_from_center({checked.path.poses() - 1, 0});
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (std::uint64_t i = 0; i < shell.point_count; ++i) {
    const glm::dvec3 place =
        end.position_m + end.orientation * glm::dvec3(shell.x[i], shell.y[i], shell.z[i]);
    low = glm::min(low, place);
    high = glm::max(high, place);
  }
  // The voxels that are not free reach farther than the surfaces: by the force layer and one more.
  const double beyond_m = h.zero_force_m + 2 * h.voxel_size_m;
  for (int axis = 0; axis < 3; ++axis) {
    const double from_m = static_cast<double>(h.origin_voxel[axis]) * h.voxel_size_m + beyond_m;
    const double to_m =
        from_m - 2 * beyond_m + static_cast<double>(h.dims_voxels[axis]) * h.voxel_size_m;
    if (high[axis] < from_m || low[axis] > to_m) return false;
  }
  return true;
}

VerdictKind yes_of(const CheckedPath& checked) {
  const CheckResult& r = checked.result;
  const bool ends =
      r.seated.empty() ? r.ends_installed : r.seated.back().to_s >= checked.rows.back().time_s;
  if (r.begins_installed && ends && r.seated.size() == 1) return VerdictKind::kStaysInstalled;
  if (!r.begins_installed || ends) return VerdictKind::kKeepsClearance;
  return ends_in_scene_box(checked) ? VerdictKind::kLeavesSeat : VerdictKind::kComesOut;
}

// "103.2 to 159.5 mm along the path"
std::string stretch_text(const CheckedPath& checked, double from_s, double to_s) {
  return text("%.1f to %.1f mm along the path", 1e3 * along_m(checked, from_s),
              1e3 * along_m(checked, to_s));
}

// "after 51.6 mm, at x 94.64, y 39.86, z 51.52 mm"
std::string where_text(const CheckedPath& checked, const CheckedMoment& moment) {
  return text("after %.1f mm, ", 1e3 * along_m(checked, moment.time_s)) +
         place_text(moment.point_m);
}

// "1.2 mm measured", or the bounds.
std::string bounds_text(const CheckedMoment& moment, const ExactMoment* exact, double proven_m) {
  if (exact != nullptr && exact->exact_m < kNothingM) {
    const std::string measured = length_text(exact->exact_m + kDecimalM) + " measured";
    const bool is_less = command::is_less_proven(exact->exact_m, proven_m);
    return is_less ? measured + ", " + length_text(proven_m) + " proven" : measured;
  }
  return command::bounds_text(proven_m, moment.max_m);
}

}  // namespace

double along_m(const CheckedPath& checked, double time_s) {
  return checked.length.at_m(checked.path.at(time_s));
}

const ExactViolation* exact_of(const CheckedPath& checked, const Violation& v) {
  if (checked.exact == nullptr) return nullptr;
  const auto number = static_cast<std::size_t>(&v - checked.result.violations.data());
  return number < checked.exact->violations.size() ? &checked.exact->violations[number] : nullptr;
}

const ExactMoment* exact_in_seat(const CheckedPath& checked, std::size_t stretch) {
  if (checked.exact == nullptr || stretch >= checked.exact->seated.size()) return nullptr;
  const ExactMoment& nearest = checked.exact->seated[stretch].nearest;
  return nearest.exact_m < kNothingM ? &nearest : nullptr;
}

const Violation& worst_of(const CheckedPath& checked) {
  const auto& violations = checked.result.violations;
  const auto order = [&](const Violation& v) {
    const VerdictKind kind = kind_of(checked, v);
    // To a tenth of a millimeter, as it is printed: where some begin at once, the deepest is first.
    const double begins =
        kind == VerdictKind::kCollides ? std::round(1e4 * begins_m(checked, v)) : 0;
    return std::tuple(rank(kind), begins, v.worst.clearance_m, -v.depth_m);
  };
  return *std::min_element(
      violations.begin(), violations.end(),
      [&](const Violation& a, const Violation& b) { return order(a) < order(b); });
}

std::string motion_text(std::span<const PathRow> rows, const Pshell& part) {
  constexpr double kStraight = 1.001, kTurnRad = 0.02, kAlong = 0.9999, kToward = 0.9;
  constexpr double kStandsM = 1e-6, kOffFraction = 1e-4;
  const auto& c = part.header().center_m;
  const PathFacts facts = path_facts(rows, c);
  const auto centroid = [&](const PathRow& row) {
    return (clearance::pose_of(row) * Pose{{c[0], c[1], c[2]}, {1, 0, 0, 0}}).position_m;
  };
  const glm::dvec3 chord_m = centroid(rows.back()) - centroid(rows.front());
  const double chord = glm::length(chord_m);
  if (facts.length_m < kStandsM) return facts.turn_rad > kTurnRad ? "turning in place" : "";
  if (chord < kStandsM) return "along a path that ends where it begins";
  // It must not leave the line either: a jog to the side hardly makes a path longer.
  double off_m = 0;
  for (const PathRow& row : rows) {
    const glm::dvec3 from_first_m = centroid(row) - centroid(rows.front());
    off_m = std::max(off_m, glm::length(glm::cross(from_first_m, chord_m)) / chord);
  }
  const bool is_straight =
      facts.length_m <= kStraight * chord && off_m <= std::max(kStandsM, kOffFraction * chord);
  const auto toward = [&](const glm::dvec3& way_m) {
    std::string along;
    for (int axis = 0; axis < 3; ++axis) {
      const double cosine = way_m[axis] / glm::length(way_m);
      if (std::abs(cosine) < (is_straight ? kAlong : kToward)) continue;
      along = text("%c%c", cosine > 0 ? '+' : '-', "xyz"[axis]);
    }
    if (!along.empty()) return along;
    const auto digit = [&](int axis) {
      return std::round(1e2 * way_m[axis] / glm::length(way_m)) / 1e2 + 0.0;
    };
    return text("(%.4g, %.4g, %.4g)", digit(0), digit(1), digit(2));
  };
  if (!is_straight) {
    // A path that turns has the directions in which it begins and ends: of its first and last
    // tenth. `from` is the row at that end, and `step` leads away from it.
    const auto tenth_m = [&](std::size_t from, int step) {
      glm::dvec3 way_m(0);
      double length_m = 0;
      for (std::size_t row = from; length_m < 0.1 * facts.length_m;) {
        const std::size_t next = step > 0 ? row + 1 : row - 1;
        if (next >= rows.size()) break;  // also before the first
        length_m += glm::length(centroid(rows[next]) - centroid(rows[row]));
        row = next;
        way_m = centroid(rows[row]) - centroid(rows[from]);
      }
      return glm::length(way_m) < kStandsM ? double(step) * chord_m : way_m;
    };
    const std::string begins = toward(tenth_m(0, 1)),
                      ends = toward(-1.0 * tenth_m(rows.size() - 1, -1));
    return "along a path that " + (begins == ends ? "" : "begins toward " + begins + ", ") +
           "turns and ends toward " + ends;
  }
  const std::string along = toward(chord_m);
  return "straight along " + along + (facts.turn_rad > kTurnRad ? " and turning" : "");
}

std::string place_text(const glm::dvec3& point_m) {
  // A coordinate that would be printed as -0 is printed as 0.
  const auto mm = [](double m) { return std::round(1e5 * m) / 1e2 + 0.0; };
  return text("at x %.2f, y %.2f, z %.2f mm", mm(point_m.x), mm(point_m.y), mm(point_m.z));
}

std::string violation_text(const CheckedPath& checked, const Violation& v) {
  // Surfaces that meet are too near before they do.
  const ExactViolation* exact = exact_of(checked, v);
  const std::string line = (exact != nullptr && exact->meets() ? "too near from " : "") +
                           stretch_text(checked, v.from_s, v.to_s) + ": " +
                           finding_text(checked, v);
  const bool is_somewhere = !v.unsettled_seat && !v.out_of_time;
  if (!is_somewhere) return line;
  const bool touches = exact != nullptr && exact->contact_known;
  const std::string contact =
      touches ? text(", contact from %.1f mm on, worst ", 1e3 * begins_m(checked, v)) : ", ";
  return line + contact + where_text(checked, v.worst);
}

std::optional<std::uint32_t> enclosing_object(const CheckedPath& checked) {
  const bool any = checked.exact != nullptr && !checked.exact->enclosed_by.empty();
  return any ? std::optional(checked.exact->enclosed_by.front()) : std::nullopt;
}

command::Verdict verdict_of(const CheckedPath& checked) {
  const CheckResult& r = checked.result;
  command::Verdict verdict;
  verdict.required_m = checked.required_m;
  verdict.motion = motion_text(checked.rows, checked.part);
  verdict.path_m = checked.length.whole_m();
  verdict.scene_names = object_names(checked.scene);
  verdict.slides = slides_of(checked);
  verdict.nearest = smallest_of(checked);
  verdict.kind = yes_of(checked);
  const auto enclosing = enclosing_object(checked);
  const bool leaves =
      verdict.kind == VerdictKind::kComesOut || verdict.kind == VerdictKind::kLeavesSeat;
  if (r.clear() && enclosing && leaves) {
    verdict.kind = VerdictKind::kDoesNotComeOut;
    verdict.finding = kEnclosed;
    verdict.nearest.known = Known::kNot;
    verdict.blocked_by = {object_name(checked.scene, *enclosing)};
    return verdict;
  }
  if (r.clear()) {
    const HiddenDepth hidden = hidden_depth(checked);
    if (hidden.is_too_much) {
      verdict.kind = VerdictKind::kUndecided;
      verdict.finding = hidden_depth_text(checked, *hidden.seat);
      verdict.nearest.known = Known::kNot;
      verdict.slides.clear();
      verdict.advice = command::kCracksAdvice;
      return verdict;
    }
    verdict.unchecked = hidden.seat != nullptr ? hidden_depth_text(checked, *hidden.seat)
                                               : hidden_overlap_text(checked);
    if (verdict.kind == VerdictKind::kKeepsClearance && verdict.path_m == 0) {
      verdict.unchecked = kStands;
    }
    if (verdict.kind == VerdictKind::kLeavesSeat) {
      verdict.unchecked = kWayOn + (verdict.unchecked.empty() ? "" : "; " + verdict.unchecked);
    }
    if (checked.exact != nullptr) add_overlaps(checked.scene, *checked.exact, verdict);
    return verdict;
  }
  const Violation& worst = worst_of(checked);
  verdict.kind = kind_of(checked, worst);
  if (verdict.kind == VerdictKind::kCollides) {
    verdict.begin = begin_of(checked, worst);
    if (r.begins_installed) verdict.kind = VerdictKind::kDoesNotComeOut;
    verdict.blocked_by = blockers(checked);
    if (may_be_blocked_before(checked, worst)) {
      verdict.unchecked =
          "other objects may block the part before, because the time limit (--time) "
          "ended the check";
    }
  }
  const ExactViolation* exact = exact_of(checked, worst);
  verdict.nearest = distance_of(checked, worst.worst, exact != nullptr ? &exact->worst : nullptr,
                                worst.clearance_m);
  if (worst.unsettled_seat || worst.out_of_time) verdict.nearest.known = Known::kNot;
  if (worst.out_of_time) verdict.slides.clear();
  if (!(verdict.kind == VerdictKind::kTooNear && exact != nullptr)) {
    verdict.finding = finding_text(checked, worst);
  }
  for (const Violation& v : r.violations) {
    if (&v != &worst) verdict.more.push_back(violation_text(checked, v));
  }
  return verdict;
}

ToldMoment told_moment(const CheckedPath& checked) {
  ToldMoment told{checked.result.smallest};
  const bool is_measured = checked.exact != nullptr && checked.exact->smallest.exact_m < kNothingM;
  if (is_measured) told.exact = &checked.exact->smallest;
  return told;
}

void add_overlaps(const Voxmap& scene, const ExactAnswer& exact, command::Verdict& verdict) {
  for (const ExactSeat& seat : exact.seat) {
    if (!seat.overlaps()) continue;
    verdict.overlapped.push_back(object_name(scene, seat.object));
    verdict.overlap_m = std::max(verdict.overlap_m, seat.installed_m);
  }
  if (!verdict.overlapped.empty()) {
    verdict.kind = command::with_overlap(verdict.kind);
    verdict.advice = command::kOverlapAdvice;
  }
}

std::vector<std::string> bounds_texts(const CheckedPath& checked) {
  const CheckResult& r = checked.result;
  std::vector<std::string> lines;
  const auto to = [&](std::uint32_t object) { return " to " + name_of(checked, object); };
  for (std::size_t n = 0; n < r.seated.size(); ++n) {
    const auto& stretch = r.seated[n];
    const ExactMoment* exact = exact_in_seat(checked, n);
    lines.push_back("in its seat from " + stretch_text(checked, stretch.from_s, stretch.to_s) +
                    ": " + bounds_text(stretch.nearest, exact, stretch.clearance_m) +
                    to(stretch.nearest.object) + ", " + where_text(checked, stretch.nearest));
  }
  if (r.clear() && smallest_of(checked).known != Known::kAtLeast) {
    lines.push_back(std::string("nearest") + (r.seated.empty() ? "" : " otherwise") + ": " +
                    bounds_text(r.smallest,
                                checked.exact != nullptr ? &checked.exact->smallest : nullptr,
                                r.clearance_m) +
                    to(r.smallest.object) + ", " + where_text(checked, r.smallest));
  }
  // Just out of its seat the part is near that. How near it comes to other objects is news.
  const VerdictDistance beyond = beyond_of(checked);
  if (r.clear() && beyond.known != Known::kNot) {
    lines.push_back("nearest other object, measured: " + length_text(beyond.distance_m) + " to " +
                    name_of(checked, checked.exact->beyond.object) +
                    text(", after %.1f mm", 1e3 * beyond.along_m));
  }
  return lines;
}

Json moment_json(const CheckedPath& checked, const CheckedMoment& moment, double clearance_m) {
  const auto finite = [](double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
  };
  Json json;
  json["clearance_m"] = clearance_m;
  json["t_s"] = moment.time_s;
  json["along_path_m"] = along_m(checked, moment.time_s);
  json["object"] =
      moment.object == 0 ? Json(nullptr) : Json(object_name(checked.scene, moment.object));
  json["point_m"] = {moment.point_m.x, moment.point_m.y, moment.point_m.z};
  json["at_most_m"] = finite(moment.max_m);
  json["slack_m"] = finite(std::max(0.0, moment.max_m - clearance_m));
  return json;
}

Json stretch_json(const CheckedPath& checked, double from_s, double to_s) {
  Json json;
  json["from_s"] = from_s;
  json["to_s"] = to_s;
  json["from_m"] = along_m(checked, from_s);
  json["to_m"] = along_m(checked, to_s);
  return json;
}

Json seated_json(const CheckedPath& checked, const clearance::SeatedStretch& stretch) {
  Json json = stretch_json(checked, stretch.from_s, stretch.to_s);
  json["travel_m"] = stretch.travel_m;
  json.update(moment_json(checked, stretch.nearest, stretch.clearance_m));
  return json;
}

}  // namespace forcelayer::voxcheck
