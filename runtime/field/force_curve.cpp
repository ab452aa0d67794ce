#include "runtime/field/force_curve.h"

#include <algorithm>

namespace forcelayer::field {

ForceCurve::ForceCurve(const Voxmap& voxmap) {
  if (voxmap.compliance().empty()) return;
  const VoxmapHeader& header = voxmap.header();
  step_m_ = header.distance_quantum_m;
  deepening_m_ = std::max(0.0, header.force_depth_m - header.voxel_size_m);
  const double per_pa = 1 / steepest_pa_per_m(voxmap);
  for (const float pressure_pa : voxmap.compliance()) {
    Node node{per_pa * double{pressure_pa}, 0};
    if (!nodes_.empty()) {
      const Node& last = nodes_.back();
      node.energy_m2 = last.energy_m2 + 0.5 * step_m_ * (last.force_m + node.force_m);
    }
    nodes_.push_back(node);
  }
}

ForceCurve::Node ForceCurve::between_nodes(double depth_m) const noexcept {
  const double steps = std::min(depth_m / step_m_, static_cast<double>(nodes_.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(steps), nodes_.size() - 2);
  const Node& low = nodes_[i];
  const double fraction = steps - static_cast<double>(i);
  const double force_m = low.force_m + fraction * (nodes_[i + 1].force_m - low.force_m);
  const double beyond_m = std::max(0.0, depth_m - steps * step_m_);
  return {force_m,
          low.energy_m2 + 0.5 * fraction * step_m_ * (low.force_m + force_m) + beyond_m * force_m};
}

}  // namespace forcelayer::field
