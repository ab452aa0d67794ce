// The surface of a part that lies inside another of its bodies, where nothing can touch it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "pointshell/certificate/certificate.h"
#include "pointshell/certificate/winding_number.h"
#include "pointshell/part/part.h"
#include "pointshell/part/triangle_tree.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::certificate {

// The insides of a part's closed bodies. A body whose edges do not all close hides nothing.
class HiddenSurface {
 public:
  // `part` must be consistently oriented (orient_outwards) and outlive this. What is hidden stays
  // so where each place of the surface is off by `slack`, m.
  explicit HiddenSurface(const part::Part& part, double slack = 0);
  HiddenSurface(const HiddenSurface&) = delete;
  HiddenSurface& operator=(const HiddenSurface&) = delete;

  // Whether there are bodies that could hide others.
  bool possible() const { return !solids_.empty(); }

  // Whether the ball is proven to lie inside a single closed body; false where rounding could
  // matter. Surface in such a ball belongs to other bodies, and this body hides it.
  bool holds_ball(const part::Vec3& center, double radius) const;

  // Where the surface of `body` in a ball lies: outside of all other closed bodies, inside one, or
  // partly both, as far as is known. `body` counts as in part::Part::body.
  enum class Side { kOuter, kHidden, kBoth };
  Side side_of(std::uint32_t body, const part::Vec3& center, double radius) const;

  // Whether a place of `box` is at least so deep inside the box around a closed body. Where none
  // is, no ball of this radius about one of them lies inside a body.
  bool may_hold(const part::Box& box, double depth) const;

 private:
  struct Solid {
    Solid(const part::Part& part, std::uint32_t body, std::vector<std::uint32_t> triangles);
    bool winds_around(const part::Vec3& place) const;  // which is not on its surface
    std::uint32_t body;
    part::Box box;
    part::TriangleTree tree;
    WindingNumber winding;
  };
  bool holds_ball(const Solid& solid, const part::Vec3& center, double radius) const;

  std::vector<std::unique_ptr<Solid>> solids_;  // the winding number keeps its tree's address
  part::Part boxes_;                            // of the solids: triangle n has the box of solid n
  std::optional<part::TriangleTree> box_tree_;
  double error_ = 0;  // m, more than any error of a distance
};

// Drops the points that lie deeper than the radius inside another body. Their balls hold no outer
// surface, so the outer surface stays covered. Replaces `proof`, the proof for all points, by one
// for the remaining points; where that proof fails, keeps all points and `proof`. Returns the
// number of points dropped.
std::size_t leave_out_hidden_points(const part::Part& part, const HiddenSurface& hidden,
                                    double radius, std::vector<part::Vec3>& points,
                                    CoveringProof& proof);

}  // namespace forcelayer::certificate
