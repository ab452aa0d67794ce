#include "runtime/field/surface_clearance.h"

#include <algorithm>

namespace forcelayer::field {

PoseClearance point_clearance(const ContactSet& set, const glm::dvec3& center_m,
                              const ContactProbe& probe) noexcept {
  PoseClearance clearance;
  if (!(set.min_distance_m > 0) || set.outside_map) return clearance;
  clearance.clearance_m = double{set.min_distance_m};
  clearance.kind = ClearanceKind::kAtLeast;
  if (set.nearest == ContactSet::kNone) return clearance;
  clearance.kind = ClearanceKind::kProven;
  clearance.nearest_point_m = center_m + glm::dvec3(set[set.nearest].arm_m);
  clearance.nearest_object = probe.object_near(clearance.nearest_point_m);
  return clearance;
}

SurfaceClearance::SurfaceClearance(const query::ContactQuery& query)
    : shell_(query.shell().surface_distance_terms()),
      deviations_m_(query.voxmap().header().static_deviation_m +
                    query.shell().header().part_deviation_m + query.rounding_bound_m()) {}

void SurfaceClearance::prove(ClearanceKind& kind, double& clearance_m) const noexcept {
  if (kind == ClearanceKind::kNone) return;
  const double proven_m = surface_distance_bound_m(shell_, clearance_m) - deviations_m_;
  if (!(proven_m > 0)) kind = ClearanceKind::kNone;
  clearance_m = std::max(0.0, proven_m);
}

}  // namespace forcelayer::field
