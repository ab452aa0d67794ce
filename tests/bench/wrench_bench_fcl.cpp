#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <glm/geometric.hpp>

#include "tests/bench/wrench_bench_peers.h"
#include "tests/support/fcl_model.h"

namespace forcelayer::bench {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

glm::dvec3 glm_of(const fcl::Vector3d& v) { return {v[0], v[1], v[2]}; }

class FclMeshes : public MeshContacts {
 public:
  explicit FclMeshes(const mesh::Mesh& part) : part_(testing::fcl_model<fcl::OBBRSSd>(part)) {}
  void set_scene(const mesh::Mesh& scene) override {
    scene_ = testing::fcl_model<fcl::OBBRSSd>(scene);
  }

 protected:
  std::shared_ptr<Model> scene_, part_;
};

class FclContacts final : public FclMeshes {
 public:
  using FclMeshes::FclMeshes;

  Wrench at(const Pose& world_from_part) override {
    constexpr std::size_t kAll = 1'000'000;
    const fcl::CollisionRequestd request(kAll, true);
    fcl::CollisionResultd result;
    fcl::collide<double>(scene_.get(), fcl::Transform3d::Identity(), part_.get(),
                         testing::fcl_transform(world_from_part), request, result);
    Wrench sum;
    for (std::size_t i = 0; i < result.numContacts(); ++i) {
      const auto& contact = result.getContact(i);  // its normal goes from the scene to the part
      const glm::dvec3 force = contact.penetration_depth * glm_of(contact.normal);
      sum.force_n += force;
      sum.torque_nm += glm::cross(glm_of(contact.pos) - world_from_part.position_m, force);
    }
    return sum;
  }
};

class FclDistance final : public FclMeshes {
 public:
  FclDistance(const mesh::Mesh& part, double offset_m) : FclMeshes(part), offset_m_(offset_m) {}

  Wrench at(const Pose& world_from_part) override {
    const fcl::DistanceRequestd request(true);  // the nearest points too
    fcl::DistanceResultd result;
    fcl::distance<double>(scene_.get(), fcl::Transform3d::Identity(), part_.get(),
                          testing::fcl_transform(world_from_part), request, result);
    const double distance_m = result.min_distance;
    if (!(distance_m > 0) || distance_m >= offset_m_) return {};
    const glm::dvec3 on_part = glm_of(result.nearest_points[1]);
    const glm::dvec3 away = (on_part - glm_of(result.nearest_points[0])) / distance_m;
    const glm::dvec3 force = (offset_m_ - distance_m) * away;
    return {force, glm::cross(on_part - world_from_part.position_m, force)};
  }

 private:
  double offset_m_;
};

}  // namespace

std::unique_ptr<MeshContacts> fcl_contacts(const mesh::Mesh& part) {
  return std::make_unique<FclContacts>(part);
}

std::unique_ptr<MeshContacts> fcl_distance(const mesh::Mesh& part, double offset_m) {
  return std::make_unique<FclDistance>(part, offset_m);
}

}  // namespace forcelayer::bench
