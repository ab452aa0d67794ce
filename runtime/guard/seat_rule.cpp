#include "runtime/guard/seat_rule.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

namespace forcelayer::guard {
namespace {

// Cosine between gradient and slope of the field, from which on both face the same side: they
// differ by some degrees before a face and up to 30 at an edge, and by up to 180 beside a sheet.
constexpr float kSameSide = 0.7f;
// Within a cell through which a thin wall leads, the slope is short, and of one direction on both
// sides. One that is at least this steep tells a point's side.
constexpr float kSureSlope = 0.5f;
// A motion that goes against a point's side by less than this fraction goes along the wall.
constexpr float kGrazing = 0.01f;
// Distances that rise at least this steeply from both sides of a position are those of one wall
// between them, flush to the line: neither of two walls nor of a corner.
constexpr float kFlushWall = 0.9f;
constexpr float kBeyondVoxels = 0.75f;  // from the first position on a side to the second
// A point is beyond the middle of a wall from there on: more than the rounding of two codes.
constexpr float kBeyondMiddleVoxels = 0.05f;

// A cell whose slope is this steep along a normal lies before the wall, but for a corner of this
// height.
constexpr float kClearSlope = 0.9f, kMaxUnseenVoxels = 0.1f;
// A point deeper than this is barred whichever side it is on (the floor of find_seat.cpp).
constexpr float kMaxDepthVoxels = 0.35f;
// So far into a solid that is thicker than a thin wall the stored distances are deep.
constexpr float kInsideVoxels = 1.75f;

constexpr float square(float x) { return x * x; }

// Voxels that a cell of eight centers extends along a direction: so far away from a plane through
// the position, a cell has all its centers on one side of the plane.
float cell_extent(const glm::vec3& direction) {
  return std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z);
}

}  // namespace

SeatRule::SeatRule(field::FieldProbe& probe, const PointRule& rule)
    : probe_(probe),
      rule_(rule),
      between_(probe),
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
  std::uint32_t in_corner = 0;
  for (std::uint32_t i = 0; i < probe_.count(); ++i) in_corner += is_in_corner(i) ? 1 : 0;
  return 8 * in_corner > corner_points_;
}

void SeatRule::apply(field::ContactSet& out) noexcept {
  for (std::uint32_t i = 0; i < out.count; ++i) {
    out.ax[i] = out.rx[i], out.ay[i] = out.ry[i], out.az[i] = out.rz[i];
  }
  const bool in_corners = corner_points_ > 0 && lies_in_corners();
  for (std::uint32_t i = 0; i < out.count; ++i) {
    const SeatObject* const object = seat_.find(probe_.object_of(i));
    out.of_seat[i] = object != nullptr ? 1 : 0;
    if (object == nullptr) continue;
    const glm::vec3 g = probe_.slope(i), n = probe_.normal(i);
    const float steepness = glm::length(g), distance_m = probe_.stored_distance_m(i);
    const std::uint32_t point = probe_.point(i);
    const bool barred =
        distance_m < (in_corners && is_in_corner(i) ? object->corner_floor_m : object->floor_m);
    if (out.is_barred[i] != 0 || out.depth_m[i] > 0) ++out.seated;
    const bool interior =
        rule_.goes_by_value() ? field::is_interior(out.value[i]) : out.is_barred[i] != 0;
    if (interior && !barred) --out.interior, ++out.surface;
    if (out.is_barred[i] != 0) --out.barred;
    if (barred) ++out.barred;
    out.is_barred[i] = barred ? 1 : 0;
    const glm::vec3 direction = steepness < field::kMinSlope ? n : g / steepness;
    // Along the gradient, where it has the same side, the push is that of a potential: a closed
    // path gives nothing. The slope is some degrees aside of it.
    const glm::vec3 e = probe_.gradient(i);
    const float fall = glm::length(e);
    const glm::vec3 push = glm::dot(e, direction) > kSameSide * fall ? e / fall : direction;
    out.ux[i] = push.x, out.uy[i] = push.y, out.uz[i] = push.z;
    float contact_m = std::min(object->contact_m, in_seat_m_[point]);
    if (const float there = in_seat_steepness_[point]; there < 1) {
      // In the seat itself as deep as there, before a face as other points.
      const float fraction = in_corners ? (1 - steepness) / (1 - there) : 0;
      contact_m = std::lerp(object->contact_m, contact_m, std::clamp(fraction, 0.0f, 1.0f));
    }
    out.depth_m[i] = contact_m - distance_m;
    if (direction == glm::vec3(0)) out.depth_m[i] = std::min(out.depth_m[i], 0.0f);
    // Short slopes are of positions near the middle of a sheet, where they have no side. A point
    // that touches it has the part, and so its inward normal, on its own side. One without an
    // inside has no side there.
    const float sure = n == glm::vec3(0) ? field::kSideSlope : kSureSlope;
    const glm::vec3 side = steepness < sure ? n : direction;
    out.sx[i] = side.x, out.sy[i] = side.y, out.sz[i] = side.z;
    out.gx[i] = g.x, out.gy[i] = g.y, out.gz[i] = g.z;
    out.from_surface_m[i] = distance_m;
  }
  if (out.seated > 0) {
    out.min_distance_m = 0;
    out.nearest = field::ContactSet::kNone;
  }
  between_.press(seat_, out);
}

