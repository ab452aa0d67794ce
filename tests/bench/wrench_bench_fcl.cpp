#include <fcl/narrowphase/collision.h>

#include <glm/geometric.hpp>

#include "tests/bench/wrench_bench_peers.h"
#include "tests/support/fcl_model.h"

namespace forcelayer::bench {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

class FclContacts : public MeshContacts {
 public:
  FclContacts(const mesh::Mesh& scene, const mesh::Mesh& part)
      : scene_(testing::fcl_model<fcl::OBBRSSd>(scene)),
        part_(testing::fcl_model<fcl::OBBRSSd>(part)) {}

  Wrench at(const Pose& world_from_part) override {
    constexpr std::size_t kAll = 1'000'000;
    const fcl::CollisionRequestd request(kAll, true);
    fcl::CollisionResultd result;
    fcl::collide<double>(scene_.get(), fcl::Transform3d::Identity(), part_.get(),
                         testing::fcl_transform(world_from_part), request, result);
    Wrench sum;
    for (std::size_t i = 0; i < result.numContacts(); ++i) {
      const auto& contact = result.getContact(i);  // its normal goes from the scene to the part
      const glm::dvec3 normal(contact.normal[0], contact.normal[1], contact.normal[2]);
      const glm::dvec3 point(contact.pos[0], contact.pos[1], contact.pos[2]);
      const glm::dvec3 force = contact.penetration_depth * normal;
      sum.force_n += force;
      sum.torque_nm += glm::cross(point - world_from_part.position_m, force);
    }
    return sum;
  }

 private:
  std::shared_ptr<Model> scene_, part_;
};

}  // namespace

std::unique_ptr<MeshContacts> fcl_contacts(const mesh::Mesh& scene, const mesh::Mesh& part) {
  return std::make_unique<FclContacts>(scene, part);
}

}  // namespace forcelayer::bench
