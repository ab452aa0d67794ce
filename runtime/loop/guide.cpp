#include "runtime/loop/guide.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "runtime/coupling/passivity.h"
#include "runtime/model/vectors.h"

namespace forcelayer::loop {
namespace {

constexpr std::size_t kNeighbors = 16;  // places: no hand is faster than 8 mm a frame
constexpr double kFadesAt = 0.5;        // of force_n reach_m that is left of the budget

double turn_rad(const glm::dquat& a, const glm::dquat& b) {
  return 2 * std::acos(std::min(1.0, std::abs(glm::dot(a, b))));
}

// The energy of a spring with the stiffness 1 that is clamped to `largest` at its stretch `x`.
double clamped_energy(double x, double largest) {
  return x < largest ? x * x / 2 : largest * (x - largest / 2);
}

// `pull` without its part against `contact`, in so far as that is felt: all of it from `full` on.
glm::dvec3 behind(const glm::dvec3& contact, const glm::dvec3& pull, double full) {
  const double felt = glm::length(contact);
  if (!(felt > 0)) return pull;
  const glm::dvec3 direction = contact / felt;
  const double against = std::max(0.0, -glm::dot(pull, direction));
  return pull + direction * (against * std::min(1.0, felt / full));
}

}  // namespace

GuidePath::GuidePath(std::span<const Pose> poses, const GuideLimits& limits, double motion_scale)
    : scale_(motion_scale), lever_m_(limits.torque_nm / limits.force_n) {
  std::vector<double> at_m{0};
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Pose &a = poses[i - 1], &b = poses[i];
    at_m.push_back(at_m.back() + std::hypot(glm::distance(a.position_m, b.position_m) / scale_,
                                            lever_m_ * turn_rad(a.orientation, b.orientation)));
  }
  const double steps = std::clamp(std::ceil(at_m.back() / kStepM), 1.0, kMaxPlaces - 1.0);
  step_m_ = at_m.back() / steps;
  std::size_t row = 0;
  glm::dquat last = poses.front().orientation;
  for (double n = 0; n <= steps; ++n) {
    const double s_m = std::min(n * step_m_, at_m.back());
    while (row + 2 < at_m.size() && at_m[row + 1] < s_m) ++row;
    const Pose &a = poses[row], &b = poses[std::min(row + 1, poses.size() - 1)];
    const double all_m = row + 1 < at_m.size() ? at_m[row + 1] - at_m[row] : 0;
    const double fraction = all_m > 0 ? std::clamp((s_m - at_m[row]) / all_m, 0.0, 1.0) : 0;
    glm::dquat q = glm::slerp(a.orientation, b.orientation, fraction);
    if (glm::dot(q, last) < 0) q = -q;
    places_.push_back(place_of({glm::mix(a.position_m, b.position_m, fraction), q}));
    last = q;
  }
}

GuidePath::Place GuidePath::place_of(const Pose& pose) const noexcept {
  const glm::dvec3 p = pose.position_m / scale_;
  const glm::dquat q = pose.orientation * (2 * lever_m_);
  return {p.x, p.y, p.z, q.w, q.x, q.y, q.z};
}

Pose GuidePath::at(double s_m) const noexcept {
  const double steps = static_cast<double>(places_.size() - 1);
  const double n = step_m_ > 0 ? std::clamp(s_m / step_m_, 0.0, steps) : 0;
  const auto i = static_cast<std::size_t>(std::min(n, steps - 1));
  Place p;
  for (std::size_t k = 0; k < p.size(); ++k) {
    p[k] = std::lerp(places_[i][k], places_[i + 1][k], n - static_cast<double>(i));
  }
  return {glm::dvec3(p[0], p[1], p[2]) * scale_,
          glm::normalize(glm::dquat(p[3], p[4], p[5], p[6]))};
}

// Searches the straight pieces that begin at the places from `first` to before `last`.
double GuidePath::nearest(const Pose& pose, std::size_t first, std::size_t last) const noexcept {
  const Place point = place_of(pose);
  double smallest = INFINITY, found_m = 0;
  for (std::size_t i = first; i < last; ++i) {
    const Place &a = places_[i], &b = places_[i + 1];
    double turns = 0;  // of a quaternion either sign is the same orientation
    for (std::size_t k = 3; k < 7; ++k) turns += a[k] * point[k];
    double along = 0, length2 = 0, distance2 = 0;
    for (std::size_t k = 0; k < 7; ++k) {
      const double to = (k >= 3 && turns < 0 ? -point[k] : point[k]) - a[k];
      along += (b[k] - a[k]) * to;
      length2 += (b[k] - a[k]) * (b[k] - a[k]);
      distance2 += to * to;
    }
    const double fraction = length2 > 0 ? std::clamp(along / length2, 0.0, 1.0) : 0;
    distance2 += fraction * (fraction * length2 - 2 * along);
    if (distance2 >= smallest) continue;
    smallest = distance2;
    found_m = (static_cast<double>(i) + fraction) * step_m_;
  }
  return found_m;
}

