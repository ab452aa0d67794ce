#include "tests/stress/point_distance.h"

#include <cmath>
#include <stdexcept>

#include "pointshell/part/triangle_tree.h"

namespace forcelayer::stress {
namespace {

part::Part soup_of(const mesh::Mesh& mesh) {
  mesh::Assembly assembly;
  assembly.meshes = {mesh};
  assembly.instances = {{0, "mesh", {}}};
  const part::PartInput input{&assembly, 1};
  auto soup = part::assemble_part({&input, 1});
  if (!soup) throw std::runtime_error(to_line(soup.error()));
  return std::move(*soup);
}

}  // namespace

struct PointDistance::Tree {
  explicit Tree(const mesh::Mesh& mesh) : soup(soup_of(mesh)), tree(soup) {}

  part::Part soup;
  part::TriangleTree tree;
};

PointDistance::PointDistance(const mesh::Mesh& mesh) : tree_(std::make_unique<Tree>(mesh)) {}
PointDistance::~PointDistance() = default;
PointDistance::PointDistance(PointDistance&&) noexcept = default;

double PointDistance::at(const glm::dvec3& place) const {
  return std::sqrt(tree_->tree.nearest({place.x, place.y, place.z}).distance_squared);
}

}  // namespace forcelayer::stress
