#include "workbench/exact/mesh_distance.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/detail/traversal/collision_node.h>
#include <fcl/narrowphase/detail/traversal/distance/mesh_distance_traversal_node.h>

#include <limits>
#include <optional>

#include "workbench/exact/triangle_distance.h"

namespace forcelayer::exact {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

// In place: FCL's models share their memory when they are assigned.
void build(Model& model, const Surface& surface) {
  model.beginModel(static_cast<int>(surface.triangles.size()),
                   static_cast<int>(surface.vertices_m.size()));
  const auto vertex = [&](std::uint32_t i) {
    const glm::dvec3& v = surface.vertices_m[i];
    return fcl::Vector3d(v.x, v.y, v.z);
  };
  for (const mesh::Triangle& t : surface.triangles) {
    model.addTriangle(vertex(t[0]), vertex(t[1]), vertex(t[2]));
  }
  model.endModel();
}

fcl::Transform3d transform_of(const Pose& pose) {
  fcl::Transform3d transform = fcl::Transform3d::Identity();
  const glm::dquat& q = pose.orientation;
  transform.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
  transform.translation() = fcl::Vector3d(pose.position_m.x, pose.position_m.y, pose.position_m.z);
  return transform;
}

glm::dvec3 point_of(const fcl::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

Corners corners_of(const Model& model, int triangle, const fcl::Transform3d& world_from_model) {
  Corners corners;
  for (std::size_t n = 0; n < 3; ++n) {
    const auto vertex = model.tri_indices[triangle][static_cast<int>(n)];
    corners[n] = point_of(world_from_model * model.vertices[vertex]);
  }
  return corners;
}

// FCL's search of two trees of boxes with a distance of triangles of our own: FCL's leaves out a
// corner before a face where the square of twice its area is below 1e-15 in the mesh's unit.
class Search final : public fcl::detail::MeshDistanceTraversalNodeOBBRSSd {
 public:
  Search(const Model& scene, const Model& part, const fcl::Transform3d& world_from_part,
         double hint_m)
      : bound_(hint_m) {
    fcl::detail::initialize(*this, scene, fcl::Transform3d::Identity(), part, world_from_part,
                            fcl::DistanceRequestd(), bound_);
    fcl::detail::distance<double>(this, nullptr, 2);
  }

  struct Found {
    TriangleDistance nearest;
    int scene_triangle = 0;
  };
  const std::optional<Found>& found() const { return found_; }  // none beyond the hint

 private:
  // Does not begin with a pair of triangles of FCL's choice.
  void preprocess() override {}
  void postprocess() override {}

  bool canStop(double bound_m) const override { return bound_m >= bound_.min_distance; }

  void leafTesting(int scene_node, int part_node) const override {
    const int of_scene = model1->getBV(scene_node).primitiveId();
    const int of_part = model2->getBV(part_node).primitiveId();
    const TriangleDistance nearest =
        triangle_distance(corners_of(*model1, of_scene, fcl::Transform3d::Identity()),
                          corners_of(*model2, of_part, tf));
    if (!(nearest.distance_m < bound_.min_distance)) return;
    bound_.min_distance = nearest.distance_m;
    found_ = {nearest, of_scene};
  }

  // FCL searches with functions that are const.
  mutable fcl::DistanceResultd bound_;
  mutable std::optional<Found> found_;
};

}  // namespace

struct MeshPair::Models {
  Model scene, part;
  bool empty = false;
};

MeshPair::MeshPair(const Surface& scene, const Surface& part) : models_(new Models) {
  models_->empty = scene.triangles.empty() || part.triangles.empty();
  if (models_->empty) return;
  build(models_->scene, scene);
  build(models_->part, part);
}
MeshPair::~MeshPair() = default;
MeshPair::MeshPair(MeshPair&&) noexcept = default;

MeshDistance MeshPair::at(const Pose& world_from_center, double hint_m) const {
  if (models_->empty) return {};
  const fcl::Transform3d world_from_part = transform_of(world_from_center);
  // The search leaves out what is as far apart as the hint.
  auto found = Search(models_->scene, models_->part, world_from_part, hint_m).found();
  if (!found) {
    constexpr double kAny = std::numeric_limits<double>::max();
    found = Search(models_->scene, models_->part, world_from_part, kAny).found();
  }
  const TriangleDistance& nearest = found->nearest;
  return {nearest.distance_m, static_cast<std::size_t>(found->scene_triangle), nearest.second_m,
          nearest.first_m};
}

}  // namespace forcelayer::exact
