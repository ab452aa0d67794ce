// The exact distance of a static mesh, and a force field of it: every collected point's closest
// point on the triangles, by a tree of boxes.
#pragma once

#include <glm/vec3.hpp>
#include <limits>
#include <random>
#include <string>

#include "formats/mesh/mesh.h"
#include "pointshell/part/triangle_tree.h"
#include "runtime/field/force_field.h"

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

  // Compares places near random vertices, `spread_m` off, with the distances to all triangles, one
  // by one. Throws std::runtime_error where one differs.
  void check(std::size_t places, double spread_m, std::mt19937_64& random) const;

  const part::Part& soup() const { return soup_; }
  const part::TriangleTree& tree() const { return tree_; }

 private:
  part::Part soup_;
  part::TriangleTree tree_;
};

// Depth below the surface at `offset_m` from the mesh, along the gradient of the distance; or that
// gradient averaged over contacts, as average_directions() does.
class ExactField final : public field::ForceField {
 public:
  // Map and distance must outlive the field.
  ExactField(const Voxmap& voxmap, const ExactDistance& distance, const Pose& world_from_mesh,
             double offset_m, bool averaged = false)
      : voxmap_(voxmap),
        distance_(distance),
        world_from_mesh_(world_from_mesh),
        offset_m_(offset_m),
        averaged_(averaged) {}

  void measure(const query::CollectedPoints& points,
               field::FieldSamples& samples) const noexcept override;
  bool has_exact_slopes() const noexcept override { return !averaged_; }

 private:
  const Voxmap& voxmap_;
  const ExactDistance& distance_;
  Pose world_from_mesh_;
  double offset_m_;
  bool averaged_;
};

}  // namespace forcelayer::bench
