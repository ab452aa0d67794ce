#include "runtime/clearance/path_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <span>

#include "runtime/clearance/path_walk.h"
#include "runtime/clearance/required_distance.h"
#include "runtime/clearance/seat_stretch.h"
#include "runtime/clearance/share_out.h"
#include "runtime/query/enclosed_object.h"

namespace forcelayer::clearance {
namespace {

constexpr std::size_t kFractions = 64;       // of a path; whatever the threads
constexpr std::size_t kFirstMoments = 1024;  // for a first idea of the least distance
constexpr double kMeasuredBeyond = 2;        // voxels above what is required
constexpr double kMaxCapVoxels = 160;        // that a search is made for
// Voxels that places on a path may be off by. Up to here a motion has moments that lie nearer to
// each other than a walk cuts it.
constexpr double kMaxRoundingVoxels = 1e-4;

// Checks the path between two moments against all objects but those left out.
class Check {
 public:
  Check(const Voxmap& voxmap, const Pshell& shell, const CenterPath& path,
        const CheckRequest& request)
      : voxmap_(voxmap),
        shell_(shell),
        path_(path),
        request_(request),
        required_(voxmap, shell, request.required_m),
        measured_voxels_(
            std::max(required_.voxels() + kMeasuredBeyond, reach_voxels(voxmap.header()))) {}

  double cap_voxels() const { return measured_voxels_ + 1; }
  std::uint32_t objects() const { return voxmap_.header().object_count; }

  struct Walked {
    std::vector<Piece> pieces;
    Sample nearest;  // of all samples
    std::uint64_t tested = 0, subdivided = 0;
  };
  Walked walk(const LeftOut& left_out, const Moment& from, const Moment& to) const;

  double clearance_m(double voxels) const { return required_.clearance_m(voxels); }
  const RequiredDistance& required() const { return required_; }
  CheckedMoment checked(PartDistance& part, const Sample& sample) const;
  CheckedMoment checked(const LeftOut& left_out, const Sample& sample) const {
    PartDistance part(voxmap_, shell_, left_out, cap_voxels());
    return checked(part, sample);
  }
  std::optional<CheckedMoment> moment_inside(const PartDistance& part, const Moment& from,
                                             const Moment& to) const;
  bool lies_inside(const glm::dvec3& world_m) const;
  std::vector<Violation> violations(const LeftOut& left_out,
                                    const std::vector<Piece>& pieces) const;

 private:
  std::vector<Moment> share_ends(const Moment& from, const Moment& to) const;

