// Whether a part keeps its clearance along a whole path, proven between poses as at them.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "formats/pshell.h"
#include "formats/result.h"
#include "formats/voxmap.h"
#include "runtime/clearance/center_path.h"
#include "runtime/clearance/front.h"
#include "runtime/guard/seat.h"

namespace forcelayer::clearance {

// An end of a path is in the seat where it is less travel away, in voxels.
inline constexpr double kSeatVoxels = 2;

using guard::SeatDepth;

struct CheckRequest {
  double required_m = 0;                // between the exact surfaces
  unsigned threads = 1;                 // no answer depends on it
  LeftOut allowed;                      // objects that may be near
  std::optional<Pose> world_from_seat;  // of the part: where it is installed
  // Whether a seat is clear where shell points feel nothing. Between them an object may have
  // features that are narrower than twice the covering radius.
  bool felt_seat_is_enough = false;
  // Objects known to be as far away as required where the part is installed: none is of the seat.
  LeftOut far_in_seat{};
  // Is called now and then with the fraction of a walk along the path that is done, in one thread.
  std::function<void(double)> progress{};
  // Whose depth decides whether the part may be in its seat. With kOfMeshes the caller asks them.
  SeatDepth seat_depth = SeatDepth::kStored;
  // Whether each object that is not proven to be as far away as required in the seat is of it, and
  // not only those that the part touches. For a caller who then finds those that are far by the
  // meshes.
  bool near_are_of_seat = false;
};

// The part at one moment of its path.
struct CheckedMoment {
  double clearance_m = 0;  // proven at that moment
  double max_m = 0;        // upper bound of the exact clearance; infinite where not known
  double time_s = 0;
  std::uint32_t object = 0;  // the nearest; 0: not known
  glm::dvec3 point_m{0};     // of the part's surface there, world
  bool beyond_side = false;  // so near lies a cropped side, beyond which nothing is known
};

// A stretch in which less than the required clearance is proven.
struct Violation {
  double from_s = 0, to_s = 0;
  double clearance_m = 0;  // proven for all of it
  CheckedMoment worst;
  bool pushed_into_seat = false;  // the part goes deeper into `worst.object` than it may
  // By how much it is deeper than in the installed pose: of that object's shell points; with
  // --exact how deep it is.
  double depth_m = 0;
  bool unsettled_seat = false;  // nothing was felt, but `worst.object` may be too narrow for that
  // `worst.object` lies wholly inside the part where the path begins: no shell point is near it.
  bool object_inside = false;
  // With --exact: the time was over before the meshes were measured here.
  bool out_of_time = false;
  // Whether what is too near is a distance that the files prove.
  bool of_distance() const {
    return !pushed_into_seat && !unsettled_seat && !object_inside && !out_of_time;
  }
};

// Clearance that is proven from one time to another.
struct CurvePiece {
  double from_s = 0, to_s = 0, clearance_m = 0;
  double but_seat_m = 0;  // while the part is in its seat, of objects that are not of it
};

// A stretch in which objects of the seat may be nearer than required: as long as the part has not
// once been as far from all of them as that. An object that is as far away where the part is
// installed is not of the seat.
struct SeatedStretch {
  double from_s = 0, to_s = 0;
  double travel_m = 0;     // a bound on how far any point of the part travels in it
  double clearance_m = 0;  // proven for all of it, the seat's objects among the others
  CheckedMoment nearest;   // of all moments looked at
};

struct CheckResult {
  bool clear() const { return violations.empty(); }

  double clearance_m = 0;  // proven along the whole path, but in the seat to its objects
  bool at_least = false;   // nothing was near enough for `smallest` to be measured
  CheckedMoment smallest;
  std::vector<Violation> violations;
  std::vector<CurvePiece> curve;
  std::vector<SeatedStretch> seated;
  // Whether the path begins, or ends, where the part is installed: in contact or not.
  bool begins_installed = false, ends_installed = false;
  // Objects that may be nearer than required where the part is installed.
  std::vector<std::uint32_t> seat_objects;
  std::uint64_t seat_points = 0;  // shell points that feel an object there
  // Why the files refuse the seat, if they do and the meshes are to be asked: it looks too deep.
  std::optional<Error> seat_too_deep;
  double travel_m = 0;  // a bound on how far any point of the part travels along the whole path
  std::uint64_t poses = 0, moments_tested = 0, motions_subdivided = 0;
};

// Errors: kUsage where the scene stores no distances, where its voxels are too small for the
// required clearance, where the path goes too far for double precision (CenterPath::rounding_m), or
// where the seat cannot be found (SeatStretch::find).
Result<CheckResult> check_path(const Voxmap& voxmap, const Pshell& shell, const CenterPath& path,
                               const CheckRequest& request);

}  // namespace forcelayer::clearance