// The height of a point, moved by an offset, over the middle of a thin wall that faces it: along
// its inward normal, so negative where the part has gone through. Two cells, one on each side, tell
// it whatever the interpolation says at the point itself. Means nothing where rise_beside() is
// small.
float SeatRule::height_over_wall_m(std::uint32_t i, const glm::vec3& offset_voxels) const noexcept {
  const glm::vec3 n = probe_.normal(i), aside = cell_extent(n) * n;
  return 0.5f * (probe_.stored_distance_m(i, offset_voxels + aside) -
                 probe_.stored_distance_m(i, offset_voxels - aside));
}

// How steeply the distance rises along a point's normal away from it, on the side where it rises
// less: 1 where nothing but a wall across the normal is near, and less beside a corner or another
// wall.
float SeatRule::rise_beside(std::uint32_t i) const noexcept {
  const glm::vec3 n = probe_.normal(i), first = cell_extent(n) * n,
                  second = first + kBeyondVoxels * n;
  const auto rise_m = [&](float side) {
    return probe_.stored_distance_m(i, side * second) - probe_.stored_distance_m(i, side * first);
  };
  return std::min(rise_m(1), rise_m(-1)) /
         (kBeyondVoxels * static_cast<float>(probe_.voxmap().voxel_size_m()));
}

// Whether the i-th point may be one of a face before a wall, or behind it. Where the slope is that
// of a cell before the wall, it is at most kMaxUnseenVoxels behind.
bool SeatRule::may_face_wall(std::uint32_t i) const noexcept {
  return glm::dot(probe_.slope(i), probe_.normal(i)) < kClearSlope;
}