  const Voxmap& voxmap_;
  const Pshell& shell_;
  const CenterPath& path_;
  const CheckRequest& request_;
  RequiredDistance required_;
  double measured_voxels_;  // of shell points
};

// Moments that cut the way between two into fractions of equal travel, as far as poses allow.
std::vector<Moment> Check::share_ends(const Moment& from, const Moment& to) const {
  std::vector<Moment> ends{from};
  const std::size_t first = from.pose + 1, last = to.fraction > 0 ? to.pose + 1 : to.pose;
  const double begin_m = path_.travel_m(from), travel_m = path_.travel_m(to) - begin_m;
  for (std::size_t n = 1; n < kFractions && first < last; ++n) {
    const double at_m = begin_m + travel_m * static_cast<double>(n) / kFractions;
    const std::size_t pose = path_.pose_beyond(at_m, first, last - 1);
    if (pose > ends.back().pose) ends.push_back({pose, 0});
  }
  ends.push_back(to);
  return ends;
}

Check::Walked Check::walk(const LeftOut& left_out, const Moment& from, const Moment& to) const {
  std::vector<std::unique_ptr<PartDistance>> parts;
  const unsigned threads = std::max(1u, request_.threads);
  for (unsigned n = 0; n < threads; ++n) {
    parts.push_back(std::make_unique<PartDistance>(voxmap_, shell_, left_out, cap_voxels()));
  }
  Walked walked;
  // A first idea of how near it comes, so that the walks need not look closely where it does not.
  const std::size_t poses = to.pose - from.pose + 1;
  const std::size_t moments = std::min(kFirstMoments, poses);
  std::vector<Sample> first(moments);
  share_out(threads, moments, [&](std::size_t thread, std::size_t n) {
    const Moment moment{from.pose + poses * n / moments, n == 0 ? from.fraction : 0};
    first[n] = {moment, path_.travel_m(moment), {}};
    first[n].smallest =
        parts[thread]->at(path_.world_from_center(moment), first[n].travel_m, measured_voxels_);
  });
  walked.tested = moments;
  walked.nearest = first[0];
  for (const Sample& sample : first) {
    if (sample.smallest.voxels < walked.nearest.smallest.voxels) walked.nearest = sample;
  }
  const WalkLimits limits{required_.voxels(),
                          std::min(measured_voxels_, walked.nearest.smallest.voxels)};
  const std::vector<Moment> ends = share_ends(from, to);
  const std::size_t fractions = std::max<std::size_t>(1, ends.size() - 1);
  std::vector<std::unique_ptr<PathWalk>> walks(fractions);
  share_out(threads, fractions, [&](std::size_t thread, std::size_t n) {
    walks[n] = std::make_unique<PathWalk>(path_, *parts[thread], voxmap_.voxel_size_m(), limits);
    walks[n]->walk(ends[n], ends[n + 1]);
    if (thread == 0 && request_.progress) {
      request_.progress(static_cast<double>(n + 1) / static_cast<double>(fractions));
    }
  });
  for (const auto& walk : walks) {
    walked.pieces.insert(walked.pieces.end(), walk->pieces().begin(), walk->pieces().end());
    walked.tested += walk->tested();
    walked.subdivided += walk->motions_subdivided();
  }
  for (const Piece& piece : walked.pieces) {
    if (piece.worst.smallest.point != MinDistance::kNone &&
        (piece.worst.smallest.voxels < walked.nearest.smallest.voxels ||
         walked.nearest.smallest.point == MinDistance::kNone)) {
      walked.nearest = piece.worst;
    }
  }
  return walked;
}

CheckedMoment Check::checked(PartDistance& part, const Sample& sample) const {
  CheckedMoment moment;
  moment.time_s = path_.time_s(sample.moment);
  moment.clearance_m = clearance_m(sample.smallest.voxels);
  moment.max_m = std::numeric_limits<double>::infinity();
  if (sample.smallest.point == MinDistance::kNone) return moment;
  moment.point_m = part.place_m(path_.world_from_center(sample.moment), sample.smallest.point);
  moment.beyond_side = part.is_of_side(moment.point_m, sample.smallest.voxels);
  if (moment.beyond_side) return moment;
  const auto nearest = part.nearest(moment.point_m);
  moment.object = nearest.object;
  moment.max_m = nearest.max_voxels * voxmap_.voxel_size_m() + required_.deviations_m() +
                 required_.point_off_surface_m();
  return moment;
}

// Whether a position on the part's surface lies in the static solid for certain: by the largest
// distance that the code of its voxel's center allows.
bool Check::lies_inside(const glm::dvec3& world_m) const {
  const double s = voxmap_.voxel_size_m();
  const glm::i64vec3 voxel(glm::floor(world_m / s));
  const double center_m = voxmap_.max_distance_m(voxel.x, voxel.y, voxel.z);
  return center_m + glm::length(world_m - (glm::dvec3(voxel) + 0.5) * s) +
             required_.deviations_m() + required_.point_off_surface_m() <
         0;
}

// A moment between two at which a shell point lies inside the solid for certain. A search for what
// is too near ends at the first such point, where the clearance may still be kept: whether the part
// goes through the solid later, it does not say. Looks at some moments, and some points.
std::optional<CheckedMoment> Check::moment_inside(const PartDistance& part, const Moment& from,
                                                  const Moment& to) const {
  constexpr std::size_t kMoments = 32, kPoints = 20'000;
  const double begin = static_cast<double>(from.pose) + from.fraction;
  const double end = static_cast<double>(to.pose) + to.fraction;
  const std::uint64_t points = shell_.view().point_count, step = 1 + points / kPoints;
  for (std::size_t n = 1; n <= kMoments; ++n) {
    const std::size_t look = n * 13 % kMoments;  // all of them, far from each other at first
    const double at = begin + (end - begin) * static_cast<double>(look) / kMoments;
    const auto pose = std::min(static_cast<std::size_t>(at), to.pose);
    const Moment moment{pose, at - static_cast<double>(pose)};
    const Pose world_from_center = path_.world_from_center(moment);
    for (std::uint64_t i = 0; i < points; i += step) {
      const glm::dvec3 point_m = part.place_m(world_from_center, static_cast<std::uint32_t>(i));
      if (!lies_inside(point_m)) continue;
      CheckedMoment inside;
      inside.time_s = path_.time_s(moment);
      inside.point_m = point_m;
      const glm::i64vec3 voxel(glm::floor(point_m / voxmap_.voxel_size_m()));
      inside.object = voxmap_.nearest_object(voxel.x, voxel.y, voxel.z);
      return inside;
    }
  }
  return std::nullopt;
}

// Pieces that are too near, those that follow each other as one.
std::vector<Violation> Check::violations(const LeftOut& left_out,
                                         const std::vector<Piece>& pieces) const {
  PartDistance part(voxmap_, shell_, left_out, cap_voxels());
  std::vector<Violation> found;
  const Piece* worst = nullptr;
  std::size_t first = 0;  // piece of the stretch
  double min_voxels = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Piece& piece = pieces[i];
    if (!piece.too_near) continue;
    if (worst == nullptr) {
      found.push_back({path_.time_s(piece.from), 0, 0, {}, false});
      worst = &piece;
      first = i;
      min_voxels = piece.min_voxels;
    }
    min_voxels = std::min(min_voxels, piece.min_voxels);
    if (piece.worst.smallest.voxels < worst->worst.smallest.voxels) worst = &piece;
    if (i + 1 < pieces.size() && pieces[i + 1].too_near) continue;
    Violation& violation = found.back();
    violation.to_s = path_.time_s(piece.to);
    violation.clearance_m = clearance_m(min_voxels);
    violation.worst = checked(part, worst->worst);
    const bool all_count = std::find(left_out.begin(), left_out.end(), 1) == left_out.end();
    if (all_count && !(violation.worst.clearance_m > 0)) {
      if (auto inside = moment_inside(part, pieces[first].from, piece.to)) {
        if (inside->object == 0) inside->object = violation.worst.object;
        violation.worst = *inside;
      }
    }
    worst = nullptr;
  }
  return found;
}

// Refuses a path that double precision or the scene's data cannot answer.
Status check_request(const Voxmap& voxmap, const Check& check, const CenterPath& path,
                     const CheckRequest& request) {
  // Not finite for a path that overflows.
  if (!(path.rounding_m() <= kMaxRoundingVoxels * voxmap.voxel_size_m())) {
    return Error{
        ErrorCode::kUsage, "", "path",
        "goes so far away that double precision cannot resolve its positions to 1e-4 voxel",
        "check the units of the path, or leave out its poses far from the scene"};
  }
  if (request.world_from_seat && voxmap.objects() == nullptr) {
    return Error{
        ErrorCode::kUsage, "", "--seat",
        "the scene names no objects, so it is not known which objects the part is seated on",
        "bake a scene of at most 65535 objects with voxelize"};
  }
  if (check.cap_voxels() <= kMaxCapVoxels) return {};
  char what[120], mend[120];
  std::snprintf(what, sizeof what, "is %.0f voxels of this scene, too many to search",
                request.required_m / voxmap.voxel_size_m());
  std::snprintf(mend, sizeof mend, "bake scene and part with --voxel-size %.3gmm or more",
                std::ceil(1e5 * request.required_m / (0.9 * kMaxCapVoxels)) / 100);
  return Error{ErrorCode::kUsage, "", "--clearance", what, mend};
}

bool is_same(const Moment& a, const Moment& b) {
  return a.pose == b.pose && a.fraction == b.fraction;
}

// The stretch of a path that is checked against all objects, and those at its ends in which the
// part is in its seat.
class PathParts {
 public:
  PathParts(const Check& check, const CenterPath& path, const CheckRequest& request,
            double voxel_size_m)
      : check_(check),
        path_(path),
        request_(request),
        seat_reach_m_(kSeatVoxels * voxel_size_m),
        to_{path.poses() - 1, 0} {
    middle_ = check.walk(request.allowed, from_, to_);
  }

