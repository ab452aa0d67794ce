#include "runtime/field/field_probe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "formats/guard.h"

namespace forcelayer::field {
namespace {

// Least and largest weight of a point. A shell may hold points of almost no area at its edges,
// which must still hold the part off.
constexpr float kLeastWeight = 0.25f, kMostWeight = 4.0f;
// Cosine between gradient and slope of the field, from which on both face the same side: they
// differ by some degrees before a face and up to 30 at an edge, and by up to 180 beside a sheet.
constexpr float kSameSide = 0.7f;

}  // namespace

[[gnu::cold]] FieldProbe::FieldProbe(query::ContactQuery& query, const ForceField& field,
                                     query::CollectedPoints& points, FieldSamples& samples)
    : query_(query),
      field_(field),
      points_(points),
      samples_(samples),
      weight_(query.shell().view().point_count) {
  const VoxmapHeader& header = query.voxmap().header();
  constexpr unsigned kSlotBits = 4;  // a frame asks for places near each other
  if (query.voxmap().distances() != nullptr) {
    unpacked_.emplace(*query.voxmap().distances(), kSlotBits);
  }
  guard_m_ = field.proves_distances() ? static_cast<float>(guard_distance_m(header)) : 0;
  free_m_ = field.proves_distances() ? static_cast<float>(free_distance_m(header)) : 0;
  zero_force_m_ = static_cast<float>(header.zero_force_m);
  told_by_distance_ = field.proves_distances() && has_standoff(header);
  const auto mean_m2 = static_cast<float>(mean_point_area_m2(query.shell()));
  const float* weight_m2 = query.shell().view().weight_m2;
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    weight_[i] = std::clamp(weight_m2[i] / mean_m2, kLeastWeight, kMostWeight);
  }
}

void FieldProbe::look_up(const Pose& world_from_center, ContactSet& out) noexcept {
  query_.run(world_from_center, points_);
  read(out);
}

bool FieldProbe::is_pushed_into_seat(const Pose& world_from_center,
                                     std::span<const std::uint8_t> left_out) noexcept {
  if (!seat_open_) return false;
  query_.run(world_from_center, points_);
  forget_sides();
  field_.measure(points_, samples_);
  float highest_m = -std::numeric_limits<float>::infinity();
  for (const SeatObject& object : seat_.objects()) {
    highest_m = std::max({highest_m, object.floor_m, object.corner_floor_m});
  }
  std::optional<bool> in_corners;
  for (std::uint32_t i = 0; i < points_.count; ++i) {
    const float distance_m = stored_distance_m(i);
    if (!(distance_m < highest_m)) continue;  // all but a few
    const std::uint32_t number = object_of(i);
    const SeatObject* const object = seat_.find(number);
    if (object == nullptr || (number < left_out.size() && left_out[number] != 0)) continue;
    float floor_m = object->floor_m;
    if (corner_points_ > 0 && is_in_corner(i)) {
      if (!in_corners) in_corners = lies_in_corners();
      if (*in_corners) floor_m = object->corner_floor_m;
    }
    if (distance_m < floor_m) return true;
  }
  return is_pushed_between(left_out);
}

// Whether collected point i is of an open sheet, and has no inside.
bool FieldProbe::is_two_sided(std::uint32_t i) const noexcept {
  const std::uint8_t* const two_sided = query_.shell().view().two_sided;
  return two_sided != nullptr && two_sided[points_.index[i]] != 0;
}

// The normal of a point without an inside says nothing: with zero in its place, the field takes
// every direction from the scene's slope, and gives no depth where there is none.
[[gnu::cold]] void FieldProbe::forget_sides() noexcept {
  if (query_.shell().view().two_sided == nullptr) return;
  for (std::uint32_t i = 0; i < points_.count; ++i) {
    if (is_two_sided(i)) points_.nx[i] = points_.ny[i] = points_.nz[i] = 0;
  }
}

// The points that the guard keeps out, and the least proven distance.
void FieldProbe::bar(ContactSet& out) const noexcept {
  out.barred = 0;
  out.least_distance_m = free_m_;
  out.nearest = ContactSet::kNone;
  std::uint32_t proximity = 0;  // points of value 3 that are not barred
  for (std::uint32_t i = 0; i < out.count; ++i) {
    bool barred =
        !told_by_distance_ && out.value[i] == static_cast<std::uint8_t>(VoxelValue::kInterior);
    if (field_.proves_distances()) {
      const float distance_m = samples_.distance_m[i];
      barred = barred || distance_m < guard_m_;
      if (distance_m < out.least_distance_m) {
        out.least_distance_m = distance_m;
        out.nearest = i;
      }
    }
    out.is_barred[i] = barred ? 1 : 0;
    out.barred += barred ? 1 : 0;
    proximity += !barred && out.value[i] == static_cast<std::uint8_t>(VoxelValue::kProximity);
  }
  if (!told_by_distance_) return;
  out.interior = out.barred;
  out.proximity = proximity;
  out.surface = out.count - out.barred - proximity;
}

