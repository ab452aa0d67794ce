// A search whose tests answer at once: the answers of a run, in order, given back to a second run
// of the same seed. The second takes the same course pose by pose, so its time is that of all but
// the tests: samples, trees, states.
#pragma once

#include <memory>
#include <stdexcept>
#include <vector>

#include "workbench/voxplan/check/pose_check.h"

namespace forcelayer::bench {

// Recorded first; then, from replay() on, played once.
template <class T>
class Answers {
 public:
  template <class Ask>
  T next(const Ask& ask) {
    if (!replays_) return all_.emplace_back(ask());
    if (at_ == all_.size()) throw std::runtime_error("a replay asks for more than was recorded");
    return all_[at_++];
  }
  void replay() { replays_ = true; }
  bool replays() const { return replays_; }
  bool is_played() const { return at_ == all_.size(); }

 private:
  std::vector<T> all_;
  std::size_t at_ = 0;
  bool replays_ = false;
};

// An answer: for a pose 1 or 0, for a motion how much of it is kept; and how many poses were tested
// for it.
struct PoseAnswer {
  double share = 0;
  std::uint64_t tested = 0;
};

// PoseCheck without a seat, whose answers are recorded or given back.
class ReplayedCheck final : public voxplan::PoseCheck {
 public:
  ReplayedCheck(const voxplan::Problem& problem, Answers<PoseAnswer>& answers)
      : PoseCheck(problem, {}), answers_(answers) {}

  bool holds(voxplan::Rule rule, const Pose& pose, clearance::LeastDistance& known) override {
    return share([&] { return PoseCheck::holds(rule, pose, known) ? 1.0 : 0.0; }) == 1;
  }

 private:
  double share_kept(voxplan::Rule rule, const Pose& from, const Pose& to, bool or_nothing,
                    clearance::KnownEnds& known) override {
    return share([&] { return PoseCheck::share_kept(rule, from, to, or_nothing, known); });
  }

  template <class Ask>
  double share(const Ask& ask) {
    const PoseAnswer answer = answers_.next([&] {
      const std::uint64_t before = poses_tested();
      const double share = ask();
      return PoseAnswer{share, poses_tested() - before};
    });
    if (answers_.replays()) count_tested(answer.tested);
    return answer.share;
  }

  Answers<PoseAnswer>& answers_;
};

}  // namespace forcelayer::bench