  // Takes from those ends of the path that lie in the seat all that is too near, until the part has
  // left it.
  void leave_seat(const Pose& world_from_center_in_seat,
                  std::span<const std::uint32_t> seat_objects) {
    const auto is_seated = [&](const Moment& moment) {
      return path_.travel_between_m(world_from_center_in_seat, path_.world_from_center(moment)) <
             seat_reach_m_;
    };
    begins_ = is_seated(from_), ends_ = is_seated(to_);
    leave_all_objects();
    // The seat's objects do not count in it. Another one that is too near does not keep the part
    // there.
    but_seat_ = with_objects(request_.allowed, seat_objects);
    walk_seat();
    const auto too_near = [](const Piece& piece) { return piece.too_near; };
    if (std::ranges::any_of(before_.counted.pieces, too_near) ||
        std::ranges::any_of(behind_.counted.pieces, too_near)) {
      leave_seat_objects(seat_objects);
      walk_seat();
    }
  }

  bool begins() const { return begins_; }
  bool ends() const { return ends_; }

  // Adds what was found to the result, the seat's stretches before and behind included.
  void add_to(CheckResult& result, SeatStretch* seat) {
    if (seat != nullptr && is_before()) add_seated(result, *seat, begin(), from_, before_);
    add(result, request_.allowed, middle_);
    if (seat != nullptr && is_behind()) add_seated(result, *seat, to_, end(), behind_);
  }