std::uint32_t FieldProbe::object_of(std::uint32_t i) const noexcept {
  const ObjectView* const objects = query_.voxmap().objects();
  if (objects == nullptr) return 0;
  return objects->lookup(points_.vx[i], points_.vy[i], points_.vz[i]).code;
}

// A frame asks a few times.
[[gnu::cold]] std::uint32_t FieldProbe::object_near(const glm::dvec3& world_m) const noexcept {
  const Voxmap& voxmap = query_.voxmap();
  if (voxmap.objects() == nullptr || !unpacked_) return 0;
  const glm::dvec3 at = glm::floor(world_m / voxmap.voxel_size_m());
  constexpr double kFar = 9e15;  // more than any voxel's index
  if (!(std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) < kFar)) return 0;
  const auto x = static_cast<std::int64_t>(at.x), y = static_cast<std::int64_t>(at.y),
             z = static_cast<std::int64_t>(at.z);
  const auto voxel = voxmap.in_directory(x, y, z);
  if (!voxel) return 0;
  const std::uint32_t code = unpacked_->code((*voxel)[0], (*voxel)[1], (*voxel)[2]);
  if (code == 0 || code == kMostDistanceCode) return 0;
  return voxmap.objects()->lookup((*voxel)[0], (*voxel)[1], (*voxel)[2]).code;
}

float FieldProbe::stored_distance_m(std::uint32_t i) const noexcept {
  return zero_force_m_ + samples_.from_zero_force_m[i];
}

// Whether one of the distances around collected point i is negative.
[[gnu::cold]] bool FieldProbe::lies_beside_solid(std::uint32_t i) const noexcept {
  const DistanceView& distances = *query_.voxmap().distances();
  const std::int32_t zero_code = query_.voxmap().header().distance_zero_code;
  const std::array<std::int32_t, 3> low{points_.vx[i] - (points_.fx[i] < 0.5f ? 1 : 0),
                                        points_.vy[i] - (points_.fy[i] < 0.5f ? 1 : 0),
                                        points_.vz[i] - (points_.fz[i] < 0.5f ? 1 : 0)};
  for (int n = 0; n < 8; ++n) {
    const std::int32_t x = low[0] + (n >> 2), y = low[1] + (n >> 1 & 1), z = low[2] + (n & 1);
    if (!distances.contains(x, y, z)) continue;
    // A center on the surface has the code below that of zero.
    if (static_cast<std::int32_t>(unpacked_->code(x, y, z)) < zero_code - 1) return true;
  }
  return false;
}

void FieldProbe::bar_crossings(const ContactSet& earlier, const glm::vec3& way_m,
                               ContactSet& later) const noexcept {
  if (!earlier.seat_open || !later.seat_open) return;
  // A sheet midway between voxel centers has this distance in the middle: half a diagonal.
  const auto sheet_m = static_cast<float>(0.87 * query_.voxmap().voxel_size_m());
  std::uint32_t at = 0;
  for (std::uint32_t i = 0; i < later.count; ++i) {
    if (later.of_seat[i] == 0) continue;
    while (at < earlier.count && earlier.point[at] < later.point[i]) ++at;
    if (at == earlier.count) return;
    if (earlier.point[at] != later.point[i] || earlier.of_seat[at] == 0) continue;
    const glm::vec3 side(earlier.sx[at], earlier.sy[at], earlier.sz[at]);
    const glm::vec3 slope(later.gx[i], later.gy[i], later.gz[i]);
    const glm::vec3 moved_m =
        way_m + glm::vec3(later.ax[i] - earlier.ax[at], later.ay[i] - earlier.ay[at],
                          later.az[i] - earlier.az[at]);
    const float into_m = -glm::dot(moved_m, side);
    // Halfway between two walls the slope turns as well, but the distance falls from there on, and
    // is larger than it can be for a sheet.
    const bool rises = glm::dot(moved_m, slope) > 0 && stored_distance_m(i) < sheet_m;
    // Not that of a wall of the part that stands on the sheet, whose normal lies along it.
    const bool turned = glm::dot(slope, side) < -0.5f * glm::length(slope);
    // A point without an inside would forget its side in the middle of a sheet: it may not go
    // there.
    const bool forgets = is_two_sided(i) && later.sx[i] == 0 && later.sy[i] == 0 &&
                         later.sz[i] == 0 && stored_distance_m(i) < sheet_m;
    if (!(into_m > 0 && (forgets || (rises && turned))) || lies_beside_solid(i)) continue;
    if (later.is_barred[i] == 0) ++later.barred;
    later.is_barred[i] = ContactSet::kBarredWay;
    later.ux[i] = side.x, later.uy[i] = side.y, later.uz[i] = side.z;
    later.depth_m[i] = into_m;
  }
}

// Whether collected point i touches where the field mixes two faces: in a corner of the scene, or
// at an edge of it.
bool FieldProbe::touches_in_corner(std::uint32_t i) const noexcept {
  const auto near_m = static_cast<float>(0.25 * query_.voxmap().voxel_size_m());
  return stored_distance_m(i) < near_m && glm::length(slope(i)) <= kFaceSlope;
}

