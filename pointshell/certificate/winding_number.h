// Generalized winding numbers of triangle soups (Jacobson, Kavan, Sorkine-Hornung 2013): 1 inside a
// closed mesh that faces outwards, 0 outside, graded near holes. Far groups of triangles act as one
// dipole each (Barill, Dickson, Schmidt, Levin, Jacobson 2018).
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "pointshell/part/triangle_tree.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::certificate {

class WindingNumber {
 public:
  // `tree` and its part must outlive this; the part's orientation must not change meanwhile.
  explicit WindingNumber(const part::TriangleTree& tree);

  // The winding number at `place`, with an error below about 0.01; with a smaller `far`, from how
  // many of its radii on a group is a dipole, sooner and less closely. On the surface it is the
  // mean of the two sides, because a triangle seen edge-on counts as zero.
  double at(const part::Vec3& place, double far = kFar) const;

 private:
  static constexpr double kFar = 5;
  struct Dipole {
    part::Vec3 center;  // of area
    part::Vec3 moment;  // sum of area times normal
    double radius = 0;  // of the node's box about `center`
  };

  void fill(std::uint32_t node);
  double at_leaf(const part::TriangleTree::Node& node, const part::Vec3& place) const;

  const part::TriangleTree& tree_;
  std::vector<Dipole> dipoles_;  // [nodes of the tree]
  std::vector<double> areas_;    // [nodes of the tree]
};

// The winding number of one triangle at `place`: its signed solid angle over 4 pi (van Oosterom and
// Strackee 1983); 0 in the triangle's plane.
double triangle_winding(const part::Vec3& place, const part::Vec3& a, const part::Vec3& b,
                        const part::Vec3& c);

}  // namespace forcelayer::certificate