 private:
  // Pieces in the seat that were taken off the path.
  struct Taken {
    void take(std::span<const Piece> pieces) {
      for (const Piece& piece : pieces) {
        if (!any || piece.worst.smallest.voxels < nearest.smallest.voxels) nearest = piece.worst;
        min_voxels = any ? std::min(min_voxels, piece.min_voxels) : piece.min_voxels;
        any = true;
      }
    }
    bool any = false;
    double min_voxels = 0;
    Sample nearest;
    Check::Walked counted;  // the same stretch, without the seat's objects
  };

  Moment begin() const { return {0, 0}; }
  Moment end() const { return {path_.poses() - 1, 0}; }
  // Whether the path begins, or ends, with a stretch in the seat.
  bool is_before() const { return !is_same(begin(), from_) || middle_.pieces.empty(); }
  bool is_behind() const { return !is_same(to_, end()); }

  void walk_seat() {
    if (is_before()) before_.counted = check_.walk(but_seat_, begin(), from_);
    if (is_behind()) behind_.counted = check_.walk(but_seat_, to_, end());
  }

  static bool is_far(const Piece& piece) { return !piece.too_near; }

  // The part has left where all objects are far from it.
  void leave_all_objects() {
    while (!middle_.pieces.empty() && (begins_ || ends_)) {
      const auto first = std::ranges::find_if(middle_.pieces, is_far);
      const auto last = std::find_if(middle_.pieces.rbegin(), middle_.pieces.rend(), is_far);
      if (first == middle_.pieces.end()) {
        before_.take(middle_.pieces);
        from_ = to_;
        middle_ = {};
        return;
      }
      const bool leaves = begins_ && first != middle_.pieces.begin();
      const bool returns = ends_ && last != middle_.pieces.rbegin();
      if (!leaves && !returns) return;
      if (leaves) {
        from_ = first->from;
        before_.take({middle_.pieces.begin(), first});
      }
      if (returns) {
        to_ = last->to;
        behind_.take({last.base(), middle_.pieces.end()});
      }
      middle_ = check_.walk(request_.allowed, from_, to_);
    }
  }

