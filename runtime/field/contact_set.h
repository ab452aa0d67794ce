// The contacts of one pose, as the default model sees them: the collected points with their signed
// depth and direction of push.
#pragma once

#include <cstdint>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/voxmap.h"

namespace forcelayer::field {

constexpr bool is_interior(std::uint8_t value) {
  return value == static_cast<std::uint8_t>(VoxelValue::kInterior);
}

// One shell point in or near the force layer. Vectors in world axes.
struct Contact {
  glm::vec3 arm_m{0};       // from the part's centroid
  glm::vec3 direction{0};   // unit, out of the static scene: the push on the part
  float depth_m = 0;        // into the force layer; negative: a gap
  float weight = 1;         // area that the point stands for, over the shell's mean
  std::uint32_t point = 0;  // of the shell; ascending in a set
  bool barred = false;      // the guard keeps points out of where this one is
};

// The contacts of a pose in columns. A column has room for every shell point and kPadding more; the
// first `count` elements are the contacts, and the rest may hold anything.
struct ContactSet {
  static constexpr std::size_t kPadding = 64;

  std::uint32_t count = 0;
  // Points by value. In a map with a standoff: barred points, points of value 3 that are not, and
  // all others.
  std::uint32_t interior = 0;   // points in value 1
  std::uint32_t surface = 0;    // points in value 2
  std::uint32_t proximity = 0;  // points in value 3
  bool outside_map = false;     // a point lay beyond a cropped side
  std::uint32_t barred = 0;     // points that the guard keeps out of where they are: in value 1
                                // (without a standoff), or with a proven distance below the guard's
  // No shell point is nearer to the static mesh, m: the least proven distance, and at most that of
  // a point in a free voxel. 0 where nothing is proven.
  float min_distance_m = 0;
  std::uint32_t nearest =
      kNone;  // its place in the set; kNone where all are farther, or none known
  static constexpr std::uint32_t kNone = UINT32_MAX;
  // Points that are nearer to an object of the open seat than force and guard allow elsewhere. They
  // count as interior only where they are barred, too.
  std::uint32_t seated = 0;
  bool seat_open = false;

  std::vector<float> rx, ry, rz;  // arm_m
  std::vector<float> ux, uy, uz;  // direction
  std::vector<float> depth_m, weight;
  std::vector<std::uint32_t> point;
  std::vector<std::uint8_t> value;      // VoxelValue: 1, 2 or 3
  std::vector<std::uint8_t> is_barred;  // 0: not; kCrossed: it went through a surface, and depth_m
                                        // is about how far it went beyond the middle
  static constexpr std::uint8_t kCrossed = 2;
  // Only while the seat is open: whether the nearest object is of the seat; the arm of the shell
  // point itself, where arm_m is that of a position beside it; the field's slope, per voxel; the
  // unit direction away from the surface, to the side on which the point is; its interpolated
  // distance from the surface.
  std::vector<std::uint8_t> of_seat;
  std::vector<float> ax, ay, az;
  std::vector<float> gx, gy, gz;
  std::vector<float> sx, sy, sz;
  std::vector<float> from_surface_m;

  void reserve(std::uint64_t points);  // set-up only
  Contact operator[](std::uint32_t i) const noexcept {
    return {{rx[i], ry[i], rz[i]}, {ux[i], uy[i], uz[i]}, depth_m[i], weight[i], point[i],
            is_barred[i] != 0};
  }
  bool in_free_space() const noexcept { return interior + surface + proximity == 0; }
};

// Finds the contacts of a pose for the default model, and which of them the guard bars
// (runtime/guard/pose_guard.h).
class ContactProbe {
 public:
  virtual ~ContactProbe() = default;

  // Every point in values 1, 2 and 3 at this pose. Never allocates, locks or throws.
  virtual void query_pose(const Pose& world_from_center, ContactSet& out) noexcept = 0;

  // Whether the rules of the seat hold from now on. Without one: never.
  virtual void open_seat(bool) noexcept {}

  // Bars the points of the seat in `later`, the set of the last query_pose(), that have gone
  // through a surface since `earlier`. The centroid has moved by `shift_m`.
  virtual void mark_crossings(const ContactSet& /*earlier*/, const glm::vec3& /*shift_m*/,
                              ContactSet& /*later*/) const noexcept {}

  // The number of the object nearest to a position, world; 0 where none is known.
  virtual std::uint32_t object_near(const glm::dvec3& /*world_m*/) const noexcept { return 0; }
};

}  // namespace forcelayer::field
