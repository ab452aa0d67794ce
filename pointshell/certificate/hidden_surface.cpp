#include "pointshell/certificate/hidden_surface.h"

#include <cmath>
#include <utility>

#include "pointshell/certificate/ray_winding.h"
#include "pointshell/part/mass_properties.h"
#include "pointshell/part/parallel.h"

namespace forcelayer::certificate {
namespace {

// In radii. Only points this deep are dropped: all that such a point alone covers is then proven
// hidden in pieces of a quarter of the radius.
constexpr double kDroppedDepth = 1.25;
// The winding number is a whole number off the surface, and in error by less than 0.01.
constexpr double kInside = 0.5;

// Whether a place of `box` is at least so deep inside `other`.
bool reaches_into(const part::Box& box, double depth, const part::Box& other) {
  for (int axis = 0; axis < 3; ++axis) {
    const double low = part::coordinate(other.low, axis) + depth;
    const double high = part::coordinate(other.high, axis) - depth;
    if (!(std::max(part::coordinate(box.low, axis), low) <=
          std::min(part::coordinate(box.high, axis), high))) {
      return false;
    }
  }
  return true;
}

bool is_closed_body(const part::Part& part, const std::vector<std::uint32_t>& triangles) {
  std::vector<mesh::Triangle> corners;
  for (const std::uint32_t t : triangles) corners.push_back(part.triangles[t]);
  return part::is_closed(corners);
}

}  // namespace

HiddenSurface::Solid::Solid(const part::Part& part, std::uint32_t number,
                            std::vector<std::uint32_t> triangles)
    : body(number),
      box(part::box_of(part, triangles)),
      tree(part, std::move(triangles)),
      winding(tree) {}

// A ray takes some dozens of boxes where the winding number takes thousands, and decides almost
// always.
bool HiddenSurface::Solid::winds_around(const part::Vec3& place) const {
  if (const std::optional<int> windings = windings_by_ray(tree, place)) return *windings != 0;
  return std::abs(winding.at(place)) > kInside;
}

HiddenSurface::HiddenSurface(const part::Part& part, double slack)
    : error_(std::ldexp(part.largest_coordinate, -40) + 2 * slack) {
  if (part.body_names.size() < 2) return;
  auto of_body = part::triangles_by_body(part);
  for (std::uint32_t body = 0; body < of_body.size(); ++body) {
    std::vector<std::uint32_t>& triangles = of_body[body];
    if (triangles.empty() || !is_closed_body(part, triangles)) continue;
    solids_.push_back(std::make_unique<Solid>(part, body, std::move(triangles)));
    const part::TriangleTree::Node& box = solids_.back()->tree.nodes()[0];
    const auto corner = static_cast<std::uint32_t>(boxes_.vertices.size());
    boxes_.vertices.push_back({box.low[0], box.low[1], box.low[2]});
    boxes_.vertices.push_back({box.high[0], box.high[1], box.high[2]});
    boxes_.triangles.push_back({corner, corner + 1, corner});
  }
  if (possible()) box_tree_.emplace(boxes_);
}

bool HiddenSurface::holds_ball(const part::Vec3& center, double radius) const {
  bool held = false;
  if (!possible()) return held;
  box_tree_->visit_near(
      center, 0, [&](std::uint32_t n) { held = held || holds_ball(*solids_[n], center, radius); });
  return held;
}

HiddenSurface::Side HiddenSurface::side_of(std::uint32_t body, const part::Vec3& center,
                                           double radius) const {
  Side side = Side::kOuter;
  if (!possible()) return side;
  box_tree_->visit_near(center, radius + error_, [&](std::uint32_t n) {
    const Solid& solid = *solids_[n];
    if (solid.body == body || side == Side::kHidden) return;
    if (solid.tree.is_within(center, radius + error_)) {
      side = Side::kBoth;
    } else if (reaches_into({center, center}, 0, solid.box) && solid.winds_around(center)) {
      side = Side::kHidden;
    }
  });
  return side;
}

bool HiddenSurface::may_hold(const part::Box& box, double depth) const {
  bool may = false;
  if (!possible()) return may;
  const part::Vec3 size = box.high - box.low;
  box_tree_->visit_near_box(
      0.5 * (box.low + box.high), part::max_abs(size) / 2 * (1 + 0x1p-20),
      [&](std::uint32_t n) { may = may || reaches_into(box, depth, solids_[n]->box); });
  return may;
}

bool HiddenSurface::holds_ball(const Solid& solid, const part::Vec3& center, double radius) const {
  return reaches_into({center, center}, radius + error_, solid.box) &&
         !solid.tree.is_within(center, radius + error_) && solid.winds_around(center);
}

std::size_t leave_out_hidden_points(const part::Part& part, const HiddenSurface& hidden,
                                    double radius, std::vector<part::Vec3>& points,
                                    CoveringProof& proof) {
  std::vector<char> drop(points.size());
  part::parallel_for_each_index(points.size(), 256, [&](std::size_t n) {
    drop[n] = hidden.holds_ball(points[n], kDroppedDepth * radius);
  });
  std::vector<part::Vec3> kept;
  for (std::size_t n = 0; n < points.size(); ++n) {
    if (!drop[n]) kept.push_back(points[n]);
  }
  if (kept.size() == points.size()) return 0;
  CoveringProof outer = prove_covering(part, kept, radius);
  if (!outer.proven) outer = continue_proof(part, kept, radius, outer, &hidden);
  if (!outer.proven) return 0;
  proof = std::move(outer);
  const std::size_t dropped = points.size() - kept.size();
  points = std::move(kept);
  return dropped;
}

}  // namespace forcelayer::certificate
