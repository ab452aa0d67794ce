// Whether the part may be at a pose, and move straight from one pose to another, by the proofs of
// voxcheck (runtime/clearance). For one thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "formats/result.h"
#include "runtime/clearance/part_distance.h"
#include "runtime/clearance/path_walk.h"
#include "runtime/clearance/required_distance.h"
#include "runtime/clearance/seat_stretch.h"
#include "workbench/voxplan/check/problem.h"

namespace forcelayer::voxplan {

// kClear: the clearance to all objects is proven. kInSeat: the clearance to all objects except
// those of the seat is proven, and no shell point goes deeper into these than allowed. With
// Problem::seat_meshes the meshes decide how deep, at poses a sixteenth of a voxel apart.
enum class Rule { kInSeat, kClear };

class PoseCheck {
 public:
  // Errors: those of SeatStretch::find().
  static Result<std::unique_ptr<PoseCheck>> create(const Problem& problem);
  virtual ~PoseCheck() = default;

  bool holds(Rule rule, const Pose& pose);
  // Also writes the proven distance to `known`.
  virtual bool holds(Rule rule, const Pose& pose, clearance::MinDistance& known);

  // From now on this pose and all within a voxel of travel are refused, because a path through it
  // was not proven clear. The start stays allowed.
  void refuse(const Pose& pose);

  // How far apart in travel the poses are at which the meshes are tested for contact. Thinner walls
  // may be missed, but the meshes prove the whole path before it is taken.
  static constexpr double kMeshStepVoxels = 1.0 / 16;
  void test_meshes_every(double voxels) { mesh_step_voxels_ = voxels; }

  // The fraction of the motion, from its beginning, that keeps the rule: 1 if all of it does.
  double fraction_kept(Rule rule, const Pose& from, const Pose& to);
  // Whether the whole motion keeps the rule. Faster than fraction_kept() if it does not.
  bool is_kept(Rule rule, const Pose& from, const Pose& to);
  // The same. The rule holds at each end whose distance is known, and both are known afterwards.
  bool is_kept(Rule rule, const Pose& from, const Pose& to, clearance::KnownEnds& known);

  // The proven clearance at a pose, m, as far as distances are stored.
  double clearance_m(const Pose& pose);

  // The object that the part meets first on the straight motion between two poses. 0 if it meets
  // nothing, or an object without a name.
  std::uint32_t met(Rule rule, const Pose& from, const Pose& to);

  // The floors of the seat at a pose. Empty without a seat.
  const std::vector<clearance::SeatStretch::Floor>& floors(const Pose& pose);

  // The objects that may be nearer than required while the part is in its seat, without those that
  // are allowed everywhere.
  std::vector<std::uint32_t> seat_objects() const;
  bool has_seat() const { return seat_ && !seat_->objects().empty(); }
  std::uint64_t poses_tested() const { return tested_ + (seat_ ? seat_->looked_up() : 0); }
  std::uint64_t motions_tested() const { return motions_tested_; }
  std::uint64_t motions_kept() const { return motions_kept_; }  // from end to end
  double kept_m() const { return kept_m_; }                     // the travel of these motions
  const Problem& problem() const { return problem_; }

 protected:
  PoseCheck(const Problem& problem, std::optional<clearance::SeatStretch> seat);
  // All functions about motions call this one.
  virtual double fraction_kept(Rule rule, const Pose& from, const Pose& to, bool or_nothing,
                               clearance::KnownEnds& known);
  // For a derived class that answers without a test: adds `poses` to poses_tested().
  void count_tested(std::uint64_t poses) { tested_ += poses; }

 private:
  clearance::PartDistance& part(Rule rule) { return rule == Rule::kClear ? clear_ : in_seat_; }
  double fraction_by_rule(Rule rule, const Pose& from, const Pose& to, bool or_nothing,
                          clearance::KnownEnds& known);
  double fraction_by_proofs(Rule rule, const Pose& from, const Pose& to, bool or_nothing,
                            clearance::KnownEnds& known);
  bool is_refused(const Pose& pose) const;
  double fraction_by_meshes(const Pose& from, const Pose& to, double largest);
  double fraction_not_refused(const Pose& from, const Pose& to) const;

  const Problem& problem_;
  clearance::RequiredDistance required_;
  std::optional<clearance::SeatStretch> seat_;
  clearance::LeftOut but_seat_;  // the allowed objects and those of the seat
  clearance::PartDistance clear_, in_seat_;
  std::vector<clearance::SeatStretch::Floor> floors_;
  struct Refused {
    Pose pose;
    double within_m = 0;
  };
  std::vector<Refused> refused_;
  std::uint64_t tested_ = 0;  // poses, without those that the seat tested
  std::uint64_t motions_tested_ = 0, motions_kept_ = 0;
  double kept_m_ = 0;
  double mesh_step_voxels_ = kMeshStepVoxels;
};

}  // namespace forcelayer::voxplan
