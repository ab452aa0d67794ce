#include "tests/bench/wrench_bench_frame.h"

#include <glm/geometric.hpp>
#include <tuple>

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
    part.areas_m2.push_back(static_cast<float>(shell.areas_m2[i]));
  }
  return test::make_pshell(part);
}

ModelFrame::ModelFrame(const Voxmap& voxmap, const Pshell& shell, const field::ForceField& field,
                       Averaging averaging)
    : query_(voxmap, shell),
      field_(field),
      averaging_(averaging),
      shell_(shell),
      weights_(shell.header().point_count, 1.0f),
      probe_(query_, field, points_, samples_) {
  points_.reserve(shell.header().point_count);
  samples_.reserve(shell.header().point_count);
  set_.reserve(shell.header().point_count);
  const field::ForceCurve curve(voxmap);
  law_ = {1, 0, curve.is_straight() ? 1.0 : 0.0, curve};
  rows_.reserve(shell.header().point_count);
}

void ModelFrame::weigh_by_area() {
  double sum = 0;
  for (std::size_t i = 0; i < weights_.size(); ++i) sum += double{shell_.view().weight_m2[i]};
  const double mean = sum / static_cast<double>(weights_.size());
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    weights_[i] = static_cast<float>(double{shell_.view().weight_m2[i]} / mean);
  }
}

// The contacts as rows of the step's solve (DefaultModel::solve_motion); of a part at rest they
// push with these impulses.
Wrench ModelFrame::of_step() noexcept {
  constexpr double kStepS = 1e-3;
  rows_.clear();
  model::add_contact_rows(set_, law_, kStepS, 0, rows_);
  rows_.energy_j({});
  const coupling::Vector6 impulse = rows_.pushing().impulse;
  return {coupling::linear_part(impulse) / kStepS, coupling::angular_part(impulse) / kStepS};
}

const field::ContactSet& ModelFrame::contacts_at(const Pose& world_from_center) {
  probe_.query_pose(world_from_center, set_);
  return set_;
}

Wrench ModelFrame::at(const Pose& world_from_center) {
  if (averaging_ == Averaging::kStep) {
    contacts_at(world_from_center);
    return of_step();
  }
  const bool averaged = averaging_ == Averaging::kDirections;
  if (averaged) {
    contacts_at(world_from_center);
  } else {
    query_.run(world_from_center, points_);
    field_.measure(points_, samples_);
  }
  const auto& [ux, uy, uz] = averaged ? std::tie(set_.ux, set_.uy, set_.uz)
                                      : std::tie(samples_.dx, samples_.dy, samples_.dz);
  Wrench sum;
  for (std::uint32_t i = 0; i < points_.count; ++i) {
    if (!(samples_.depth_m[i] > 0)) continue;
    // The paper: points in value 1 press nothing.
    const bool surface = points_.value[i] == static_cast<std::uint8_t>(VoxelValue::kSurface);
    if (averaging_ == Averaging::kByTen && !surface) continue;
    const glm::dvec3 force = double{weights_[points_.index[i]]} * double{samples_.depth_m[i]} *
                             glm::dvec3(ux[i], uy[i], uz[i]);
    const glm::dvec3 arm(points_.rx[i], points_.ry[i], points_.rz[i]);
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
