#include "runtime/exact/mesh_distance.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>

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
  const fcl::DistanceRequestd request(true);  // with the nearest points
  // The search leaves out what is farther apart than the result so far.
  fcl::DistanceResultd result(hint_m);
  const auto measure = [&] {
    fcl::distance<double>(&models_->scene, fcl::Transform3d::Identity(), &models_->part,
                          transform_of(world_from_center), request, result);
  };
  measure();
  if (result.b1 == fcl::DistanceResultd::NONE) {  // the hint was too small
    result = fcl::DistanceResultd();
    measure();
  }
  return {std::max(0.0, result.min_distance), static_cast<std::size_t>(result.b1),
          point_of(result.nearest_points[1]), point_of(result.nearest_points[0])};
}

}  // namespace forcelayer::exact