  // The part has left where the objects of its seat are far from it.
  void leave_seat_objects(std::span<const std::uint32_t> seat_objects) {
    LeftOut others(check_.objects() + std::size_t{1}, 1);
    for (const std::uint32_t object : seat_objects) {
      const bool is_allowed = object < request_.allowed.size() && request_.allowed[object] != 0;
      if (!is_allowed) others[object] = 0;
    }
    const bool is_all_in_seat = middle_.pieces.empty();
    const bool is_behind_first = is_behind();
    if (is_before()) {
      const auto walked = check_.walk(others, begin(), from_);
      const auto first = std::ranges::find_if(walked.pieces, is_far);
      if (is_all_in_seat && first == walked.pieces.end()) return;
      before_ = {};
      if (begins_) before_.take({walked.pieces.begin(), first});
      if (!begins_) from_ = begin();
      if (begins_ && first != walked.pieces.end()) from_ = first->from;
    }
    if (is_behind_first || (is_all_in_seat && ends_)) {
      const auto walked = check_.walk(others, is_all_in_seat ? from_ : to_, end());
      const auto last = std::find_if(walked.pieces.rbegin(), walked.pieces.rend(), is_far);
      behind_ = {};
      behind_.take({last.base(), walked.pieces.end()});
      if (last != walked.pieces.rend()) to_ = last->to;
    }
    middle_ = check_.walk(request_.allowed, from_, to_);
  }

  void add_seated(CheckResult& result, SeatStretch& seat, const Moment& from, const Moment& to,
                  const Taken& taken) {
    const std::size_t first_piece = result.curve.size();
    result.seated.push_back(
        {path_.time_s(from), path_.time_s(to), path_.travel_m(to) - path_.travel_m(from),
         check_.clearance_m(taken.min_voxels), check_.checked(request_.allowed, taken.nearest)});
    add(result, but_seat_, taken.counted);
    for (std::size_t n = first_piece; n < result.curve.size(); ++n) {
      CurvePiece& piece = result.curve[n];
      piece.clearance_m = std::min(piece.clearance_m, result.seated.back().clearance_m);
    }
    const std::uint32_t first = first_that_counts(result.seat_objects);
    if (first == 0) return;
    Violation in_seat;
    in_seat.from_s = in_seat.worst.time_s = path_.time_s(from);
    in_seat.to_s = path_.time_s(to);
    if (const auto pushed = seat.first_pushed_in(path_, from, to, request_.allowed)) {
      in_seat.from_s = in_seat.worst.time_s = path_.time_s(pushed->moment);
      in_seat.worst.object = pushed->object;
      in_seat.worst.point_m = pushed->point_m;
      in_seat.pushed_into_seat = true;
      in_seat.depth_m = pushed->deeper_m;
    } else if (request_.felt_seat_is_enough && !seat.too_deep()) {
      return;
    } else {
      in_seat.worst.object = first;
      in_seat.unsettled_seat = true;
    }
    result.violations.push_back(in_seat);
  }

  // The first object of the seat that is not allowed to be near; 0 where there is none.
  std::uint32_t first_that_counts(std::span<const std::uint32_t> seat_objects) const {
    for (const std::uint32_t object : seat_objects) {
      if (object >= request_.allowed.size() || request_.allowed[object] == 0) return object;
    }
    return 0;
  }

  void add(CheckResult& result, const LeftOut& left_out, const Check::Walked& walked) {
    if (walked.pieces.empty()) return;
    const auto found = check_.violations(left_out, walked.pieces);
    result.violations.insert(result.violations.end(), found.begin(), found.end());
    for (const Piece& piece : walked.pieces) {
      min_voxels_ = std::min(min_voxels_, piece.min_voxels);
      const double clearance_m = check_.clearance_m(piece.min_voxels);
      result.curve.push_back(
          {path_.time_s(piece.from), path_.time_s(piece.to), clearance_m, clearance_m});
    }
    result.clearance_m = check_.clearance_m(min_voxels_);
    const bool is_first = result.moments_tested == 0;
    const bool is_measured = walked.nearest.smallest.point != MinDistance::kNone;
    const bool is_nearer = walked.nearest.smallest.voxels < nearest_voxels_;
    if (is_first || (is_measured && (result.at_least || is_nearer))) {
      result.smallest = check_.checked(left_out, walked.nearest);
      // A bound that no object is known to be near.
      result.at_least =
          !is_measured || (!result.smallest.beyond_side && !std::isfinite(result.smallest.max_m));
      nearest_voxels_ = walked.nearest.smallest.voxels;
    }
    result.moments_tested += walked.tested;
    result.motions_subdivided += walked.subdivided;
  }

