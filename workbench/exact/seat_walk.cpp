#include "workbench/exact/seat_walk.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <memory>
#include <utility>

#include "pointshell/part/pieces.h"
#include "workbench/exact/watch.h"

namespace forcelayer::exact {
namespace {

// Resolution of depths that decide nothing.
constexpr double kWithinFraction = 1.0 / 64;
// So many pieces may a proof leave open: at first, and where it is likely to succeed.
constexpr std::size_t kFewOpen = 64, kAllOpen = std::numeric_limits<std::size_t>::max();
// Pieces of motions that are looked at for one that changes its side: at first, and where neither
// surface is then proven to keep its side.
constexpr std::uint64_t kFewCellsOfSide = 1 << 11, kMaxCellsOfSide = 1 << 16;
// And then for the first that does.
constexpr std::uint64_t kCellsToFirst = 1 << 9;

// Whether a surface that does not meet the solid lies inside of it: one place tells.
bool begins_inside(const SurfaceInSolid& pair) {
  const part::Vec3& place = pair.surface->tree().part().vertices.front();
  const Pose solid_from_surface = inverse(pair.world_from_solid) * pair.world_from_surface;
  return pair.solid->holds(
      vec3_of(solid_from_surface.position_m + solid_from_surface.orientation * dvec3_of(place)));
}

}  // namespace

SeatWalk::SeatWalk(const clearance::CenterPath& path, const Bodies& part, const Bodies& object,
                   const MeshPair& distance, double within_m)
    : path_(path), part_(part), object_(object), distance_(distance), within_m_(within_m) {
  for (const auto& body : part) {
    for (const part::Vec3& v : body->tree().part().vertices) {
      radius_m_ = std::max(radius_m_, part::length(v));
    }
  }
  for (const auto& own : part) {
    for (const auto& other : object) {
      const auto add = [&](const Body& surface, const Body& solid, bool is_of_part) {
        if (!solid.is_solid()) return;
        all_.push_back({all_.size(), &surface, &solid, is_of_part, whole_surface()});
      };
      add(*own, *other, true);
      add(*other, *own, false);
    }
  }
}

bool SeatWalk::is_settled() const { return are_solid(part_) || are_solid(object_); }

Depth SeatWalk::at_pose(const Pose& world_from_center, std::optional<double> allowed_m,
                        double within_fraction, const DepthProgress& progress) const {
  return depth_of(all_, world_from_center, allowed_m, within_fraction, progress);
}

Depth SeatWalk::depth_of(const Opens& open, const Pose& world_from_center,
                         std::optional<double> allowed_m, double within_fraction,
                         const DepthProgress& progress) const {
  const Pose world{glm::dvec3(0), {1, 0, 0, 0}};
  std::vector<SurfaceInSolid> pairs;
  for (const Open& o : open) {
    const auto& [of_surface, of_solid] =
        o.is_of_part ? std::pair(world_from_center, world) : std::pair(world, world_from_center);
    pairs.push_back({o.surface, o.solid, of_surface, of_solid, &o.parts});
  }
  const MeshDistance apart = distance_.at(world_from_center, voxcheck::kNothingM);
  if (apart.distance_m > 0 && std::none_of(pairs.begin(), pairs.end(), begins_inside)) {
    return {-apart.distance_m, -apart.distance_m, apart.part_m, apart.scene_m, 0, 0, false};
  }
  Depth met;  // where surfaces meet, that is a place of both, and no depth
  if (!pairs.empty() && !(apart.distance_m > 0)) {
    met = {0, 0, apart.part_m, apart.scene_m, 0, 0, false};
    if (!open[0].is_of_part) std::swap(met.place_m, met.foot_m);
  }
  Depth depth = deepest(pairs, allowed_m, within_m_, within_fraction, progress, met);
  if (!pairs.empty() && !open[depth.pair].is_of_part) {
    std::swap(depth.place_m, depth.foot_m);
    depth.is_at_foot = true;
  }
  return depth;
}

const Depth& SeatWalk::at(const Moment& moment, std::optional<double> allowed_m) {
  return at(moment, allowed_m, all_);
}

const Depth& SeatWalk::at(const Moment& moment, std::optional<double> allowed_m,
                          const Opens& open) {
  const std::tuple key{moment.pose, moment.fraction, allowed_m.has_value()};
  if (const auto known = depths_.find(key); known != depths_.end()) return known->second;
  const Depth depth =
      depth_of(open, path_.world_from_center(moment), allowed_m, kWithinFraction, {});
  if (!deepest_ || depth.found_m > deepest_->second.found_m) deepest_ = {moment, depth};
  return depths_.emplace(key, depth).first->second;
}

// In the part's frame a place of the object moves by p' = R^T (p - c): it turns about the centroid,
// which goes away from it. Its acceleration over the motion is turn^2 |p'| + 2 turn way at most,
// that of a place of the part in the world is turn^2 |p|, and a way with the acceleration a leaves
// its chord by a / 8 at most. A place that comes into the part is within its radius then. Both
// accelerations are across the axis: along it p' = axis (p - c) goes straight.
Motion SeatWalk::motion_of(bool is_of_part, const Moment& begin, const Moment& end) const {
  const Pose from = path_.world_from_center(begin), to = path_.world_from_center(end);
  const Pose middle = path_.world_from_center(path_.middle(begin, end));
  const glm::dquat turned = glm::conjugate(from.orientation) * to.orientation;
  const glm::dvec3 axis(turned.x, turned.y, turned.z);  // of the part's frame, times a sine
  const double sine = glm::length(axis), turn = 2 * std::atan2(sine, std::abs(turned.w));
  const auto bend_of = [&](double max_m, const glm::dquat& solid_from_part) {
    return Bend{max_m, sine > 0 ? vec3_of(solid_from_part * (axis / sine)) : part::Vec3{}};
  };
  const double shift_m = glm::length(to.position_m - from.position_m);
  if (is_of_part) {
    return {from, middle, to, bend_of(turn * turn * radius_m_ / 8, from.orientation),
            (shift_m + turn * radius_m_) / 2};
  }
  const double farthest_m = radius_m_ + shift_m;
  return {inverse(from), inverse(middle), inverse(to),
          bend_of((turn * turn * farthest_m + 2 * turn * shift_m) / 8, {1, 0, 0, 0}),
          (shift_m + turn * farthest_m) / 2};
}

SeatWalk::Opens SeatWalk::not_proven(const Opens& open, const Moment& begin, const Moment& end,
                                     double allowed_m, std::size_t max_open) {
  if (clearance::CenterPath::between(begin, end).count() > 0) return open;
  const Motion of_part = motion_of(true, begin, end), of_object = motion_of(false, begin, end);
  std::uint64_t cells = 0;
  Opens left;
  for (const Open& o : open) {
    std::vector<part::Piece> met;
    Parts parts =
        exact::not_proven(o.parts, *o.surface, *o.solid, o.is_of_part ? of_part : of_object,
                          allowed_m, max_open, cells, met);
    for (const part::Piece& piece : met) met_[o.number].push_back({begin, end, piece});
    if (parts.empty()) continue;
    left.push_back({o.number, o.surface, o.solid, o.is_of_part, std::move(parts)});
  }
  return left;
}

// A motion in which a piece may change its side of a solid, as short as it is told; none where all
// are proven to keep it. With `first`, none that begins later is looked at, and `first` is the
// answer where none is found among so many.
std::optional<SeatWalk::Met> SeatWalk::changes_side(const Open& pair, double allowed_m,
                                                    std::uint64_t max_cells,
                                                    std::optional<Met> first) const {
  const bool is_any = !first;
  std::vector<Met> open = met_[pair.number];
  const auto is_earlier = [&](const Met& a, const Met& b) {
    return path_.time_s(a.begin) < path_.time_s(b.begin);
  };
  std::stable_sort(open.rbegin(), open.rend(), is_earlier);
  for (std::uint64_t cells = 0; !open.empty(); ++cells) {
    keep_going();
    const Met tried = open.back();
    open.pop_back();
    if (first && !is_earlier(tried, *first)) continue;
    const Motion motion = motion_of(pair.is_of_part, tried.begin, tried.end);
    const Hull hull = hull_of(motion, tried.piece);
    if (keeps_side(*pair.solid, hull, allowed_m, motion.bend)) continue;
    double travel_m = 0;
    for (std::size_t n = 0; n < 3; ++n) {
      travel_m = std::max(travel_m, part::length(hull.points[n + 3] - hull.points[n]));
    }
    const part::LongestEdge longest = part::longest_edge(tried.piece);
    const double edge_m = std::sqrt(longest.length_squared);
    if (cells >= max_cells) return first ? first : tried;
    if (std::max(travel_m, edge_m) <= within_m_) {
      first = tried;
      if (is_any) break;
    } else if (travel_m > edge_m) {
      const Moment half = path_.middle(tried.begin, tried.end);
      open.push_back({half, tried.end, tried.piece});
      open.push_back({tried.begin, half, tried.piece});
    } else {
      for (const part::Piece& piece : part::bisected(tried.piece, longest.from)) {
        open.push_back({tried.begin, tried.end, piece});
      }
    }
  }
  return first;
}

// Where a piece begins to change its side: its middle, and the nearest place of the other surface.
SeatWalk::Stretch SeatWalk::begin_of(const Met& change, const Open& pair) const {
  const Pose world{glm::dvec3(0), {1, 0, 0, 0}}, pose = path_.world_from_center(change.begin);
  const Pose& of_surface = pair.is_of_part ? pose : world;
  const Pose& of_solid = pair.is_of_part ? world : pose;
  const auto placed = [](const Pose& frame, const part::Vec3& p) {
    return frame.position_m + frame.orientation * dvec3_of(p);
  };
  const glm::dvec3 place_m = placed(of_surface, part::centroid(change.piece));
  const part::Vec3 in_solid = vec3_of(placed(inverse(of_solid), vec3_of(place_m)));
  const auto nearest = pair.solid->tree().nearest(in_solid);
  Depth depth;
  depth.found_m = pair.solid->holds(in_solid) ? std::sqrt(nearest.distance_squared) : 0;
  depth.at_most_m = depth.found_m;
  depth.place_m = place_m;
  depth.foot_m = placed(of_solid, nearest.point.position);
  if (!pair.is_of_part) std::swap(depth.place_m, depth.foot_m);
  depth.is_at_foot = !pair.is_of_part;
  return {change.begin, change.end, change.begin, depth, false, true};
}

// Two surfaces that pass through each other change both their sides. So it is enough that one of
// both keeps its side all the time; where neither does, both have changed it when the second does.
std::optional<SeatWalk::Stretch> SeatWalk::passage(double allowed_m) {
  for (const Open& open : all_) {
    std::vector<const Open*> ways{&open};
    for (const Open& other : all_) {
      if (other.surface == open.solid && other.solid == open.surface) ways.push_back(&other);
    }
    if (ways.size() > 1 && !open.is_of_part) continue;  // was looked at with the other
    std::vector<Met> changes(ways.size());
    bool is_kept = false;
    for (const std::uint64_t max_cells : {kFewCellsOfSide, kMaxCellsOfSide}) {
      for (std::size_t n = 0; n < ways.size() && !is_kept; ++n) {
        const auto change = changes_side(*ways[n], allowed_m, max_cells, std::nullopt);
        is_kept = !change;
        if (change) changes[n] = *change;
      }
    }
    if (is_kept) continue;
    std::optional<Stretch> second;
    for (std::size_t n = 0; n < ways.size(); ++n) {
      const auto change = changes_side(*ways[n], allowed_m, kCellsToFirst, changes[n]);
      if (second && path_.time_s(change->begin) <= path_.time_s(second->from)) continue;
      second = begin_of(*change, *ways[n]);
    }
    at(second->from, allowed_m);  // how deep it is then, be it the deepest or not
    return second;
  }
  return std::nullopt;
}

// Looks at moments all over a stretch, its poses first, for the deepest, and then closer and closer
// about that. Where a part lies deep in an object along all of a long face, one moment takes
// seconds. A stretch that is known to be too deep is then left after a few of them: no verdict
// depends on how deep it is.
void SeatWalk::find_worst(Stretch& stretch, std::size_t moments) try {
  constexpr std::uint64_t kMaxLooks = 50000;  // at nodes and pieces: a few seconds
  std::uint64_t looks = 0;
  const double from_s = path_.time_s(stretch.from), to_s = path_.time_s(stretch.to);
  const auto look_at = [&](const Moment& moment) {
    if (stretch.is_deeper && looks > kMaxLooks) return;
    const Depth& depth = at(moment, std::nullopt);
    looks += depth.looked_at;
    if (depth.found_m > stretch.worst.found_m) stretch.worst_at = moment, stretch.worst = depth;
  };
  for (const Moment& moment : {stretch.from, stretch.to, stretch.worst_at}) look_at(moment);
  const auto poses = clearance::CenterPath::between(stretch.from, stretch.to);
  const std::size_t count = std::min(moments, poses.count());
  for (std::size_t n = 0; n < count; ++n) look_at({poses.first + n * poses.count() / count, 0});
  double step_s = (to_s - from_s) / static_cast<double>(moments);
  for (std::size_t n = 1; n < moments; ++n) {
    look_at(path_.at(from_s + static_cast<double>(n) * step_s));
  }
  for (std::size_t halving = 0; halving < moments / 2; ++halving) {
    step_s /= 2;
    const double worst_s = path_.time_s(stretch.worst_at);
    for (const double time_s : {worst_s - step_s, worst_s + step_s}) {
      if (time_s > from_s && time_s < to_s) look_at(path_.at(time_s));
    }
  }
} catch (const Stopped&) {
  if (!stretch.is_deeper) throw;
}

SeatWalk::Stretch SeatWalk::deepest_of(const Moment& from, const Moment& to, const Moment& known,
                                       std::size_t moments) {
  Stretch stretch{from, to, known, {}, true};
  find_worst(stretch, moments);
  return stretch;
}

std::vector<SeatWalk::Stretch> SeatWalk::deeper_than(const Moment& from, const Moment& to,
                                                     double allowed_m, double resolution_m,
                                                     bool all) {
  // Where both ends are too deep, what is between is looked at only this closely.
  const double coarse_m = 64 * resolution_m;
  bool is_any_close = false;  // one is enough to be found as closely as can be
  std::vector<Stretch> found;
  const double whole_m =
      std::max(path_.travel_m(to) - path_.travel_m(from), std::numeric_limits<double>::min());
  // Motions, and what of the surfaces may go too deep in them.
  struct Motions {
    Moment begin, end;
    std::shared_ptr<const Opens> parts;
  };
  std::vector<Motions> open{{from, to, std::make_shared<const Opens>(all_)}};
  reached_s_ = path_.time_s(from);
  met_.assign(all_.size(), {});
  const auto is_cut_short = [](const Open& o) {
    return !o.parts.nodes.empty() || o.parts.pieces.size() > kFewOpen;
  };
  const auto is_known_deeper = [&](const Moment& moment) {
    const auto known = depths_.find({moment.pose, moment.fraction, true});
    return known != depths_.end() && known->second.found_m > allowed_m;
  };
  const auto prove = [&](const Opens& parts, const Moment& begin, const Moment& end,
                         std::size_t max_open) {
    return std::make_shared<const Opens>(not_proven(parts, begin, end, allowed_m, max_open));
  };
  const auto is_deeper_so_far = [&] { return !found.empty() && found.back().is_deeper; };
  const auto look_at_next = [&] {
    const auto [begin, end, parts] = open.back();
    open.pop_back();
    reached_s_ = path_.time_s(begin);
    progress_((path_.travel_m(begin) - path_.travel_m(from)) / whole_m);
    // One that begins or ends too deep has no proof.
    auto left = parts;
    const bool is_hopeless = is_known_deeper(begin) || is_known_deeper(end);
    if (!is_hopeless) left = prove(*parts, begin, end, kFewOpen);
    // Where much may be too deep it mostly is.
    const bool is_worth_more = !is_hopeless && std::ranges::any_of(*left, is_cut_short) &&
                               !(at(begin, allowed_m, *left).found_m > allowed_m) &&
                               !(at(end, allowed_m, *left).found_m > allowed_m);
    if (is_worth_more) left = prove(*left, begin, end, kAllOpen);
    if (left->empty()) {
      if (!all && is_deeper_so_far()) open.clear();
      return;
    }
    const double travel_m = path_.travel_m(end) - path_.travel_m(begin);
    bool is_end = false, is_deeper = false;
    Depth a, b;
    if (travel_m <= coarse_m) {
      a = at(begin, allowed_m, *left), b = at(end, allowed_m, *left);
      is_deeper = std::max(a.found_m, b.found_m) > allowed_m;
      is_end = std::min(a.found_m, b.found_m) > allowed_m;
      const bool is_one_motion = clearance::CenterPath::between(begin, end).count() == 0;
      if (travel_m <= resolution_m && is_one_motion) {
        is_end = is_deeper || is_any_close || travel_m <= within_m_;
      }
    }
    if (!is_end) {
      const Moment half = path_.middle(begin, end);
      open.push_back({half, end, left});
      open.push_back({begin, half, left});
      return;
    }
    is_any_close |= !is_deeper;
    const bool follows = !found.empty() && path_.time_s(found.back().to) == path_.time_s(begin);
    if (!follows) found.push_back({begin, end, begin, a});
    Stretch& stretch = found.back();
    stretch.to = end;
    stretch.is_deeper |= is_deeper;
    if (a.found_m > stretch.worst.found_m) stretch.worst_at = begin, stretch.worst = a;
    if (b.found_m > stretch.worst.found_m) stretch.worst_at = end, stretch.worst = b;
  };
  try {
    at(from, std::nullopt), at(to, std::nullopt);  // how deep it is, be it proven or not
    while (!open.empty()) look_at_next();
    if (found.empty() && !may_pass_) {
      if (const auto passed = passage(allowed_m)) found.push_back(*passed);
    }
  } catch (const Stopped&) {
    if (!is_deeper_so_far()) throw;
  }
  for (Stretch& stretch : found) {
    if (stretch.passes_wall) continue;
    find_worst(stretch);
    stretch.is_deeper |= stretch.worst.found_m > allowed_m;
  }
  return found;
}

}  // namespace forcelayer::exact
