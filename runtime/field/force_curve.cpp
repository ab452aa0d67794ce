#include "runtime/field/force_curve.h"

#include <algorithm>
#include <cmath>

namespace forcelayer::field {
namespace {

// With the steepest slope at every depth, one in a hundred parts in the foam of tests/stress crept
// for more than 2.5 s (FORCELAYER_LONG_TESTS, RestIsQuietInEveryTrial). With this, none of 1,200.
constexpr double kReachVoxels = 0.1;
constexpr double kMinSlope = 1e-3;  // a row without stiffness would have no force

}  // namespace

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
  const auto count = static_cast<std::ptrdiff_t>(nodes_.size());
  const auto reach =
      static_cast<std::ptrdiff_t>(std::ceil(kReachVoxels * header.voxel_size_m / step_m_));
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    double steepest = 0;
    for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(1, i - reach);
         k <= std::min(count - 1, i + 1 + reach); ++k) {
      steepest = std::max(steepest, (nodes_[k].force_m - nodes_[k - 1].force_m) / step_m_);
    }
    nodes_[i].slope = std::max(kMinSlope, std::min(1.0, steepest));
  }
}

double ForceCurve::slope(double depth_m) const noexcept {
  if (is_straight()) return 1;
  if (!(depth_m > 0)) return nodes_[0].slope;
  const double steps = std::min(depth_m / step_m_, static_cast<double>(nodes_.size() - 1));
  return nodes_[static_cast<std::size_t>(steps)].slope;
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
