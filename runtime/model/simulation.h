// One scene, one part, and the step between them.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "forcelayer/parameters.h"
#include "forcelayer/placement.h"
#include "formats/pshell.h"
#include "formats/result.h"
#include "formats/voxmap.h"
#include "runtime/coupling/state.h"
#include "runtime/field/force_field.h"
#include "runtime/field/surface_clearance.h"
#include "runtime/guard/seat.h"
#include "runtime/model/default_model.h"
#include "runtime/query/contact_query.h"

namespace forcelayer::guard {
class PoseGuard;
}

namespace forcelayer::model {

// The map's side of one step, for a model. `points` and `samples` have room for every shell point.
struct StepContext {
  const Parameters& parameters;
  query::ContactQuery& query;
  const field::ForceField& field;
  query::CollectedPoints& points;
  field::FieldSamples& samples;
};

// Owns the map, the shell and the memory that a step needs. step() is a pure function of its
// arguments and of what create() was given: two calls with equal arguments give equal bits,
// whatever the calling thread rounds or flushes (step_arithmetic.h).
class Simulation {
 public:
  // Takes over both files. Errors: kFilesDoNotMatch where the part is too large for the voxel size;
  // kUsage where model, force and map do not go together.
  static Result<std::unique_ptr<Simulation>> create(Voxmap voxmap, Pshell shell,
                                                    const Parameters& parameters,
                                                    const query::QueryOptions& query = {});
  ~Simulation();

  // A part at rest at `world_from_part`, gripped without stretch by a handle at
  // `world_from_handle`.
  State registered(const Pose& world_from_part, const Pose& world_from_handle) const;

  // The same for a start that may name place and grip.
  State registered(const PartStart& start, const Pose& world_from_handle) const;

  // Seats the part: from here on registered() opens the seat on the objects that the part touches
  // at `world_from_center` (runtime/guard/seat.h), or none where it touches nothing. The paper's
  // model has none. Not beside step(). Errors: kUsage if a seat cannot be distinguished from a
  // penetration.
  Status find_seat(const Pose& world_from_center);
  std::span<const guard::SeatObject> seat() const;
  const std::optional<Pose>& world_from_seat() const { return world_from_seat_; }

  // registered(), seated where `start` says. Errors: as find_seat().
  Result<State> begin(const PartStart& start, const Pose& world_from_handle);

  // One frame of `dt_s` seconds. Never throws, allocates, locks, logs or calls the system.
  StepResult step(State& state, const StepInput& input, double dt_s) noexcept;

  // Around a step in which the query's helper threads should take part. Both call the system.
  void wake_helpers() noexcept { query_.wake(); }
  void rest_helpers() noexcept { query_.rest(); }
  std::vector<std::string> give_helpers_real_time_priority() {
    return query_.give_helpers_real_time_priority();
  }

  // The part's frame (its mesh's) from its centroid frame, and back.
  Pose world_from_part(const Pose& world_from_center) const;
  Pose world_from_center(const Pose& world_from_part) const;

  const Parameters& parameters() const { return parameters_; }
  const Voxmap& voxmap() const { return voxmap_; }
  const Pshell& shell() const { return shell_; }
  const query::ContactQuery& query() const { return query_; }

  // How far apart the exact surfaces are where the premises of that hold (run/separation.h); 0:
  // nothing is guaranteed. Whoever opened the files sets it before the first step.
  double guaranteed_m() const { return guaranteed_m_; }
  void set_guaranteed_m(double guaranteed_m) { guaranteed_m_ = guaranteed_m; }

 private:
  Simulation(Voxmap voxmap, Pshell shell, const Parameters& parameters,
             const query::QueryOptions& query);
  void make_default_model();
  void make_default_model_of_guard();
  StepResult step_model(State& state, const StepInput& input, double dt_s) noexcept;

  Voxmap voxmap_;
  Pshell shell_;
  Parameters parameters_;
  query::ContactQuery query_;
  field::SurfaceClearance clearance_;
  std::unique_ptr<field::ForceField> field_;
  query::CollectedPoints points_;
  field::FieldSamples samples_;
  std::unique_ptr<guard::PoseGuard> guard_;  // of the default model
  std::unique_ptr<DefaultModel> default_;
  double guaranteed_m_ = 0;
  std::optional<Pose> world_from_seat_;  // of the centroid frame; none without a seat
};

}  // namespace forcelayer::model