// Whether it does so in the seat too.
bool FieldProbe::is_in_corner(std::uint32_t i) const noexcept {
  return in_seat_steepness_[points_.index[i]] < 1 && touches_in_corner(i);
}

// Whether the part lies in the corners of its seat: with an eighth of the points that do there. An
// edge of the scene that a few of them meet elsewhere looks like a corner.
bool FieldProbe::lies_in_corners() const noexcept {
  std::uint32_t in_corner = 0;
  for (std::uint32_t i = 0; i < points_.count; ++i) in_corner += is_in_corner(i) ? 1 : 0;
  return 8 * in_corner > corner_points_;
}

// Points near an object of the seat follow the seat's rules: force and guard where the part touches
// the object, or as deep as it lies there, in place of the force layer and the guard before it.
void FieldProbe::apply_seat(ContactSet& out) const noexcept {
  const bool in_corners = corner_points_ > 0 && lies_in_corners();
  for (std::uint32_t i = 0; i < out.count; ++i) {
    const SeatObject* const object = seat_.find(object_of(i));
    out.of_seat[i] = object != nullptr ? 1 : 0;
    if (object == nullptr) continue;
    const glm::vec3 g = slope(i), n = normal(i);
    const float steepness = glm::length(g), distance_m = stored_distance_m(i);
    const std::uint32_t point = points_.index[i];
    const bool barred =
        distance_m < (in_corners && is_in_corner(i) ? object->corner_floor_m : object->floor_m);
    if (out.is_barred[i] != 0 || out.depth_m[i] > 0) ++out.seated;
    const bool interior = told_by_distance_ ? out.is_barred[i] != 0 : is_interior(out.value[i]);
    if (interior && !barred) --out.interior, ++out.surface;
    if (out.is_barred[i] != 0) --out.barred;
    if (barred) ++out.barred;
    out.is_barred[i] = barred ? 1 : 0;
    const glm::vec3 direction = steepness < kLeastSlope ? n : g / steepness;
    // Along the gradient, where it tells the same side, the push is that of a potential: a closed
    // way gives nothing. The slope is some degrees aside of it.
    const glm::vec3 e(samples_.ex[i], samples_.ey[i], samples_.ez[i]);
    const float fall = glm::length(e);
    const glm::vec3 push = glm::dot(e, direction) > kSameSide * fall ? e / fall : direction;
    out.ux[i] = push.x, out.uy[i] = push.y, out.uz[i] = push.z;
    float contact_m = std::min(object->contact_m, in_seat_m_[point]);
    if (const float there = in_seat_steepness_[point]; there < 1) {
      // In the seat itself as deep as there, before a face as other points.
      const float share = in_corners ? (1 - steepness) / (1 - there) : 0;
      contact_m = std::lerp(object->contact_m, contact_m, std::clamp(share, 0.0f, 1.0f));
    }
    out.depth_m[i] = contact_m - distance_m;
    if (direction == glm::vec3(0)) out.depth_m[i] = std::min(out.depth_m[i], 0.0f);
    // Short slopes are of places near the middle of a sheet, where they tell no side. A point that
    // touches it has the part, and so its inward normal, on its own side. One without an inside has
    // no side there.
    const glm::vec3 side = steepness < kSideSlope ? n : direction;
    out.sx[i] = side.x, out.sy[i] = side.y, out.sz[i] = side.z;
    out.gx[i] = g.x, out.gy[i] = g.y, out.gz[i] = g.z;
  }
  if (out.seated == 0) return;
  out.least_distance_m = 0;
  out.nearest = ContactSet::kNone;
}

void FieldProbe::read(ContactSet& out) noexcept {
  forget_sides();
  field_.measure(points_, samples_);
  out.count = points_.count;
  out.interior = points_.interior_count;
  out.surface = points_.surface_count;
  out.proximity = points_.proximity_count;
  out.outside_map = points_.outside_map;
  const auto copy = [&out](const auto& from, auto& to) {
    std::copy_n(from.begin(), out.count, to.begin());
  };
  copy(points_.rx, out.rx), copy(points_.ry, out.ry), copy(points_.rz, out.rz);
  copy(samples_.dx, out.ux), copy(samples_.dy, out.uy), copy(samples_.dz, out.uz);
  copy(samples_.depth_m, out.depth_m);
  if (seat_open_) copy(points_.rx, out.ax), copy(points_.ry, out.ay), copy(points_.rz, out.az);
  copy(points_.index, out.point);
  copy(points_.value, out.value);
  for (std::uint32_t i = 0; i < out.count; ++i) out.weight[i] = weight_[out.point[i]];
  bar(out);
  out.seat_open = seat_open_;
  out.seated = 0;
  if (seat_open_) apply_seat(out);
  if (seat_open_) apply_between(out);
  if (field_.has_exact_slopes()) return;
  const auto voxel_size_m = static_cast<float>(query_.voxmap().voxel_size_m());
  average_directions(points_, samples_, voxel_size_m, -voxel_size_m, out);
}

}  // namespace forcelayer::field
