#include "tests/stress/rest_place.h"

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <stdexcept>

#include "runtime/coupling/coupling.h"
#include "runtime/coupling/virtual_coupling.h"
#include "runtime/field/force_field.h"
#include "runtime/guard/pose_guard.h"
#include "runtime/model/contact_force.h"

namespace forcelayer::stress {
namespace {

// Energy of the two springs at a pose.
class RestEnergy {
 public:
  RestEnergy(const model::Simulation& simulation, const coupling::GripTarget& target)
      : parameters_(simulation.parameters()),
        target_(target),
        query_(simulation.voxmap(), simulation.shell(), {}),
        field_(field_of(simulation)),
        probe_(query_, *field_, points_, samples_) {
    const std::uint64_t count = simulation.shell().view().point_count;
    points_.reserve(count);
    samples_.reserve(count);
    contacts_.reserve(count);
    translation_ = {parameters_.coupling_n_per_m, glm::dmat3(0),
                    parameters_.coupling_force_limit_n};
    rotation_ = {parameters_.coupling_nm_per_rad, glm::dmat3(0),
                 parameters_.coupling_torque_limit_nm};
    law_ = {parameters_.field_n_per_m, 0, parameters_.voxel_size_m,
            field::ForceCurve(simulation.voxmap())};
  }

  // Infinite with a point in the interior.
  double operator()(const Pose& pose) {
    probe_.query_pose(pose, contacts_);
    if (contacts_.interior > 0) return INFINITY;
    const model::ContactTotals totals = model::contact_totals(contacts_, law_);
    return coupling::spring_energy_j(translation_, coupling::grip_stretch_m(target_, pose)) +
           coupling::spring_energy_j(
               rotation_,
               coupling::rotation_vector(target_.orientation * glm::conjugate(pose.orientation))) +
           model::contact_energy_j(totals, model::LoadSharing(totals), law_);
  }

 private:
  static std::unique_ptr<field::ForceField> field_of(const model::Simulation& simulation) {
    auto field = field::make_force_field(Model::kDefault, simulation.parameters().force,
                                         simulation.voxmap());
    if (!field) throw std::runtime_error(to_line(field.error()));
    return std::move(*field);
  }

  const Parameters& parameters_;
  coupling::GripTarget target_;
  query::ContactQuery query_;
  std::unique_ptr<field::ForceField> field_;
  query::CollectedPoints points_;
  field::FieldSamples samples_;
  guard::PoseGuard probe_;
  field::ContactSet contacts_;
  coupling::CouplingHalf translation_, rotation_;
  model::ContactLaw law_;
};

}  // namespace

RestPlace nearest_rest_place(const model::Simulation& simulation,
                             const coupling::GripTarget& target, const Pose& start) {
  constexpr double kFirstVoxels = 0.25, kLastVoxels = 0.005;
  RestEnergy energy(simulation, target);
  const Parameters& parameters = simulation.parameters();
  RestPlace place{start, energy(start), 0};
  place.start_energy_j = place.energy_j;
  for (double step = kFirstVoxels; step >= kLastVoxels; step /= 2) {
    const double way_m = step * parameters.voxel_size_m;
    for (bool better = true; better;) {
      better = false;
      for (int motion = 0; motion < 12; ++motion) {
        glm::dvec3 axis(0);
        axis[motion % 3] = motion % 2 == 0 ? 1 : -1;
        Pose pose = place.world_from_center;
        if (motion < 6) {
          pose.position_m += way_m * axis;
        } else {
          pose.orientation = glm::normalize(
              coupling::rotation_by(way_m / parameters.part_radius_m * axis) * pose.orientation);
        }
        const double energy_j = energy(pose);
        if (!(energy_j < place.energy_j)) continue;
        place.world_from_center = pose;
        place.energy_j = energy_j;
        better = true;
      }
    }
  }
  return place;
}

}  // namespace forcelayer::stress
