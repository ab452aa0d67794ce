#include "workbench/voxplan/pose_space.h"

#include <ompl/base/ProjectionEvaluator.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>

#include "workbench/voxplan/nearest/pose_index.h"

namespace forcelayer::voxplan {
namespace {

namespace ob = ompl::base;

class Position final : public ob::ProjectionEvaluator {
 public:
  Position(const ob::StateSpace* space, double cell_m)
      : ProjectionEvaluator(space), cell_m_(cell_m) {}
  unsigned getDimension() const override { return 3; }
  void defaultCellSizes() override { cellSizes_.assign(3, cell_m_); }
  void project(const ob::State* state, Eigen::Ref<Eigen::VectorXd> to) const override {
    const glm::dvec3& p = pose_of(state).position_m;
    for (int axis = 0; axis < 3; ++axis) to(axis) = p[axis];
  }

 private:
  double cell_m_;
};

}  // namespace

PoseSpace::PoseSpace(const Box& bounds, double turn_m, double cell_m, MakeSampler make_sampler)
    : bounds_(bounds), turn_m_(turn_m), cell_m_(cell_m), make_sampler_(std::move(make_sampler)) {
  setName("poses");
  type_ = ob::STATE_SPACE_UNKNOWN;
}

// The longest chord between two orientations is that of half a turn.
double PoseSpace::getMaximumExtent() const {
  return glm::distance(bounds_.low, bounds_.high) + turn_m_ * std::numbers::sqrt2;
}

double PoseSpace::getMeasure() const {
  const glm::dvec3 side = bounds_.high - bounds_.low;
  return side.x * side.y * side.z * std::numbers::pi * std::numbers::pi;
}

void PoseSpace::enforceBounds(ob::State* state) const {
  const Pose& pose = pose_of(state);
  put({glm::clamp(pose.position_m, bounds_.low, bounds_.high), glm::normalize(pose.orientation)},
      state);
}

bool PoseSpace::satisfiesBounds(const ob::State* state) const {
  const glm::dvec3& p = pose_of(state).position_m;
  return glm::clamp(p, bounds_.low, bounds_.high) == p;
}

void PoseSpace::copyState(ob::State* to, const ob::State* from) const {
  put(pose_of(from), to);
  known_of(to) = known_of(from);
}

double PoseSpace::distance(const ob::State* a, const ob::State* b) const {
  return pose_distance_m(pose_of(a), pose_of(b), turn_m_);
}

bool PoseSpace::equalStates(const ob::State* a, const ob::State* b) const {
  return distance(a, b) == 0;
}

void PoseSpace::interpolate(const ob::State* from, const ob::State* to, double fraction,
                            ob::State* state) const {
  put(pose_between(pose_of(from), pose_of(to), fraction), state);
}

ob::StateSamplerPtr PoseSpace::allocDefaultStateSampler() const { return make_sampler_(this); }

void PoseSpace::registerProjections() {
  registerDefaultProjection(std::make_shared<Position>(this, cell_m_));
}

}  // namespace forcelayer::voxplan
