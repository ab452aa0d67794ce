#include "tests/bench/query_bench_fcl.h"

#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include "tests/support/fcl_model.h"

namespace forcelayer::bench {
namespace {

using testing::fcl_model;
using testing::fcl_transform;
using Model = fcl::BVHModel<fcl::OBBRSSd>;

}  // namespace

struct FclQuery::Models {
  std::shared_ptr<Model> scene, part;
};

FclQuery::FclQuery(const mesh::Mesh& scene, const mesh::Mesh& part)
    : models_(new Models{fcl_model<fcl::OBBRSSd>(scene), fcl_model<fcl::OBBRSSd>(part)}) {}
FclQuery::~FclQuery() = default;

std::uint32_t FclQuery::contacts(const Pose& world_from_part) const {
  constexpr std::size_t kAll = 1'000'000;
  const fcl::CollisionRequestd request(kAll, true);
  fcl::CollisionResultd result;
  fcl::collide<double>(models_->scene.get(), fcl::Transform3d::Identity(), models_->part.get(),
                       fcl_transform(world_from_part), request, result);
  return static_cast<std::uint32_t>(result.numContacts());
}

double FclQuery::distance_m(const Pose& world_from_part) const {
  const fcl::DistanceRequestd request(false);
  fcl::DistanceResultd result;
  fcl::distance<double>(models_->scene.get(), fcl::Transform3d::Identity(), models_->part.get(),
                        fcl_transform(world_from_part), request, result);
  return result.min_distance;
}

}  // namespace forcelayer::bench
