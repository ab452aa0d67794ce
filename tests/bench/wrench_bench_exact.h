// The exact distance to a static mesh: its closest point, by a tree of boxes.
#pragma once

#include <glm/vec3.hpp>
#include <limits>
#include <random>

#include "formats/mesh/mesh.h"
#include "pointshell/part/triangle_tree.h"

namespace forcelayer::bench {

class ExactDistance {
 public:
  explicit ExactDistance(const mesh::Mesh& mesh);  // m
  ExactDistance(const ExactDistance&) = delete;    // the tree knows the soup

  struct Foot {
    double distance_m;     // infinite where nothing is near enough
    glm::dvec3 direction;  // from the foot
  };
  Foot foot(const glm::dvec3& place,
            double within_m = std::numeric_limits<double>::infinity()) const;

  // Compares the distances of places near random vertices, `spread_m` off, with the distances to
  // all triangles, one by one. Throws std::runtime_error where one differs.
  void check(std::size_t places, double spread_m, std::mt19937_64& random) const;

  const part::Part& soup() const { return soup_; }
  const part::TriangleTree& tree() const { return tree_; }

 private:
  part::Part soup_;
  part::TriangleTree tree_;
};

}  // namespace forcelayer::bench