double GuidePath::nearest(const Pose& world_from_center) const noexcept {
  return nearest(world_from_center, 0, places_.size() - 1);
}

double GuidePath::nearest(const Pose& world_from_center, double from_m,
                          double to_m) const noexcept {
  const auto place = [&](double s_m) {
    return static_cast<std::size_t>(step_m_ > 0 ? s_m / step_m_ : 0);
  };
  const std::size_t first = place(from_m), last = place(to_m);
  return nearest(world_from_center, first - std::min(first, kNeighbors),
                 std::min(last + kNeighbors + 1, places_.size() - 1));
}

// Where the handle would be with the part at the anchor.
Pose Guide::wanted_handle(const GuideFrame& frame) const noexcept {
  return path_.at(anchor_m_) * inverse(frame.handle_from_center);
}

Wrench Guide::spring(const GuideFrame& frame) const noexcept {
  const Pose wanted = wanted_handle(frame);
  const double k = limits_.force_n / limits_.reach_m;
  const double lever_m = limits_.torque_nm / limits_.force_n;
  const glm::dvec3 gap_m = (wanted.position_m - frame.world_from_handle.position_m) / scale_;
  const glm::dquat turn = wanted.orientation * glm::conjugate(frame.world_from_handle.orientation);
  const glm::dvec3 sine = 2 * turn.w * glm::dvec3(turn.x, turn.y, turn.z);
  return {model::clamped(k * gap_m, limits_.force_n),
          model::clamped(k * lever_m * lever_m * sine, limits_.torque_nm)};
}

// At least the energy of that spring.
double Guide::stretch_j(const GuideFrame& frame) const noexcept {
  const Pose wanted = wanted_handle(frame);
  const double k = limits_.force_n / limits_.reach_m;
  const double lever_m = limits_.torque_nm / limits_.force_n;
  const double gap_m =
      glm::distance(wanted.position_m, frame.world_from_handle.position_m) / scale_;
  const double turn_m = lever_m * turn_rad(wanted.orientation, frame.world_from_handle.orientation);
  return k * (clamped_energy(gap_m, limits_.reach_m) + clamped_energy(turn_m, limits_.reach_m));
}

void Guide::engage(const GuideFrame& frame) noexcept {
  past_j_ += peak_j_;
  past_allowed_j_ += allowed_j_;
  sum_j_ = peak_j_ = 0;
  s_m_ = anchor_m_ = engaged_m_ = farthest_m_ =
      path_.nearest(frame.world_from_handle * frame.handle_from_center);
  begin_j_ = stretch_j(frame);
}

Wrench Guide::pull(const GuideFrame& frame, double dt_s) noexcept {
  const Wrench in_scene{left_.force_n / scale_, left_.torque_nm};
  work_j_ = frame.placed ? coupling::held_work_j(in_scene, handle_, frame.world_from_handle) : 0;
  sum_j_ += work_j_;
  peak_j_ = std::max(peak_j_, sum_j_);
  pulled_ = {};
  if (frame.placed) handle_ = frame.world_from_handle;
  if (!frame.sound || !frame.placed) {
    strength_ = 0;
    return {};
  }
  if (strength_ == 0) {
    if (!frame.wanted) return {};
    engage(frame);
  }
  strength_ = frame.wanted ? std::min(1.0, strength_ + dt_s / limits_.ramp_s)
                           : std::max(0.0, strength_ - dt_s / limits_.fade_s);
  s_m_ = path_.nearest(frame.world_from_handle * frame.handle_from_center, s_m_, anchor_m_);
  anchor_m_ = std::clamp(anchor_m_ + limits_.speed_mps * dt_s, s_m_,
                         std::min(s_m_ + limits_.reach_m, path_.length_m()));
  farthest_m_ = std::max(farthest_m_, s_m_);
  allowed_j_ = begin_j_ + limits_.force_n * (limits_.reach_m + farthest_m_ - engaged_m_);
  const double left = (allowed_j_ - sum_j_) / (kFadesAt * limits_.force_n * limits_.reach_m);
  const double fraction = strength_ * std::clamp(left, 0.0, 1.0);
  const Wrench whole = spring(frame);
  const Wrench& contact = frame.contact;
  pulled_.force_n = behind(contact.force_n, whole.force_n * fraction, limits_.force_n);
  pulled_.torque_nm = behind(contact.torque_nm, whole.torque_nm * fraction, limits_.torque_nm);
  pulled_.force_n = model::clamped(pulled_.force_n,
                                   std::max(0.0, frame.max_force_n - glm::length(contact.force_n)));
  pulled_.torque_nm = model::clamped(
      pulled_.torque_nm, std::max(0.0, frame.max_torque_nm - glm::length(contact.torque_nm)));
  return pulled_;
}

void Guide::leave(double gain) noexcept {
  left_ = {pulled_.force_n * gain, pulled_.torque_nm * gain};
}

}  // namespace forcelayer::loop
