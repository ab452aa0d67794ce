#include "runtime/guard/seat_rule.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

namespace forcelayer::guard {
namespace {

// A motion that goes against a point's side by less than this fraction goes along the wall.
constexpr float kGrazing = 0.01f;
// A point is beyond the middle of a wall from there on: more than the rounding of two codes.
constexpr float kBeyondMiddleVoxels = 0.05f;

// A cell whose slope is this steep along a normal lies before the wall, but for a corner of a tenth
// of a voxel.
constexpr float kClearSlope = 0.9f;

// A normal at most some 80 degrees aside of a wall's direction tells a point's side of the wall.
constexpr float kAlongWall = 0.15f;
// A point without an inside has the side on which it is. So it may not come nearer to the middle
// of a wall than this, which is more than the error of its height.
constexpr float kBeforeMiddleVoxels = 0.1f;
// Two cells may differ by so much in the height of a position over a wall.
constexpr float kHeightErrorVoxels = 0.07f;

constexpr float square(float x) { return x * x; }

}  // namespace

SeatRule::SeatRule(field::FieldProbe& probe, const PointRule& rule)
    : probe_(probe),
      rule_(rule),
      between_(probe),
      walls_(probe),
      tables_(seat_),
      nearest_(probe),
      corner_m_(static_cast<float>(0.25 * probe.voxmap().voxel_size_m())) {}

// A sheet midway between voxel centers has this distance in the middle: half a diagonal. A wall of
// less than twice that may have no deeper distance, and points in it none that is deep enough to be
// barred: like a sheet, it is known by the side that they came from.
float SeatRule::half_sheet_m() const noexcept {
  return static_cast<float>(0.87 * probe_.voxmap().voxel_size_m());
}

// Whether the i-th point touches where the field mixes two faces: in a corner of the scene, or at
// an edge of it.
bool SeatRule::touches_in_corner(std::uint32_t i) const noexcept {
  return probe_.stored_distance_m(i) < corner_m_ && glm::length(probe_.slope(i)) <= kFaceSlope;
}

// Whether it does so in the seat too.
bool SeatRule::is_in_corner(std::uint32_t i) const noexcept {
  return in_seat_steepness_[probe_.point(i)] < 1 && touches_in_corner(i);
}

// Whether the part lies in the corners of its seat: with an eighth of the points that do there. An
// edge of the scene that a few of them meet elsewhere looks like a corner.
bool SeatRule::lies_in_corners() const noexcept {
  return 8 * count_in_corners(probe_, in_seat_steepness_.data(), corner_m_) > corner_points_;
}

void SeatRule::apply(field::ContactSet& out) noexcept {
  std::copy_n(out.rx.begin(), out.count, out.ax.begin());
  std::copy_n(out.ry.begin(), out.count, out.ay.begin());
  std::copy_n(out.rz.begin(), out.count, out.az.begin());
  const bool corners = corner_points_ > 0;
  press_points(
      probe_,
      {nearest_.find(), tables_, in_seat_m_.data(), corners ? in_seat_steepness_.data() : nullptr,
       corners && lies_in_corners(), corner_m_, rule_.goes_by_value()},
      out);
  if (out.seated > 0) {
    out.min_distance_m = 0;
    out.nearest = field::ContactSet::kNone;
  }
  between_.press(seat_, out);
}

// Whether the i-th point may be one of a face before a wall, or behind it. Where the slope is that
// of a cell before the wall, it is at most a tenth of a voxel behind.
bool SeatRule::may_face_wall(std::uint32_t i) const noexcept {
  return glm::dot(probe_.slope(i), probe_.normal(i)) < kClearSlope;
}

// Whether the i-th point, which has moved, has gone through a flush wall. None where none is known.
std::optional<SeatRule::WallCrossing> SeatRule::flush_crossing(
    std::uint32_t i, const glm::vec3& moved_m) const noexcept {
  const bool has_inside = !probe_.is_two_sided(i);
  const float proven_m = probe_.samples().distance_m[i], moved2_m2 = glm::dot(moved_m, moved_m);
  if (has_inside && proven_m > 0 && moved2_m2 < square(proven_m)) return std::nullopt;
  const FlushWall wall = walls_.beside(i);
  if (!wall.is_known()) return std::nullopt;
  const auto voxel_size_m = static_cast<float>(probe_.voxmap().voxel_size_m());
  const float along = glm::dot(moved_m, wall.direction) / voxel_size_m;
  const float facing = glm::dot(probe_.normal(i), wall.direction);
  const bool faces = std::abs(facing) > kAlongWall;
  const float sign = (faces ? facing : wall.height - along) > 0 ? 1.0f : -1.0f;
  const float after = sign * wall.height, before = after - sign * along;
  const float lowest = has_inside ? -kBeyondMiddleVoxels : kBeforeMiddleVoxels;
  const float was_before = faces || !has_inside ? lowest - kHeightErrorVoxels : kHeightErrorVoxels;
  const float grazing = has_inside ? 0 : kGrazing * std::sqrt(moved2_m2) / voxel_size_m;
  return WallCrossing{before > was_before && after < lowest && after < before - grazing,
                      (lowest - after) * voxel_size_m, sign * wall.direction};
}

void SeatRule::mark_crossings(const field::ContactSet& earlier, const glm::vec3& shift_m,
                              field::ContactSet& later) const noexcept {
  if (!earlier.seat_open || !later.seat_open) return;
  const float sheet_m = half_sheet_m();
  const std::size_t pairs =
      find_turned(probe_, earlier, later, sheet_m, kClearSlope, turned_.data());
  for (std::size_t n = 0; n < pairs; ++n) {
    const std::uint32_t at = turned_[n].earlier, i = turned_[n].later;
    const glm::vec3 slope(later.gx[i], later.gy[i], later.gz[i]);
    const glm::vec3 side(earlier.sx[at], earlier.sy[at], earlier.sz[at]);
    const bool faces = may_face_wall(i);
    // A point without an inside would forget its side in the middle of a sheet: it may not go
    // there.
    const bool forgets =
        probe_.is_two_sided(i) && later.sx[i] == 0 && later.sy[i] == 0 && later.sz[i] == 0;
    if (!(glm::dot(slope, side) < 0 || faces || forgets)) continue;
    const glm::vec3 moved_m =
        shift_m + glm::vec3(later.ax[i] - earlier.ax[at], later.ay[i] - earlier.ay[at],
                            later.az[i] - earlier.az[at]);
    const auto bar = [&](const glm::vec3& to, float by_m) {
      if (later.is_barred[i] == 0) ++later.barred;
      later.is_barred[i] = field::ContactSet::kCrossed;
      later.ux[i] = to.x, later.uy[i] = to.y, later.uz[i] = to.z;
      later.depth_m[i] = by_m;
    };
    const float steepness = glm::length(slope);
    const glm::vec3 slope_before(earlier.gx[at], earlier.gy[at], earlier.gz[at]);
    const bool before_one_face = !probe_.is_two_sided(i) && steepness >= kClearSlope &&
                                 glm::dot(slope_before, slope_before) >= square(kClearSlope) &&
                                 glm::dot(slope_before, slope) > 0;
    if (const auto flush = before_one_face ? std::nullopt : flush_crossing(i, moved_m)) {
      if (flush->crossed) bar(flush->side, flush->deeper_m);
      continue;
    }
    const float into_m = -glm::dot(moved_m, side);
    // Halfway between two walls the slope turns as well, but the distance falls from there on, and
    // is larger than it can be for a sheet.
    const bool rises = glm::dot(moved_m, slope) > 0;
    // Not that of a wall of the part that stands on the sheet, whose normal lies along it.
    const bool turned = steepness >= kSureSlope && glm::dot(slope, side) < -0.5f * steepness;
    const bool crossed = into_m > kGrazing * glm::length(moved_m) && (forgets || (rises && turned));
    // The distance falls by as much as the point moves up to the middle, and then rises again.
    const float rise_m = later.from_surface_m[i] - earlier.from_surface_m[at];
    const float deeper_m = std::clamp(0.5f * (into_m + rise_m), 0.0f, std::max(into_m, 0.0f));
    if (!crossed || probe_.lies_beside_solid(i, sheet_m)) continue;
    if (walls_.beside(i).is_known()) continue;  // it was not to be asked: it is not crossed
    bar(side, deeper_m);
  }
}

bool SeatRule::bars_any(std::span<const std::uint8_t> left_out) noexcept {
  float highest_m = -std::numeric_limits<float>::infinity();
  for (const SeatObject& object : seat_.objects()) {
    highest_m = std::max({highest_m, object.floor_m, object.corner_floor_m});
  }
  std::optional<bool> in_corners;
  for (std::uint32_t i = 0; i < probe_.count(); ++i) {
    const float distance_m = probe_.stored_distance_m(i);
    if (!(distance_m < highest_m)) continue;  // all but a few
    const std::uint32_t number = probe_.object_of(i);
    const SeatObject* const object = seat_.find(number);
    if (object == nullptr || (number < left_out.size() && left_out[number] != 0)) continue;
    float floor_m = object->floor_m;
    if (corner_points_ > 0 && is_in_corner(i)) {
      if (!in_corners) in_corners = lies_in_corners();
      if (*in_corners) floor_m = object->corner_floor_m;
    }
    if (distance_m < floor_m) return true;
  }
  return between_.bars_any(seat_, left_out);
}

}  // namespace forcelayer::guard
