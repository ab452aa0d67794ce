// The question of voxcheck to voxcheck-exact, and the answer: JSON between two programs of one
// build. Lengths in meters, world frame unless said otherwise.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/result.h"
#include "runtime/voxcheck/path_source.h"

namespace forcelayer::voxcheck {

inline constexpr double kNothingM = 1e100;  // farther away than any mesh

// A stretch of a path, and the clearance that the baked files prove for all of it.
struct ProvenStretch {
  double from_s = 0, to_s = 0, proven_m = 0;
  bool too_near = false;  // less than required is proven
  bool seated = false;    // the seat's objects do not count
};

// The bounds of the exact distance at one moment, by the baked files.
struct ProvenMoment {
  double time_s = 0, min_m = 0;
  double max_m = 0;     // kNothingM where they do not say
  bool seated = false;  // the seat's objects do not count in `min_m`
};

struct ExactRequest : PathSource {
  std::vector<std::string> meshes, part_meshes, without;
  std::optional<double> unit_m, part_unit_m;  // meters per file unit
  bool allow_outside = false;
  std::string sandbox;  // as typed behind --sandbox=; empty: not given
  double required_m = 0;
  double min_s = 0;             // when the least clearance is proven,
  std::optional<double> max_m;  // and what the exact one is no more than then, where known
  std::vector<std::uint32_t> allowed, seat;   // objects of the scene, by number
  std::vector<ProvenStretch> stretches;       // in the order of time, without gaps
  std::vector<ProvenMoment> moments;          // to hold the meshes against
  std::vector<std::array<double, 2>> seated;  // from, to: when the part is in its seat, s
  std::array<double, 7> seat_pose{};          // world_from_part: m, then w, x, y, z
  // How much deeper than installed the part may go into an object of its seat, beside deviations
  // and rounding.
  std::optional<double> seat_depth_m;
  std::optional<double> max_s;  // after which the measurement stops
  std::string animation;        // file to write the motion into; empty: none
  // A file for the clearance map. Where there is one, the answer is ExactAnswer::warnings alone.
  std::string map;
  // A file of rules. Where there is one, the answer is ExactAnswer::rules and warnings alone, and
  // `required_m` is the clearance where no rule says otherwise.
  std::string rules;
  bool quiet = false;  // no line of progress on the terminal
};

// The surfaces at one moment, as the meshes have them.
struct ExactMoment {
  double time_s = 0, exact_m = 0;             // kNothingM where no object counts
  std::uint32_t object = 0;                   // the nearest; 0: the file names none
  std::array<double, 3> part_m{}, scene_m{};  // the nearest points of the two surfaces
};

// A stretch in which the meshes do not keep the required clearance.
struct ExactViolation {
  double from_s = 0, to_s = 0;
  double clearance_m = 0;  // that holds for all of it, deviations and rounding taken off
  ExactMoment worst;
  bool graze = false;  // so near to what is required that deviations and rounding decide
  // In its seat the part goes deeper into an object than it may. `worst` is the deepest place, and
  // the nearest one of the other surface.
  bool pushed_into_seat = false;
  // How deep the two were found to lie in each other, and at most do at that moment. Of surfaces
  // that meet elsewhere it is the deepest of some moments; 0 where one of the two has no inside.
  double depth_m = 0, max_depth_m = 0;
  // From when on the surfaces meet. Not known where the time was over before that was found.
  double contact_s = 0;
  bool contact_known = false;
  // All of the part was inside of a solid for a while, where its surface met none.
  bool inside = false;
  // No place was found that is deeper than allowed, but walls that are thinner than twice that may
  // pass through each other.
  bool passes_wall = false;
  bool meets() const { return !pushed_into_seat && worst.exact_m == 0; }
};

// Where a mesh is open.
struct ExactHole {
  double edges_m = 0;               // length of all open edges
  std::array<double, 3> place_m{};  // the middle of the longest, world, where the part is installed
};

// How deep the part goes into an object of its seat, as the meshes have it.
struct ExactSeat {
  std::uint32_t object = 0;
  double gap_m = 0;        // how far it and the part are apart where that is installed
  double installed_m = 0;  // how deep they lie in each other there
  double allowed_m = 0;    // how deep they may
  double margin_m = 0;     // deviations, rounding and cracks: what it may lie deeper than the truth
  double crack_m = 0;      // that of cracks in it
  double deepest_m = 0;    // how deep they were found to lie while the part is in its seat
  double nearest_m = 0;    // how near they come then; 0 where they touch
  // Where the part has moved out of its seat by twice the required clearance and twice
  // `installed_m`: how far they are apart, and the time of the path. Where that is the required
  // clearance or more: the same at an earlier time, just before which it is less.
  double soon_m = 0;
  double soon_s = 0;
  // False where one of the two has no inside and their surfaces meet: then the depth says nothing
  // of the other's inside, and it stays open whether the part goes through.
  bool settled = true;
  ExactHole part_hole{}, object_hole{};  // where it is not settled

  // Whether they overlap where the part is installed, for certain.
  bool overlaps() const { return installed_m > margin_m; }
  bool has_seat_depth() const { return allowed_m > installed_m + margin_m; }
};

// A stretch in which the part is in its seat by the meshes: the files prove less than there is, and
// find its end too late. And how near the part comes to all objects that count in it.
struct ExactNearest {
  double from_s = 0, to_s = 0;
  double clearance_m = 0;  // that holds for all of the stretch, deviations and rounding taken off
  ExactMoment nearest;
};

// Where the measurement stopped because its time was over.
struct ExactStop {
  // In kBlockers and kDepths the part is known to meet something; in the latter all that it meets
  // is known, but for its seat. In the last one all is proven but how near it comes.
  enum Stage { kClearance, kBlockers, kDepths, kInstalled, kContact, kSmallest };
  int stage = kClearance;
  std::uint32_t object = 0;  // of the seat, in the stages kInstalled and kContact
  double settled_s = 0;      // until then the path was checked in this stage
};

// The distance that an object must keep from the part, by the rules.
struct ExactRule {
  double required_m = 0;
  bool ignored = false;  // the object may be near, and may collide
};

struct ExactAnswer {
  double clearance_m = 0;  // that holds along the whole path, deviations and rounding taken off
  double margin_m = 0;     // deviations of scene and part, and rounding
  ExactMoment smallest;
  std::vector<ExactViolation> violations;
  std::vector<ExactSeat> seat;
  std::vector<ExactNearest> seated;  // in ExactRequest::seated
  ExactMoment beyond;             // the least distance from all objects that are not of the seat,
  double beyond_clearance_m = 0;  // and what it is at least
  // The object with a closed surface all around the part where the path begins; at most one.
  std::vector<std::uint32_t> enclosed_by;
  // Whether the path ends where the part is beyond the whole scene, along an axis of the world or
  // in the direction in which the path ends.
  bool ends_beyond_scene = false;
  std::uint64_t moments = 0;     // at which a distance was measured
  std::vector<ExactStop> stop;   // at most one
  std::vector<ExactRule> rules;  // [objects] of the scene
  std::vector<std::string> warnings;
};

std::string text_of(const ExactRequest& request);
std::string text_of(const Result<ExactAnswer>& answer);

// Errors: kInternal for a text that the other side did not write.
Result<ExactRequest> exact_request(const std::string& text);
Result<ExactAnswer> exact_answer(const std::string& text);

}  // namespace forcelayer::voxcheck
