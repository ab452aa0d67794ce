#include "tests/bench/query_bench_fcl.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

namespace forcelayer::bench {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

std::shared_ptr<Model> model_of(const Mesh& mesh) {
  auto model = std::make_shared<Model>();
  model->beginModel(static_cast<int>(mesh.triangles.size()),
                    static_cast<int>(mesh.vertices.size()));
  const auto vertex = [&](std::uint32_t i) {
    const Vec3d& v = mesh.vertices[i];
    return fcl::Vector3d(v[0], v[1], v[2]);
  };
  for (const Triangle& t : mesh.triangles) {
    model->addTriangle(vertex(t[0]), vertex(t[1]), vertex(t[2]));
  }
  model->endModel();
  return model;
}

fcl::Transform3d transform_of(const Pose& pose) {
  fcl::Transform3d transform = fcl::Transform3d::Identity();
  const glm::dquat& q = pose.orientation;
  transform.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
  transform.translation() = fcl::Vector3d(pose.position_m.x, pose.position_m.y, pose.position_m.z);
  return transform;
}

}  // namespace

struct FclQuery::Models {
  std::shared_ptr<Model> scene, part;
};

FclQuery::FclQuery(const Mesh& scene, const Mesh& part)
    : models_(new Models{model_of(scene), model_of(part)}) {}
FclQuery::~FclQuery() = default;

std::uint32_t FclQuery::contacts(const Pose& world_from_part) const {
  constexpr std::size_t kAll = 1'000'000;
  const fcl::CollisionRequestd request(kAll, true);
  fcl::CollisionResultd result;
  fcl::collide<double>(models_->scene.get(), fcl::Transform3d::Identity(), models_->part.get(),
                       transform_of(world_from_part), request, result);
  return static_cast<std::uint32_t>(result.numContacts());
}

double FclQuery::distance_m(const Pose& world_from_part) const {
  const fcl::DistanceRequestd request(false);
  fcl::DistanceResultd result;
  fcl::distance<double>(models_->scene.get(), fcl::Transform3d::Identity(), models_->part.get(),
                        transform_of(world_from_part), request, result);
  return result.min_distance;
}

}  // namespace forcelayer::bench
