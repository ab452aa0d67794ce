// Distance of a place from the triangles of a mesh, exact but for rounding.
#pragma once

#include <glm/vec3.hpp>
#include <memory>

#include "formats/mesh/mesh.h"

namespace forcelayer::stress {

class PointDistance {
 public:
  // Throws std::runtime_error where no triangle has an area.
  explicit PointDistance(const mesh::Mesh& mesh);
  ~PointDistance();
  PointDistance(PointDistance&&) noexcept;

  // In the mesh's frame and unit.
  double at(const glm::dvec3& place) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace forcelayer::stress
