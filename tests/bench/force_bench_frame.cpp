#include "tests/bench/force_bench_frame.h"

#include <glm/geometric.hpp>

#include "runtime/field/surface_directions.h"
#include "tests/support/curve_order.h"
#include "tests/support/point_part.h"

namespace forcelayer::bench {

Pshell pshell_of(const AnalyticShell& shell, double voxel_size_m) {
  test::PointPart part;
  part.voxel_size_m = voxel_size_m;
  for (const std::uint32_t i : test::curve_order(shell.points_m, shell.radius_m)) {
    const auto& p = shell.points_m[i];
    const auto& n = shell.normals[i];
    part.add({p.x, p.y, p.z}, {n.x, n.y, n.z});
  }
  return test::make_pshell(part);
}

ModelFrame::ModelFrame(const Voxmap& voxmap, const Pshell& shell, const ForceField& field,
                       Averaging averaging)
    : query_(voxmap, shell),
      field_(field),
      averaging_(averaging),
      shell_(shell),
      weights_(shell.header().point_count, 1.0f),
      voxel_size_m_(static_cast<float>(voxmap.voxel_size_m())) {
  points_.reserve(shell.header().point_count);
  samples_.reserve(shell.header().point_count);
  set_.reserve(static_cast<std::uint32_t>(shell.header().point_count));
}

void ModelFrame::weigh_by_area() {
  double sum = 0;
  for (std::size_t i = 0; i < weights_.size(); ++i) sum += double{shell_.view().weight_m2[i]};
  const double mean = sum / static_cast<double>(weights_.size());
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    weights_[i] = static_cast<float>(double{shell_.view().weight_m2[i]} / mean);
  }
}

Wrench ModelFrame::at(const Pose& world_from_center) {
  query_.run(world_from_center, points_);
  const bool directions = averaging_ == Averaging::kDirections;
  directions ? field_.measure(points_, samples_) : field_.evaluate(points_, samples_);
  set_.count = samples_.count;
  for (std::uint32_t i = 0; i < set_.count; ++i) {
    set_.ux[i] = samples_.dx[i], set_.uy[i] = samples_.dy[i], set_.uz[i] = samples_.dz[i];
    set_.depth_m[i] = samples_.depth_m[i];
  }
  if (directions) average_directions(points_, samples_, voxel_size_m_, -voxel_size_m_, set_);
  Wrench sum;
  for (std::uint32_t i = 0; i < set_.count; ++i) {
    if (!(set_.depth_m[i] > 0)) continue;
    const std::uint32_t at = samples_.at[i];
    // The paper: points in value 1 press nothing.
    const bool surface = points_.value[at] == static_cast<std::uint8_t>(VoxelValue::kSurface);
    if (averaging_ == Averaging::kByTen && !surface) continue;
    const glm::dvec3 force = double{weights_[points_.index[at]]} * double{set_.depth_m[i]} *
                             glm::dvec3(set_.ux[i], set_.uy[i], set_.uz[i]);
    const glm::dvec3 arm(points_.rx[at], points_.ry[at], points_.rz[at]);
    sum.force_n += force;
    sum.torque_nm += glm::cross(arm, force);
  }
  if (averaging_ == Averaging::kByTen && points_.surface_count >= 10) {
    sum.force_n *= 10.0 / points_.surface_count;
    sum.torque_nm *= 10.0 / points_.surface_count;
  }
  return sum;
}

}  // namespace forcelayer::bench
