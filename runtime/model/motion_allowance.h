// The rule that makes rest provable: with the handle held still, the part's energy may only fall.
//
// The contact forces of a sampled scene are not conservative: a part can gain energy on a closed
// path and would then never come to rest. So every motion is judged by its energy,
//   E = kinetic + coupling spring + contact springs,
// and is refused where E would rise, except by what is left of an allowance. The hand's own motion
// fills the allowance (without it a part could not slide over the voxels' steps); it is bounded,
// and it fades while the hand rests. Once it is gone, every motion lowers E by at least a fixed
// multiple of the square of its length, and motions below a least length are not made: so their
// number is finite, and then nothing moves at all.
#pragma once

#include "forcelayer/pose.h"

namespace forcelayer::model {

struct AllowanceLaw {
  double limit_j = 0;
  double fade_s = 0;  // time constant
};

// Work that the hand's last motion could have done on the coupling: clamped force along the path.
double handle_work_j(const Pose& before, const Pose& after, double force_n,
                     double torque_nm) noexcept;

// The allowance one frame later, with `work_j` from the hand. Ends at exactly zero.
double faded_allowance_j(double allowance_j, double work_j, const AllowanceLaw& law,
                         double dt_s) noexcept;

}  // namespace forcelayer::model
