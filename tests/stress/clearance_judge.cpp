#include "tests/stress/clearance_judge.h"

#include <algorithm>

#include "tests/stress/shapes.h"

namespace forcelayer::stress {
namespace {

// Rounding of FCL's distances, in voxels: it rounds to double precision of the scene's size.
constexpr double kRoundingVoxels = 1e-6;

mesh::Mesh united(std::span<const mesh::Mesh> objects) {
  mesh::Mesh all;
  for (const mesh::Mesh& object : objects) append(all, object);
  return all;
}

}  // namespace

ClearanceClaim claim_of(const StepReport& report) {
  return {report.clearance_kind, report.clearance_m, report.nearest_point_m, report.nearest_object};
}

ClearanceJudge::ClearanceJudge(std::span<const mesh::Mesh> objects, const mesh::Mesh& part,
                               double voxel_size_m)
    : exact_(united(objects), part), voxel_size_m_(voxel_size_m) {
  for (const mesh::Mesh& object : objects) objects_.emplace_back(object);
}

double ClearanceJudge::exact_m(const glm::dvec3& world_m) const {
  double smallest = 1e300;
  for (const PointDistance& object : objects_) smallest = std::min(smallest, object.at(world_m));
  return smallest;
}

JudgedClearance ClearanceJudge::judge(const Pose& world_from_part,
                                      const ClearanceClaim& claim) const {
  JudgedClearance judged;
  judged.exact_m = exact_.at(world_from_part);
  judged.too_much = claim.kind != ClearanceKind::kNone &&
                    claim.clearance_m > judged.exact_m + kRoundingVoxels * voxel_size_m_;
  judged.object = judge_object(claim);
  return judged;
}

ObjectVerdict ClearanceJudge::judge_object(const ClearanceClaim& claim) const {
  if (claim.kind != ClearanceKind::kProven || claim.object == 0) return ObjectVerdict::kNotTold;
  if (claim.object > objects_.size()) return ObjectVerdict::kWrong;
  double told = 0, others = 1e300;
  for (std::size_t n = 0; n < objects_.size(); ++n) {
    const double distance_m = objects_[n].at(claim.point_m);
    (n + 1 == claim.object ? told : others) =
        n + 1 == claim.object ? distance_m : std::min(others, distance_m);
  }
  if (std::abs(told - others) <= voxel_size_m_) return ObjectVerdict::kTie;
  return told < others ? ObjectVerdict::kRight : ObjectVerdict::kWrong;
}

}  // namespace forcelayer::stress