// Whether the i-th point, which has moved, has gone from before the middle of a thin wall that
// faces it to behind it. None where nothing tells: the wall does not face it, or others are near.
std::optional<SeatRule::WallCrossing> SeatRule::wall_crossing(std::uint32_t i,
                                                              const glm::vec3& moved_m,
                                                              bool seems_crossed) const noexcept {
  const auto voxel_size_m = static_cast<float>(probe_.voxmap().voxel_size_m());
  const float beyond_m = kBeyondMiddleVoxels * voxel_size_m;
  const glm::vec3 n = probe_.normal(i);
  if (n == glm::vec3(0)) return std::nullopt;
  if (!seems_crossed) {
    // It goes the other way.
    if (!(glm::dot(moved_m, n) < 0)) return std::nullopt;
    // It is farther from the wall than it has moved, or a solid faces it.
    const float proven_m = probe_.samples().distance_m[i];
    if (proven_m - beyond_m > 0 && glm::dot(moved_m, moved_m) < square(proven_m - beyond_m)) {
      return std::nullopt;
    }
    if (probe_.stored_center_distance_m(i, -kInsideVoxels * n) < -half_sheet_m()) {
      return std::nullopt;
    }
    // Behind a flush wall, and not so deep in it that the floor bars the point, the distance has
    // risen by so much on the far side.
    const float extent = cell_extent(n);
    if (probe_.stored_distance_m(i, -extent * n) <
        (kFlushWall * extent - kMaxDepthVoxels) * voxel_size_m) {
      return std::nullopt;
    }
  }
  const float height_m = height_over_wall_m(i, {});
  const bool is_behind = height_m < -beyond_m;
  if (!seems_crossed && !is_behind) return std::nullopt;
  if (!(rise_beside(i) >= kFlushWall)) return std::nullopt;
  const bool was_behind =
      height_over_wall_m(i, -moved_m / voxel_size_m) < -beyond_m - kMaxUnseenVoxels * voxel_size_m;
  return WallCrossing{is_behind && !was_behind, -height_m - beyond_m};
}

void SeatRule::mark_crossings(const field::ContactSet& earlier, const glm::vec3& shift_m,
                              field::ContactSet& later) const noexcept {
  if (!earlier.seat_open || !later.seat_open) return;
  const float sheet_m = half_sheet_m();
  std::uint32_t at = 0;
  for (std::uint32_t i = 0; i < later.count; ++i) {
    if (later.of_seat[i] == 0) continue;
    while (at < earlier.count && earlier.point[at] < later.point[i]) ++at;
    if (at == earlier.count) return;
    if (earlier.point[at] != later.point[i] || earlier.of_seat[at] == 0) continue;
    if (!(probe_.stored_distance_m(i) < sheet_m)) continue;
    const glm::vec3 slope(later.gx[i], later.gy[i], later.gz[i]);
    glm::vec3 side(earlier.sx[at], earlier.sy[at], earlier.sz[at]);
    const bool faces = may_face_wall(i);
    // A point without an inside would forget its side in the middle of a sheet: it may not go
    // there.
    const bool forgets =
        probe_.is_two_sided(i) && later.sx[i] == 0 && later.sy[i] == 0 && later.sz[i] == 0;
    if (!(glm::dot(slope, side) < 0 || faces || forgets)) continue;
    const glm::vec3 moved_m =
        shift_m + glm::vec3(later.ax[i] - earlier.ax[at], later.ay[i] - earlier.ay[at],
                            later.az[i] - earlier.az[at]);
    const float into_m = -glm::dot(moved_m, side);
    // Halfway between two walls the slope turns as well, but the distance falls from there on, and
    // is larger than it can be for a sheet.
    const bool rises = glm::dot(moved_m, slope) > 0;
    // Not that of a wall of the part that stands on the sheet, whose normal lies along it.
    const float steepness = glm::length(slope);
    const bool turned = steepness >= kSureSlope && glm::dot(slope, side) < -0.5f * steepness;
    bool crossed = into_m > kGrazing * glm::length(moved_m) && (forgets || (rises && turned));
    // The distance falls by as much as the point moves up to the middle, and then rises again.
    const float rise_m = later.from_surface_m[i] - earlier.from_surface_m[at];
    float deeper_m = std::clamp(0.5f * (into_m + rise_m), 0.0f, std::max(into_m, 0.0f));
    if (!crossed && !faces) continue;
    if (const auto wall = wall_crossing(i, moved_m, crossed)) {
      crossed = wall->crossed;
      if (crossed) side = probe_.normal(i), deeper_m = wall->deeper_m;
    }
    if (!crossed || probe_.lies_beside_solid(i, sheet_m)) continue;
    if (later.is_barred[i] == 0) ++later.barred;
    later.is_barred[i] = field::ContactSet::kCrossed;
    later.ux[i] = side.x, later.uy[i] = side.y, later.uz[i] = side.z;
    later.depth_m[i] = deeper_m;
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