  const Check& check_;
  const CenterPath& path_;
  const CheckRequest& request_;
  double seat_reach_m_;
  Moment from_, to_;
  Check::Walked middle_;
  Taken before_, behind_;
  bool begins_ = false, ends_ = false;  // whether the path begins, or ends, in the seat
  LeftOut but_seat_;                    // in the seat
  double min_voxels_ = std::numeric_limits<double>::infinity();
  double nearest_voxels_ = std::numeric_limits<double>::infinity();
};

using NoObjects = std::span<const guard::SeatObject>;

// An object that lies wholly inside the part as the path begins is no distance away. Unless the
// surfaces meet there, it stays inside until they do.
Status add_object_inside(const Voxmap& voxmap, const Pshell& shell, const CenterPath& path,
                         const CheckRequest& request, std::span<const guard::SeatObject> seat,
                         CheckResult& result) {
  std::vector<std::uint32_t> felt;
  for (const guard::SeatObject& object : seat) felt.push_back(object.object);
  for (std::uint32_t object = 1; object < request.allowed.size(); ++object) {
    if (request.allowed[object] != 0) felt.push_back(object);
  }
  const double begin_s = path.time_s({0, 0}), end_s = path.time_s({path.poses() - 1, 0});
  for (const Violation& v : result.violations) {
    if (v.from_s <= begin_s && v.clearance_m == 0 && v.of_distance()) return {};
  }
  const auto found =
      query::find_enclosed_object(voxmap, shell, path.world_from_center({0, 0}), felt);
  if (!found) return found.error();
  const std::optional<query::EnclosedObject>& inside = *found;
  if (!inside) return {};
  Violation violation;
  violation.from_s = violation.worst.time_s = begin_s;
  violation.to_s = end_s;
  violation.worst.max_m = std::numeric_limits<double>::infinity();
  violation.worst.object = inside->object;
  violation.worst.point_m = inside->world_m;
  violation.object_inside = true;
  result.violations.push_back(violation);
  return {};
}

}  // namespace

Result<CheckResult> check_path(const Voxmap& voxmap, const Pshell& shell, const CenterPath& path,
                               const CheckRequest& request) {
  if (voxmap.distances() == nullptr) {
    return Error{ErrorCode::kUsage, "", "",
                 "the scene stores no distances, so no clearance is known",
                 "bake the scene without --kind lean or paper"};
  }
  const Check check(voxmap, shell, path, request);
  if (Status sound = check_request(voxmap, check, path, request); !sound) return sound.error();
  std::optional<SeatStretch> seat;
  CheckResult result;
  Pose in_seat;
  if (request.world_from_seat) {
    const auto& c = shell.header().center_m;
    in_seat = *request.world_from_seat * Pose{glm::dvec3(c[0], c[1], c[2]), {1, 0, 0, 0}};
    auto found = SeatStretch::find(voxmap, shell, in_seat, request.seat_depth);
    if (!found) return found.error();
    seat.emplace(std::move(*found));
    result.seat_too_deep = seat->too_deep();
    result.seat_objects = request.near_are_of_seat
                              ? seat->all_near_objects(check.required(), request.far_in_seat)
                              : seat->near_objects(check.required(), request.far_in_seat);
    result.seat_points = guard::points_in_seat(seat->objects());
  }
  PathParts parts(check, path, request, voxmap.voxel_size_m());
  if (seat) {
    parts.leave_seat(in_seat, result.seat_objects);
    result.begins_installed = parts.begins();
    result.ends_installed = parts.ends();
  }
  result.poses = path.poses();
  result.travel_m = path.travel_m({path.poses() - 1, 0});
  parts.add_to(result, seat ? &*seat : nullptr);
  if (Status s = add_object_inside(voxmap, shell, path, request,
                                   seat ? seat->objects() : NoObjects{}, result);
      !s) {
    return s.error();
  }
  return result;
}

}  // namespace forcelayer::clearance
