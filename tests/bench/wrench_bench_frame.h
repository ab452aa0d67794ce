// A frame of the force models as the runtime computes it, from pose to wrench, to be timed.
#pragma once

#include <vector>

#include "formats/pshell.h"
#include "runtime/guard/pose_guard.h"
#include "runtime/model/contact_force.h"
#include "tests/bench/wrench_bench_shell.h"

namespace forcelayer::bench {

// The .pshell of these points, in the order in which pointshell writes them.
Pshell pshell_of(const AnalyticShell& shell, double voxel_size_m);

// Averaging of contacts: none, by query and field alone; the default model's look-up, which
// averages directions where the field asks for it; the same, with the contact rows of the default
// model's step; or of the force, by N/10 (paper 5.2).
enum class Averaging { kNone, kDirections, kStep, kByTen };

// Query, field and sum over the whole shell.
class ModelFrame {
 public:
  // All must outlive this.
  ModelFrame(const Voxmap& voxmap, const Pshell& shell, const field::ForceField& field,
             Averaging averaging);
  ModelFrame(const ModelFrame&) = delete;  // the probe knows the other members

  // Every point counts by its area over the mean; without this, all count alike. Of kStep the
  // look-up says by what they count.
  void weigh_by_area();

  // The contacts there, as the default model's look-up finds them; until the next call.
  const field::ContactSet& contacts_at(const Pose& world_from_center);

  Wrench at(const Pose& world_from_center);  // per N/m of stiffness, about the center, world axes

 private:
  Wrench of_step() noexcept;  // of set_

  query::ContactQuery query_;
  const field::ForceField& field_;
  Averaging averaging_;
  const Pshell& shell_;
  std::vector<float> weights_;  // by shell point
  query::CollectedPoints points_;
  field::FieldSamples samples_;
  guard::PoseGuard probe_;
  field::ContactSet set_;
  model::ContactLaw law_;  // of kStep, with 1 N/m
  model::ContactRows rows_;
};

}  // namespace forcelayer::bench
