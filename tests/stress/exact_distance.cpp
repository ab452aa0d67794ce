#include "tests/stress/exact_distance.h"

#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "runtime/coupling/coupling.h"
#include "tests/support/fcl_model.h"

namespace forcelayer::stress {
namespace {

using testing::fcl_model;
using testing::fcl_transform;
using Model = fcl::BVHModel<fcl::RSSd>;

}  // namespace

struct ExactDistance::Models {
  std::shared_ptr<Model> scene, part;
};

ExactDistance::ExactDistance(const mesh::Mesh& scene, const mesh::Mesh& part)
    : models_(new Models{fcl_model<fcl::RSSd>(scene), fcl_model<fcl::RSSd>(part)}) {}
ExactDistance::~ExactDistance() = default;
ExactDistance::ExactDistance(ExactDistance&&) noexcept = default;

double ExactDistance::at(const Pose& world_from_part, double at_most_m) const {
  const fcl::DistanceRequestd request(false);
  // The search leaves out what is farther apart than the result so far.
  fcl::DistanceResultd result(at_most_m);
  fcl::distance<double>(models_->scene.get(), fcl::Transform3d::Identity(), models_->part.get(),
                        fcl_transform(world_from_part), request, result);
  return std::max(0.0, result.min_distance);
}

void PathDistance::visit(const Pose& world_from_part, const glm::dvec3& center_m) {
  ++visited_;
  if (started_) {
    const glm::dvec3 way_m = world_from_part.orientation * center_m + world_from_part.position_m -
                             last_.orientation * center_m - last_.position_m;
    const double angle = glm::length(
        coupling::rotation_vector(world_from_part.orientation * glm::conjugate(last_.orientation)));
    at_least_m_ -= glm::length(way_m) + radius_m_ * angle;
  }
  last_ = world_from_part;
  if (started_ && at_least_m_ >= smallest_m_) return;
  started_ = true;
  ++measured_;
  at_least_m_ = exact_.at(world_from_part, smallest_m_ + kSlackM);
  smallest_m_ = std::min(smallest_m_, at_least_m_);
}

}  // namespace forcelayer::stress
