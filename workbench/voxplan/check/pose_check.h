// Whether the part may be at a pose, and go straight from one pose to another: by the proofs of
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

// kClear: the clearance is proven to all objects. kInSeat: to all but those of the seat, into which
// no shell point is pushed deeper than it may; with Problem::seat_meshes, into which the part goes
// no deeper by the meshes, as far as poses a sixteenth of a voxel apart tell.
enum class Rule { kInSeat, kClear };

class PoseCheck {
 public:
  // Errors: those of SeatStretch::find().
  static Result<std::unique_ptr<PoseCheck>> create(const Problem& problem);
  virtual ~PoseCheck() = default;

  bool holds(Rule rule, const Pose& pose);
  virtual bool holds(Rule rule, const Pose& pose, clearance::MinDistance& known);  // it tells

  // From now on no way leads by that pose, or within a voxel of travel around it: it belongs to a
  // way that was found and did not prove clear. The start stays allowed.
  void refuse(const Pose& pose);

  // How much of the motion keeps the rule from its beginning on: 1 where all of it does.
  double fraction_kept(Rule rule, const Pose& from, const Pose& to);
  // Whether all of it does: quicker where it does not.
  bool is_kept(Rule rule, const Pose& from, const Pose& to);
  // The same; the rule holds at ends of which something is known, and of both more is known then.
  bool is_kept(Rule rule, const Pose& from, const Pose& to, clearance::KnownEnds& known);

  // The proven clearance at a pose; as much as the stored distances tell.
  double clearance_m(const Pose& pose);

  // The object that the part meets first on the straight way between two poses; 0 where nothing is
  // met, or the file does not name it.
  std::uint32_t met(Rule rule, const Pose& from, const Pose& to);

  // Where the floors of the seat are at a pose. Empty without a seat.
  const std::vector<clearance::SeatStretch::Floor>& floors(const Pose& pose);

  // The objects that may be nearer than required while the part is in its seat, but allowed ones.
  std::vector<std::uint32_t> seat_objects() const;
  bool has_seat() const { return seat_ && !seat_->objects().empty(); }
  std::uint64_t poses_tested() const { return tested_ + (seat_ ? seat_->looked_up() : 0); }
  std::uint64_t motions_tested() const { return motions_tested_; }
  std::uint64_t motions_kept() const { return motions_kept_; }  // as a whole
  double kept_m() const { return kept_m_; }                     // their travel
  const Problem& problem() const { return problem_; }

 protected:
  PoseCheck(const Problem& problem, std::optional<clearance::SeatStretch> seat);
  // All questions about motions end here.
  virtual double fraction_kept(Rule rule, const Pose& from, const Pose& to, bool or_nothing,
                               clearance::KnownEnds& known);
  // For one that answers without a test: so many poses count as tested.
  void count_tested(std::uint64_t poses) { tested_ += poses; }

 private:
  clearance::PartDistance& part(Rule rule) { return rule == Rule::kClear ? clear_ : in_seat_; }
  double share_told(Rule rule, const Pose& from, const Pose& to, bool or_nothing,
                    clearance::KnownEnds& known);
  double share_by_proofs(Rule rule, const Pose& from, const Pose& to, bool or_nothing,
                         clearance::KnownEnds& known);
  bool is_refused(const Pose& pose) const;
  double share_by_meshes(const Pose& from, const Pose& to, double largest);
  double share_not_refused(const Pose& from, const Pose& to) const;

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
  std::uint64_t tested_ = 0;  // but for those of the seat
  std::uint64_t motions_tested_ = 0, motions_kept_ = 0;
  double kept_m_ = 0;
};

}  // namespace forcelayer::voxplan
