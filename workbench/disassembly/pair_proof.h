// Whether a part on its path keeps the rules of a study beside one other part, proven by the meshes
// of both, between the poses as at them:
//
// - An object that is farther from the installed part than the clearance stays so along the path.
// - Another one is of the seat. Until the part has once been as far from it as the clearance, the
//   part goes no deeper into it than it is installed, and does not meet what it is apart from
//   there. From then on the clearance counts.
//
// A study has one seat for all objects, which ends where the part has left the last of them. Here
// each object counts as soon as the part has left it, which is stricter. So each pair of parts is
// settled by itself, and its answer holds whatever other parts there are.
#pragma once

#include <optional>

#include "runtime/clearance/center_path.h"
#include "workbench/pairs/pair_check.h"

namespace forcelayer::disassembly {

struct PairRule {
  double required_m = 0;    // clearance
  double rounding_m = 0;    // of a measured distance
  double deviation_m = 0;   // of both meshes from the true surfaces
  bool is_ignored = false;  // the parts may be near and may collide: nothing is measured
  double margin_m() const { return rounding_m + deviation_m; }
};

// Two parts as installed.
struct Installed {
  double gap_m = 0;     // between the surfaces; 0 where they meet
  double depth_m = 0;   // how deep one lies in the other; 0 where it does not
  double margin_m = 0;  // deviations, rounding and cracks: what the depth may be wrong by
  double allowed_m() const { return depth_m + margin_m; }  // of depth, along a path
  bool is_seat = false;                                    // nearer than the clearance
  // Whether one lies inside the other, and their surfaces do not meet: no path leads out of that.
  bool is_enclosed = false;
  // Whether one of both has an inside, so that a depth can be measured.
  bool is_settled = true;
  bool is_known = true;  // false: the measurement was too long
};

// Measures two parts as installed. Both shapes are in the world.
Installed measure_installed(const pairs::Shape& part, const pairs::Shape& object,
                            const PairRule& rule);

enum class PairOutcome {
  kFree,       // proven
  kBlocked,    // a violation was found
  kUndecided,  // neither: only deviations and rounding decide, or the proof was too long
};

// Whether the rules are broken at one of some moments of the path: quick, where a proof may be
// long. No says nothing. Arguments as of check_pair().
bool is_seen_blocked(const clearance::CenterPath& path, const pairs::Shape& part,
                     const pairs::Shape& object, const Installed& installed, const PairRule& rule);

// `part` is in its center frame, which `path` moves, and `object` in the world. The path begins
// where the part is installed. Undecided where the boxes of the two are not apart by end_gap_m()
// where it ends: a part that ends inside of an object has not come out.
PairOutcome check_pair(const clearance::CenterPath& path, const pairs::Shape& part,
                       const pairs::Shape& object, const Installed& installed,
                       const PairRule& rule);

// How far apart two boxes are, at least, at the end of a path that is proven.
double end_gap_m(const PairRule& rule);

// A lower bound of the distance between the boxes of both along the whole path.
double swept_gap_m(const clearance::CenterPath& path, const mesh::Box& part,
                   const mesh::Box& object);

// The least distance along a path.
struct Nearest {
  double distance_m = 0;  // as measured
  double proven_m = 0;    // a lower bound, less the deviations; 0 at least
  double at_s = 0;        // time of the path
};
// None where it is proven to be `beyond_m` or more, or is ignored. `part`, `object` and `path` as
// above.
std::optional<Nearest> nearest_along(const clearance::CenterPath& path, const pairs::Shape& part,
                                     const pairs::Shape& object, const PairRule& rule,
                                     double beyond_m);

}  // namespace forcelayer::disassembly
