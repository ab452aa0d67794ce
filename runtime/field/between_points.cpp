// Edges of the scene that dig into the part's surface between two shell points.
//
// Where the stored distance falls from both points toward each other along the part's surface,
// something stands between them. Along the surface from point a to point b, at the share t of the
// way, the distances
//   D_a - f_a t   and   D_b - f_b (1 - t)
// are those of the two planes that face the points. They meet at the edge, so the distance there is
//   D = D_a - f_a t,   t = (D_a - D_b + f_b) / (f_a + f_b),   where 0 < t < 1.
// A convex edge between two plane faces has exactly that distance; one that is round lies a little
// deeper in the scene. The slopes that D has with the part's pose are those of the two points with
// the weights f_b and f_a over their sum, and so are its place and its push.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "runtime/field/field_probe.h"

namespace forcelayer::field {
namespace {

// Points with normals nearer than this, as a cosine, lie in one flat face, and those nearer than
// kOneFace in one that bends, unless the way between them lies in the face of one of them: its
// share along that normal is at most kInFace.
constexpr float kSameNormal = 0.9f, kOneFace = 0.74f, kInFace = 0.12f;
// Interpolation makes a distance fall by up to kFlatFall per length where there is nothing, in a
// bore of a few voxels. A fall counts from there on, and in full from kSteepFall on.
constexpr float kFlatFall = 0.2f, kSteepFall = 0.4f;

// By how much the distance falls along a way, as far as that counts.
float counted_fall_m(float fall_m, float way_m) {
  const float share = (fall_m - kFlatFall * way_m) / ((kSteepFall - kFlatFall) * way_m);
  return fall_m * std::clamp(share, 0.0f, 1.0f);
}

}  // namespace

struct FieldProbe::Between {
  float distance_m = 0;
  float weight = 0;  // of the first point; the second has the rest
  std::uint32_t object = 0;
};

// Takes the pairs of collected points a and b with something between them.
struct FieldProbe::BetweenSink {
  virtual void take(std::uint32_t a, std::uint32_t b, const Between& found) = 0;

