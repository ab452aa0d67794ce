// Judges what is said of the clearance at a pose by the exact distance of the meshes (FCL), whoever
// says it: a frame of a run, or a row of a path that was checked.
#pragma once

#include <span>
#include <vector>

#include "forcelayer/step.h"
#include "tests/stress/exact_distance.h"
#include "tests/stress/point_distance.h"

namespace forcelayer::stress {

// The clearance claimed for one pose.
struct ClearanceClaim {
  ClearanceKind kind = ClearanceKind::kNone;
  double clearance_m = 0;    // 0 where nothing is proven
  glm::dvec3 point_m{0};     // world: a place of the part that is nearest to the scene
  std::uint32_t object = 0;  // the object nearest to that place, from 1 on; 0: not known
};
ClearanceClaim claim_of(const StepReport& report);

// Whether the reported object is the one nearest to the place.
enum class ObjectVerdict {
  kNotTold,
  kTie,  // the second nearest is no more than a voxel farther: either will do
  kRight,
  kWrong,
};

struct JudgedClearance {
  double exact_m = 0;     // between the surfaces of part and scene; 0 where they meet
  bool too_much = false;  // the claim is above that
  ObjectVerdict object = ObjectVerdict::kNotTold;
};

class ClearanceJudge {
 public:
  // `objects` in world, numbered from 1 on as a bake in this order numbers them; `part` in its own
  // frame; m.
  ClearanceJudge(std::span<const mesh::Mesh> objects, const mesh::Mesh& part, double voxel_size_m);

  JudgedClearance judge(const Pose& world_from_part, const ClearanceClaim& claim) const;

  double exact_m(const Pose& world_from_part) const { return exact_.at(world_from_part); }
  // Between a place in world and the scene's surface.
  double exact_m(const glm::dvec3& world_m) const;

 private:
  ObjectVerdict judge_object(const ClearanceClaim& claim) const;

  ExactDistance exact_;
  std::vector<PointDistance> objects_;
  double voxel_size_m_;
};

}  // namespace forcelayer::stress
