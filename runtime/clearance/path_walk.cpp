#include "runtime/clearance/path_walk.h"

#include <algorithm>
#include <cmath>

namespace forcelayer::clearance {
namespace {

// Resolution of the walk, in voxels of travel: how far below the least distance of its samples
// what is proven for the whole path may lie; the ends of a piece that is too near; what happens
// inside of one; and the shortest way that it cuts.
constexpr double kMinTolerance = 0.05;
constexpr double kEdge = 1.0 / 16;
constexpr double kInside = 0.5;
constexpr double kShortest = 1.0 / 4096;

// Ways that are longer are tested at their middle first, voxels of travel.
constexpr double kCoarse = 8;

// How many poses a straight way is compared with at most.
constexpr std::size_t kMaxPoses = 1024;

constexpr double kRounding = 1e-6;  // voxels: exceeds that of the bounds here

}  // namespace

PathWalk::PathWalk(const CenterPath& path, PartDistance& part, double voxel_size_m,
                   const WalkLimits& limits)
    : path_(path),
      part_(part),
      voxel_size_m_(voxel_size_m),
      limits_(limits),
      path_rounding_(path.rounding_m() / voxel_size_m),
      margin_(2 * (kRounding + path_rounding_)) {}

// enough(): the distance that a piece must prove for the path's least distance to be known.
// wanted(): the distance that also proves that no piece is too near.
double PathWalk::enough() const { return limits_.min_voxels - kMinTolerance; }
double PathWalk::wanted() const { return std::max(limits_.required_voxels, enough()); }

Sample PathWalk::sample(const Moment& moment, double enough_voxels) {
  ++tested_;
  Sample sample{moment, path_.travel_m(moment), {}};
  sample.smallest = part_.at(path_.world_from_center(moment), sample.travel_m, enough_voxels);
  if (sample.smallest.point != MinDistance::kNone) {
    limits_.min_voxels = std::min(limits_.min_voxels, sample.smallest.voxels);
  }
  return sample;
}

double PathWalk::proven_between(const Sample& a, const Sample& b) const {
  const double travel = (b.travel_m - a.travel_m) / voxel_size_m_ + path_rounding_;
  const double nearer = std::min(a.smallest.voxels, b.smallest.voxels) - path_rounding_;
  const double farther = std::max(a.smallest.voxels, b.smallest.voxels) - path_rounding_;
  const double by_ends = (nearer + farther - travel) / 2 - kRounding;
  if (by_ends >= wanted()) return by_ends;
  const double squared = nearer * nearer - travel * travel / 4;
  const double by_chord = squared > 0 ? std::sqrt(squared) - kRounding : 0;
  // Where that would not do, nothing is gained by looking at every pose.
  const bool is_of_use = by_chord > by_ends && (by_chord >= wanted() || by_chord >= enough());
  const CenterPath::Between poses = CenterPath::between(a.moment, b.moment);
  if (!is_of_use || poses.count() > kMaxPoses) return by_ends;
  return std::max(by_ends, by_chord - path_.deviation_m(a.moment, b.moment) / voxel_size_m_);
}

// Whether a piece need not be cut any more.
bool PathWalk::is_settled(const Sample& a, const Sample& b, double proven, double travel) const {
  if (travel < kShortest) return true;
  if (proven < enough()) return false;
  const double required = limits_.required_voxels;
  if (proven >= required) return true;
  const bool near_a = a.smallest.voxels < required, near_b = b.smallest.voxels < required;
  if (near_a && near_b) return travel < kInside;
  return (near_a || near_b) && travel < kEdge;
}

// A moment between two others that halves the way: a pose of the path where there is one.
Moment PathWalk::between(const Sample& a, const Sample& b) {
  if (const CenterPath::Between poses = CenterPath::between(a.moment, b.moment);
      poses.count() > 0) {
    return {path_.pose_beyond((a.travel_m + b.travel_m) / 2, poses.first, poses.beyond - 1), 0};
  }
  if (last_subdivided_ != a.moment.pose) ++motions_subdivided_;
  last_subdivided_ = a.moment.pose;
  const double end = b.moment.pose == a.moment.pose ? b.moment.fraction : 1;
  return {a.moment.pose, (a.moment.fraction + end) / 2};
}

void PathWalk::cover(const Sample& a, const Sample& b) {
  const double travel = (b.travel_m - a.travel_m) / voxel_size_m_;
  const double proven = proven_between(a, b);
  if (is_settled(a, b, proven, travel)) {
    const bool too_near = proven < limits_.required_voxels;
    pieces_.push_back(
        {a.moment, b.moment, proven, too_near, b.smallest.voxels < a.smallest.voxels ? b : a});
    return;
  }
  const double target = std::max(limits_.required_voxels, limits_.min_voxels);
  Sample middle = sample(between(a, b), target + travel / 2 + margin_);
  // The ends may prove more there.
  const double from_a =
      a.smallest.voxels - (middle.travel_m - a.travel_m) / voxel_size_m_ - margin_;
  const double from_b =
      b.smallest.voxels - (b.travel_m - middle.travel_m) / voxel_size_m_ - margin_;
  middle.smallest.voxels = std::max({middle.smallest.voxels, from_a, from_b});
  cover(a, middle);
  cover(middle, b);
}

void PathWalk::walk(const Moment& from, const Moment& to) {
  part_.forget();
  const double travel = (path_.travel_m(to) - path_.travel_m(from)) / voxel_size_m_;
  const double enough =
      std::max(limits_.required_voxels, limits_.min_voxels) + travel / 2 + margin_;
  const Sample first = sample(from, enough);
  if (from.pose == to.pose && from.fraction == to.fraction) {
    const bool too_near = first.smallest.voxels < limits_.required_voxels;
    pieces_.push_back({from, to, first.smallest.voxels, too_near, first});
    return;
  }
  cover(first, sample(to, enough));
}

// As sample(), but of a moment that is too near it returns only that.
Sample PathWalk::tested(const Moment& moment, double enough_voxels) {
  ++tested_;
  const double travel_m = path_.travel_m(moment);
  return {
      moment, travel_m,
      part_.at(path_.world_from_center(moment), travel_m, enough_voxels, limits_.required_voxels)};
}

// Whether the way between two moments, neither of them too near, is kept. Moves `until` on.
bool PathWalk::keep(const Sample& a, const Sample& b, bool or_nothing, Moment& until) {
  const double travel = (b.travel_m - a.travel_m) / voxel_size_m_;
  if (proven_between(a, b) >= limits_.required_voxels) {
    until = b.moment;
    return true;
  }
  if (travel < kEdge) return false;
  const Sample middle = tested(between(a, b), limits_.required_voxels + travel / 2 + margin_);
  if (middle.smallest.voxels < limits_.required_voxels) {
    if (!or_nothing) keep(a, middle, false, until);
    return false;
  }
  return keep(a, middle, or_nothing, until) && keep(middle, b, or_nothing, until);
}

// An end by what is known of it, should that be enough or all that there is to know.
Sample PathWalk::end(const Moment& moment, double enough_voxels, MinDistance& known) {
  const bool is_all = known.point != MinDistance::kNone || known.voxels >= enough_voxels;
  if (known.voxels < limits_.required_voxels || !is_all) {
    known = tested(moment, enough_voxels).smallest;
  }
  return {moment, path_.travel_m(moment), known};
}

// Whether the part is too near at a moment, or at one of some in the middle of a way: by less than
// its distances. Counts as tested only where it is.
bool PathWalk::is_too_near(const Moment& moment) {
  const double required = limits_.required_voxels;
  const Pose pose = path_.world_from_center(moment);
  const bool too_near =
      part_.at(pose, path_.travel_m(moment), required, required).voxels < required;
  if (too_near) ++tested_;
  return too_near;
}
bool PathWalk::is_too_near_between(const Moment& from, const Moment& to) {
  if (path_.travel_m(to) - path_.travel_m(from) < kCoarse * voxel_size_m_) return false;
  const Moment middle = path_.middle(from, to);
  return is_too_near(middle) || is_too_near_between(from, middle) ||
         is_too_near_between(middle, to);
}

Moment PathWalk::kept_until(const Moment& from, const Moment& to, bool or_nothing,
                            KnownEnds& known) {
  part_.forget();
  const double required = limits_.required_voxels;
  if (or_nothing) {
    // Most ways that are not kept are too near at their end, most others at a middle, which is
    // found sooner than how far they are.
    if (known.last.voxels < required && is_too_near(to)) return from;
    if (is_too_near_between(from, to)) return from;
  }
  const double travel = (path_.travel_m(to) - path_.travel_m(from)) / voxel_size_m_;
  const double enough = required + travel / 2 + margin_;
  const Sample last = end(to, enough, known.last);
  const Sample first = end(from, enough, known.first);
  Moment until = from;
  if (first.smallest.voxels >= required) keep(first, last, or_nothing, until);
  return until;
}

}  // namespace forcelayer::clearance