 protected:
  ~BetweenSink() = default;
};

std::optional<FieldProbe::Between> FieldProbe::between(std::uint32_t a,
                                                       std::uint32_t b) const noexcept {
  const glm::vec3 way_m = arm_m(b) - arm_m(a);
  const float length_m = glm::length(way_m);
  // A slope is hardly above 1: two points that are farther from the scene than apart have nothing
  // in it between them.
  if (stored_distance_m(a) + stored_distance_m(b) > 1.2f * length_m) return std::nullopt;
  glm::vec3 normal_a = normal(a), normal_b = normal(b);
  const float alike = glm::dot(normal_a, normal_b);
  if (alike < kSameNormal) {
    // The normal of a point on a sharp edge is that of no face.
    if (std::abs(glm::dot(way_m, normal_b)) <= kInFace * length_m) {
      normal_a = normal_b;
    } else if (std::abs(glm::dot(way_m, normal_a)) <= kInFace * length_m) {
      normal_b = normal_a;
    } else if (alike < kOneFace) {
      return std::nullopt;
    }
  }
  const auto along = [&](const glm::vec3& n) { return way_m - glm::dot(way_m, n) * n; };
  const float fall_a_m = counted_fall_m(-glm::dot(slope(a), along(normal_a)), length_m);
  const float fall_b_m = counted_fall_m(glm::dot(slope(b), along(normal_b)), length_m);
  if (!(fall_a_m > 0 && fall_b_m > 0)) return std::nullopt;
  const float per_fall = 1 / (fall_a_m + fall_b_m);
  const float t = (stored_distance_m(a) - stored_distance_m(b) + fall_b_m) * per_fall;
  if (!(t > 0 && t < 1)) return std::nullopt;
  const std::uint32_t object = object_of(a);
  if (object_of(b) != object) return std::nullopt;
  return Between{stored_distance_m(a) - fall_a_m * t, fall_b_m * per_fall, object};
}

// Finds the pairs of neighbors near one object with something between them.
void FieldProbe::look_between(BetweenSink& sink) noexcept {
  tilted_.clear();
  for (std::uint32_t i = 0; i < points_.count; ++i) {
    if (!(stored_distance_m(i) < neighbor_m_)) continue;
    const glm::vec3 g = slope(i), n = normal(i);
    const float out = glm::dot(g, n);
    if (!(glm::dot(g, g) - out * out > kFlatFall * kFlatFall)) continue;
    tilted_.push_back(i);
    place_[points_.index[i]] = i;
  }
  for (const std::uint32_t a : tilted_) {
    for (const std::uint32_t point : neighbors_->after(points_.index[a])) {
      const std::uint32_t b = place_[point];
      if (b == ContactSet::kNone) continue;
      if (const std::optional<Between> found = between(a, b)) sink.take(a, b, *found);
    }
  }
  for (const std::uint32_t a : tilted_) place_[points_.index[a]] = ContactSet::kNone;
}

// Whether something between two neighbors lies below its floor. As look_between(), but for points
// from which the distance cannot fall so far: it falls no faster than by the slope.
bool FieldProbe::is_pushed_between(std::span<const std::uint8_t> left_out) noexcept {
  constexpr float kMargin = 1.001f;  // exceeds rounding
  float highest_m = -neighbor_m_;
  for (const SeatObject& object : seat_.objects()) {
    if (object.feels_between) highest_m = std::max(highest_m, object.between_floor_m);
  }
  tilted_.clear();
  for (std::uint32_t i = 0; i < points_.count; ++i) {
    const float distance_m = stored_distance_m(i);
    if (!(distance_m < neighbor_m_)) continue;
    const glm::vec3 g = slope(i);
    const float squared = glm::dot(g, g), out = glm::dot(g, normal(i));
    if (!(squared - out * out > kFlatFall * kFlatFall)) continue;
    if (distance_m - kMargin * std::sqrt(squared) * neighbor_m_ > highest_m) continue;
    tilted_.push_back(i);
    place_[points_.index[i]] = i;
  }
  bool pushed = false;
  for (const std::uint32_t a : tilted_) {
    for (const std::uint32_t point : neighbors_->after(points_.index[a])) {
      const std::uint32_t b = place_[point];
      if (b == ContactSet::kNone) continue;
      const std::optional<Between> found = between(a, b);
      if (!found || !(found->distance_m < highest_m)) continue;
      const SeatObject* const object = seat_.find(found->object);
      if (object == nullptr || !object->feels_between) continue;
      if (found->object < left_out.size() && left_out[found->object] != 0) continue;
      pushed = pushed || found->distance_m < object->between_floor_m;
    }
  }
  for (const std::uint32_t a : tilted_) place_[points_.index[a]] = ContactSet::kNone;
  return pushed;
}

[[gnu::cold]] void FieldProbe::find_between(Seat& seat) {
  if (!neighbors_) {
    const PshellView& shell = query_.shell().view();
    neighbor_m_ = static_cast<float>(2 * query_.shell().header().covering_radius_m);
    neighbors_.emplace(shell, double{neighbor_m_});
    place_.assign(shell.point_count, ContactSet::kNone);
    tilted_.reserve(shell.point_count);
  }
  struct InSeat final : BetweenSink {
    explicit InSeat(Seat& objects) : seat(objects) {}
    void take(std::uint32_t, std::uint32_t, const Between& found) override {
      for (SeatObject& object : seat.entries()) {
        if (object.object == found.object) {
          object.between_m = std::min(object.between_m, found.distance_m);
        }
      }
    }
    Seat& seat;
  } sink(seat);
  look_between(sink);
}

void FieldProbe::apply_between(ContactSet& out) noexcept {
  struct Contacts final : BetweenSink {
    Contacts(const FieldProbe& of, ContactSet& set) : probe(of), contacts(set) {}
    void take(std::uint32_t a, std::uint32_t b, const Between& found) override {
      probe.press_between(a, b, found, contacts);
    }
    const FieldProbe& probe;
    ContactSet& contacts;
  } sink(*this, out);
  look_between(sink);
}

// An edge between two points presses both, where it is deeper than they are.
void FieldProbe::press_between(std::uint32_t a, std::uint32_t b, const Between& found,
                               ContactSet& out) const noexcept {
  const SeatObject* const object = seat_.find(found.object);
  if (object == nullptr || !object->feels_between) return;
  const float depth_m = object->between_m - found.distance_m;
  const glm::vec3 push = glm::mix(slope(b), slope(a), found.weight);
  const float length = glm::length(push);
  if (!(depth_m > 0 && length >= kLeastSlope)) return;
  const glm::vec3 u = push / length, arm = glm::mix(arm_m(b), arm_m(a), found.weight);
  const bool barred = found.distance_m < object->between_floor_m;
  for (const std::uint32_t i : {a, b}) {
    if (barred && out.is_barred[i] == 0) out.is_barred[i] = 1, ++out.barred;
    if (depth_m <= out.depth_m[i]) continue;
    out.depth_m[i] = depth_m;
    out.ux[i] = u.x, out.uy[i] = u.y, out.uz[i] = u.z;
    out.rx[i] = arm.x, out.ry[i] = arm.y, out.rz[i] = arm.z;
  }
}

}  // namespace forcelayer::field
