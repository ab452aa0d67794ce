// Energy at the hand: a passivity observer per contact episode (after Hannaford and Ryu 2002), the
// entry into contact without a blow, and a damper that takes back what was generated.
#pragma once

#include "forcelayer/pose.h"

namespace forcelayer::coupling {

// Energy that the hand was given, by contact episode, J.
struct EpisodeEnergy {
  double given_j = 0;           // since the episode began; negative: the hand paid
  double peak_j = 0;            // highest of that since then, at least 0
  double generated_j = 0;       // sum of the peaks of past episodes
  double damping_ns_per_m = 0;  // that the passivity controller injects now
};

// Work of a wrench about the handle's origin that was held while the handle went from one pose to
// another, J. Positive: the hand received it. (A device holds its output between samples, so this
// is exact.)
double held_work_j(const Wrench& wrench, const Pose& from, const Pose& to) noexcept;

// Adds what the hand received. The peak of that sum is energy that a passive scene, which stores
// nothing at first, could not give. An episode ends in free space, where the wrench is exactly
// zero. It takes its credit with it: a credit that stayed would hide later activity.
void add_given(EpisodeEnergy& energy, double to_hand_j) noexcept;
void end_episode(EpisodeEnergy& energy) noexcept;
inline double total_generated_j(const EpisodeEnergy& energy) noexcept {
  return energy.generated_j + energy.peak_j;
}

// The stretch that is felt. Free space gives the hand exactly zero, whatever the coupling's stretch
// (paper 5.2). When contact begins, the hand has not paid for that stretch: felt at once it would
// be a blow, and energy from nowhere. So `held_back` begins as the stretch of that moment, and of a
// later stretch the component along it is not felt, up to its size. It only shrinks: with the
// stretch, and with time, so that a part far from a hand that jumped is felt again, gently.
glm::dvec3 felt_stretch(const glm::dvec3& stretch, glm::dvec3& held_back, double dt_s) noexcept;

inline constexpr double kHeldBackFadeS = 2;

// The passivity controller: a damper at the handle that takes back the energy which the hand was
// given in this episode beyond what it paid. It is no stronger than `limit_ns_per_m`, never drives,
// and vanishes with the debt. Its strength follows the need within kControlS, up and down, so that
// it cannot buzz. The damper of the rotation is the same times `radius_m` squared.
Wrench passivity_damping(EpisodeEnergy& energy, const Twist& handle_velocity, double radius_m,
                         double limit_ns_per_m, double dt_s) noexcept;

inline constexpr double kControlS = 0.005;

}  // namespace forcelayer::coupling
