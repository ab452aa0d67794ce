// The space of poses for OMPL. A state is one piece of memory. OMPL's own states of SE(3) are
// three, and its trees compare a new pose with thousands of others: half of a search's time went
// into reading them.
#pragma once

#include <ompl/base/StateSampler.h>
#include <ompl/base/StateSpace.h>

#include <functional>

#include "forcelayer/pose.h"
#include "runtime/clearance/path_walk.h"
#include "workbench/voxplan/destination.h"

namespace forcelayer::voxplan {

struct PoseState final : ompl::base::State {
  Pose pose;  // of the part's centroid frame, world
  // The distance of the shell points that a test of this pose, or of a motion to it, has found, so
  // that the next motion from here does not compute it again. Negative if there was no test.
  mutable clearance::MinDistance known{clearance::KnownEnds::kUnknown};
};

inline const Pose& pose_of(const ompl::base::State* state) {
  return static_cast<const PoseState*>(state)->pose;
}
inline clearance::MinDistance& known_of(const ompl::base::State* state) {
  return static_cast<const PoseState*>(state)->known;
}
inline void put(const Pose& pose, ompl::base::State* state) {
  auto* const to = static_cast<PoseState*>(state);
  to->pose = pose;
  to->known = {clearance::KnownEnds::kUnknown};
}

class PoseSpace final : public ompl::base::StateSpace {
 public:
  using MakeSampler =
      std::function<ompl::base::StateSamplerPtr(const ompl::base::StateSpace* space)>;

  // Positions in `bounds`. Distances are pose_distance_m() with `turn_m`. `cell_m` is the side of
  // the cells in which a planner counts its visits.
  PoseSpace(const Box& bounds, double turn_m, double cell_m, MakeSampler make_sampler);

  unsigned getDimension() const override { return 6; }
  double getMaximumExtent() const override;
  double getMeasure() const override;
  void enforceBounds(ompl::base::State* state) const override;
  bool satisfiesBounds(const ompl::base::State* state) const override;
  void copyState(ompl::base::State* to, const ompl::base::State* from) const override;
  double distance(const ompl::base::State* a, const ompl::base::State* b) const override;
  bool equalStates(const ompl::base::State* a, const ompl::base::State* b) const override;
  void interpolate(const ompl::base::State* from, const ompl::base::State* to, double fraction,
                   ompl::base::State* state) const override;
  ompl::base::StateSamplerPtr allocDefaultStateSampler() const override;
  ompl::base::State* allocState() const override { return new PoseState; }
  void freeState(ompl::base::State* state) const override { delete static_cast<PoseState*>(state); }
  void registerProjections() override;

 private:
  Box bounds_;
  double turn_m_, cell_m_;
  MakeSampler make_sampler_;
};

}  // namespace forcelayer::voxplan
