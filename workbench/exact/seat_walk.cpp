#include "workbench/exact/seat_walk.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace forcelayer::exact {
namespace {

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
  for (const Bodies* bodies : {&part, &object}) {
    for (const auto& body : *bodies) crack_m_ = std::max(crack_m_, body->crack_m());
  }
}

Depth SeatWalk::at_pose(const Pose& world_from_center, std::optional<double> allowed_m) const {
  const Pose world{glm::dvec3(0), {1, 0, 0, 0}};
  std::vector<SurfaceInSolid> pairs;
  for (const auto& part : part_) {
    for (const auto& object : object_) {
      if (object->is_solid()) pairs.push_back({part.get(), object.get(), world_from_center, world});
    }
  }
  const std::size_t of_part = pairs.size();
  for (const auto& part : part_) {
    for (const auto& object : object_) {
      if (part->is_solid()) pairs.push_back({object.get(), part.get(), world, world_from_center});
    }
  }
  const MeshDistance apart = distance_.at(world_from_center, voxcheck::kNothingM);
  if (apart.distance_m > 0 && std::none_of(pairs.begin(), pairs.end(), begins_inside)) {
    return {-apart.distance_m, -apart.distance_m, apart.part_m, apart.scene_m, 0, 0};
  }
  Depth depth = deepest(pairs, allowed_m, within_m_);
  if (depth.pair >= of_part) std::swap(depth.place_m, depth.foot_m);
  return depth;
}

const Depth& SeatWalk::at(const Moment& moment, double allowed_m) {
  const auto [place, is_new] = depths_.try_emplace({moment.pose, moment.share});
  if (is_new) {
    place->second = at_pose(path_.world_from_center(moment), allowed_m);
    if (!deepest_ || place->second.found_m > deepest_->second.found_m) {
      deepest_ = {moment, place->second};
    }
  }
  return place->second;
}

// The depth from which a part that moves goes deeper.
double SeatWalk::from_m(const Depth& depth) const {
  if (depth.at_most_m < 0) return depth.at_most_m + crack_m_;
  return std::max(depth.at_most_m, crack_m_);
}

std::vector<SeatWalk::Stretch> SeatWalk::deeper_than(const Moment& from, const Moment& to,
                                                     double allowed_m, double resolution_m) {
  // Where both ends are too deep, what is between is looked at only this closely.
  const double coarse_m = 64 * resolution_m;
  std::vector<Stretch> found;
  const double whole_m =
      std::max(path_.travel_m(to) - path_.travel_m(from), std::numeric_limits<double>::min());
  std::vector<std::pair<Moment, Moment>> open{{from, to}};
  while (!open.empty()) {
    const auto [begin, end] = open.back();
    open.pop_back();
    const Depth &a = at(begin, allowed_m), &b = at(end, allowed_m);
    const double way_m = path_.travel_m(end) - path_.travel_m(begin);
    progress_((path_.travel_m(begin) - path_.travel_m(from)) / whole_m);
    if ((from_m(a) + from_m(b) + way_m) / 2 <= allowed_m) continue;
    const bool both = std::min(a.found_m, b.found_m) > allowed_m;
    if (way_m > resolution_m && !(both && way_m <= coarse_m)) {
      const Moment half = path_.middle(begin, end);
      open.push_back({half, end});
      open.push_back({begin, half});
      continue;
    }
    const bool follows = !found.empty() && path_.time_s(found.back().to) == path_.time_s(begin);
    if (!follows) found.push_back({begin, end, begin, a});
    Stretch& stretch = found.back();
    stretch.to = end;
    if (a.found_m > stretch.worst.found_m) stretch.worst_at = begin, stretch.worst = a;
    if (b.found_m > stretch.worst.found_m) stretch.worst_at = end, stretch.worst = b;
  }
  return found;
}

}  // namespace forcelayer::exact
